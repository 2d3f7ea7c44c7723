"""Simulated robots with MuJoCo, to try out touch sensing where the truth is known."""

from .arm import Measurement, SimulatedRobot
from .controller import ComputedTorqueController
from .coordinates import Coordinates
from .geoms import Geom, geoms_of
from .mjcf import mjcf_string, mjcf_tree
from .models import model_from_urdf, named_model
from .noise import TorqueNoise
from .push import Push, random_push
from .trajectory import SineTrajectory, TrajectoryPoint

__all__ = [
    "ComputedTorqueController",
    "Coordinates",
    "Geom",
    "Measurement",
    "Push",
    "SimulatedRobot",
    "SineTrajectory",
    "TorqueNoise",
    "TrajectoryPoint",
    "geoms_of",
    "mjcf_string",
    "mjcf_tree",
    "model_from_urdf",
    "named_model",
    "random_push",
]
