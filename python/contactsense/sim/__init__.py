"""Simulated robots with MuJoCo, to try out touch sensing where the truth is known."""

from .arm import SimulatedRobot
from .controller import ComputedTorqueController
from .coordinates import Coordinates
from .floor import FLOOR_TYPE, Floor
from .geoms import Geom, geoms_of
from .measurement import Measurement
from .mjcf import mjcf_string, mjcf_tree
from .models import model_from_urdf, named_geoms, named_model
from .noise import TorqueNoise, WrenchNoise
from .push import Push, random_push
from .sensors import SensorMount
from .standing import Sole, StandingController
from .trajectory import SineTrajectory, TrajectoryPoint

__all__ = [
    "FLOOR_TYPE",
    "ComputedTorqueController",
    "Coordinates",
    "Floor",
    "Geom",
    "Measurement",
    "Push",
    "SensorMount",
    "SimulatedRobot",
    "SineTrajectory",
    "Sole",
    "StandingController",
    "TorqueNoise",
    "TrajectoryPoint",
    "WrenchNoise",
    "geoms_of",
    "mjcf_string",
    "mjcf_tree",
    "model_from_urdf",
    "named_geoms",
    "named_model",
    "random_push",
]
