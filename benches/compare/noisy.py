"""`ContactMonitor.update` on noisy torques: one contact, two contacts, and torques without any cause.

Noiseless torques are the easy case: one force explains them to rounding. With noise the search for other
explanations runs, and what counts is its worst tick.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import contactsense as cs

from . import robots
from .reference_monitor import ReferenceMonitor
from .timing import Comparison, Pace, time_calls

FloatArray = NDArray[np.float64]

DT = 1e-3  # [s]
GAIN = 500.0  # [1/s]
THRESHOLD = 0.5  # [Nm], the default of ContactMonitor
NOISE = 0.1  # of each torque in each tick, standard deviation [Nm]
FORCE = (10.0, 60.0)  # [N]
GARBAGE = (1.0, 100.0)  # standard deviation of torques without a cause [Nm]
TICKS = 50  # of one scene
REPEATS = 3
CONE = 0.3  # largest tangential force, as a share of the normal one
ROBOTS: dict[str, tuple[str, bool, tuple[str, ...], float]] = {
    # path, floating base, locked joints, limit on the slowest tick [us]
    "xarm7": ("xarm_description/urdf/xarm7.urdf", False, (), 500.0),
    "panda": (
        "panda_description/urdf/panda.urdf",
        False,
        ("panda_finger_joint1", "panda_finger_joint2"),
        500.0,
    ),
    "talos": ("talos_data/robots/talos_full_v2.urdf", True, (), 1000.0),
    "g1": ("g1_description/urdf/g1_29dof_rev_1_0.urdf", True, (), 1000.0),
}


class Scene(NamedTuple):
    """A robot at rest and what its joints measure tick by tick."""

    q: FloatArray
    torques: list[FloatArray]


def compare(pace: Pace) -> list[Comparison]:
    """Four robots; the peer takes one contact only."""
    results = []
    for name, (path, floating, locked, limit) in ROBOTS.items():
        robot, model = robots.example(path, floating_base=floating, locked=locked)
        ours = cs.ContactMonitor(robot, dt=DT, observer_gain=GAIN, torque_threshold=THRESHOLD)
        peer = ReferenceMonitor(model, robot, dt=DT, threshold=THRESHOLD)
        kinds: dict[str, Callable[[FloatArray, np.random.Generator], FloatArray]] = {
            "one contact": partial(_pushes, robot, 1),
            "two contacts": partial(_pushes, robot, 2),
        }
        for kind, torque in kinds.items():
            scenes = [_scene(robot, model, torque, seed) for seed in range(pace.scenes)]
            contestants = [("contactsense", partial(_calls, ours, scenes))]
            if kind == "one contact":
                contestants.append(("pinocchio, numpy, trimesh, embree", partial(_calls, peer, scenes)))
            timings = time_calls(contestants, REPEATS)
            results.append(Comparison(f"noisy tick, {name}, {kind}", timings, max_worst_us=limit))
        scenes = [_garbage(robot, model, seed) for seed in range(pace.scenes)]
        timings = time_calls([("contactsense", partial(_calls, ours, scenes))], REPEATS)
        results.append(Comparison(f"noisy tick, {name}, random torques", timings, max_worst_us=limit))
    return results


def _calls(monitor: Any, scenes: Sequence[Scene]) -> list[Callable[[], object]]:
    """Every tick of every scene; the first of a scene starts anew."""
    calls: list[Callable[[], object]] = []
    for q, torques in scenes:
        rest = np.zeros(len(torques[0]))
        calls.append(partial(_first, monitor, q, rest, torques[0]))
        calls += [partial(monitor.update, q, rest, torque) for torque in torques[1:]]
    return calls


def _first(monitor: Any, *sample: FloatArray) -> None:
    monitor.reset()
    monitor.update(*sample)


def _scene(
    robot: cs.Robot,
    model: Any,
    torque: Callable[[FloatArray, np.random.Generator], FloatArray],
    seed: int,
) -> Scene:
    rng = np.random.default_rng([seed, robot.nv])
    q = robots.random_posture(model, rng)
    held = _held(robot, q) - torque(q, rng)
    return Scene(q, [held + NOISE * rng.standard_normal(robot.nv) for _ in range(TICKS)])


def _garbage(robot: cs.Robot, model: Any, seed: int) -> Scene:
    rng = np.random.default_rng([seed, robot.nv, 1])
    q = robots.random_posture(model, rng)
    sizes = rng.uniform(*GARBAGE, TICKS)
    return Scene(q, [_held(robot, q) - size * rng.standard_normal(robot.nv) for size in sizes])


def _held(robot: cs.Robot, q: FloatArray) -> FloatArray:
    rest = np.zeros(robot.nv)
    return robot.inverse_dynamics(q, rest, rest)


def _pushes(robot: cs.Robot, count: int, q: FloatArray, rng: np.random.Generator) -> FloatArray:
    """External torque of so many pushes on links that move."""
    torque = np.zeros(robot.nv)
    moving = [link for link in robot.link_names if robot.jacobian(q, link).any()]
    for link in rng.choice(moving, count, replace=False):
        sample = robot.surface(link).sample(1, seed=int(rng.integers(2**32)))
        pose = robot.link_pose(q, link)
        point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
        inward = rng.uniform(-CONE, CONE, 3) - pose[:3, :3] @ sample.normals[0]
        force = rng.uniform(*FORCE) * inward / np.linalg.norm(inward)
        torque += robot.jacobian(q, link, point)[:3].T @ force
    return torque
