"""Torques that no push explains: what detection leaves holds."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs

ROBOT, Q = cs.Robot.named("iiwa14"), np.array([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0])
STILL = np.zeros(7)


@pytest.mark.parametrize(("joint", "torque"), [(4, 1.0), (5, 1.0), (6, 1.0), (6, 5.0), (6, -10.0)])
def test_a_twisted_joint_is_no_contact_before_it(joint: int, torque: float) -> None:
    # No force on a link before a joint causes a torque there.
    monitor = cs.ContactMonitor(ROBOT, dt=0.001)
    weight = ROBOT.inverse_dynamics(Q, STILL, STILL)
    for tick in range(400):
        twisted = np.where(np.arange(7) == joint, torque, 0.0) * (tick > 100)
        report = monitor.update(Q, STILL, weight - twisted)
    (contact,) = report.contacts
    assert contact.link in report.links
    assert int(contact.link[-1]) > joint
    assert not contact.located
