"""Poses and speeds that a calibration never saw widen the noise, and raise no alarms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import contactsense as cs
from contactsense.log import Log
from contactsense.sim import ImperfectArm, JointMotion, PersonScene, record_imperfect

DT = 1e-3
AMPLITUDE = 0.25  # [rad]


def narrow_motion(robot: cs.Robot, seconds: float, rng: np.random.Generator) -> JointMotion:
    """Slow motion about one pose."""
    limits = np.clip(robot.position_limits, -np.pi, np.pi)
    span = limits[:, 1] - limits[:, 0]
    about = limits.mean(axis=1) + 0.2 * span * rng.uniform(-1.0, 1.0, robot.nv)
    time = np.arange(0.0, seconds, DT)
    q, v, a = np.tile(about, (len(time), 1)), np.zeros((len(time), robot.nv)), np.zeros((len(time), robot.nv))
    for _ in range(5):
        rate = 2.0 * np.pi * rng.uniform(0.05, 0.4, robot.nv)
        angle = np.outer(time, rate) + rng.uniform(0.0, 2.0 * np.pi, robot.nv)
        q += AMPLITUDE / 5.0 * np.sin(angle)
        v += AMPLITUDE / 5.0 * rate * np.cos(angle)
        a -= AMPLITUDE / 5.0 * rate**2 * np.sin(angle)
    return JointMotion(time, q, v, a)


def heard(robot: cs.Robot, calibration: cs.Calibration, log: Log) -> tuple[int, float]:
    """Onsets, and the share of the time in collision."""
    monitor = cs.ContactMonitor(robot, dt=DT, calibration=calibration, samples=0)
    steps = np.diff(log.time, prepend=log.time[0] - DT)
    rows = zip(log.q, log.v, log.tau, steps, strict=True)
    reports = [monitor.update(q, v, tau, dt=dt) for q, v, tau, dt in rows]
    return sum(report.onset for report in reports), float(np.mean([report.collision for report in reports]))


@pytest.mark.parametrize("seed", [3, 4])
def test_a_narrow_calibration_raises_no_alarms_elsewhere(tmp_path: Path, seed: int) -> None:
    robot = cs.Robot.named("iiwa14")
    arm = ImperfectArm.typical(robot, seed)
    motion = narrow_motion(robot, 40.0, np.random.default_rng(seed))
    narrow = cs.calibrate(robot, record_imperfect(robot, arm, motion, seed=seed).log)
    assert narrow.model_errors.shape[1:] == (7, 6)
    assert len(narrow.model_errors) > 0
    free = PersonScene(seconds=60.0, contacts=0, dt=DT, seed=seed).record(robot, arm).log
    onsets, share = heard(robot, narrow, free)
    assert onsets <= 2
    assert share < 0.02
    # As if the log had shown all there is to know.
    file = tmp_path / "narrow.yaml"
    narrow.save(file)
    lines = file.read_text().splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("model_errors:"))
    last = next(k for k in range(first + 1, len(lines)) if not lines[k].startswith(" "))
    file.write_text("\n".join(lines[:first] + lines[last:]) + "\n")
    trusting = cs.Calibration.load(file)
    assert len(trusting.model_errors) == 0
    assert heard(robot, trusting, free)[1] > 0.1


def test_errors_of_the_model_are_kept_in_the_file(tmp_path: Path) -> None:
    robot = cs.Robot.named("iiwa14")
    arm = ImperfectArm.typical(robot, 5)
    motion = narrow_motion(robot, 20.0, np.random.default_rng(5))
    calibration = cs.calibrate(robot, record_imperfect(robot, arm, motion, seed=5).log)
    file = tmp_path / "arm.yaml"
    calibration.save(file)
    loaded = cs.Calibration.load(file)
    np.testing.assert_allclose(loaded.model_errors, calibration.model_errors, rtol=1e-6, atol=1e-12)
    assert not loaded.model_errors.flags.writeable
    text = file.read_text()
    first = text.index("model_errors:")
    broken = text[:first] + text[first:].replace("- [", "# [", 1)
    file.write_text(broken)
    with pytest.raises(cs.InputError, match="model_errors"):
        cs.Calibration.load(file)


def test_a_wide_calibration_leaves_little_open() -> None:
    robot = cs.Robot.named("iiwa14")
    arm = ImperfectArm.typical(robot, 6)
    plan = cs.exciting_motion(robot, 60.0, dt=DT, seed=6)
    wide = record_imperfect(robot, arm, JointMotion(plan.time, plan.q, plan.v, plan.a), seed=6).log
    narrow = record_imperfect(robot, arm, narrow_motion(robot, 40.0, np.random.default_rng(6)), seed=6).log
    sizes = [np.abs(cs.calibrate(robot, log).model_errors[..., 4]).sum() for log in (wide, narrow)]
    assert sizes[0] < 0.2 * sizes[1]
