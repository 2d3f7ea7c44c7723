"""Motion without contact tells what is wrong with an arm; bad logs and arguments are refused by name."""

from __future__ import annotations

import pickle
import signal
import subprocess
import sys
import threading
import time
from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from robots import parameters, robot_named

import contactsense as cs

IIWA = cs.Robot.named("iiwa14")
TICK = 0.005


@cache
def motion() -> cs.Motion:
    return cs.exciting_motion(IIWA, 20.0, dt=TICK)


def torques(robot: cs.Robot = IIWA) -> np.ndarray:
    rows = zip(motion().q, motion().v, motion().a, strict=True)
    return np.array([robot.inverse_dynamics(q, v, a) for q, v, a in rows])


def white(size: float) -> np.ndarray:
    return np.random.default_rng(1).normal(0.0, size, motion().v.shape)


def log(tau: np.ndarray, rows: slice = slice(None)) -> cs.Log:
    return cs.Log(motion().time, motion().q, motion().v, tau)[rows]


def corrected(calibration: cs.Calibration) -> cs.Robot:
    """The robot with the inertias of a calibration; each link of this one has the frame of its joint."""
    model = IIWA.model.copy()
    for joint, body in enumerate(calibration.bodies, start=1):
        model.inertias[joint] = pin.Inertia(body.mass, body.com, body.inertia)
    model.armature = np.array(calibration.armature)
    return cs.Robot.from_pinocchio(model, IIWA.geometry_model)


def test_what_an_imperfect_arm_has_is_found() -> None:
    pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")
    from contactsense import sim

    arm = sim.ImperfectArm.typical(IIWA)
    run = sim.record_imperfect(IIWA, arm, motion(), seed=4)
    half = len(run.log) // 2
    calibration = cs.calibrate(IIWA, run.log[:half])

    def left(robot: cs.Robot, calibration: cs.Calibration) -> np.ndarray:
        rows = slice(half, None)
        q, v, a = run.truth.q[rows], run.truth.v[rows], run.truth.a[rows]
        model = [robot.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)]
        friction = calibration.friction
        slow = np.array([width for _, width in friction.reversal])
        bias = calibration.torque_bias + friction.coulomb * np.tanh(v / slow) + friction.viscous * v
        return np.sqrt(np.mean((run.log.tau[rows] - model - bias) ** 2, axis=0))

    before = left(IIWA, cs.Calibration.of_description(IIWA))
    assert (left(corrected(calibration), calibration) < 0.7 * before).sum() >= 5
    assert calibration.joint_names == IIWA.joint_names
    calibration.check(IIWA)
    assert pickle.loads(pickle.dumps(calibration)) == calibration


def test_bias_friction_and_rotors() -> None:
    bias, coulomb = np.linspace(-0.4, 0.4, 7), np.linspace(0.2, 1.0, 7)
    rotor = np.array([0.3, 0.3, 0.3, 0.2, 0.1, 0.1, 0.0])
    v, a = motion().v, motion().a
    tau = torques() + bias + coulomb * np.tanh(v / 0.01) + 0.3 * v + rotor * a
    calibration = cs.calibrate(IIWA, log(tau + white(0.05)), false_alarms_per_hour=0.5)
    np.testing.assert_allclose(calibration.torque_bias, bias, atol=0.05)
    np.testing.assert_allclose(calibration.friction.coulomb, coulomb, atol=0.1)
    np.testing.assert_allclose(calibration.friction.viscous, 0.3, atol=0.15)
    # The first rotor and the inertia of the first link turn about one axis: nothing tells them apart.
    np.testing.assert_allclose(calibration.armature[1:5], rotor[1:5], atol=0.1)
    assert calibration.false_alarms_per_hour == 0.5
    assert calibration.payload is None
    np.testing.assert_allclose(calibration.noise.torque, 0.05, rtol=0.3)
    assert calibration.residual.max() < 0.1
    for std in (calibration.torque_bias_std, calibration.friction.coulomb_std, calibration.armature_std):
        assert (std > 0.0).all()


def test_slow_errors_of_short_stretches_keep_their_estimate() -> None:
    # A pause every 0.9 s: no stretch is long enough to follow slow errors in.
    time = motion().time + np.floor(motion().time / 0.9)
    errors = 0.3 * np.sin(7.0 * motion().time)[:, np.newaxis]
    tau = torques() + errors + white(0.02)
    calibration = cs.calibrate(IIWA, cs.Log(time, motion().q, motion().v, tau))
    # The errors have a root mean square of 0.21 Nm.
    assert ((calibration.noise.model > 0.1) & (calibration.noise.model < 1.0)).all()
    # A joint without any error still has errors of rounding.
    exact = cs.calibrate(IIWA, log(torques()))
    assert (exact.noise.model >= 1e-6).all()


def kept_back(torque: np.ndarray, width: np.ndarray) -> np.ndarray:
    """What one element that follows the torque up to a width either way holds."""
    state, held = np.zeros(torque.shape[1]), np.zeros_like(torque)
    for row in range(1, len(torque)):
        state = np.clip(state + torque[row] - torque[row - 1], -width, width)
        held[row] = state
    return held


def test_hysteresis_of_gears_is_found_and_corrected() -> None:
    true = torques() + 0.3 + 0.5 * np.tanh(motion().v / 0.01)
    # Another form than the one that is fitted: one element.
    tau = true - 0.1 * kept_back(true, 0.4 * true.std(axis=0)) + white(0.02)
    calibration = cs.calibrate(IIWA, log(tau))
    assert (calibration.hysteresis > 0.02).sum() >= 5
    error = np.abs(calibration.torque_bias - 0.3)
    assert (error < 2.0 * calibration.torque_bias_std).sum() >= 6
    assert calibration.inertial_change <= 0.3
    without = cs.calibrate(IIWA, log(true + white(0.02)))
    assert (without.hysteresis < 0.01).all()
    # The share stands for what a torque that is not trimmed to a per cent, or another form, may add.
    assert (calibration.noise.relative != 0.05).sum() >= 5


def test_a_payload_is_found() -> None:
    loaded = IIWA.with_payload("iiwa_link_7", 1.5, [0.02, -0.03, 0.08], 2e-3 * np.eye(3))
    payload = cs.calibrate(IIWA, log(torques(loaded) + white(0.05)), payload_link="iiwa_link_7").payload
    assert payload is not None
    assert payload.link == "iiwa_link_7"
    assert payload.mass == pytest.approx(1.5, rel=0.05)
    np.testing.assert_allclose(payload.com, [0.02, -0.03, 0.08], atol=0.015)
    assert 0.0 < payload.mass_std < 0.2
    assert payload == pickle.loads(pickle.dumps(payload))
    assert set(payload.to_dict()) == {"link", "mass", "mass_std", "com", "com_std", "moment"}


def test_where_nothing_is_held_the_calibration_does_what_its_residual_says() -> None:
    # The description holds a tool that is not mounted: a payload would have to weigh less than nothing.
    described = IIWA.with_payload("iiwa_link_7", 1.0, [0.0, 0.0, 0.1])
    moved, tau = motion(), torques() + white(0.05)
    calibration = cs.calibrate(described, log(tau), payload_link="iiwa_link_7")
    assert calibration.payload is not None
    assert calibration.payload.mass == 0.0
    assert calibration.payload.mass_std > 0.0
    assert any("Nothing is held at iiwa_link_7" in note for note in calibration.notes)
    step = float(moved.time[1] - moved.time[0])
    observer = cs.MomentumObserver(described, dt=step, gain=8.0, calibration=calibration)
    left = [observer.update(*row) for row in zip(moved.q, moved.v, tau, strict=True)]
    assert (np.sqrt(np.mean(np.square(left), axis=0)) < 2.0 * calibration.residual).all()


def test_external_torques_of_a_vendor() -> None:
    bias = np.linspace(-0.6, 0.6, 7)
    external = bias + 0.4 * np.tanh(motion().v / 0.01) + white(0.05)
    given = cs.Log(motion().time, motion().q, motion().v, external_torque=external)
    calibration = cs.calibrate(IIWA, given)
    assert calibration.torque_is_external
    assert not cs.calibrate(IIWA, log(torques())).torque_is_external
    np.testing.assert_allclose(calibration.torque_bias, bias, atol=0.02)
    np.testing.assert_allclose(calibration.friction.coulomb, 0.4, atol=0.03)
    np.testing.assert_allclose(calibration.noise.torque, 0.05, rtol=0.2)
    assert (np.array(calibration.noise.velocity) == 0.0).all()
    described = cs.Calibration.of_description(IIWA)
    assert [body.mass for body in calibration.bodies] == pytest.approx([b.mass for b in described.bodies])
    with pytest.raises(cs.InputError, match="payload_link: needs the torques of the motors"):
        cs.calibrate(IIWA, given, payload_link="iiwa_link_7")


@pytest.mark.parametrize("opposite", [[3], [0, 5], list(range(7))])
def test_opposite_torques_are_found(opposite: list[int]) -> None:
    sign = np.ones(7)
    sign[opposite] = -1.0
    tau = torques() + 0.3 + 0.5 * np.tanh(motion().v / 0.01) + white(0.05)
    calibration = cs.calibrate(IIWA, log(sign * tau))
    np.testing.assert_array_equal(calibration.torque_scale, sign)
    np.testing.assert_allclose(calibration.torque_bias, 0.3, atol=0.05)


def test_a_torque_that_is_scaled_is_found() -> None:
    factor = np.array([1.0, 1.3, 1.0, 1.0, 1.0, 1.0, 1.0])
    tau = torques() + 0.3 + 0.5 * np.tanh(motion().v / 0.01) + white(0.05)
    np.testing.assert_allclose(cs.calibrate(IIWA, log(tau / factor)).torque_scale, factor, rtol=0.05)
    np.testing.assert_array_equal(cs.calibrate(IIWA, log(tau)).torque_scale, 1.0)


def test_gears_with_hysteresis_do_not_scale_torques() -> None:
    pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")
    from contactsense import sim

    # Small changes of a torque come through such a gear as if it were an eighth smaller.
    arm = sim.ImperfectArm.typical(IIWA, seed=0)
    run = sim.record_imperfect(IIWA, arm, cs.exciting_motion(IIWA, 30.0, dt=TICK), seed=0)
    np.testing.assert_array_equal(cs.calibrate(IIWA, run.log).torque_scale, 1.0)


def test_rotors_do_not_scale_torques() -> None:
    tau = torques() + 0.3 + 0.5 * np.tanh(motion().v / 0.01) + 5.0 * motion().a + white(0.05)
    np.testing.assert_array_equal(cs.calibrate(IIWA, log(tau)).torque_scale, 1.0)


def test_a_contact_is_left_out() -> None:
    tau = torques() + white(0.05)
    touched = (motion().time > 8.0) & (motion().time < 8.5)
    tau[touched] += [8.0, 12.0, 5.0, 8.0, 3.0, 3.0, 1.0]
    calibration = cs.calibrate(IIWA, log(tau))
    assert any(start <= 8.0 and end >= 8.5 for start, end in calibration.contacts)
    np.testing.assert_allclose(calibration.torque_bias, 0.0, atol=0.05)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"robot": "iiwa14"}, "robot: expected a contactsense.Robot"),
        ({"robot": cs.Robot.named("atlas")}, "q: must be 400 rows of 37"),
        ({"log": [1.0, 2.0]}, "log: expected a contactsense.Log, got list"),
        ({"log": cs.Log([0.0], np.zeros((1, 7)), np.zeros((1, 7)), np.zeros((1, 7)))}, "log: "),
        ({"log": cs.Log([], np.zeros((0, 7)), np.zeros((0, 7)), np.zeros((0, 7)))}, "log: "),
        ({"log": cs.Log([0.0, 0.1], *[np.zeros((2, 7))] * 3)}, "log: is too short"),
        ({"log": cs.Log([0.0, 0.1], np.zeros((2, 6)), *[np.zeros((2, 7))] * 2)}, "q: must be 2 rows of 7"),
        ({"log": cs.Log([0.0, 0.1], *[np.zeros((2, 7))] * 2, np.zeros((2, 1)))}, "tau: must be 2 rows of 7"),
        (
            {"log": cs.Log([0.0], *[np.zeros((1, 7))] * 2, external_torque=np.zeros((1, 7)))},
            "log: must have rows",
        ),
        ({"log": cs.Log(np.arange(3e3) * 0.01, *[np.zeros((3000, 7))] * 3)}, "log: "),
        ({"false_alarms_per_hour": 0.0}, "false_alarms_per_hour: must be positive"),
        ({"false_alarms_per_hour": "one"}, "false_alarms_per_hour: expected a number"),
        ({"payload_link": "gripper"}, "payload_link: there is no link 'gripper'; the links are iiwa_link_0"),
        ({"payload_link": "iiwa_link_0"}, "payload_link: 'iiwa_link_0' is fixed to the world"),
        ({"payload_link": 7}, "payload_link: expected a string"),
    ],
)
def test_arguments_that_cannot_be_used(change: dict[str, object], said: str) -> None:
    short = log(np.zeros_like(motion().v), slice(0, 400))
    given = {"robot": IIWA, "log": short} | change
    with pytest.raises(cs.InputError, match=said):
        cs.calibrate(**given)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", parameters(["xarm7", "kinova", "panda", "ur5"]))
def test_arms_with_massless_links_sliding_or_endless_joints(name: str) -> None:
    robot = robot_named(name)
    phase = np.linspace(0.0, 6.0, robot.nv)
    seconds = 0.01 * np.arange(1500)[:, None]
    rate = np.linspace(0.7, 2.9, robot.nv)
    q = [robot.integrate(robot.neutral(), x) for x in 0.3 * np.sin(rate * seconds + phase)]
    v = 0.3 * rate * np.cos(rate * seconds + phase)
    a = -0.3 * rate**2 * np.sin(rate * seconds + phase)
    tau = [robot.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)]
    noisy = np.array(tau) + np.random.default_rng(0).normal(0.0, 0.05, v.shape)
    calibration = cs.calibrate(robot, cs.Log(seconds[:, 0], q, v, noisy))
    assert calibration.residual.max() < 0.1
    assert all(np.linalg.eigvalsh(body.inertia)[0] >= -1e-12 for body in calibration.bodies)
    calibration.check(robot)


def test_other_threads_run_while_it_computes() -> None:
    ticks, stop = [], threading.Event()

    def count() -> None:
        while not stop.wait(1e-3):
            ticks.append(time.monotonic())

    other = threading.Thread(target=count)
    other.start()
    begin = time.monotonic()
    cs.calibrate(IIWA, log(torques() + white(0.05)))
    end = time.monotonic()
    stop.set()
    other.join()
    assert sum(begin < tick < end for tick in ticks) > 3


INTERRUPTED = """
import os, signal, threading
import numpy as np, contactsense as cs
signal.signal(signal.SIGINT, signal.default_int_handler)
robot = cs.Robot.named("iiwa14")
time = 0.01 * np.arange(60_000)
angles = np.sin(np.outer(time, np.linspace(0.5, 3.0, 7)))
log = cs.Log(time, angles, angles, angles)
threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
try:
    cs.calibrate(robot, log)
except KeyboardInterrupt:
    print("interrupted")
"""


@pytest.mark.skipif(not hasattr(signal, "SIGINT") or sys.platform == "win32", reason="POSIX signals")
def test_ctrl_c_ends_it() -> None:
    run = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True, timeout=120)
    assert run.stdout == "interrupted\n", run.stderr
