"""A short hit over time: the force that joint torques show, and the one that sensors show (VI-D, Fig. 10)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ... import Contact, Robot
from ..sampling import FloatArray
from .instruments import SENSOR_LINKS, Method, external_torque, external_wrenches, sensor_links
from .isolation import Setting, make_isolator
from .physics import pinocchio_atlas
from .scenes import Scene

DURATION = 0.02  # [s]
STEP = 0.001  # [s]
GAIN = 500.0  # [1/s]
LENGTH = 0.04  # [s]
RIGHT = 1e-6  # [m], a point counts as right: the thresholds' share of the force is small, not nil
SHIFTS = np.arange(0.0, 0.01, 2e-5)  # [s]


@dataclass(frozen=True)
class Signal:
    """What an isolation says over time; NaN where it locates nothing."""

    force: FloatArray  # (n, 3) [N]
    point_error: FloatArray  # (n,) [m]

    @property
    def right(self) -> NDArray[np.bool_]:
        """Whether the point is right, per sample."""
        right: NDArray[np.bool_] = np.nan_to_num(self.point_error, nan=np.inf) <= RIGHT
        return right


@dataclass(frozen=True)
class Series:
    """One hit."""

    scene: Scene  # its force: at the peak
    time: FloatArray  # (n,) [s]
    force: FloatArray  # (n, 3) [N]
    signals: dict[Method, Signal]

    def delay(self, method: Method) -> float:
        """Shift [s] of the half sine that fits the force found best; NaN if nothing is found."""
        found = np.nan_to_num(self.signals[method].force) @ self._direction
        if not found.any():
            return np.nan
        shifted = half_sine(self.time[None] - SHIFTS[:, None])
        fit = shifted @ found / np.linalg.norm(shifted, axis=1)
        return float(SHIFTS[np.argmax(fit)])

    def peak_delay(self, method: Method) -> float:
        """From the true peak to the greatest force found [s]."""
        found = np.nan_to_num(self.signals[method].force) @ self._direction
        return float(self.time[np.argmax(found)] - DURATION / 2) if found.any() else np.nan

    def first_right(self, method: Method) -> int | None:
        """Number of the first sample under force (from 1) whose point is right."""
        right = np.flatnonzero(self.signals[method].right)
        return int(right[0]) if len(right) else None

    def right_share(self, method: Method) -> float:
        """Share of samples with the right point, of those under force from the second on."""
        under = (self.time > 1.5 * STEP) & (self.time < DURATION - 0.5 * STEP)
        return float(self.signals[method].right[under].mean())

    def point_error(self, method: Method) -> float:
        """Worst distance of a located point from the truth [m]; NaN if none is located."""
        errors = self.signals[method].point_error
        return float(np.nanmax(errors)) if np.isfinite(errors).any() else np.nan

    @cached_property
    def _direction(self) -> FloatArray:
        force = self.scene.touches[0].force
        return force / np.linalg.norm(force)


def half_sine(time: FloatArray) -> FloatArray:
    """Unit force over time [s]: one half wave from 0 to `DURATION`."""
    inside = (time > 0.0) & (time < DURATION)
    return np.where(inside, np.sin(np.pi * time / DURATION), 0.0)


def filtered_half_sine(time: FloatArray, gain: float = GAIN) -> FloatArray:
    """What the observer makes of `half_sine`: the exact answer of its first-order dynamics (6)."""
    rate = np.pi / DURATION

    def during(t: FloatArray) -> FloatArray:
        wave = gain * np.sin(rate * t) - rate * np.cos(rate * t) + rate * np.exp(-gain * t)
        answer: FloatArray = gain * wave / (gain**2 + rate**2)
        return answer

    end = during(np.array([DURATION]))[0]
    after = end * np.exp(-gain * np.clip(time - DURATION, 0.0, None))
    return np.where(time < DURATION, during(np.clip(time, 0.0, DURATION)), after)


def scaled(scene: Scene, amplitude: float) -> Scene:
    """The scene with forces of `amplitude` [N]."""
    touches = [
        replace(touch, force=amplitude * touch.force / np.linalg.norm(touch.force)) for touch in scene.touches
    ]
    return Scene(scene.q, touches)


def ideal_series(robot: Robot, scene: Scene, methods: Sequence[Method], gain: float = GAIN) -> Series:
    """A hit on the robot at rest, with the errors that (6) and (10) give: the paper's Fig. 10.

    Torques are filtered as in (6). Wrenches miss what (10) leaves of the acceleration of the bodies behind
    the sensor.
    """
    time = np.linspace(0.0, LENGTH, round(LENGTH / STEP) + 1)
    true, seen = half_sine(time), filtered_half_sine(time, gain)
    tau, wrenches = external_torque(robot, scene), external_wrenches(robot, scene)
    acceleration = np.asarray(np.linalg.solve(robot.mass_matrix(scene.q), tau), dtype=np.float64)
    missed = inertial_wrenches(scene.q, acceleration)
    signals: dict[Method, Signal] = {}
    for method in methods:
        isolator = make_isolator(robot, Setting(method))
        contacts = []
        for now, past in zip(true, seen, strict=True):
            torques = np.zeros(robot.nv) if method == "sensors" else past * tau
            readings = [now * wrenches - (now - past) * missed] if sensor_links(method) else []
            contacts.append(isolator.isolate(scene.q, torques, *readings).contacts)
        signals[method] = _signal(contacts, scene.touches[0].point)
    return Series(scene, time, true[:, None] * scene.touches[0].force, signals)


def inertial_wrenches(q: FloatArray, acceleration: FloatArray) -> FloatArray:
    """What accelerating the bodies behind each sensor takes, at rest `(9, 6)`: (16), (18) by Pinocchio."""
    model = pinocchio_atlas()
    moved, still = model.createData(), model.createData()
    pin.rnea(model, moved, q, np.zeros(model.nv), acceleration)
    pin.rnea(model, still, q, np.zeros(model.nv), np.zeros(model.nv))
    wrenches = []
    for link in SENSOR_LINKS:
        joint = model.frames[model.getBodyId(link)].parentJoint
        rotation, wrench = moved.oMi[joint].rotation, moved.f[joint] - still.f[joint]
        wrenches.append([*(rotation @ wrench.linear), *(rotation @ wrench.angular)])
    return np.array(wrenches)


def _signal(contacts: Sequence[Sequence[Contact]], point: FloatArray) -> Signal:
    """The contact nearest to the truth, of those located."""
    force, error = np.full((len(contacts), 3), np.nan), np.full(len(contacts), np.nan)
    for row, found in enumerate(contacts):
        located = [(np.linalg.norm(each.point - point), each) for each in found if each.located]
        if located:
            error[row], contact = min(located, key=lambda pair: pair[0])
            force[row] = contact.force
    return Signal(force, error)
