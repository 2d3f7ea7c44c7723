"""A hit on a free-floating robot in motion, by Pinocchio: what its sensors read each millisecond."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from contactsense.sim._arrays import FloatArray
from contactsense.sim.atlas import SENSOR_LINKS

from .isolation import shared_robot
from .scenes import Scene

STEP = 1e-3  # [s]
SUBSTEPS = 20
STIFFNESS = (2 * np.pi * 3.0) ** 2  # [1/s^2], of the joints' hold, times their inertia
DAMPING = 2 * np.sqrt(STIFFNESS)  # [1/s]


@dataclass(frozen=True)
class Recording:
    """A row a millisecond; the hit begins at time 0."""

    time: FloatArray  # (n,) [s]
    q: FloatArray  # (n, nq)
    v: FloatArray  # (n, nv)
    a: FloatArray  # (n, nv)
    tau: FloatArray  # (n, nv), nil for the base
    readings: FloatArray  # (n, 9, 6) of the sensors: what the distal side exerts, sensor axes
    point: FloatArray  # (n, 3) the point hit
    force: FloatArray  # (n, 3)


def simulate(
    scene: Scene,
    pulse: Callable[[float], float],
    *,
    before: float = 0.02,
    after: float = 0.06,
    speed: float = 0.0,
) -> Recording:
    """A robot that falls freely, its joints held softly, pushed by the scene's force times `pulse(time)`.

    `speed` [rad/s]: of every joint at the start, in alternating directions.
    """
    model = shared_robot().model
    data = model.createData()
    touch = scene.touches[0]
    joint = model.frames[model.getBodyId(touch.link)].parentJoint
    pin.forwardKinematics(model, data, scene.q)
    local = data.oMi[joint].actInv(touch.point)
    inertia = np.diag(pin.crba(model, data, scene.q)).copy()

    def motors(q: FloatArray, v: FloatArray) -> FloatArray:
        tau = inertia * (STIFFNESS * pin.difference(model, q, scene.q) - DAMPING * (v - start))
        tau[:6] = 0.0
        return np.asarray(tau, dtype=np.float64)

    def outside(q: FloatArray, time: float) -> Any:
        pin.forwardKinematics(model, data, q)
        forces = pin.StdVec_Force([pin.Force.Zero() for _ in range(model.njoints)])
        point, force = data.oMi[joint].act(local), pulse(time) * touch.force
        forces[joint] = data.oMi[joint].actInv(pin.Force(force, np.cross(point, force)))
        return forces

    def acceleration(q: FloatArray, v: FloatArray, time: float) -> FloatArray:
        return np.asarray(pin.aba(model, data, q, v, motors(q, v), outside(q, time)), dtype=np.float64).copy()

    start = speed * (-1.0) ** np.arange(model.nv)
    start[:6] = 0.0
    q, v = scene.q.copy(), start.copy()
    rows = []
    for tick in range(round((before + after) / STEP) + 1):
        time = tick * STEP - before
        a = acceleration(q, v, time)
        pin.rnea(model, data, q, v, a, outside(q, time))
        readings = [-data.f[model.frames[model.getBodyId(link)].parentJoint].vector for link in SENSOR_LINKS]
        pin.forwardKinematics(model, data, q)
        point, force = data.oMi[joint].act(local), pulse(time) * touch.force
        rows.append((time, q, v, a, motors(q, v), np.array(readings), point, force))
        h = STEP / SUBSTEPS
        for step in range(SUBSTEPS):
            # Midpoint rule.
            now = time + step * h
            half_q = pin.integrate(model, q, 0.5 * h * v)
            half_v = v + 0.5 * h * acceleration(q, v, now)
            q = pin.integrate(model, q, h * half_v)
            v = v + h * acceleration(half_q, half_v, now + 0.5 * h)
    return Recording(*(np.array(column) for column in zip(*rows, strict=True)))
