"""Isolation of noisy torques: what is called located is there, and what else explains the torques is said."""

from __future__ import annotations

import map_reference
import numpy as np
import pytest
from robots import BY_NAME
from tools.figures.noisy_isolation import SIGMA, count, seeded

import contactsense as cs
from contactsense.sim.sampling import lines, random_configuration, touches

ROBOTS = ("iiwa14", "panda", "xarm7", "talos", "g1")


def robot_named(name: str) -> cs.Robot:
    return BY_NAME[name].robot() if name in BY_NAME else cs.Robot.named(name)


def push_torque(
    robot: cs.Robot, q: np.ndarray, link: str, point: np.ndarray, force: np.ndarray
) -> np.ndarray:
    return robot.jacobian(q, link, point)[:3].T @ force


# The nested, open meshes of Talos' wrists do not tell what is inside another link.
@pytest.mark.parametrize(
    ("name", "free"), [(name, free) for name in ROBOTS for free in (True, False) if free or name != "talos"]
)
def test_located_points_are_within_their_uncertainty(name: str, free: bool) -> None:
    """Pushes along free lines, and along lines that other parts of the robot bar, which are harder."""
    found = count(robot_named(name), seeded(name, free), free)
    assert found["wrong"] <= 0.01 * found["located"] + 1  # of few, one is more than one per cent
    assert found["located"] >= 0.02 * found["pushes"]


def test_a_link_hidden_by_a_silent_joint_is_a_candidate() -> None:
    """With joint 6 at zero, some pushes on link 6 are explained by link 7 as well, 46 mm off."""
    robot = cs.Robot.named("iiwa14")
    isolator = cs.ContactIsolator(robot)
    rng = np.random.default_rng(9)
    several = 0
    for _ in range(60):
        q = random_configuration(robot, rng)
        q[5] = 0.0
        for point, inward in zip(*lines(robot, q, "iiwa_link_6", 4, rng), strict=True):
            isolation = isolator.isolate(q, push_torque(robot, q, "iiwa_link_6", point, 30.0 * inward))
            (contact,) = isolation.contacts
            entries = [candidate for candidate in contact.candidates if candidate.pushing]
            apart = max((np.linalg.norm(entry.point - contact.point) for entry in entries), default=0.0)
            several += apart > 0.04
            if contact.located:
                assert apart < 0.05
                assert np.linalg.norm(contact.point - point) < 1e-6 + 3 * contact.point_std
            elif entries:
                assert min(np.linalg.norm(entry.point - point) for entry in entries) < 1e-6
    assert several > 0


def test_a_joint_under_its_threshold_decides_nothing() -> None:
    """The torque of joint 7 is noise or a contact on link 7: links 6 and 7 are both candidates."""
    robot = cs.Robot.named("iiwa14")
    q = np.array([0.3, 0.6, -0.2, -1.3, 0.4, 0.9, 0.1])
    rng = np.random.default_rng(3)
    isolator = cs.ContactIsolator(robot, torque_threshold=3 * SIGMA)
    seen = 0
    for point, inward in zip(*lines(robot, q, "iiwa_link_7", 60, rng), strict=True):
        tau = push_torque(robot, q, "iiwa_link_7", point, 25.0 * inward)
        if not 0.5 * SIGMA < abs(tau[6]) < 2.5 * SIGMA:
            continue
        seen += 1
        (contact,) = isolator.isolate(q, tau).contacts
        on_seven = [c for c in contact.candidates if c.link == "iiwa_link_7" and c.pushing]
        assert contact.link == "iiwa_link_7" or on_seven or not contact.candidates
        if contact.located and contact.link != "iiwa_link_7":
            assert np.linalg.norm(contact.point - point) < 3 * contact.point_std
    assert seen > 10


# The posterior has errors of places as well: it grows less than the noise.
@pytest.mark.parametrize(("samples", "grows"), [(0, 2.0), (1000, 1.0)])
def test_agreement_of_a_redundant_torque_does_not_shrink_the_uncertainty(samples: int, grows: float) -> None:
    """Without noise the torques agree to rounding; the stated noise stays what it is."""
    robot = cs.Robot.named("iiwa14")
    rng = np.random.default_rng(4)
    for touch in touches(robot, "iiwa_link_7", 20, rng):
        tau = push_torque(robot, touch.q, touch.link, touch.point, touch.force)
        stds = []
        for threshold in (0.003, 0.03):
            isolator = cs.ContactIsolator(robot, torque_threshold=threshold, samples=samples)
            (contact,) = isolator.isolate(touch.q, tau).contacts
            if np.isfinite(contact.point_std):
                stds.append(contact.point_std)
                # A point moves by at least the noise over the force, a lever of a millimetre at the least.
                assert contact.point_std > threshold / 3 / np.linalg.norm(touch.force) / 20
        if len(stds) == 2:
            assert stds[1] > grows * stds[0]


def test_located_is_a_distance_in_metres() -> None:
    robot = cs.Robot.named("atlas")
    touch = next(touches(robot, "pelvis", 1, np.random.default_rng(8)))
    tau = push_torque(robot, touch.q, "pelvis", touch.point, 40.0 * touch.force / np.linalg.norm(touch.force))
    options = {"torque_threshold": 1.0}
    (contact,) = cs.ContactIsolator(robot, **options).isolate(touch.q, tau).contacts
    limit = contact.region_radius
    for factor, located in ((0.9, False), (1.1, True)):
        isolator = cs.ContactIsolator(robot, locate_within=factor * limit, **options)
        assert isolator.isolate(touch.q, tau).contacts[0].located == located
    for bad in (0.0, -1.0, np.nan, np.inf, "near"):
        with pytest.raises(cs.InputError, match="locate_within"):
            cs.ContactIsolator(robot, locate_within=bad)


def test_nothing_verifies_a_contact_without_redundant_torques() -> None:
    """Six joints, six unknowns of a wrench: a force with a moment may look like a force elsewhere."""
    robot = cs.Robot.named("iiwa14")
    isolator = cs.ContactIsolator(robot)
    rng = np.random.default_rng(5)
    for link, verified in (("iiwa_link_6", False), ("iiwa_link_7", True)):
        found = [
            isolator.isolate(t.q, push_torque(robot, t.q, link, t.point, t.force)).contacts[0]
            for t in touches(robot, link, 30, rng)
        ]
        located = [contact for contact in found if contact.located and contact.link == link]
        assert len(located) > 5
        assert all(contact.verified == verified for contact in located)


def test_contacts_that_are_left_out_are_said() -> None:
    robot = cs.Robot.named("atlas")
    q = random_configuration(robot, np.random.default_rng(4))
    tau = np.zeros(robot.nv)
    for link in ("l_hand", "r_hand", "l_foot", "r_foot"):
        point = robot.link_pose(q, link)[:3, 3] + [0.05, 0.03, 0.02]
        tau += push_torque(robot, q, link, point, np.array([10.0, -20.0, 15.0]))
    assert cs.ContactIsolator(robot, max_contacts=2).isolate(q, tau).truncated
    push = push_torque(robot, q, "l_hand", robot.link_pose(q, "l_hand")[:3, 3], np.array([10.0, -20.0, 15.0]))
    assert not cs.ContactIsolator(robot, max_contacts=2).isolate(q, push).truncated


@pytest.mark.parametrize("name", ["iiwa14", "panda"])
def test_noisy_pushes_on_an_arm_are_located_by_the_posterior_and_rarely_wrong(name: str) -> None:
    """Pushes of 10 to 60 N anywhere on the surface, 0.1 Nm on each joint, thresholds of 0.3 Nm."""
    robot = robot_named(name)
    rng = np.random.default_rng(6)
    areas = map_reference.area_shares(robot)
    isolators = {
        samples: cs.ContactIsolator(robot, torque_threshold=0.3, samples=samples) for samples in (0, 1000)
    }
    located, wrong, right = (
        dict.fromkeys(isolators, 0),
        dict.fromkeys(isolators, 0),
        dict.fromkeys(isolators, 0),
    )
    for _ in range(400):
        truth = map_reference.draw(robot, rng, areas, forces=(10.0, 60.0), friction=0.3, pull_probability=0.0)
        measured = truth.torque + 0.1 * rng.standard_normal(robot.nv)
        for samples, isolator in isolators.items():
            contacts = isolator.isolate(truth.q, measured).contacts
            if not contacts:
                continue
            contact = contacts[0]
            right[samples] += contact.link == truth.link
            if contact.located:
                located[samples] += 1
                error = np.linalg.norm(contact.point - truth.point)
                wrong[samples] += error > 0.01 + 3.0 * contact.point_std
    assert located[1000] > max(2 * located[0], 50)
    assert wrong[1000] <= 0.03 * located[1000]
    assert right[1000] > right[0] + 20
