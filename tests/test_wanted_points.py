"""Contacts that are meant at a known point, without a sensor."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs

IIWA = cs.Robot.named("iiwa14")
DT = 1e-3
LINK, LOCAL = "iiwa_link_7", [0.0, 0.0, 0.05]
Q = np.array([0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.1])
REST = np.zeros(7)
OPTIONS = {
    "thresholds": {"torque_threshold": 1.0},
    "bias": {"torque_threshold": 1.0, "bias_time_constant": 0.3},
    "calibration": {"calibration": cs.Calibration.of_description(IIWA)},
}


def torque(q: np.ndarray, link: str, local: list[float], force: list[float]) -> np.ndarray:
    point = (IIWA.link_pose(q, link) @ [*local, 1.0])[:3]
    return IIWA.jacobian(q, link, point)[:3].T @ force


def ticks(
    monitor: cs.ContactMonitor, tau_ext: np.ndarray, count: int, seed: int = 0
) -> list[cs.ContactReport]:
    rng = np.random.default_rng(seed)
    tau = IIWA.inverse_dynamics(Q, REST, REST) - tau_ext
    return [monitor.update(Q, REST, tau + rng.normal(scale=0.05, size=7)) for _ in range(count)]


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_a_wanted_force_is_no_collision_and_another_is(options: dict[str, object]) -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT, wanted_contacts=[(LINK, LOCAL)], **options)
    ticks(monitor, REST, 500)
    wanted = torque(Q, LINK, LOCAL, [20.0, -10.0, 20.0])
    held = ticks(monitor, wanted, 3000, seed=1)
    assert not any(report.collision for report in held)
    np.testing.assert_allclose(np.mean([r.external_torque for r in held[500:]], axis=0), wanted, atol=0.2)
    np.testing.assert_allclose(held[-1].collision_torque, 0.0, atol=0.3)
    np.testing.assert_allclose(monitor.bias, 0.0, atol=0.1)
    other = torque(Q, "iiwa_link_4", [0.0, 0.0, 0.0], [0.0, 20.0, -20.0])
    touched = ticks(monitor, wanted + other, 200, seed=2)
    assert any(report.onset for report in touched)
    assert not ticks(monitor, wanted, 2000, seed=3)[-1].collision


def test_without_being_wanted_it_is_a_collision() -> None:
    monitor = cs.ContactMonitor(IIWA, dt=DT, calibration=cs.Calibration.of_description(IIWA))
    ticks(monitor, REST, 500)
    assert ticks(monitor, torque(Q, LINK, LOCAL, [20.0, -10.0, 20.0]), 200)[-1].collision


def test_what_no_force_at_the_point_explains_is_left() -> None:
    """Against NumPy's least squares in the metric of the thresholds."""
    threshold = np.array([2.0, 2.0, 1.5, 1.5, 0.5, 0.5, 0.3])
    monitor = cs.ContactMonitor(IIWA, dt=DT, wanted_contacts=[(LINK, LOCAL)], torque_threshold=threshold)
    push = torque(Q, LINK, LOCAL, [20.0, -10.0, 20.0]) + torque(Q, "iiwa_link_4", [0.0] * 3, [9.0, 8.0, 7.0])
    tau = IIWA.inverse_dynamics(Q, REST, REST) - push
    for _ in range(1000):
        report = monitor.update(Q, REST, tau)
    columns = np.stack([torque(Q, LINK, LOCAL, list(axis)) for axis in np.eye(3)], axis=1)
    force = np.linalg.lstsq(columns / threshold[:, None], push / threshold)[0]
    np.testing.assert_allclose(report.collision_torque, push - columns @ force, atol=1e-8)
    np.testing.assert_allclose(report.external_torque, push, atol=1e-8)


@pytest.mark.parametrize(
    "wanted",
    [
        [("nothing", LOCAL)],
        [(LINK, [0.0, 0.0])],
        [(LINK, [0.0, 0.0, np.nan])],
        [(LINK, LOCAL, 1.0)],
        [(LINK, "here")],
        [("iiwa_link_0", LOCAL)],
        [3],
        (LINK, LOCAL),
        LINK,
    ],
)
def test_what_is_no_point_is_refused(wanted: object) -> None:
    with pytest.raises(cs.InputError, match=r"^wanted_contacts: "):
        cs.ContactMonitor(IIWA, dt=DT, wanted_contacts=wanted)


def test_a_wanted_sensor_and_a_wanted_point() -> None:
    sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_7")
    wanted = ["wrist", ("iiwa_link_5", [0.0, 0.0, 0.1])]
    monitor = cs.ContactMonitor(IIWA, dt=DT, sensors=[sensor], wanted_contacts=wanted, torque_threshold=1.0)
    reading = cs.LoadCompensator(IIWA, [sensor]).update(Q, REST, REST, np.zeros((1, 6)))[0]
    turn = IIWA.link_pose(Q, "iiwa_link_7")[:3, :3].T
    free = -np.r_[turn @ reading[:3], turn @ reading[3:]][None]
    push = torque(Q, "iiwa_link_5", [0.0, 0.0, 0.1], [0.0, 30.0, 0.0])
    tau = IIWA.inverse_dynamics(Q, REST, REST)
    for external in (REST, push):
        assert not any(monitor.update(Q, REST, tau - external, free).collision for _ in range(300))
