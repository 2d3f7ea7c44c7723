"""Classes of contacts, and reactions: what features say, and what is refused."""

from __future__ import annotations

import json
import pickle

import numpy as np
import pytest

import contactsense as cs

IIWA = cs.Robot.named("iiwa14")
Q, STILL = np.array([0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.1]), np.zeros(7)
WEIGHT = IIWA.inverse_dynamics(Q, STILL, STILL)
PUSH = IIWA.jacobian(Q, "iiwa_link_6")[:3].T @ np.array([30.0, 0.0, 0.0])


def classes(shares: np.ndarray, velocity: np.ndarray | None = None, **options: object) -> list:
    """What is said of a push of `shares` of `PUSH` at 1 kHz; `velocity` is what the classifier is told."""
    monitor = cs.ContactMonitor(IIWA, dt=1e-3, torque_threshold=1.0)
    classifier = cs.ContactClassifier(IIWA, dt=1e-3, **options)
    v = STILL if velocity is None else velocity
    said = []
    for share in shares:
        report = monitor.update(Q, STILL, WEIGHT - share * PUSH)
        said.append(classifier.update(Q, v, report))
    return said


def ramp(rise: float, hold: float, before: float = 0.1, after: float = 0.3) -> np.ndarray:
    """From 0 to 1 in `rise`, and after `hold` back as fast [s]."""
    time = np.arange(0.0, before + 2.0 * rise + hold + after, 1e-3) - before
    return np.clip(np.minimum(time / rise, (2.0 * rise + hold - time) / rise), 0.0, 1.0)


def test_a_contact_is_said_to_run_and_then_once_to_have_ended() -> None:
    said = classes(ramp(0.2, 0.3))
    assert said[0] == ()
    counts = {len(each) for each in said}
    assert counts == {0, 1}
    ended = [each[0] for each in said if each and not each[0].running]
    assert len(ended) == 1
    assert 0.4 < ended[0].duration < 0.8
    assert ended[0].id == 0
    for each in (contact for row in said for contact in row):
        assert abs(each.clamped + each.transient + each.sustained - 1.0) < 1e-12
        assert 0.0 < each.intended < 1.0


def test_a_slow_push_on_an_arm_at_rest_is_intended_and_sustained() -> None:
    last = [row for row in classes(ramp(0.3, 0.8)) if row][-1][0]
    assert last.intended > 0.8
    assert last.sustained > 0.5
    assert last.features["approach_speed"] == 0.0
    assert last.features["rise_time"] > 0.1


def test_a_hit_against_the_motion_is_accidental() -> None:
    # The torque works against a motion along `-PUSH`.
    velocity = -0.3 * PUSH / np.linalg.norm(PUSH)
    short = [row for row in classes(ramp(0.005, 0.02), velocity) if row][-1][0]
    assert short.intended < 0.2
    assert short.transient > 0.8
    assert short.features["approach_speed"] > 0.05
    lasting = [row for row in classes(ramp(0.005, 0.9, after=0.0), velocity) if row][-1][0]
    assert lasting.intended < 0.3
    assert lasting.clamped > lasting.transient


def test_contributions_and_constants_are_the_logits() -> None:
    contact = [row for row in classes(ramp(0.05, 0.3)) if row][-1][0]
    assert set(contact.contributions) == {"clamped", "transient", "sustained", "intended"}
    other = [row for row in classes(ramp(0.05, 0.3), prior=[0.2, 0.2, 0.6], intended_prior=0.5) if row][-1][0]
    assert contact.contributions == other.contributions
    assert contact.features == other.features
    # Another prior shifts the logits by as much as its odds differ.
    odds = np.log(other.intended / (1.0 - other.intended)) - np.log(
        contact.intended / (1.0 - contact.intended)
    )
    np.testing.assert_allclose(odds, -np.log(0.26 / 0.74), atol=1e-9)
    assert other.sustained > contact.sustained


def test_several_contacts_are_told_apart_by_their_own_torques() -> None:
    # A second contact on another branch of Atlas does not change what is said of the first.
    atlas = cs.Robot.named("atlas")
    q, still = atlas.neutral(), np.zeros(atlas.nv)
    weight = atlas.inverse_dynamics(q, still, still)
    links = ("l_hand", "r_hand") if "l_hand" in atlas.link_names else tuple(atlas.link_names[-2:])
    torques = [atlas.jacobian(q, link)[:3].T @ np.array([-40.0, 0.0, 0.0]) for link in links]
    monitor = cs.ContactMonitor(atlas, dt=1e-3, torque_threshold=0.5)
    classifier = cs.ContactClassifier(atlas, dt=1e-3)
    said = []
    for tick in range(500):
        external = min(1.0, tick / 100) * torques[0] + (
            min(1.0, (tick - 250) / 100) * torques[1] if tick > 250 else 0.0
        )
        report = monitor.update(q, still, (weight - external)[6:])
        said.append(classifier.update(q, still, report))
    assert 1 <= len(said[-1]) <= 4
    assert all(np.isfinite(each.intended) for each in said[-1])


def test_results_can_be_pickled_and_are_plain_values() -> None:
    contact = [row for row in classes(ramp(0.05, 0.3)) if row][-1][0]
    copy = pickle.loads(pickle.dumps(contact))
    assert copy.to_dict() == contact.to_dict()
    assert json.loads(json.dumps(contact.to_dict()))["running"] is False
    assert repr(contact).startswith("ContactClass(clamped=0.")


def test_what_makes_no_sense_is_refused_by_name() -> None:
    for options, name in (
        ({"prior": [0.5, 0.5]}, "prior"),
        ({"prior": [0.5, 0.6, 0.2]}, "prior"),
        ({"prior": [np.nan, 0.5, 0.5]}, "prior"),
        ({"intended_prior": 1.5}, "intended_prior"),
        ({"dt": 0.0}, "dt"),
    ):
        with pytest.raises(cs.InputError, match=name):
            cs.ContactClassifier(IIWA, **{"dt": 1e-3, **options})
    classifier = cs.ContactClassifier(IIWA, dt=1e-3)
    report = cs.ContactMonitor(IIWA, dt=1e-3).update(Q, STILL, WEIGHT)
    with pytest.raises(cs.InputError, match="v:"):
        classifier.update(Q, np.full(7, np.nan), report)
    other = cs.Robot.named("atlas")
    of_other, q, v = cs.ContactClassifier(other, dt=1e-3), other.neutral(), np.zeros(other.nv)
    with pytest.raises(cs.InputError, match="report"):
        of_other.update(q, v, report)


def test_reactions_stay_within_their_limits() -> None:
    reaction = cs.Reaction(
        IIWA,
        dt=1e-3,
        velocity_limit=0.3,
        acceleration_limit=2.0,
        torque_limit=50.0,
        distance=0.05,
        duration=0.5,
    )
    last = np.clip(0.2 * PUSH, -0.3, 0.3)
    way = np.zeros(7)
    for _ in range(1000):
        command = reaction.retract(0.2 * PUSH, PUSH, admittance=5.0)
        assert (np.abs(command) <= 0.3 + 1e-12).all()
        assert (np.abs(command - last) <= 2e-3 + 1e-12).all()
        last = command
    np.testing.assert_array_equal(last, 0.0)
    reaction.reset()
    for _ in range(1000):
        command = reaction.retract(STILL, PUSH)
        way += 1e-3 * command
        assert command @ PUSH >= 0.0
    assert 0.0 < np.abs(way).max() <= 0.05 + 1e-9
    torque = reaction.gravity_compensation(Q, STILL)
    np.testing.assert_allclose(torque, np.clip(WEIGHT, -50.0, 50.0), atol=1e-9)
    with pytest.raises(cs.InputError, match="collision_torque"):
        reaction.retract(STILL, np.full(7, np.inf))
    with pytest.raises(cs.InputError, match="acceleration_limit"):
        cs.Reaction(IIWA, dt=1e-3, acceleration_limit=0.0)
