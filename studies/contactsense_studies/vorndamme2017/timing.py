"""How long an isolation takes from Python, in one process that does nothing else."""

from __future__ import annotations

import gc
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from contactsense import Robot

from .instruments import Method, observed
from .isolation import Setting, make_isolator
from .scenes import Scene

REPEATS = 3
# What the paper reports, mean and max [s]: (contacts, method).
PAPER: dict[tuple[int, Method], tuple[float, float]] = {
    (1, "torques"): (170e-6, 570e-6),
    (2, "torques"): (3600e-6, 31_800e-6),
    (5, "torques"): (11_000e-6, 43_200e-6),
    (1, "both"): (250e-6, 670e-6),
    (2, "both"): (280e-6, 750e-6),
    (5, "both"): (520e-6, 920e-6),
}
# What this library aims at, mean and max [s], so that a contact costs a small part of a 1 kHz tick.
GOALS: dict[tuple[int, Method], tuple[float, float]] = {
    (1, "torques"): (15e-6, 60e-6),
    (2, "torques"): (60e-6, 300e-6),
    (5, "torques"): (150e-6, 1000e-6),
    (1, "both"): (20e-6, 60e-6),
    (2, "both"): (30e-6, 100e-6),
    (5, "both"): (60e-6, 200e-6),
}


@dataclass(frozen=True)
class Timing:
    """Seconds a call of `ContactIsolator.isolate`."""

    contacts: int
    method: Method
    scenes: int
    mean: float
    max: float  # over scenes, of the fastest of three calls: the work, not the operating system's pauses
    plain_max: float  # over all calls but the very first


def measure(robot: Robot, scenes: Sequence[Scene], method: Method) -> Timing:
    """Times every scene three times in a row, with ideal measurements and default thresholds."""
    isolator = make_isolator(robot, Setting(method))
    inputs = [(scene.q, *observed(robot, scene, method)) for scene in scenes]
    taken = np.empty((len(scenes), REPEATS))
    collecting = gc.isenabled()
    gc.disable()
    try:
        for row, (q, tau, wrenches) in enumerate(inputs):
            arguments = (q, tau) if wrenches is None else (q, tau, wrenches)
            for repeat in range(REPEATS):
                start = time.perf_counter()
                isolator.isolate(*arguments)
                taken[row, repeat] = time.perf_counter() - start
    finally:
        if collecting:
            gc.enable()
    return Timing(
        contacts=len(scenes[0].touches),
        method=method,
        scenes=len(scenes),
        mean=float(taken.mean()),
        max=float(taken.min(axis=1).max()),
        plain_max=float(taken.ravel()[1:].max()),
    )
