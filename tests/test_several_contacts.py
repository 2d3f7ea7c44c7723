"""Several contacts at once, from torques, from sensors, and from both."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from ranks import rank_deficit
from robots import parameters, robot_named

import contactsense as cs
from contactsense.sim.sampling import Touch, random_configuration, touches_in_pose

CONE = np.deg2rad(40.0)
LINKS = ("l_hand", "r_hand", "l_foot", "r_foot", "l_clav", "r_clav", "l_uglut", "r_uglut", "utorso")


def push(robot: cs.Robot, q: np.ndarray, link: str, rng: np.random.Generator) -> Touch | None:
    return next(iter(touches_in_pose(robot, q, link, 1, rng, CONE)), None)


def torque(robot: cs.Robot, pushes: list[Touch]) -> np.ndarray:
    return sum(robot.jacobian(push.q, push.link, push.point)[:3].T @ push.force for push in pushes)


def is_behind(robot: cs.Robot, link: str, other: str) -> bool:
    """Whether all that moves `other` moves `link`, too."""
    q = robot.neutral()
    joints, others = (robot.jacobian(q, name).any(axis=0) for name in (link, other))
    return bool(np.all(joints[others]))


def sensed(robot: cs.Robot, pushes: list[Touch], links: tuple[str, ...] = LINKS) -> np.ndarray:
    """External wrenches of sensors at the links."""
    wrenches = np.zeros((len(links), 6))
    for row, link in zip(wrenches, links, strict=True):
        for push in pushes:
            if is_behind(robot, push.link, link):
                arm = push.point - robot.link_pose(push.q, link)[:3, 3]
                row += [*push.force, *np.cross(arm, push.force)]
    return wrenches


def assert_found(isolation: cs.Isolation, pushes: list[Touch]) -> None:
    assert {contact.link for contact in isolation.contacts} == {push.link for push in pushes}
    for contact in isolation.contacts:
        (push,) = (push for push in pushes if push.link == contact.link)
        np.testing.assert_allclose(contact.point, push.point, atol=1e-9)
        np.testing.assert_allclose(contact.force, push.force, atol=1e-7 * np.linalg.norm(push.force))


def assert_consistent(robot: cs.Robot, q: np.ndarray, isolation: cs.Isolation) -> None:
    for contact in isolation.contacts:
        if not contact.located:
            continue
        pose = robot.link_pose(q, contact.link)
        np.testing.assert_allclose(pose[:3, :3] @ contact.point_local + pose[:3, 3], contact.point, atol=1e-9)
        size = np.linalg.norm(contact.force)
        moment = np.cross(contact.point - pose[:3, 3], contact.force)
        np.testing.assert_allclose(contact.wrench, [*contact.force, *moment], atol=1e-9 * (1.0 + size))
        assert contact.normal @ contact.force < 0.0
        assert np.isfinite(contact.point_std)


def scenes(robot: cs.Robot, groups: list[tuple[str, ...]], seed: int) -> list[tuple[np.ndarray, list[Touch]]]:
    """A scene for each group of links, each in a pose of its own."""
    rng = np.random.default_rng(seed)
    found = []
    for group in groups:
        for _ in range(20):
            q = random_configuration(robot, rng)
            pushes = [push(robot, q, link, rng) for link in group]
            if all(pushes):
                found.append((q, [one for one in pushes if one is not None]))
                break
    return found


@pytest.mark.parametrize("name", parameters(["atlas", "atlas_v5", "talos", "g1"]))
def test_two_contacts_are_found_where_six_joints_lie_between_them(name: str) -> None:
    robot = robot_named(name)
    q = robot.neutral()
    joints = {link: robot.jacobian(q, link).any(axis=0) for link in robot.link_names}
    pairs = [
        pair for pair in combinations(robot.link_names, 2) if np.sum(joints[pair[0]] != joints[pair[1]]) >= 6
    ]
    rng = np.random.default_rng(1)
    chosen = [pairs[i] for i in rng.choice(len(pairs), 60, replace=False)]
    found = scenes(robot, chosen, seed=2)
    assert len(found) > 40
    isolator = cs.ContactIsolator(robot)
    for q, pushes in found:
        isolation = isolator.isolate(q, torque(robot, pushes))
        assert_found(isolation, pushes)
        assert isolation.rank_deficit == rank_deficit(robot, q, [push.link for push in pushes])
        assert isolation.residual < 1e-7
        assert_consistent(robot, q, isolation)


def test_three_contacts_that_share_joints_are_found_together() -> None:
    robot = cs.Robot.named("atlas")
    isolator = cs.ContactIsolator(robot)
    # Four joints to each, twelve in all: no force follows from its own joints.
    groups = [("l_larm", "r_larm", "l_lleg"), ("l_lleg", "r_lleg", "r_larm"), ("pelvis", "l_hand", "r_foot")]
    found = scenes(robot, groups * 4, seed=3)
    assert len(found) == 12
    located = 0
    for q, pushes in found:
        isolation = isolator.isolate(q, torque(robot, pushes))
        assert_found(isolation, pushes)
        located += sum(contact.located for contact in isolation.contacts)
        assert not any(c.located and c.point_std > 0.01 for c in isolation.contacts)
    # Eighteen unknowns from few more torques: noise of the stated size moves many points by centimetres.
    assert located > 10


def test_the_last_joint_under_its_threshold_decides_nothing() -> None:
    """Forces on the hands that their own joint does not feel, beside others."""
    robot = cs.Robot.named("atlas")
    isolator = cs.ContactIsolator(robot)
    found = 0
    for q, pushes in scenes(robot, [("l_hand", "r_foot"), ("l_hand", "l_clav", "r_hand")] * 20, seed=4):
        own = np.flatnonzero(robot.jacobian(q, "l_hand").any(axis=0))[-1]
        hand = next(push for push in pushes if push.link == "l_hand")
        share = abs(torque(robot, [hand])[own])
        # As weak as the last joint's threshold asks, twice over.
        weak = Touch(hand.link, hand.q, hand.point, hand.force * (5e-4 / share))
        if np.linalg.norm(weak.force) < 0.01:
            continue
        both = [weak if push.link == "l_hand" else push for push in pushes]
        isolation = isolator.isolate(q, torque(robot, both))
        assert {contact.link for contact in isolation.contacts} == {push.link for push in both}
        for contact in isolation.contacts:
            (true,) = (push for push in both if push.link == contact.link)
            assert np.linalg.norm(contact.point - true.point) < 1e-6
        found += 1
    assert found > 10


def test_candidates_of_two_contacts_belong_together() -> None:
    """Each solution of a deficit of two explains the torques."""
    robot = cs.Robot.named("atlas")
    isolator = cs.ContactIsolator(robot)
    several = 0
    for q, pushes in scenes(robot, [("pelvis", "l_lleg"), ("utorso", "r_larm")] * 15, seed=5):
        tau = torque(robot, pushes)
        isolation = isolator.isolate(q, tau)
        assert isolation.rank_deficit == 2
        first, second = isolation.contacts
        if len(first.candidates) == 1 or len(second.candidates) != len(first.candidates):
            continue
        several += 1
        for one, other in zip(first.candidates, second.candidates, strict=True):
            jacobians = [robot.jacobian(q, c.link, c.point)[:3] for c in (one, other)]
            stacked = np.vstack(jacobians).T
            left = tau - stacked @ np.linalg.lstsq(stacked, tau, rcond=None)[0]
            assert np.linalg.norm(left) < 1e-6 * np.linalg.norm(tau)
        assert not (first.located and second.located)
    assert several > 3


def test_a_moment_beside_a_push_locates_nothing_wrong() -> None:
    robot = cs.Robot.named("atlas")
    isolator = cs.ContactIsolator(robot)
    rng = np.random.default_rng(6)
    located = 0
    for q, (hand, foot) in scenes(robot, [("l_hand", "r_foot")] * 30, seed=7):
        twist = robot.jacobian(q, "l_hand")[3:].T @ rng.uniform(-2.0, 2.0, 3)
        contacts = {c.link: c for c in isolator.isolate(q, torque(robot, [hand, foot]) + twist).contacts}
        assert set(contacts) == {"l_hand", "r_foot"}
        assert not contacts["l_hand"].located
        located += contacts["r_foot"].located
        np.testing.assert_allclose(contacts["r_foot"].point, foot.point, atol=1e-9)
    assert located > 15


def test_sensors_find_a_contact_each_and_the_joints_the_rest() -> None:
    robot = cs.Robot.named("atlas")
    sensors = [cs.ForceTorqueSensor(link, link) for link in LINKS]
    isolator = cs.ContactIsolator(robot, sensors=sensors, max_contacts=10)
    groups = [("l_hand", "l_larm", "utorso", "r_foot", "r_lleg", "pelvis"), ("head", "mtorso", "l_talus")]
    found = scenes(robot, groups * 8, seed=8)
    assert len(found) >= 10
    for q, pushes in found:
        isolation = isolator.isolate(q, torque(robot, pushes), sensed(robot, pushes))
        assert_found(isolation, pushes)
        assert_consistent(robot, q, isolation)
        for contact in isolation.contacts:
            loaded = [link for link in LINKS if is_behind(robot, contact.link, link)]
            nearest = max(loaded, key=lambda link: robot.jacobian(q, link).any(axis=0).sum(), default=None)
            assert contact.source == (nearest or "joint torques")


def test_two_contacts_behind_one_sensor_follow_from_it_and_the_joints() -> None:
    robot = cs.Robot.named("atlas")
    sensors = [cs.ForceTorqueSensor("waist", "utorso")]
    isolator = cs.ContactIsolator(robot, sensors=sensors)
    for q, pushes in scenes(
        robot, [("utorso", "l_hand"), ("l_clav", "r_hand"), ("head", "l_hand")] * 4, seed=9
    ):
        isolation = isolator.isolate(q, torque(robot, pushes), sensed(robot, pushes, ("utorso",)))
        assert_found(isolation, pushes)
        assert {contact.source for contact in isolation.contacts} == {"waist"}


def test_a_sensor_without_reading_is_left_out_and_the_rest_goes_on() -> None:
    robot = cs.Robot.named("atlas")
    sensors = [cs.ForceTorqueSensor(link, link) for link in LINKS]
    isolator = cs.ContactIsolator(robot, sensors=sensors)
    for q, pushes in scenes(robot, [("l_hand", "r_foot", "pelvis")] * 5, seed=10):
        wrenches = sensed(robot, pushes)
        wrenches[LINKS.index("l_hand"), 3] = np.nan
        isolation = isolator.isolate(q, torque(robot, pushes), wrenches)
        assert_found(isolation, pushes)
        sources = {contact.link: contact.source for contact in isolation.contacts}
        assert sources == {"l_hand": "l_clav", "r_foot": "r_foot", "pelvis": "joint torques"}


def test_wanted_contacts_are_not_reported() -> None:
    robot = cs.Robot.named("atlas")
    sensors = [cs.ForceTorqueSensor(link, link) for link in LINKS]
    isolator = cs.ContactIsolator(robot, sensors=sensors, wanted_contacts=["l_foot", "r_foot"])
    for q, pushes in scenes(robot, [("l_foot", "r_foot", "r_lleg", "head")] * 5, seed=11):
        wrenches = sensed(robot, pushes)
        isolation = isolator.isolate(q, torque(robot, pushes), wrenches)
        assert_found(isolation, pushes[2:])
        # What the left leg carries is not known without its sensors.
        wrenches[[LINKS.index("l_foot"), LINKS.index("l_uglut")]] = np.nan
        isolation = isolator.isolate(q, torque(robot, pushes), wrenches)
        assert_found(isolation, pushes[2:])


def test_sensors_alone_find_what_is_behind_them() -> None:
    """Before an observer has felt anything, too."""
    robot = cs.Robot.named("atlas")
    sensors = [cs.ForceTorqueSensor(link, link) for link in LINKS]
    isolator = cs.ContactIsolator(robot, sensors=sensors)
    for q, pushes in scenes(robot, [("l_hand", "r_clav"), ("l_talus", "head")] * 5, seed=12):
        assert_found(isolator.isolate(q, np.zeros(robot.nv), sensed(robot, pushes)), pushes)


@settings(max_examples=60, deadline=None)
@given(
    tau=arrays(np.float64, 36, elements=st.floats(-1e6, 1e6)),
    wrenches=arrays(np.float64, (9, 6), elements=st.floats(-1e6, 1e6) | st.just(np.nan)),
    seed=st.integers(0, 1000),
)
def test_any_torques_and_wrenches_have_an_answer(tau: np.ndarray, wrenches: np.ndarray, seed: int) -> None:
    robot = cs.Robot.named("atlas")
    q = random_configuration(robot, np.random.default_rng(seed))
    sensors = [cs.ForceTorqueSensor(link, link) for link in LINKS]
    isolator = cs.ContactIsolator(robot, sensors=sensors)
    first = isolator.isolate(q, tau, wrenches)
    assert_consistent(robot, q, first)
    again = isolator.isolate(q, tau, wrenches)
    assert repr(first.contacts) == repr(again.contacts)
    assert len(first.contacts) <= 5
    assert_consistent(robot, q, cs.ContactIsolator(robot).isolate(q, tau))


def test_bad_input_is_refused_by_name() -> None:
    robot = cs.Robot.named("atlas")
    hand = cs.ForceTorqueSensor("hand", "l_hand")
    for sensors, message in (
        ([cs.ForceTorqueSensor("x", "nothing")], "nothing"),
        ([cs.ForceTorqueSensor("x", "pelvis")], "pelvis"),
        ([hand, cs.ForceTorqueSensor("hand", "r_hand")], "hand"),
    ):
        with pytest.raises(cs.InputError, match=message):
            cs.ContactIsolator(robot, sensors=sensors)
    with pytest.raises(cs.InputError, match="wanted_contacts"):
        cs.ContactIsolator(robot, sensors=[hand], wanted_contacts=["foot"])
    with pytest.raises(cs.InputError, match="wrench_threshold"):
        cs.ContactIsolator(robot, sensors=[hand], wrench_threshold=-1.0)
    isolator = cs.ContactIsolator(robot, sensors=[hand])
    q, tau = robot.neutral(), np.zeros(robot.nv)
    for wrenches in (None, np.zeros((0, 6)), np.zeros((2, 6)), np.zeros((1, 5)), np.full((1, 6), np.inf)):
        with pytest.raises(cs.InputError, match="wrenches"):
            isolator.isolate(q, tau, wrenches)
    with pytest.raises(cs.InputError, match="wrenches"):
        cs.ContactIsolator(robot).isolate(q, tau, np.zeros((1, 6)))
    assert isolator.isolate(q, tau, np.zeros((1, 6))).contacts == ()
