"""`ContactMonitor.update` beside the same steps with Pinocchio, NumPy, trimesh and embree."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

import contactsense as cs

from . import robots
from .reference_monitor import ReferenceMonitor
from .timing import Comparison, Contestant, Pace, Timing, interleave

DT = 1e-3  # [s]
STEPS = 200
SETTLED = 600  # ticks until the observer stands still: exp(-gain DT SETTLED) is 1e-13
THRESHOLD = 0.05  # [Nm]
FORCE = 30.0  # [N]
TRIES = 1000
LOCATED = 0.75  # of the contacts at least; elsewhere another place explains the torques as well
FOLLOW = "for q, v, tau in path: update(q, v, tau)"
HOLD = "update(q, v, tau)"
READ = "contact = update(q, v, tau).contacts[0]; contact.link; contact.point; contact.force"
# Links whose wrench the torques determine.
LINKS = {
    "iiwa14": ["iiwa_link_6", "iiwa_link_7"],
    "atlas": ["l_hand", "r_hand", "utorso", "pelvis", "l_foot"],
}
SILENT = {"iiwa14": "iiwa_link_7", "atlas": "l_hand"}  # links that their joint need not feel
LIMITS = {"iiwa14": (5.0, 10.0), "atlas": (15.0, 40.0)}  # [us], without and with a contact


def compare(pace: Pace) -> list[Comparison]:
    """iiwa14 and Atlas (floating), each without a contact and held at many places."""
    results = []
    for name, (free, touched) in LIMITS.items():
        robot, model = robots.packaged(name)
        results.append(_free(name, robot, model, free, pace))
        results += _touched(name, robot, model, touched, pace)
        results.append(_behind_silent_joint(name, robot, model, touched, pace))
    return results


def _free(name: str, robot: cs.Robot, model: Any, limit: float, pace: Pace) -> Comparison:
    path = robots.motion(model, DT, STEPS, np.random.default_rng(0))
    ours, reference = _monitors(robot, model, 0.5)
    for step in path:
        report, other = ours.update(*step), reference.update(*step)
        assert not report.collision
        assert not other.collision
        np.testing.assert_allclose(other.external_torque, report.external_torque, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(other.acceleration, report.acceleration, rtol=1e-7, atol=1e-7)
    contestants = [
        Contestant("contactsense", FOLLOW, {"path": path, "update": ours.update}, STEPS),
        Contestant("pinocchio, numpy", FOLLOW, {"path": path, "update": reference.update}, STEPS),
    ]
    return Comparison(f"monitor, {name}, no contact", interleave(contestants, pace), max_us=limit)


def _touched(name: str, robot: cs.Robot, model: Any, limit: float, pace: Pace) -> list[Comparison]:
    """The contacts with the median and with the longest time."""
    rng = np.random.default_rng(1)
    runs = []
    for index in range(pace.contacts):
        link = LINKS[name][index % len(LINKS[name])]
        if timings := _touched_once(robot, model, link, pace, rng):
            runs.append((link, timings))
    assert len(runs) >= LOCATED * pace.contacts
    runs.sort(key=lambda run: run[1][0].median)
    chosen = [(f"median of {len(runs)}", runs[(len(runs) - 1) // 2]), (f"slowest of {len(runs)}", runs[-1])]
    return [
        Comparison(f"monitor, {name}, {link}, {which}", timings, max_us=limit)
        for which, (link, timings) in chosen
    ]


def _touched_once(
    robot: cs.Robot, model: Any, link: str, pace: Pace, rng: np.random.Generator
) -> list[Timing] | None:
    """None where another place explains the torques about as well."""
    step = _held_contact(robot, model, link, rng)
    ours, reference = _monitors(robot, model, THRESHOLD)
    for _ in range(SETTLED):
        report, other = ours.update(*step), reference.update(*step)
    contact = report.contacts[0]
    assert contact.link == link
    if not contact.located:
        return None
    assert other.contact is not None
    assert other.contact.link == link
    # The reference's round shapes are tessellated.
    np.testing.assert_allclose(other.contact.point, contact.point, rtol=0, atol=1e-3)
    np.testing.assert_allclose(other.contact.force, contact.force, rtol=0, atol=0.02 * FORCE)
    names = dict(zip(("q", "v", "tau"), step, strict=True))
    contestants = [
        Contestant("contactsense", HOLD, {**names, "update": ours.update}),
        Contestant("pinocchio, numpy, trimesh, embree", HOLD, {**names, "update": reference.update}),
        Contestant("contactsense, contact read too", READ, {**names, "update": ours.update}),
    ]
    return interleave(contestants, pace)


def _behind_silent_joint(name: str, robot: cs.Robot, model: Any, limit: float, pace: Pace) -> Comparison:
    """The slowest contact that its link's own joint does not feel; the reference cannot find it."""
    rng = np.random.default_rng(2)
    link = SILENT[name]
    runs = []
    for _ in range(pace.contacts):
        q, v, tau = _held_contact(robot, model, link, rng, felt=False)
        monitor = cs.ContactMonitor(robot, dt=DT, torque_threshold=THRESHOLD)
        for _ in range(SETTLED):
            report = monitor.update(q, v, tau)
        assert report.contacts[0].link == link
        # The noise that thresholds stand for leaves some of the places open, but not the force.
        assert abs(np.linalg.norm(report.contacts[0].force) - FORCE) < 0.02 * FORCE
        names = {"q": q, "v": v, "tau": tau, "update": monitor.update}
        runs.append(interleave([Contestant("contactsense", HOLD, names)], pace))
    slowest = max(runs, key=lambda run: run[0].median)
    task = f"monitor, {name}, {link}, slowest of {len(runs)}, its joint silent"
    return Comparison(task, slowest, max_us=limit)


def _monitors(robot: cs.Robot, model: Any, threshold: float) -> tuple[cs.ContactMonitor, ReferenceMonitor]:
    ours = cs.ContactMonitor(robot, dt=DT, torque_threshold=threshold)
    return ours, ReferenceMonitor(model, robot, dt=DT, threshold=threshold)


def _held_contact(
    robot: cs.Robot, model: Any, link: str, rng: np.random.Generator, *, felt: bool = True
) -> robots.Step:
    """A robot at rest that is pushed on `link` where the torques tell the point, and holds against it.

    `felt`: whether the link's own joint feels the push.
    """
    own = model.joints[model.frames[model.getFrameId(link, pin.FrameType.BODY)].parentJoint]
    isolator = cs.ContactIsolator(robot, torque_threshold=THRESHOLD)
    for _ in range(TRIES):
        q = robots.random_posture(model, rng)
        sample = robot.surface(link).sample(1, seed=int(rng.integers(2**32)))
        pose = robot.link_pose(q, link)
        point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
        # Not along the normal: on a round link that gives its joint no torque.
        inward = rng.uniform(-0.3, 0.3, 3) * felt - pose[:3, :3] @ sample.normals[0]
        force = FORCE * inward / np.linalg.norm(inward)
        pushed = robot.jacobian(q, link, point)[:3].T @ force
        contacts = isolator.isolate(q, pushed).contacts
        largest = np.abs(pushed[own.idx_v : own.idx_v + own.nv]).max()
        fits = largest > 2.0 * THRESHOLD if felt else largest < 0.5 * THRESHOLD
        if fits and len(contacts) == 1 and contacts[0].located and contacts[0].link == link:
            rest = np.zeros(robot.nv)
            return q, rest, robot.inverse_dynamics(q, rest, rest) - pushed
    raise RuntimeError(f"no contact on {link} that the torques determine in {TRIES} tries")
