"""Each error of an imperfect arm, measured back from its log by other means."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

from robots import parameters, robot_named

import contactsense as cs
from contactsense import sim

ARMS = parameters(["iiwa14", "panda", "ur5", "kinova"])
IIWA = cs.Robot.named("iiwa14")
TICK = 1e-3


@cache
def moves(name: str) -> sim.JointMotion:
    return sim.random_moves(robot_named(name), 8.0, rest=(0.2, 0.5), seed=3)


def record(seed: int = 0, **errors: object) -> sim.ImperfectRun:
    return sim.record_imperfect(IIWA, sim.ImperfectArm(**errors), moves("iiwa14"), seed=seed)  # type: ignore[arg-type]


def dynamics(robot: cs.Robot, motion: sim.JointMotion) -> np.ndarray:
    rows = zip(motion.q, motion.v, motion.a, strict=True)
    return np.array([robot.inverse_dynamics(q, v, a) for q, v, a in rows])


def surplus(run: sim.ImperfectRun) -> np.ndarray:
    """What is measured above the inverse dynamics of the description."""
    return run.log.tau - dynamics(IIWA, moves("iiwa14"))


def slopes(y: np.ndarray, *columns: np.ndarray) -> np.ndarray:
    """(columns, nv) least squares of `y` (n, nv) on columns (n, nv), joint by joint."""
    pairs = range(y.shape[1])
    return np.array([np.linalg.lstsq(np.stack([c[:, j] for c in columns], 1), y[:, j])[0] for j in pairs]).T


@pytest.mark.parametrize("name", ARMS)
def test_an_ideal_arm_measures_its_inverse_dynamics(name: str) -> None:
    robot, motion = robot_named(name), moves(name)
    run = sim.record_imperfect(robot, sim.ImperfectArm.ideal(), motion)
    np.testing.assert_array_equal(run.log.time, motion.time)
    np.testing.assert_array_equal(run.log.q, motion.q)
    np.testing.assert_array_equal(run.log.v, motion.v)
    data = robot.model.createData()
    rows = zip(motion.q, motion.v, motion.a, strict=True)
    expected = np.array([pin.rnea(robot.model, data, q, v, a) for q, v, a in rows])
    np.testing.assert_allclose(run.log.tau, expected, rtol=0, atol=1e-10)
    np.testing.assert_allclose(dynamics(robot, motion), expected, rtol=0, atol=1e-10)
    assert run.truth.robot is robot
    assert run.truth.contact_free.all()


def test_torque_noise_is_white_and_as_large_as_asked() -> None:
    noise = np.linspace(0.02, 0.2, 7)
    error = surplus(record(torque_noise=noise))
    np.testing.assert_allclose(error.std(axis=0), noise, rtol=0.05)
    assert np.abs(error.mean(axis=0) / noise).max() < 0.05
    together = np.corrcoef(np.vstack([error[1:].T, error[:-1].T]))
    assert np.abs(together - np.eye(14)).max() < 0.06


def test_bias_scale_and_sign() -> None:
    bias, scale = np.linspace(-0.3, 0.3, 7), np.array([1.1, -1.0, 0.9, 1.0, 1.02, -0.5, 2.0])
    run = record(torque_bias=bias, torque_scale=scale)
    true = dynamics(IIWA, moves("iiwa14"))
    np.testing.assert_allclose(
        slopes(run.log.tau, true, np.ones_like(true)), [scale, bias], rtol=0, atol=1e-9
    )


@pytest.mark.parametrize("ticks", [3.0, 1.6])
def test_torque_and_velocity_are_late(ticks: float) -> None:
    run = record(torque_delay=ticks * TICK, velocity_delay=2.0 * ticks * TICK)
    true = dynamics(IIWA, moves("iiwa14"))
    for late, signal, delay in (
        (run.log.tau, true, ticks * TICK),
        (run.log.v, moves("iiwa14").v, 2 * ticks * TICK),
    ):
        steps = np.gradient(signal, TICK, axis=0)
        np.testing.assert_allclose(-slopes(late - signal, steps)[0], delay, rtol=0.05)
    if ticks == 3.0:
        np.testing.assert_allclose(run.log.tau[3:], true[:-3], rtol=0, atol=1e-6)
        np.testing.assert_allclose(run.log.v[6:], moves("iiwa14").v[:-6], rtol=0, atol=1e-9)


def test_friction_is_in_the_torque_as_far_as_the_sensor_sees_it() -> None:
    v = moves("iiwa14").v
    coulomb, viscous = np.linspace(0.2, 2.0, 7), np.linspace(1.0, 0.3, 7)
    friction = sim.Friction(coulomb=coulomb, viscous=viscous, stribeck=0.5, stribeck_velocity=0.05)
    columns = np.tanh(v / 0.01), v, np.tanh(v / 0.01) * np.exp(-((v / 0.05) ** 2))
    run = record(friction=friction)
    expected = [coulomb, viscous, np.full(7, 0.5)]
    np.testing.assert_allclose(slopes(surplus(run), *columns), expected, rtol=0, atol=1e-8)
    for share in (0.0, 0.25):
        part = record(friction=sim.Friction(coulomb=coulomb, seen=share))
        np.testing.assert_allclose(slopes(surplus(part), columns[0])[0], share * coulomb, atol=1e-8)
        np.testing.assert_allclose(slopes(part.truth.friction, columns[0])[0], coulomb, atol=1e-8)


def test_presliding_friction_stays_at_rest() -> None:
    motion = moves("iiwa14")
    error = surplus(record(friction=sim.Friction(coulomb=1.0, presliding=1e-3)))
    assert np.abs(error).max() <= 1.0 + 1e-9
    fast = np.abs(motion.v) > 0.1
    np.testing.assert_array_equal(np.sign(error[fast]), np.sign(motion.v[fast]))
    still = (motion.v == 0.0).all(axis=1) & (motion.time > 4.0)
    assert still.any()
    assert (np.abs(error[still]) > 0.5).mean() > 0.9


def test_a_contact_leaves_a_share_of_its_torque_behind() -> None:
    time = TICK * np.arange(1001)
    still = np.zeros((1001, 7))
    q = np.array([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.2])
    motion = sim.JointMotion(time, np.tile(q, (1001, 1)), still, still)
    push = sim.PersonContact("iiwa_link_6", [0.0, 0.06, 0.0], [12.0, -35.0, 20.0], 0.2, 0.5, 0.2)
    run = sim.record_imperfect(IIWA, sim.ImperfectArm(hysteresis=0.04), motion, [push])
    peak = np.abs(run.truth.external_torque).max(axis=0)
    error = np.abs(run.log.tau - run.truth.tau)
    np.testing.assert_array_equal(error[:200], 0.0)
    finest = 0.01 * IIWA.effort_limits
    large = (peak > 2.0 * finest) & (peak < 16.0 * finest)
    assert large.sum() >= 3
    np.testing.assert_allclose(error[-1], np.where(large, 0.04 * (peak - finest), error[-1]), atol=1e-9)
    assert (error.max(axis=0)[large] >= error[-1][large]).all()


def test_rotors_resist_acceleration() -> None:
    rotor = np.linspace(0.1, 1.0, 7)
    run = record(rotor_inertia=rotor)
    np.testing.assert_allclose(slopes(surplus(run), moves("iiwa14").a)[0], rotor, rtol=1e-6)
    np.testing.assert_allclose(run.truth.robot.model.armature, rotor)


def test_masses_are_those_of_the_true_robot() -> None:
    run = record(mass_error=0.02, com_error=2e-3, inertia_error=0.05)
    np.testing.assert_allclose(run.log.tau, dynamics(run.truth.robot, moves("iiwa14")), atol=1e-9)
    shares, shifts = [], []
    for seed in range(40):
        true = sim.ImperfectArm(mass_error=0.02, com_error=2e-3, seed=seed).true_robot(IIWA).model
        for body, described in zip(true.inertias[1:], IIWA.model.inertias[1:], strict=True):
            shares.append(body.mass / described.mass - 1.0)
            shifts.append(body.lever - described.lever)
    assert np.std(shares) == pytest.approx(0.02, rel=0.15)
    assert np.std(shifts) == pytest.approx(2e-3, rel=0.15)


def test_a_payload_weighs_and_resists() -> None:
    load = sim.Payload("iiwa_link_7", 1.5, (0.03, 0.0, 0.1))
    run = record(payload=load)
    motion = moves("iiwa14")
    still = int(np.flatnonzero((motion.v == 0.0).all(axis=1))[-1])
    q = motion.q[still]
    pose = IIWA.link_pose(q, load.link)
    centre = pose[:3, :3] @ np.array(load.com) + pose[:3, 3]
    weight = IIWA.jacobian(q, load.link, centre)[:3].T @ [0.0, 0.0, 1.5 * 9.81]
    np.testing.assert_allclose(surplus(run)[still], weight, atol=1e-9)
    assert np.abs(surplus(run) - surplus(run)[still]).max() > 1.0


def test_encoders_count_steps() -> None:
    run = record(encoder_bits=12)
    step = 2.0 * np.pi / 2**12
    np.testing.assert_allclose(run.log.q / step, np.round(run.log.q / step), rtol=0, atol=1e-6)
    error = run.log.q - moves("iiwa14").q
    assert np.abs(error).max() <= 0.5 * step + 1e-12
    np.testing.assert_array_equal(run.truth.q, moves("iiwa14").q)
    np.testing.assert_array_equal(run.log.v, moves("iiwa14").v)


def test_encoders_of_joints_that_turn_without_limit() -> None:
    robot, motion = robot_named("kinova"), moves("kinova")
    run = sim.record_imperfect(robot, sim.ImperfectArm(encoder_bits=17), motion)
    moved = np.array([pin.difference(robot.model, q, p) for q, p in zip(motion.q, run.log.q, strict=True)])
    step = 2.0 * np.pi / 2**17
    assert 0.2 * step < np.abs(moved).mean() < 0.3 * step


@pytest.mark.parametrize("order", [1, 2])
def test_velocities_are_differenced_filtered_and_late(order: int) -> None:
    v = moves("iiwa14").v
    run = record(velocity_cutoff=30.0, velocity_order=order, velocity_delay=4e-3)
    lag = -slopes(run.log.v - v, np.gradient(v, TICK, axis=0))[0]
    np.testing.assert_allclose(lag, order / (2.0 * np.pi * 30.0) + 4e-3 + 0.5 * TICK, rtol=0.1)
    quantised = record(velocity_cutoff=30.0, velocity_order=order, velocity_delay=4e-3, encoder_bits=14)
    noise = quantised.log.v - run.log.v
    step = 2.0 * np.pi / 2**14 / TICK
    assert 1e-3 * step < noise.std() < 0.3 * step


def test_ticks_are_lost_in_gaps_and_stamps_jitter() -> None:
    run = record(dropped_ticks=0.05, drop_length=6e-3, jitter=5e-5)
    whole = len(moves("iiwa14"))
    assert 1.0 - len(run) / whole == pytest.approx(0.05, abs=0.02)
    gaps = np.diff(run.truth.time) / TICK
    lost = np.round(gaps[gaps > 1.5]) - 1.0
    assert lost.mean() == pytest.approx(6.0, rel=0.4)
    rows = np.searchsorted(moves("iiwa14").time, run.truth.time)
    np.testing.assert_array_equal(run.log.q, moves("iiwa14").q[rows])
    np.testing.assert_array_equal(run.truth.q, moves("iiwa14").q[rows])
    assert (run.log.time - run.truth.time).std() == pytest.approx(5e-5, rel=0.05)
    assert (np.diff(record(jitter=1.0).log.time) > 0.0).all()
