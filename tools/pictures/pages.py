"""Pictures of the pages in the browser: of a log, of a control loop, and the exported file."""

from __future__ import annotations

import io
import tempfile
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from matplotlib.image import imread

import contactsense as cs
from contactsense import sim

from ..browser import PATIENCE, Browser

_DT = 0.001  # [s]
_SEED = 4
_FREE = 30.0  # motion for the calibration [s]
_END = 12.0  # of the log [s]
_POSE = np.array([0.3, 0.7, -0.4, -1.2, 0.5, 0.8, 0.0])  # about which the arm moves
# Link, force inward [N], start and duration [s].
_PUSHES = (("iiwa_link_4", 30.0, 2.0, 0.8), ("iiwa_link_6", 25.0, 5.0, 1.0), ("iiwa_link_7", 20.0, 8.5, 1.2))
_SHOWN = 5.5  # in the middle of the second [s]
_TO_EYE = np.array([0.8, 0.5, 0.3])  # from the robot to the camera of the page, about
_PORT = 8470
_NEXT = 0.035  # [s]: until the next instant is shown
# Shares of the pixels of a page: those of the robot at least, and those that change at most where it stands
# still but for a time line. Colours are the same up to rounding.
_LEAST_DRAWN, _STILL, _SAME = 0.05, 0.01, 0.02
# A browser without a graphics card is told so: not on a picture.
_CLOSE_NOTES = "document.querySelectorAll('[class*=Notification] button').forEach(it => it.click())"


@cache
def _replay() -> cs.Replay:
    """A calibrated arm with the errors of a real one that moves and is pushed."""
    robot = cs.Robot.named("iiwa14")
    arm = sim.ImperfectArm.typical(robot, _SEED)
    free = cs.exciting_motion(robot, _FREE, dt=_DT, seed=_SEED)
    record = sim.record_imperfect(robot, arm, sim.JointMotion(free.time, free.q, free.v, free.a), seed=_SEED)
    calibration = cs.calibrate(robot, record.log)
    time_ = _DT * np.arange(round(_END / _DT))
    phase = 0.5 * time_[:, None] + np.arange(7)
    motion = sim.JointMotion(
        time_, _POSE + 0.25 * np.sin(phase), 0.125 * np.cos(phase), -0.0625 * np.sin(phase)
    )
    contacts = []
    for link, force, start, duration in _PUSHES:
        point, normal = _seen_point(robot, link)
        contacts.append(sim.PersonContact(link, point, -force * normal, start, duration, rise=0.15))
    pushed = sim.record_imperfect(robot, arm, motion, contacts, seed=_SEED + 1)
    return cs.replay(pushed.log, cs.ContactMonitor(robot, dt=_DT, calibration=calibration))


def _seen_point(robot: cs.Robot, link: str) -> tuple[np.ndarray, np.ndarray]:
    """A point of a link that faces the camera, and its normal, link frame."""
    sample = robot.surface(link).sample(50, seed=_SEED)
    towards = sample.normals @ robot.link_pose(_POSE, link)[:3, :3].T @ _TO_EYE
    best = np.argmax(towards)
    return sample.points[best], sample.normals[best]


def view_log(file: Path) -> None:
    """A log, in the middle of a contact."""
    with cs.view(_replay(), port=_PORT) as page:
        page.show(_SHOWN)
        _take(page.address, file)


def view_html(file: Path) -> None:
    """A part of the log as one file, without a server."""
    with tempfile.TemporaryDirectory() as folder:
        written = Path(folder) / "work.html"
        with cs.view(_replay(), port=_PORT) as page:
            page.to_html(written, _SHOWN, _SHOWN + 0.01)  # one instant
        _take(written.as_uri(), file)


def view_live(file: Path) -> None:
    """A control loop in which the arm is pushed at its wrist."""
    robot, link = cs.Robot.named("iiwa14"), "iiwa_link_6"
    q, rest, pose = _POSE, np.zeros(7), robot.link_pose(_POSE, link)
    point, normal = _seen_point(robot, link)
    jacobian = robot.jacobian(q, link, pose[:3, :3] @ point + pose[:3, 3])
    # Somewhat downward, so that the arrow is not seen from its end.
    pushed = jacobian[:3].T @ (-14.0 * pose[:3, :3] @ normal + [0.0, 0.0, -6.0])
    still, rng = robot.inverse_dynamics(q, rest, rest), np.random.default_rng(_SEED)
    monitor = cs.ContactMonitor(robot, dt=_DT)
    with cs.view(monitor, port=_PORT) as page:
        for tick in range(200):
            torque = still - pushed * (60 < tick < 110 or tick > 140)
            for _ in range(20):
                report = monitor.update(q, rest, torque + rng.normal(0.0, 0.1, 7))
            page.show(q, report)
            time.sleep(_NEXT)
        _take(page.address, file)


def view_particles(file: Path) -> None:
    """A contact near the base, by a particle filter after some motion in contact."""
    robot = cs.Robot.named("iiwa14")
    touch = sim.touch_scene(
        robot, "iiwa_link_2", kind="sphere", force_range=(20.0, 30.0), least_torque=2.0, seed=0
    )
    pace = sim.Pace(motions=10, duration=0.2)
    path = sim.joint_exploration(robot, touch, amplitude=np.deg2rad(2.0), pace=pace, seed=0)
    run = sim.record_quasi_static(robot, touch.contact(robot), path.time, path.q)
    measured = sim.TorqueError(percent=3.0, newton_metres=0.02, seed=0).measure(run.external_torque)
    particles, monitor = cs.ContactParticleFilter(robot, seed=0), cs.ContactMonitor(robot, dt=_DT)
    with cs.view(monitor, port=_PORT) as page:
        for q, torque in zip(run.q, measured, strict=True):
            particles.update(q, torque)
            report = monitor.update_external(q, torque)
            page.show(q, report, particles)
            time.sleep(_NEXT)
        _take(page.address, file)


def _take(address: str, file: Path) -> None:
    """The page as it is once nothing moves any more but its time line."""
    with Browser() as browser:
        browser.open(address)
        until = time.monotonic() + PATIENCE
        before = np.zeros(())
        while time.monotonic() < until:
            browser.evaluate(_CLOSE_NOTES)
            time.sleep(2.0)
            picture = browser.picture()
            pixels = imread(io.BytesIO(picture), format="png")[..., :3]
            # What is not there yet stands still, too: most of a page without a robot is white.
            is_drawn = np.mean(pixels.min(axis=2) < 0.9) > _LEAST_DRAWN
            if is_drawn and before.shape == pixels.shape:
                moved = np.abs(pixels - before).max(axis=2) > _SAME
                if np.mean(moved) < _STILL:
                    file.write_bytes(picture)
                    return
            before = pixels
        raise TimeoutError(f"{address} never stood still")


PICTURES: dict[str, Callable[[Path], None]] = {
    function.__name__: function for function in (view_log, view_live, view_particles, view_html)
}
