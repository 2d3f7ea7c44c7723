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
    """A filter, and the noise of the torques it is fed."""

    name: str
    motion: MotionModel = "curvature"
    likelihood: Likelihood = "gaussian"
    noise: float = 0.0  # [%] of each external torque, standard deviation
    schedule: Literal["adaptive", "paper"] = "adaptive"
    # What the filter is told of its torques, beyond the noise above.
    torque_noise: float = 0.02  # [Nm]
    relative_noise: float = 0.01


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
# Friction turns a force away from the normal: torques that follow from the normal are off by such a share.
RUBBING = Filter("curvature", relative_noise=0.1)
SPHERE = (*MODELS, PRINTED, *NOISES[1:])

EXPERIMENTS = (
    Experiment("random", "random", "sphere", SPHERE),
    Experiment("deliberate", "deliberate", "sphere", SPHERE),
    Experiment("cube", "random", "cube", (CURVATURE,)),
    Experiment("smooth pole", "null space", "cylinder", (CURVATURE,)),
    Experiment("pole", "null space", "cylinder", (RUBBING,), friction=0.2, model_error=0.05),
)
BY_NAME = {experiment.name: experiment for experiment in EXPERIMENTS}
