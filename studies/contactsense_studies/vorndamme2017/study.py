"""All experiments in one run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeAlias, get_args

import numpy as np

from contactsense import Robot

from ..harness import Report, silent
from ..parallel import run_trials
from .hits import ideal_series, scaled, simulated_series
from .instruments import METHODS, Method
from .isolation import Setting, Task, run_tasks, shared_robot
from .judge import Verdict
from .noise import Noise, noise_cases
from .noisy_settings import stated_settings
from .options import Options
from .scenes import Scene, fives, pairs, singles
from .time_series import Series
from .timing import Timing, measure

TIMED = 1000  # scenes
SIMULATED = 5  # one hit in so many
AMPLITUDES = (1.0, 50.0)  # [N]
NOISY_METHODS: tuple[Method, ...] = ("torques", "both")


@dataclass(frozen=True)
class Run:
    """One set of scenes under one setting."""

    name: str  # "singles", "pairs", "pairs by area", "fives"
    setting: Setting
    scenes: list[Scene]
    verdicts: list[Verdict]


# With the errors of (6) and (10); of (6) alone, the acceleration without delay; on a simulated robot.
Kind: TypeAlias = Literal["late", "prompt", "simulated"]


@dataclass(frozen=True)
class Hits:
    """Hits of one size over time."""

    amplitude: float  # [N]
    kind: Kind
    series: list[Series]


@dataclass(frozen=True)
class Study:
    """All runs."""

    options: Options
    robot: Robot
    runs: list[Run]
    hits: list[Hits]
    timings: list[Timing] = field(default_factory=list)
    complete: bool = True  # Ctrl-C did not end it early

    def run(self, name: str, method: Method) -> Run:
        """The run of a set of scenes with ideal measurements."""
        for run in self.runs:
            if (run.name, run.setting) == (name, Setting(method)):
                return run
        raise KeyError((name, method))

    def baseline(self, name: str) -> Run:
        """The paper's steps with true links, on a set of scenes."""
        return next(run for run in self.runs if run.name == name and run.setting.solver == "pseudoinverse")


def run(
    options: Options | None = None,
    *,
    processes: int | None = None,
    methods: Sequence[Method] = METHODS,
    progress: Report = silent,
) -> Study:
    """Runs the study; `progress` is told the stage, and how much of it is done.

    The answer, but for the timings, depends on the options alone, not on `processes` (default: one a core).
    Ctrl-C ends it early, with the scenes that are finished.

    Raises:
        InputError: an option cannot be used.
    """
    options = options or Options()
    robot = shared_robot()
    sets = _scenes(robot, options)
    over_time = [method for method in methods if method != "distal"]
    tasks = _tasks(robot, sets, options, methods)
    verdicts, complete = run_tasks([task for _, task in tasks], processes, progress)
    runs = [
        Run(name, task.setting, list(task.scenes[: len(found)]), found)
        for (name, task), found in zip(tasks, verdicts, strict=True)
        if found
    ]
    hits: list[Hits] = []
    timings: list[Timing] = []
    if complete:
        hits, complete = _hits(sets["singles"][: options.hits], over_time, processes, progress)
    if complete:
        timed = [
            (sets[name][:TIMED], method) for method in over_time for name in ("singles", "pairs", "fives")
        ]
        try:
            for number, (scenes, method) in enumerate(timed, 1):
                timings.append(measure(robot, scenes, method))
                progress("timing", number, len(timed))
        except KeyboardInterrupt:
            complete = False
    return Study(options, robot, runs, hits, timings, complete)


def _scenes(robot: Robot, options: Options) -> dict[str, list[Scene]]:
    seed, cone, random_poses = options.seed, np.radians(options.cone), options.random_poses
    return {
        "singles": singles(robot, options.singles, seed, cone=cone, random_poses=random_poses),
        "pairs": pairs(robot, options.pairs, seed, cone=cone, random_poses=random_poses),
        "pairs by area": pairs(robot, options.pairs, seed, by="area", cone=cone, random_poses=random_poses),
        "fives": fives(robot, options.fives, seed, cone=cone, random_poses=random_poses),
    }


def _tasks(
    robot: Robot, sets: dict[str, list[Scene]], options: Options, methods: Sequence[Method]
) -> list[tuple[str, Task]]:
    tasks = []
    for name, scenes in sets.items():
        for method in methods:
            tasks.append((name, Task(Setting(method), scenes, 0, options.seed)))
        tasks.append((name, Task(Setting(solver="pseudoinverse"), scenes, 0, options.seed)))
    for name in ("singles", "pairs", "fives"):
        for method in [method for method in methods if method != "distal"]:
            tasks.append((name, Task(Setting(method, Noise(options.noise)), sets[name], 0, options.seed)))
        for method in [method for method in methods if method in NOISY_METHODS]:
            for noise in noise_cases(options.noise):
                for setting in stated_settings(robot, sets[name], method, noise):
                    tasks.append((name, Task(setting, sets[name], 0, options.seed)))
    return tasks


def _hits(
    scenes: Sequence[Scene],
    methods: Sequence[Method],
    processes: int | None,
    progress: Report,
) -> tuple[list[Hits], bool]:
    sets: list[tuple[Kind, float]] = [(kind, size) for kind in get_args(Kind) for size in AMPLITUDES]
    items = [
        (kind, scaled(scene, amplitude), tuple(methods))
        for kind, amplitude in sets
        for scene in (scenes[::SIMULATED] if kind == "simulated" else scenes)
    ]
    found, complete = run_trials(_hit, items, "impacts over time", processes, progress)
    series: dict[tuple[Kind, float], list[Series]] = {kind_and_size: [] for kind_and_size in sets}
    for (kind, _, _), one in zip(items, found, strict=False):
        size = min(AMPLITUDES, key=lambda amplitude: abs(amplitude - one.amplitude))
        series[kind, size].append(one)
    hits = [Hits(amplitude, kind, series[kind, amplitude]) for kind, amplitude in sets]
    return [each for each in hits if each.series], complete


HitItem: TypeAlias = tuple[Kind, Scene, tuple[Method, ...]]


def _hit(item: HitItem) -> Series:
    kind, scene, methods = item
    if kind == "simulated":
        return simulated_series(shared_robot(), scene, [each for each in methods if each != "sensors"])
    return ideal_series(shared_robot(), scene, methods, late=kind == "late")
