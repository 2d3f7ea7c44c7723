"""Mass matrix, bias torque, Jacobians, and a motion under an external torque, by Pinocchio."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pinocchio as pin

from .robot import GoldenRobot

DT = 2e-3  # [s]
STEPS = 10  # of the integration, a tick
TICKS = 100
GAIN = 50.0  # [1/s]


def make(robot: GoldenRobot, count: int, seed: int) -> dict[str, Any]:
    """`count` random states."""
    rng = np.random.default_rng(seed)
    model, data = robot.model, robot.data
    rows = []
    for _ in range(count):
        q = robot.configuration(rng)
        v, a = np.round(rng.uniform(-2.0, 2.0, (2, model.nv)), 4)
        mass = pin.crba(model, data, q)
        robot.place(q)
        link = robot.links[rng.integers(1, len(robot.links))]
        offset = np.round(rng.uniform(-0.3, 0.3, 3), 4)
        point = robot.pose(link).translation + offset
        rows.append(
            {
                "q": q,
                "v": v,
                "a": a,
                "mass_matrix": np.triu(mass) + np.triu(mass, 1).T,
                "bias": pin.nonLinearEffects(model, data, q, v).copy(),
                "inverse_dynamics": pin.rnea(model, data, q, v, a).copy(),
                "link": link.name,
                "point": point,
                "jacobian": robot.jacobian(link, point),
            }
        )
    return {"states": rows}


def observer(robot: GoldenRobot, seed: int) -> dict[str, Any]:
    """What a first-order filter with `gain` makes of an external torque.

    The arm swings under a motor torque and, from the 20th tick on, the external one.
    """
    rng = np.random.default_rng(seed)
    model, data = robot.model, robot.data
    q, v = robot.configuration(rng), np.round(rng.uniform(-0.5, 0.5, model.nv), 4)
    push = np.round(rng.uniform(-8.0, 8.0, model.nv), 3)
    filtered = np.zeros(model.nv)
    weight = pin.computeGeneralizedGravity(model, data, q).copy()
    swing = 3.0 * np.sin(0.05 * np.arange(TICKS + 1)[:, None] + np.arange(model.nv))
    torques = np.round(weight + swing, 6)
    rows = []
    for tick, (tau, after) in enumerate(pairwise(torques)):
        rows.append({"q": q, "v": v, "tau": tau, "filtered": filtered.copy()})
        external = push if tick >= 20 else np.zeros(model.nv)
        for step in range(STEPS):
            # The motor torque changes evenly between the ticks.
            between = tau + (step + 0.5) / STEPS * (after - tau)
            q, v = _step(model, data, q, v, between + external, DT / STEPS)
        filtered += (1.0 - np.exp(-GAIN * DT)) * (external - filtered)
    return {"dt": DT, "gain": GAIN, "push": push, "ticks": rows}


def _step(
    model: pin.Model, data: pin.Data, q: np.ndarray, v: np.ndarray, tau: np.ndarray, dt: float
) -> tuple[np.ndarray, np.ndarray]:
    """Runge-Kutta of fourth order for joints whose position is an angle."""

    def rate(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return pin.aba(model, data, q, v, tau).copy()

    v1, a1 = v, rate(q, v)
    v2, a2 = v + 0.5 * dt * a1, rate(q + 0.5 * dt * v1, v + 0.5 * dt * a1)
    v3, a3 = v + 0.5 * dt * a2, rate(q + 0.5 * dt * v2, v + 0.5 * dt * a2)
    v4, a4 = v + dt * a3, rate(q + dt * v3, v + dt * a3)
    return q + dt / 6 * (v1 + 2 * v2 + 2 * v3 + v4), v + dt / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
