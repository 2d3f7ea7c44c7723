"""A contact that the torques' errors feign must not be called located."""

import numpy as np

import contactsense as cs
from contactsense.sim.sampling import touches

THRESHOLD = 0.2  # [Nm], three standard deviations of a torque


def test_errors_of_torques_never_make_up_a_force() -> None:
    robot = cs.Robot.named("iiwa14")
    isolator = cs.ContactIsolator(robot, torque_threshold=THRESHOLD)
    rng = np.random.default_rng(3)
    ratios, shares = [], []
    for link in ("iiwa_link_6", "iiwa_link_7"):
        for touch in touches(robot, link, 300, rng):
            torque = robot.jacobian(touch.q, link, touch.point)[:3].T @ touch.force
            torque += rng.normal(scale=THRESHOLD / 3, size=robot.nv)
            for contact in isolator.isolate(touch.q, torque).contacts:
                if contact.located:
                    ratios.append(np.linalg.norm(contact.force) / np.linalg.norm(touch.force))
                    shares.append(np.linalg.norm(contact.point - touch.point) / contact.point_std)
    assert len(ratios) > 100
    assert max(ratios) < 2.0
    assert np.mean(np.array(shares) < 3.0) > 0.95
