"""A simulated robot is hit: what it feels, against the truth.

"iiwa14" is an arm that is hit while it moves fast; "atlas" a humanoid that is pushed while it stands.

`run` simulates and scores, `save_picture` draws, `as_data` gives what `--json` prints.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING

from .._extras import require
from ..errors import InputError
from .result import DemoResult, HitResult, Progress, as_data
from .settings import Noise

if TYPE_CHECKING:
    from pathlib import Path

__all__ = [
    "ROBOTS",
    "DemoResult",
    "HitResult",
    "Noise",
    "Progress",
    "as_data",
    "run",
    "save_picture",
]

ROBOTS = ("iiwa14", "atlas")


def run(
    *,
    robot: str = "iiwa14",
    seed: int = 0,
    noise: tuple[float, float] = (0.0, 0.0),
    sensor_noise: tuple[float, float] = (0.0, 0.0),
    gain: float | None = None,
    on_progress: Callable[[Progress], None] | None = None,
) -> DemoResult:
    """Simulates the robot, hits it at random, and scores what a `ContactMonitor` says.

    Args:
        robot: one of `ROBOTS`.
        seed: of the motion, the hits and the noise; same seed, same result.
        noise: standard deviation of every measured torque, new each tick: percent of the torque, and [Nm].
        sensor_noise: standard deviation of every measured wrench of "atlas", new each tick: [N] and [Nm].
        gain: of the observer [1/s]; by default from the noise, see `settings`.
        on_progress: called every few ticks and after every hit.

    Raises:
        InputError: an argument cannot be used; names it.
        MissingExtraError: MuJoCo is not installed.
    """
    if robot not in ROBOTS:
        raise InputError(f"robot: the demo has no robot {robot!r}; there is {', '.join(ROBOTS)}")
    if seed < 0:
        raise InputError(f"seed: must be zero or positive, not {seed}")
    require("demo", "mujoco")
    if robot == "atlas":
        from .atlas.experiment import run_experiment as run_standing
        from .atlas.settings import SensorNoise

        return run_standing(seed, Noise(*noise), SensorNoise(*sensor_noise), gain, on_progress)
    if any(sensor_noise):
        raise InputError(f"sensor_noise: '{robot}' has no force/torque sensors; leave it at zero")
    from .experiment import run_experiment

    return run_experiment(robot, seed, Noise(*noise), gain, on_progress)


def save_picture(result: DemoResult, path: str | os.PathLike[str]) -> Path:
    """Writes torques, detection and forces of a run as a picture; returns its absolute path.

    Raises:
        InputError: the file cannot be written.
        MissingExtraError: matplotlib is not installed.
    """
    require("demo", "matplotlib")
    if result.standing is not None:
        from .atlas.figure import save_figure as save_standing

        return save_standing(result, path)
    from .figure import save_figure

    return save_figure(result, path)
