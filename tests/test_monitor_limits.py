"""The stop at a joint's limit is no contact; a person elsewhere is, at the same time."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs

IIWA = cs.Robot.named("iiwa14")
DT = 1e-3
JOINT = 3  # of which the torque is the stop's
Q = np.array([0.3, 0.6, -0.4, 0.0, 0.5, 0.9, 0.1])
REST = np.zeros(7)
OPTIONS = {
    "thresholds": {"torque_threshold": 1.0},
    "bias": {"torque_threshold": 1.0, "bias_time_constant": 0.3},
    "calibration": {"calibration": cs.Calibration.of_description(IIWA)},
}


def at_limit(upper: bool) -> tuple[np.ndarray, float]:
    """A pose with the joint at its limit, and the sign of the stop's torque."""
    q = Q.copy()
    q[JOINT] = IIWA.position_limits[JOINT][int(upper)]
    return q, -1.0 if upper else 1.0


def ticks(
    monitor: cs.ContactMonitor, q: np.ndarray, tau_ext: np.ndarray, count: int, seed: int = 0
) -> list[cs.ContactReport]:
    rng = np.random.default_rng(seed)
    tau = IIWA.inverse_dynamics(q, REST, REST) - tau_ext
    return [monitor.update(q, REST, tau + rng.normal(scale=0.05, size=7)) for _ in range(count)]


def stop(torque: float) -> np.ndarray:
    tau_ext = np.zeros(7)
    tau_ext[JOINT] = torque
    return tau_ext


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
@pytest.mark.parametrize("upper", [True, False])
def test_a_stop_is_no_contact(options: dict[str, object], upper: bool) -> None:
    q, inward = at_limit(upper)
    monitor = cs.ContactMonitor(IIWA, dt=DT, **options)
    assert not any(report.limited_joints for report in ticks(monitor, q, REST, 500))
    pushed = ticks(monitor, q, stop(20.0 * inward), 500, seed=1)
    assert not any(report.collision for report in pushed)
    assert pushed[-1].limited_joints == (IIWA.joint_names[JOINT],)
    assert pushed[-1].to_dict()["limited_joints"] == [IIWA.joint_names[JOINT]]
    np.testing.assert_allclose(pushed[-1].external_torque[JOINT], 20.0 * inward, atol=0.5)
    assert pushed[-1].collision_torque[JOINT] == 0.0
    # The bias has not learnt the stop.
    np.testing.assert_allclose(monitor.bias, 0.0, atol=0.1)


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
@pytest.mark.parametrize("link", ["iiwa_link_3", "iiwa_link_6"])
def test_a_person_beside_a_stop_is_a_contact(options: dict[str, object], link: str) -> None:
    q, inward = at_limit(True)
    monitor = cs.ContactMonitor(IIWA, dt=DT, **options)
    ticks(monitor, q, REST, 500)
    ticks(monitor, q, stop(20.0 * inward), 200, seed=1)
    push = IIWA.jacobian(q, link)[:3].T @ [20.0, 15.0, 0.0]
    push[JOINT] = min(push[JOINT], 0.0)  # the joint bears no push outward: the stop does
    touched = ticks(monitor, q, stop(20.0 * inward) + push, 200, seed=2)
    assert any(report.onset for report in touched)
    assert touched[-1].collision
    assert touched[-1].limited_joints == (IIWA.joint_names[JOINT],)
    assert touched[-1].contacts


@pytest.mark.parametrize("options", OPTIONS.values(), ids=OPTIONS)
def test_a_push_against_the_joint_away_from_its_limit_is_a_contact(options: dict[str, object]) -> None:
    q, inward = at_limit(True)
    away = q.copy()
    away[JOINT] -= 0.1
    for pose, torque in ((away, 20.0 * inward), (q, -20.0 * inward)):
        monitor = cs.ContactMonitor(IIWA, dt=DT, **options)
        ticks(monitor, pose, REST, 500)
        touched = ticks(monitor, pose, stop(torque), 200, seed=1)
        assert touched[-1].collision
        assert not touched[-1].limited_joints
