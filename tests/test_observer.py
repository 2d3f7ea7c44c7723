"""Momentum observer: first-order response, trajectories, friction, per-joint gains, bad input."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs


@pytest.fixture(scope="module")
def arm() -> cs.Robot:
    return cs.Robot.named("iiwa14")


def sines(t: float, speed: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, velocity and acceleration of seven sines whose velocities peak at `speed` [rad/s]."""
    omega = 2 * np.pi * np.array([0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1])
    phase = np.arange(7.0)
    amplitude = speed / omega
    return (
        amplitude * np.sin(omega * t + phase),
        speed * np.cos(omega * t + phase),
        -speed * omega * np.sin(omega * t + phase),
    )


@pytest.mark.parametrize("gain_dt", [0.05, 0.5, 5.0])
@pytest.mark.parametrize("moving", [False, True])
def test_step_response_is_first_order(arm: cs.Robot, gain_dt: float, moving: bool) -> None:
    dt = 1e-3
    observer = cs.MomentumObserver(arm, dt=dt, gain=gain_dt / dt)
    step = np.array([5.0, -3.0, 2.0, 4.0, -1.0, 0.5, 0.2])
    for k in range(200):
        q, v, a = sines(k * dt, 0.5 if moving else 0.0)
        # The motors supply what the external torque does not: the motion stays the same.
        r = observer.update(q, v, arm.inverse_dynamics(q, v, a) - step)
        expected = step * (1 - np.exp(-gain_dt * k))
        assert np.all(np.abs(r - expected) <= 0.01 * np.abs(step) + 1e-12)


def test_trajectory_without_contact_stays_silent(arm: cs.Robot) -> None:
    observer = cs.MomentumObserver(arm, dt=1e-3, gain=500.0)
    worst = 0.0
    for k in range(4000):
        q, v, a = sines(k * 1e-3, 1.9)
        worst = max(worst, np.max(np.abs(observer.update(q, v, arm.inverse_dynamics(q, v, a)))))
    assert worst < 1e-3, f"{worst:.2e} Nm"


def test_error_is_second_order_in_dt(arm: cs.Robot) -> None:
    def worst(dt: float) -> float:
        observer = cs.MomentumObserver(arm, dt=dt, gain=500.0)
        values = []
        for k in range(round(1.0 / dt)):
            q, v, a = sines(k * dt, 1.9)
            values.append(np.max(np.abs(observer.update(q, v, arm.inverse_dynamics(q, v, a)))))
        return max(values)

    assert 3.5 < worst(2e-3) / worst(1e-3) < 4.5


def test_floating_base_sees_the_base_force() -> None:
    robot = cs.Robot.named("atlas")
    rng = np.random.default_rng(0)
    q, v, tau_ext = robot.neutral(), np.zeros(robot.nv), rng.uniform(-5, 5, robot.nv)
    # Held at rest: the base has no motor, so what the joints carry must balance the rest of tau_ext.
    weight = robot.inverse_dynamics(q, v, v)
    tau_ext[:6] = weight[:6]
    observer = cs.MomentumObserver(robot, dt=1e-3, gain=500.0)
    for _ in range(60):
        r = observer.update(q, v, (weight - tau_ext)[6:])
    np.testing.assert_allclose(r, tau_ext, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(observer.acceleration, 0.0, atol=1e-8)


def test_acceleration_follows_the_motion(arm: cs.Robot) -> None:
    observer = cs.MomentumObserver(arm, dt=1e-3, gain=500.0)
    for k in range(300):
        q, v, a = sines(k * 1e-3, 1.0)
        observer.update(q, v, arm.inverse_dynamics(q, v, a))
        np.testing.assert_allclose(observer.acceleration, a, atol=2e-3)


def test_friction_is_taken_out(arm: cs.Robot) -> None:
    plain, rubbed = (cs.MomentumObserver(arm, dt=1e-3) for _ in range(2))
    for k in range(100):
        q, v, a = sines(k * 1e-3, 1.0)
        tau, friction = arm.inverse_dynamics(q, v, a), 0.3 * v + 0.2 * np.sign(v)
        expected = plain.update(q, v, tau)
        found = rubbed.update(q, v, tau + friction, friction=friction)
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_gain_per_joint_and_time_step_per_call(arm: cs.Robot) -> None:
    gain = np.arange(1.0, 8.0) * 20
    observer = cs.MomentumObserver(arm, dt=1.0, gain=gain)
    q, zero = arm.neutral(), np.zeros(7)
    tau = arm.inverse_dynamics(q, zero, zero) - 1.0
    observer.update(q, zero, tau)
    for _ in range(10):
        r = observer.update(q, zero, tau, dt=2e-3)
    np.testing.assert_allclose(r, 1 - np.exp(-gain * 20e-3), rtol=1e-12)
    observer.reset()
    assert not observer.external_torque.any()
    assert not observer.update(q, zero, tau).any()


def bad_calls(nq: int) -> list[tuple[str, tuple[object, object, object], str]]:
    ok = np.zeros(nq)
    nan, inf = ok.copy(), ok.copy()
    nan[3], inf[0] = np.nan, -np.inf
    return [
        ("nan", (nan, ok, ok), "q"),
        ("infinite", (ok, inf, ok), "v"),
        ("short", (ok, ok, ok[:-1]), "tau"),
        ("two dimensions", (ok.reshape(1, -1), ok, ok), "q"),
        ("none", (ok, None, ok), "v"),
        ("text", (ok, ok, "torque"), "tau"),
        ("complex", (ok, ok, ok * 1j), "tau"),
        ("ragged", ([[1.0], [1.0, 2.0]], ok, ok), "q"),
    ]


@pytest.mark.parametrize(
    ("what", "arguments", "name"), bad_calls(7), ids=lambda x: x if isinstance(x, str) else ""
)
def test_bad_input_is_named_and_changes_nothing(
    arm: cs.Robot, what: str, arguments: tuple[object, object, object], name: str
) -> None:
    observers = [cs.MomentumObserver(arm, dt=1e-3) for _ in range(2)]
    for k in range(10):
        q, v, a = sines(k * 1e-3, 1.0)
        tau = arm.inverse_dynamics(q, v, a) + 1.0
        first = observers[0].update(q, v, tau)
        with pytest.raises(cs.InputError, match=name):
            observers[1].update(*arguments)
        np.testing.assert_array_equal(observers[1].update(q, v, tau), first)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"dt": 0.0}, "dt"),
        ({"dt": float("nan")}, "dt"),
        ({"dt": 1e-3, "gain": -1.0}, "gain"),
        ({"dt": 1e-3, "gain": [1.0, 2.0]}, "gain"),
        ({"dt": 1e-3, "gain": float("inf")}, "gain"),
    ],
)
def test_bad_settings_are_named(arm: cs.Robot, options: dict[str, object], name: str) -> None:
    with pytest.raises(cs.InputError, match=name):
        cs.MomentumObserver(arm, **options)


def test_array_likes_are_welcome(arm: cs.Robot) -> None:
    q, v = [0.1] * 7, tuple([0] * 7)
    strided = np.zeros(14)[::2]
    observer = cs.MomentumObserver(arm, dt=1e-3)
    observer.update(q, v, strided)
    assert observer.update(np.float32(q), np.zeros(7, dtype=int), strided).shape == (7,)


def test_fields_of_packed_records_are_read(arm: cs.Robot) -> None:
    record = np.zeros(3, np.dtype([("flag", "i1"), ("q", "f8", (7,))]))
    record["q"][1] = np.arange(7.0)
    expected = arm.mass_matrix(np.arange(7.0))
    np.testing.assert_array_equal(arm.mass_matrix(record[1]["q"]), expected)
