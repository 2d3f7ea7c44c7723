"""Runs scenes through the isolator, on as many processes as wanted: the answer is the same for any number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, TypeAlias

import numpy as np

from contactsense import ContactIsolator, ForceTorqueSensor, NoiseModel, Robot

from ..harness import Report, silent
from ..parallel import run_trials
from .information import rank_deficit
from .instruments import Method, observed, sensor_links
from .judge import Verdict, judge, judge_answers
from .noise import NONE, Noise
from .pseudoinverse import isolate as isolate_by_pseudoinverse
from .scenes import Scene

ROBOT = "atlas"
CHUNK = 100
THRESHOLD = 1e-3  # [N, Nm], the paper's and the isolator's default


# What the isolator is told of the noise.
Stated: TypeAlias = Literal["nothing", "thresholds", "noise model"]


@dataclass(frozen=True)
class Setting:
    """How scenes are measured and isolated."""

    method: Method = "torques"
    noise: Noise = NONE
    stated: Stated = "nothing"
    # [N, Nm], one or one a coordinate; none: those of the noise model.
    torque_threshold: float | tuple[float, ...] | None = THRESHOLD
    # [N, Nm], one or six a sensor
    wrench_threshold: float | tuple[tuple[float, ...], ...] = THRESHOLD
    solver: Literal["contactsense", "pseudoinverse"] = "contactsense"


@dataclass(frozen=True)
class Task:
    """A chunk of scenes under one setting; `start` is the first one's number, which seeds its noise."""

    setting: Setting
    scenes: Sequence[Scene]
    start: int
    seed: int


def make_isolator(robot: Robot, setting: Setting) -> ContactIsolator:
    """The isolator for a setting, with the sensors of its method."""
    options: dict[str, Any] = {}
    if setting.torque_threshold is not None:
        options["torque_threshold"] = setting.torque_threshold
    if setting.stated == "noise model":
        noise = setting.noise
        options["noise"] = NoiseModel(torque=noise.torque, relative=noise.relative, model=0.0)
    if setting.method != "torques":
        options["sensors"] = make_sensors(setting.method)
        options["wrench_threshold"] = setting.wrench_threshold
    return ContactIsolator(robot, **options)


def make_sensors(method: Method) -> list[ForceTorqueSensor]:
    """The sensors of a method, each in its link's frame and named after it."""
    return [ForceTorqueSensor(link, link) for link in sensor_links(method)]


def run_task(task: Task) -> list[Verdict]:
    """Isolates and judges every scene of a task."""
    robot, setting = shared_robot(), task.setting
    if setting.solver == "pseudoinverse":
        return [
            judge_answers(
                scene,
                isolate_by_pseudoinverse(robot, scene),
                _deficit(tuple(scene.q), scene.links, "torques"),
            )
            for scene in task.scenes
        ]
    isolator = _isolator(setting)
    verdicts = []
    for number, scene in enumerate(task.scenes, task.start):
        tau, wrenches = observed(robot, scene, setting.method, setting.noise, [task.seed, 9, number])
        arguments = (scene.q, tau) if wrenches is None else (scene.q, tau, wrenches)
        deficit = _deficit(tuple(scene.q), scene.links, setting.method)
        verdicts.append(judge(robot, scene, isolator.isolate(*arguments), deficit))
    return verdicts


def run_tasks(
    tasks: Sequence[Task], processes: int | None = None, progress: Report = silent
) -> tuple[list[list[Verdict]], bool]:
    """Verdicts of each task, in the tasks' order, and whether these are all: Ctrl-C ends it early."""
    chunks = [
        (number, Task(task.setting, task.scenes[start : start + CHUNK], task.start + start, task.seed))
        for number, task in enumerate(tasks)
        for start in range(0, len(task.scenes), CHUNK)
    ]
    results: list[list[Verdict]] = [[] for _ in tasks]
    found, complete = run_trials(
        _run_numbered, chunks, "isolating", processes, progress, lambda chunk: len(chunk[1].scenes)
    )
    for (number, _), verdicts in zip(chunks, found, strict=False):
        results[number] += verdicts
    return results, complete


def _run_numbered(chunk: tuple[int, Task]) -> list[Verdict]:
    return run_task(chunk[1])


@lru_cache(maxsize=1)
def shared_robot() -> Robot:
    """The study's robot, loaded once a process."""
    return Robot.named(ROBOT)


@lru_cache(maxsize=8)
def _isolator(setting: Setting) -> ContactIsolator:
    return make_isolator(shared_robot(), setting)


@lru_cache(maxsize=10_000)
def _deficit(q: tuple[float, ...], links: tuple[str, ...], method: Method) -> int:
    return rank_deficit(shared_robot(), np.array(q), links, method)
