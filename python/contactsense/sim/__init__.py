"""Simulated robots, with MuJoCo or in closed form, to try out touch sensing where the truth is known."""

from .arm import SimulatedRobot
from .contact_path import ContactPath, Pace, PathPoint
from .controller import ComputedTorqueController
from .coordinates import Coordinates
from .deepest import ContactQuery, DeepestPoint
from .disturbance import TorqueError, perturbed_model
from .exploration import joint_exploration, null_space_exploration, sliding_exploration
from .external_torque import external_torque
from .floor import FLOOR_TYPE, Floor
from .friction import Friction
from .geoms import Geom, geoms_of, named_geoms
from .impedance import HandImpedanceController, ImpedanceController
from .imperfect_arm import ImperfectArm
from .imperfect_record import record_imperfect
from .imperfect_run import ImperfectRun, RecordedContact, Truth
from .joint_motion import JointMotion
from .joint_size import rated_torque
from .measurement import Measurement
from .mjcf import mjcf_string, mjcf_tree
from .noise import TorqueNoise, WrenchNoise
from .obstacles import CubeObstacle, CylinderObstacle, Obstacle, SphereObstacle, obstacle_from_dict
from .payload import Payload
from .penalty import ContactForce, PenaltyContact, joint_torque
from .person_contact import PersonContact
from .person_scene import PersonScene
from .push import Push, random_push
from .quasi_static import record_quasi_static
from .random_contacts import random_contacts
from .random_moves import random_moves
from .record import record_run
from .run import ContactRun
from .scene import TouchScene, touch_scene
from .standing import Sole, StandingController
from .trajectory import SineTrajectory, TrajectoryPoint

__all__ = [
    "FLOOR_TYPE",
    "ComputedTorqueController",
    "ContactForce",
    "ContactPath",
    "ContactQuery",
    "ContactRun",
    "Coordinates",
    "CubeObstacle",
    "CylinderObstacle",
    "DeepestPoint",
    "Floor",
    "Friction",
    "Geom",
    "HandImpedanceController",
    "ImpedanceController",
    "ImperfectArm",
    "ImperfectRun",
    "JointMotion",
    "Measurement",
    "Obstacle",
    "Pace",
    "PathPoint",
    "Payload",
    "PenaltyContact",
    "PersonContact",
    "PersonScene",
    "Push",
    "RecordedContact",
    "SimulatedRobot",
    "SineTrajectory",
    "Sole",
    "SphereObstacle",
    "StandingController",
    "TorqueError",
    "TorqueNoise",
    "TouchScene",
    "TrajectoryPoint",
    "Truth",
    "WrenchNoise",
    "external_torque",
    "geoms_of",
    "joint_exploration",
    "joint_torque",
    "mjcf_string",
    "mjcf_tree",
    "named_geoms",
    "null_space_exploration",
    "obstacle_from_dict",
    "perturbed_model",
    "random_contacts",
    "random_moves",
    "random_push",
    "rated_torque",
    "record_imperfect",
    "record_quasi_static",
    "record_run",
    "sliding_exploration",
    "touch_scene",
]
