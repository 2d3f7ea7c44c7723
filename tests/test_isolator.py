"""Isolation of single contacts: exact where determined, silent on the point where not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import contactsense as cs
from contactsense.sim.sampling import random_configuration, touches


def torque(robot: cs.Robot, q: np.ndarray, link: str, point: np.ndarray, force: np.ndarray) -> np.ndarray:
    return robot.jacobian(q, link, point)[:3].T @ force


def test_no_point_is_invented() -> None:
    robot = cs.Robot.named("iiwa14")
    rng = np.random.default_rng(0)
    isolator = cs.ContactIsolator(robot)
    for touch in touches(robot, "iiwa_link_3", 20, rng):
        isolation = isolator.isolate(touch.q, torque(robot, touch.q, touch.link, touch.point, touch.force))
        (contact,) = isolation.contacts
        assert contact.link == "iiwa_link_3"
        assert not contact.located
        assert np.isnan([*contact.point, *contact.point_local, *contact.force, *contact.normal]).all()
        assert contact.candidates == ()
        assert isolation.rank_deficit == 3
        assert isolation.link_candidates[0] == "iiwa_link_3"


def test_all_vectors_of_a_located_contact_agree() -> None:
    robot = cs.Robot.named("atlas")
    isolator = cs.ContactIsolator(robot)
    located = 0
    for touch in touches(robot, "l_lfarm", 20, np.random.default_rng(1)):
        isolation = isolator.isolate(touch.q, torque(robot, touch.q, touch.link, touch.point, touch.force))
        (contact,) = isolation.contacts
        pose = robot.link_pose(touch.q, contact.link)
        np.testing.assert_allclose(
            pose[:3, :3] @ contact.point_local + pose[:3, 3], contact.point, atol=1e-12
        )
        moment = np.cross(contact.point - pose[:3, 3], contact.force)
        np.testing.assert_allclose(contact.wrench, [*contact.force, *moment], atol=1e-9)
        assert contact.normal @ contact.force < 0.0
        assert contact.source == "joint torques"
        # The threshold of 1 mNm stands for a noise of a third of it, which the force turns into a distance.
        scale = 1e-3 / 3 / np.linalg.norm(contact.force)
        assert 0.1 * scale < contact.point_std
        assert contact.located == (contact.point_std < 5 * scale)
        located += contact.located
        assert contact.verified
        assert isolation.residual < 1e-9
        assert isolation.rank_deficit == 0
        assert [c.pushing for c in contact.candidates] == sorted(
            (c.pushing for c in contact.candidates), reverse=True
        )
        assert contact.candidates[0].link == contact.link
        np.testing.assert_array_equal(contact.candidates[0].point, contact.point)
        closest = robot.surface(contact.link).closest_points(contact.point_local)
        assert closest.distances[0] < 1e-9
    assert located > 10  # the line of the others enters the surface twice


def test_pulling_leaves_the_point_open() -> None:
    robot = cs.Robot.named("atlas")
    touch = next(touches(robot, "r_hand", 1, np.random.default_rng(2)))
    tau = torque(robot, touch.q, touch.link, touch.point, touch.force)
    (contact,) = cs.ContactIsolator(robot, pushing=False).isolate(touch.q, tau).contacts
    assert not contact.located
    assert any(np.allclose(candidate.point, touch.point) for candidate in contact.candidates)


def test_an_external_moment_is_not_taken_for_a_point() -> None:
    robot = cs.Robot.named("atlas")
    isolator = cs.ContactIsolator(robot)
    rng = np.random.default_rng(3)
    for touch in touches(robot, "l_hand", 20, rng):
        jacobian = robot.jacobian(touch.q, touch.link, touch.point)
        tau = jacobian.T @ np.concatenate([touch.force, rng.uniform(0.3, 1.0) * touch.force])
        assert not any(contact.located for contact in isolator.isolate(touch.q, tau).contacts)


@pytest.mark.parametrize("name", ["iiwa14", "atlas"])
def test_torques_that_contradict_one_force_locate_nothing_elsewhere(name: str) -> None:
    """A twist beside the push, or a second push on the same branch, ten and more thresholds strong."""
    robot = cs.Robot.named(name)
    isolator = cs.ContactIsolator(robot)
    rng = np.random.default_rng(21)
    first, second = ("iiwa_link_7", "iiwa_link_5") if name == "iiwa14" else ("l_hand", "l_scap")
    other = list(touches(robot, second, 100, rng))
    far = 0
    for touch, beside in zip(touches(robot, first, 100, rng), other, strict=True):
        push = torque(robot, touch.q, first, touch.point, touch.force)
        twist = robot.jacobian(touch.q, first, touch.point)[3:].T @ (0.03 * touch.force)
        pose = robot.link_pose(touch.q, second)
        local = robot.link_pose(beside.q, second)
        turn = pose[:3, :3] @ local[:3, :3].T
        point = turn @ (beside.point - local[:3, 3]) + pose[:3, 3]
        both = push + torque(robot, touch.q, second, point, turn @ beside.force)
        for tau, true in ((push + twist, [touch.point]), (both, [touch.point, point])):
            for contact in isolator.isolate(touch.q, tau).contacts:
                off = np.linalg.norm(contact.point - true, axis=1).min()
                far += contact.located and off > 0.01 and off > 3 * contact.point_std
    assert far <= 2  # of 200


def test_two_branches_are_both_named() -> None:
    robot = cs.Robot.named("atlas")
    q = random_configuration(robot, np.random.default_rng(4))
    tau = np.zeros(robot.nv)
    for link in ("l_hand", "r_foot"):
        point = robot.link_pose(q, link)[:3, 3] + [0.05, 0.03, 0.02]
        tau += torque(robot, q, link, point, np.array([10.0, -20.0, 15.0]))
    isolation = cs.ContactIsolator(robot).isolate(q, tau)
    assert {contact.link for contact in isolation.contacts} == {"l_hand", "r_foot"}
    assert len(cs.ContactIsolator(robot, max_contacts=1).isolate(q, tau).contacts) == 1


def test_silence_is_no_contact() -> None:
    robot = cs.Robot.named("iiwa14")
    isolation = cs.ContactIsolator(robot).isolate(robot.neutral(), np.full(7, 9e-4))
    assert isolation.contacts == ()
    assert isolation.link_candidates == ()
    assert isolation.residual == pytest.approx(9e-4 * np.sqrt(7))


def test_error_bars_hold_under_noise() -> None:
    """Points of noisy torques: most within two standard deviations, none far outside."""
    robot = cs.Robot.named("iiwa14")
    rng = np.random.default_rng(5)
    noise = 0.02
    isolator = cs.ContactIsolator(robot, torque_threshold=3 * noise)
    ratios, wrong_links, located = [], 0, 0
    for touch in touches(robot, "iiwa_link_7", 400, rng):
        tau = torque(robot, touch.q, touch.link, touch.point, touch.force) + noise * rng.standard_normal(7)
        for contact in isolator.isolate(touch.q, tau).contacts:
            if contact.located:
                located += 1
                wrong_links += contact.link != touch.link
                ratios.append(np.linalg.norm(contact.point - touch.point) / contact.point_std)
    assert located > 150
    assert wrong_links < 0.1 * located
    assert np.mean(np.array(ratios) < 2.0) > 0.85
    assert np.mean(np.array(ratios) < 5.0) > 0.95


@settings(max_examples=200, deadline=None)
@given(
    tau=arrays(float, 36, elements=st.floats(-1e6, 1e6)),
    step=arrays(float, 36, elements=st.floats(-10.0, 10.0)),
)
def test_any_finite_torque_has_an_answer(tau: np.ndarray, step: np.ndarray) -> None:
    q = ATLAS.integrate(ATLAS.neutral(), step)
    isolation = ISOLATOR.isolate(q, tau)
    for contact in isolation.contacts:
        assert contact.link in ATLAS.link_names
        assert np.isfinite(contact.point).all() or not contact.located
    assert np.isfinite(isolation.residual)


ATLAS = cs.Robot.named("atlas")
ISOLATOR = cs.ContactIsolator(ATLAS)


@settings(max_examples=200, deadline=None)
@given(values=st.lists(st.floats(allow_nan=True, allow_infinity=True), max_size=40))
def test_bad_torques_are_refused(values: list[float]) -> None:
    if len(values) == ATLAS.nv and np.isfinite(values).all():
        return
    with pytest.raises(cs.InputError, match="tau_ext"):
        ISOLATOR.isolate(ATLAS.neutral(), values)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"torque_threshold": 0.0}, "torque_threshold"),
        ({"torque_threshold": [0.1, 0.2]}, "torque_threshold"),
        ({"torque_threshold": np.nan}, "torque_threshold"),
        ({"max_contacts": 0}, "max_contacts"),
        ({"max_contacts": -1}, "max_contacts"),
        ({"max_contacts": 2.5}, "max_contacts"),
    ],
)
def test_bad_settings_are_named(options: dict[str, object], name: str) -> None:
    with pytest.raises(cs.InputError, match=name):
        cs.ContactIsolator(ATLAS, **options)


def test_a_quaternion_must_be_unit() -> None:
    q = ATLAS.neutral()
    q[3:7] *= 1.5
    with pytest.raises(cs.InputError, match="quaternion"):
        ISOLATOR.isolate(q, np.zeros(ATLAS.nv))
