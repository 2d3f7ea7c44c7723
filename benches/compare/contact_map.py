"""`ContactMap.evaluate` beside the same posterior with Pinocchio and NumPy, on noisy torques."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import contactsense as cs

from . import robots
from .reference_map import ReferenceMap
from .timing import Comparison, Pace, time_calls

FloatArray = NDArray[np.float64]
Case = tuple[FloatArray, FloatArray, str]  # q, tau_ext, link

SAMPLES = 5_000
DEVIATION = 0.3  # of each torque [Nm; N of a floating base]
FORCE = (10.0, 60.0)  # [N]
CONE = 0.3  # largest tangential force, as a share of the normal one
GARBAGE = (1.0, 100.0)  # standard deviation of torques without a cause [Nm]
EACH = 10  # pushes for one scene of the other comparisons
REPEATS = 3
MIN_RATIO = 30.0
MAX_US = {"iiwa14": 500.0, "panda": 500.0, "atlas": 800.0, "talos": 800.0}
# In so many of so many pushes the true link has this much of the posterior. The peer does not divide its
# samples, which are too far apart for the narrow posteriors of a humanoid.
CHECKED, LIKELY, OURS_RIGHT, PEER_RIGHT = 100, 0.05, 0.9, 0.75


def compare(pace: Pace) -> list[Comparison]:
    """Two arms and two humanoids: pushes, and torques without any cause, which have no peer."""
    results = []
    for name, limit in MAX_US.items():
        robot, model = _robot(name)
        noise = cs.NoiseModel(torque=DEVIATION, model=0.0, relative=0.0)
        ours = cs.ContactMap(robot, samples=SAMPLES, noise=noise)
        peer = ReferenceMap(robot, model, samples=SAMPLES, deviation=DEVIATION)
        checked = [_push(robot, model, seed) for seed in range(CHECKED)]
        assert _right(ours, checked) >= OURS_RIGHT
        assert _right(peer, checked) >= PEER_RIGHT
        cases = [_push(robot, model, seed) for seed in range(EACH * pace.scenes)]
        contestants = [
            ("contactsense", partial(_calls, ours, cases)),
            ("pinocchio, numpy", partial(_calls, peer, cases)),
        ]
        timings = time_calls(contestants, REPEATS)
        task = f"contact map, {name}, {SAMPLES:,} samples"
        results.append(
            Comparison(f"{task}, one contact", timings, max_us=limit, min_ratio=MIN_RATIO, has_tail=True)
        )
        cases = [_garbage(robot, model, seed) for seed in range(EACH * pace.scenes)]
        timings = time_calls([("contactsense", partial(_calls, ours, cases))], REPEATS)
        results.append(Comparison(f"{task}, random torques", timings, max_us=limit, has_tail=True))
    return results


def _robot(name: str) -> tuple[cs.Robot, Any]:
    if name == "talos":
        return robots.talos()
    return robots.panda()[1:] if name == "panda" else robots.packaged(name)


def _calls(contact_map: Any, cases: list[Case]) -> list[Callable[[], object]]:
    return [partial(contact_map.evaluate, q, torque) for q, torque, _ in cases]


def _right(contact_map: Any, cases: list[Case]) -> float:
    """In which share of the cases the true link is likely."""
    likely = [contact_map.evaluate(q, torque).link_probabilities[link] > LIKELY for q, torque, link in cases]
    return float(np.mean(likely))


def _push(robot: cs.Robot, model: Any, seed: int) -> Case:
    rng = np.random.default_rng([seed, robot.nv])
    q = robots.random_posture(model, rng)
    link = str(rng.choice([link for link in robot.link_names if robot.jacobian(q, link).any()]))
    sample = robot.surface(link).sample(1, seed=int(rng.integers(2**32)))
    pose = robot.link_pose(q, link)
    point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
    inward = rng.uniform(-CONE, CONE, 3) - pose[:3, :3] @ sample.normals[0]
    force = rng.uniform(*FORCE) * inward / np.linalg.norm(inward)
    torque = robot.jacobian(q, link, point)[:3].T @ force
    return q, torque + DEVIATION * rng.standard_normal(robot.nv), link


def _garbage(robot: cs.Robot, model: Any, seed: int) -> Case:
    rng = np.random.default_rng([seed, robot.nv, 1])
    q = robots.random_posture(model, rng)
    return q, rng.uniform(*GARBAGE) * rng.standard_normal(robot.nv), ""
