"""Contacts on a simulated robot: what is estimated, against the truth.

"iiwa14" is an arm that moves fast, with short contacts: once with ideal torques, and once with the errors of
a real arm, which is calibrated. "atlas" is a humanoid that stands and is pushed.

`run` simulates and scores, `save_picture` draws, `as_data` gives what `--json` prints.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

from .._extras import require
from ..errors import InputError
from .result import DemoResult, HitResult, ImperfectResult, Progress, as_data

if TYPE_CHECKING:
    from pathlib import Path

__all__ = [
    "ROBOTS",
    "DemoResult",
    "HitResult",
    "ImperfectResult",
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
    imperfect: bool = True,
    on_progress: Callable[[Progress], None] | None = None,
) -> DemoResult:
    """Simulates the robot with random contacts, and compares what a `ContactMonitor` reports with the truth.

    Args:
        robot: one of `ROBOTS`.
        seed: of the motion, the contacts and the noise; same seed, same result.
        noise: standard deviation of every measured torque, new each tick: percent of the torque, and [Nm].
        sensor_noise: standard deviation of every measured wrench of "atlas", new each tick: [N] and [Nm].
        gain: of the observer [1/s]; by default from the noise, see `settings`.
        imperfect: whether "iiwa14" is then moved and pushed in the same way with the errors of a real arm,
            calibrated from motion without contact. `noise` and `gain` do not apply to this run.
        on_progress: called every few ticks and after every contact.

    Raises:
        InputError: an argument cannot be used; names it.
        MissingExtraError: MuJoCo is not installed.
    """
    if robot not in ROBOTS:
        raise InputError(f"robot: the demo has no robot {robot!r}; there is {', '.join(ROBOTS)}")
    if seed < 0:
        raise InputError(f"seed: must be zero or positive, not {seed}")
    require("demo", "mujoco")
    from ..sim import TorqueNoise, WrenchNoise
    from . import arm, humanoid
    from .loop import run_loop

    with _naming("noise"):
        torque_noise = TorqueNoise(percent=noise[0], newton_metres=noise[1], seed=seed)
    with _naming("sensor_noise"):
        wrench_noise = WrenchNoise(newtons=sensor_noise[0], newton_metres=sensor_noise[1], seed=seed)
    prepare = humanoid.prepare if robot == humanoid.NAME else arm.prepare
    setup = prepare(seed, torque_noise, wrench_noise, gain)
    result = run_loop(setup, seed, torque_noise, wrench_noise, on_progress)
    if not imperfect or robot != arm.NAME:
        return result
    from .imperfect import run_imperfect

    if on_progress is not None:
        pushes = len(setup.pushes)
        on_progress(Progress(setup.end, setup.end, result.hits, pushes, setup.settings, "", imperfect=True))
    motion = arm.plan_motion(setup.robot, seed)
    return replace(result, imperfect=run_imperfect(setup.robot, motion, setup.pushes, setup.end, seed))


@contextmanager
def _naming(argument: str) -> Iterator[None]:
    """Names the argument in errors about a part of it."""
    try:
        yield
    except InputError as cause:
        raise InputError(f"{argument}: {cause}") from None


def save_picture(result: DemoResult, path: str | os.PathLike[str]) -> Path:
    """Writes torques, detection and forces of a run as a picture; returns its absolute path.

    Raises:
        InputError: the file cannot be written.
        MissingExtraError: matplotlib is not installed.
    """
    require("demo", "matplotlib")
    from .figure import save_figure

    return save_figure(result, path)
