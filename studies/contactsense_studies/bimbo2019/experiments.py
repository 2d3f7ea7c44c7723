"""What is compared with what: obstacles, motions, and the filters that follow them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

MotionModel: TypeAlias = Literal["curvature", "fixed_on_link", "fixed_in_world"]
Likelihood: TypeAlias = Literal["gaussian", "exponential"]
Obstacle: TypeAlias = Literal["sphere", "cube", "cylinder"]
# Random poses, points and small motions; chosen poses, and motions that move the contact, or the elbow alone.
Setup: TypeAlias = Literal["random", "deliberate", "null space"]


@dataclass(frozen=True)
class Filter:
    """A filter, and the noise of the torques it is fed, of which it is not told."""

    name: str
    motion: MotionModel = "curvature"
    likelihood: Likelihood = "gaussian"
    noise: float = 0.0  # [%] of each external torque, standard deviation
    schedule: Literal["adaptive", "paper"] = "adaptive"
    measurement: Literal["normal", "friction_cone"] = "normal"


@dataclass(frozen=True)
class Experiment:
    """Runs of one kind, followed by several filters."""

    name: str
    setup: Setup
    obstacle: Obstacle
    filters: tuple[Filter, ...]
    friction: float = 0.0
    model_error: float = 0.0  # relative, of every mass


CURVATURE = Filter("curvature")
MODELS = (CURVATURE, Filter("on link", "fixed_on_link"), Filter("in world", "fixed_in_world"))
PRINTED = Filter("printed", likelihood="exponential", schedule="paper")
NOISES = (CURVATURE, Filter("5 % noise", noise=5.0), Filter("10 % noise", noise=10.0))
RUBBING = Filter("friction cone", measurement="friction_cone")
SPHERE = (*MODELS, PRINTED, *NOISES[1:])

EXPERIMENTS = (
    Experiment("random", "random", "sphere", SPHERE),
    Experiment("deliberate", "deliberate", "sphere", SPHERE),
    Experiment("cube", "random", "cube", (CURVATURE,)),
    Experiment("smooth pole", "null space", "cylinder", (CURVATURE,)),
    Experiment("pole", "null space", "cylinder", (CURVATURE, RUBBING), friction=0.2, model_error=0.05),
)
BY_NAME = {experiment.name: experiment for experiment in EXPERIMENTS}
