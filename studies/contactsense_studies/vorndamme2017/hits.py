"""Hits: with the errors that the equations give, and on a simulated robot in motion (VI-D)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from contactsense import Contact, ContactMonitor, Robot
from contactsense.sim._arrays import FloatArray
from contactsense.sim.atlas import SENSOR_LINKS

from .instruments import Method, external_torque, external_wrenches, sensor_links
from .isolation import Setting, make_isolator, make_sensors, shared_robot
from .physics import simulate
from .scenes import Scene
from .time_series import GAIN, STEP, Series, Signal, filtered_half_sine, half_sine

LENGTH = 0.04  # [s]
IDEAL_TOLERANCE = 1e-6  # [m]
MOVING_TOLERANCE = 0.01  # [m]
SPEED = 0.5  # [rad/s], of the joints of the simulated robot
# Thresholds in simulation, of the hit's force: the robot moves on between the samples.
SHARE = 0.01


def scaled(scene: Scene, amplitude: float) -> Scene:
    """The scene with forces of `amplitude` [N]."""
    touches = [
        replace(touch, force=amplitude * touch.force / np.linalg.norm(touch.force)) for touch in scene.touches
    ]
    return Scene(scene.q, touches)


def ideal_series(robot: Robot, scene: Scene, methods: Sequence[Method], *, late: bool = True) -> Series:
    """A hit on the robot at rest, with the errors that (6) and (10) give: the paper's Fig. 10.

    Torques are filtered as in (6). Wrenches miss what (10) leaves of the acceleration of the bodies behind
    the sensor; nothing, if the acceleration is not `late`.
    """
    time = np.linspace(0.0, LENGTH, round(LENGTH / STEP) + 1)
    true, seen = half_sine(time), filtered_half_sine(time)
    tau, wrenches = external_torque(robot, scene), external_wrenches(robot, scene)
    acceleration = np.asarray(np.linalg.solve(robot.mass_matrix(scene.q), tau), dtype=np.float64)
    missed = inertial_wrenches(scene.q, acceleration)
    signals: dict[Method, Signal] = {}
    for method in methods:
        isolator = make_isolator(robot, Setting(method))
        contacts = []
        for now, past in zip(true, seen, strict=True):
            torques = np.zeros(robot.nv) if method == "sensors" else past * tau
            readings = [now * wrenches - late * (now - past) * missed] if sensor_links(method) else []
            contacts.append(isolator.isolate(scene.q, torques, *readings).contacts)
        points = np.tile(scene.touches[0].point, (len(time), 1))
        signals[method] = _signal(contacts, points)
    return Series(scene, time, true[:, None] * scene.touches[0].force, signals, IDEAL_TOLERANCE)


def simulated_series(robot: Robot, scene: Scene, methods: Sequence[Method]) -> Series:
    """A hit on the robot in motion, measured each millisecond and told by `ContactMonitor`."""
    amplitude = float(np.linalg.norm(scene.touches[0].force))
    record = simulate(scene, lambda time: float(half_sine(np.array(time))), speed=SPEED)
    signals: dict[Method, Signal] = {}
    for method in methods:
        monitor = ContactMonitor(
            robot,
            dt=STEP,
            sensors=make_sensors(method),
            observer_gain=GAIN,
            torque_threshold=SHARE * amplitude,
            wrench_threshold=SHARE * amplitude,
            hold_time=0.0,
        )
        used = [SENSOR_LINKS.index(link) for link in sensor_links(method)]
        contacts = [
            monitor.update(q, v, tau, readings[used] if used else None).contacts
            for q, v, tau, readings in zip(record.q, record.v, record.tau, record.readings, strict=True)
        ]
        signals[method] = _signal(contacts, record.point)
    return Series(scene, record.time, record.force, signals, MOVING_TOLERANCE)


def inertial_wrenches(q: FloatArray, acceleration: FloatArray) -> FloatArray:
    """What accelerating the bodies behind each sensor takes, at rest `(9, 6)`: (16), (18) by Pinocchio."""
    model = shared_robot().model
    moved, still = model.createData(), model.createData()
    pin.rnea(model, moved, q, np.zeros(model.nv), acceleration)
    pin.rnea(model, still, q, np.zeros(model.nv), np.zeros(model.nv))
    wrenches = []
    for link in SENSOR_LINKS:
        joint = model.frames[model.getBodyId(link)].parentJoint
        rotation, wrench = moved.oMi[joint].rotation, moved.f[joint] - still.f[joint]
        wrenches.append([*(rotation @ wrench.linear), *(rotation @ wrench.angular)])
    return np.array(wrenches)


def _signal(contacts: Sequence[Sequence[Contact]], points: FloatArray) -> Signal:
    """The contact nearest to the truth, of those that have a point."""
    force, error = np.full((len(contacts), 3), np.nan), np.full(len(contacts), np.nan)
    for row, found in enumerate(contacts):
        known = [each for each in found if np.isfinite(each.point).all()]
        estimates = [(np.linalg.norm(each.point - points[row]), each) for each in known]
        if estimates:
            error[row], contact = min(estimates, key=lambda pair: pair[0])
            force[row] = contact.force
    return Signal(force, error)
