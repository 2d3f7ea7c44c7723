"""How many contacts, and on which bodies, where torques have noise: a floating robot."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs
from contactsense.sim.sampling import Touch, random_configuration, touches_in_pose

CONE = np.deg2rad(30.0)
SIGMA = 0.02  # [Nm, N]


@pytest.fixture(scope="module")
def robot() -> cs.Robot:
    return cs.Robot.named("atlas")


def push(robot: cs.Robot, q: np.ndarray, link: str, rng: np.random.Generator, size: float) -> Touch:
    (touch,) = touches_in_pose(robot, q, link, 1, rng, CONE)
    return Touch(link, q, touch.point, size * touch.force / np.linalg.norm(touch.force))


def torque(robot: cs.Robot, pushes: list[Touch]) -> np.ndarray:
    return sum(robot.jacobian(each.q, each.link, each.point)[:3].T @ each.force for each in pushes)


def own_joint(robot: cs.Robot, link: str) -> int:
    return int(np.flatnonzero(robot.jacobian(robot.neutral(), link).any(axis=0))[-1])


def test_noise_of_an_idle_joint_is_no_second_contact(robot: cs.Robot) -> None:
    isolator = cs.ContactIsolator(robot, torque_threshold=3 * SIGMA)
    rng = np.random.default_rng(1)
    located = 0
    for _ in range(20):
        q = random_configuration(robot, rng)
        true = push(robot, q, "l_foot", rng, 40.0)
        tau = torque(robot, [true]) + SIGMA * 0.5 * rng.standard_normal(robot.nv)
        tau[own_joint(robot, "r_hand")] = 3.2 * SIGMA
        (contact,) = isolator.isolate(q, tau).contacts
        assert contact.link in ("l_foot", "l_talus")
        located += contact.located
    assert located > 10
    # This is no noise, also beside that which grows with the torque of the contact.
    tau[own_joint(robot, "r_hand")] = 20.0 * SIGMA
    assert len(isolator.isolate(q, tau).contacts) > 1


def test_a_contact_whose_own_joint_is_under_its_threshold_is_found_beside_another(robot: cs.Robot) -> None:
    """The torques of the joints before it tell the body."""
    isolator = cs.ContactIsolator(robot, torque_threshold=3 * SIGMA)
    rng = np.random.default_rng(2)
    silent = right = 0
    for _ in range(150):
        q = random_configuration(robot, rng)
        pushes = [push(robot, q, "l_foot", rng, 5.0), push(robot, q, "r_hand", rng, 30.0)]
        tau = torque(robot, pushes)
        if abs(tau[own_joint(robot, "l_foot")]) > 2 * SIGMA:
            continue
        silent += 1
        tau += SIGMA * rng.standard_normal(robot.nv)
        contacts = isolator.isolate(q, tau).contacts
        right += {contact.link for contact in contacts} == {"l_foot", "r_hand"}
        for contact in contacts:
            if contact.located:
                off = min(np.linalg.norm(contact.point - each.point) for each in pushes)
                assert off < 0.01 + 3 * contact.point_std
    assert silent > 20
    assert right > 0.6 * silent


def test_noise_stated_as_a_share_of_the_torque_is_believed(robot: cs.Robot) -> None:
    """Errors of a hundredth of strong torques contradict thresholds, and no stated noise."""
    noise = cs.NoiseModel(torque=0.01, model=0.0, relative=0.01)
    rng = np.random.default_rng(3)
    counts = np.zeros(2, dtype=int)
    for _ in range(40):
        q = random_configuration(robot, rng)
        true = push(robot, q, "r_hand", rng, 60.0)
        tau = torque(robot, [true])
        tau += np.hypot(0.01 * tau, 0.01) * rng.standard_normal(robot.nv)
        isolators = (cs.ContactIsolator(robot, noise=noise), cs.ContactIsolator(robot, torque_threshold=0.03))
        for index, isolator in enumerate(isolators):
            for contact in isolator.isolate(q, tau).contacts:
                counts[index] += contact.located
                off = np.linalg.norm(contact.point - true.point)
                assert not contact.located or off < 0.01 + 3 * contact.point_std
    assert min(counts) > 25


def test_a_deficit_under_noise_locates_nothing(robot: cs.Robot) -> None:
    """What closes it errs by more than the covariance of the wrenches tells."""
    rng = np.random.default_rng(4)
    deficient = 0
    for _ in range(30):
        q = random_configuration(robot, rng)
        pushes = [push(robot, q, "utorso", rng, 30.0), push(robot, q, "l_ufarm", rng, 30.0)]
        tau = torque(robot, pushes) + SIGMA * rng.standard_normal(robot.nv)
        isolation = cs.ContactIsolator(robot, torque_threshold=3 * SIGMA).isolate(q, tau)
        if isolation.rank_deficit == 1:
            deficient += 1
            assert not any(contact.located for contact in isolation.contacts)
    assert deficient > 5
