"""Moves whose acceleration jumps are no contacts, whatever makes the velocities late."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco")

import contactsense as cs
from contactsense import sim

DT = 1e-3
SEED = 41

# Of the readings; the rest is that of a typical arm.
READINGS: dict[str, dict[str, Any]] = {
    "typical": {},
    "filter of second order": {
        "velocity_order": 2,
        "velocity_cutoff": 30.0,
        "velocity_delay": 0.0,
        "torque_delay": 2e-3,
    },
    "fine encoder": {"encoder_bits": 20},
    "coarse encoder": {"encoder_bits": 14},
    "late torque": {"velocity_cutoff": 200.0, "velocity_delay": 0.0, "torque_delay": 8e-3},
}


@pytest.fixture(scope="module")
def robot() -> cs.Robot:
    return cs.Robot.named("iiwa14")


@pytest.mark.parametrize("readings", READINGS)
def test_trapezoidal_moves_are_no_contacts(robot: cs.Robot, readings: str) -> None:
    arm = replace(sim.ImperfectArm.typical(robot, SEED), **READINGS[readings])
    plan = cs.exciting_motion(robot, 40.0, dt=DT, seed=SEED)
    exciting = sim.record_imperfect(robot, arm, sim.JointMotion(plan.time, plan.q, plan.v, plan.a), seed=SEED)
    calibration = cs.calibrate(robot, exciting.log)
    motion = sim.random_moves(robot, 30.0, rest=(0.2, 1.0), profile="trapezoidal", seed=SEED)
    assert np.abs(np.diff(motion.a, axis=0)).max() > 1.0
    push = sim.PersonContact("iiwa_link_6", [0.0, 0.0, 0.05], [25.0, 10.0, 0.0], 25.0, 0.8, 0.1)
    run = sim.record_imperfect(robot, arm, motion, [push], seed=SEED + 1)
    monitor = cs.ContactMonitor(robot, dt=DT, calibration=calibration, samples=0)
    onsets, last = [], run.log.time[0] - DT
    for time, q, v, tau in zip(run.log.time, run.log.q, run.log.v, run.log.tau, strict=True):
        if monitor.update(q, v, tau, dt=max(time - last, 1e-5)).onset:
            onsets.append(float(time))
        last = time
    assert len(onsets) == 1
    assert 25.0 < onsets[0] < 25.3


def test_calibration_learns_the_step_of_the_encoders(robot: cs.Robot) -> None:
    plan = cs.exciting_motion(robot, 12.0, dt=DT, seed=SEED)
    motion = sim.JointMotion(plan.time, plan.q, plan.v, plan.a)
    for bits in (14, 17, None):
        arm = replace(sim.ImperfectArm.typical(robot, SEED), encoder_bits=bits)
        noise = cs.calibrate(robot, sim.record_imperfect(robot, arm, motion, seed=SEED).log).noise
        if bits is None:
            assert np.asarray(noise.position_step).max() < 1e-6
        else:
            np.testing.assert_allclose(noise.position_step, 2.0 * np.pi / 2.0**bits, rtol=1e-6)
