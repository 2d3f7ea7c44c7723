"""Simulated robots with MuJoCo, to try out touch sensing where the truth is known."""

from .arm import SimulatedRobot
from .contact_path import ContactPath, Pace, PathPoint
from .controller import ComputedTorqueController
from .coordinates import Coordinates
from .deepest import ContactQuery, DeepestPoint
from .disturbance import TorqueError, perturbed_model
from .exploration import joint_exploration, null_space_exploration, sliding_exploration
from .floor import FLOOR_TYPE, Floor
from .geoms import Geom, geoms_of, named_geoms
from .impedance import HandImpedanceController, ImpedanceController
from .measurement import Measurement
from .mjcf import mjcf_string, mjcf_tree
from .noise import TorqueNoise, WrenchNoise
from .obstacles import CubeObstacle, CylinderObstacle, Obstacle, SphereObstacle, obstacle_from_dict
from .penalty import ContactForce, PenaltyContact, joint_torque
from .push import Push, random_push
from .quasi_static import record_quasi_static
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
    "Geom",
    "HandImpedanceController",
    "ImpedanceController",
    "Measurement",
    "Obstacle",
    "Pace",
    "PathPoint",
    "PenaltyContact",
    "Push",
    "SimulatedRobot",
    "SineTrajectory",
    "Sole",
    "SphereObstacle",
    "StandingController",
    "TorqueError",
    "TorqueNoise",
    "TouchScene",
    "TrajectoryPoint",
    "WrenchNoise",
    "geoms_of",
    "joint_exploration",
    "joint_torque",
    "mjcf_string",
    "mjcf_tree",
    "named_geoms",
    "null_space_exploration",
    "obstacle_from_dict",
    "perturbed_model",
    "random_push",
    "record_quasi_static",
    "record_run",
    "sliding_exploration",
    "touch_scene",
]
