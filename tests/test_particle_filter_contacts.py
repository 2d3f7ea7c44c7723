"""Several contacts at the same time, each with particles of its own."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from parts_of_runs import torque_of

import contactsense as cs
from contactsense.sim import TorqueNoise, atlas
from contactsense_studies.several_contacts.data import as_data
from contactsense_studies.several_contacts.judge import Judged, judge_several
from contactsense_studies.several_contacts.options import Options
from contactsense_studies.several_contacts.runs import record_several
from contactsense_studies.several_contacts.study import run

ARM_NOISE = {"newton_metres": 0.02, "percent": 3.0}


@pytest.fixture(scope="module")
def arm() -> cs.Robot:
    return cs.Robot.named("iiwa14")


def test_one_contact_is_what_a_filter_of_one_finds(arm: cs.Robot) -> None:
    touched = record_several(arm, ("iiwa_link_5",), 1, 20, seed=3)
    alone, of_three = (cs.ContactParticleFilter(arm, particles=3000, max_contacts=k) for k in (1, 3))
    noise = TorqueNoise(seed=3, **ARM_NOISE)
    for q, torque in zip(touched.q, touched.external_torque, strict=True):
        measured = noise.measure(torque)
        found, same = alone.update(q, measured), of_three.update(q, measured)
        assert len(same.contacts) == 1
        np.testing.assert_array_equal(found.point, same.point)
    np.testing.assert_array_equal(alone.particles.point, of_three.particles.point)


def test_contacts_come_and_go(arm: cs.Robot) -> None:
    """What is known of a contact mostly stays known when another one begins or ends."""
    links = tuple(f"iiwa_link_{k}" for k in (4, 5, 6, 7))
    during, after, numbers = [], [], []
    for seed in range(20, 32):
        touched = record_several(arm, links, 2, 60, seed=seed)
        alone = torque_of(arm, touched, 0)
        tracker = cs.ContactParticleFilter(arm, particles=5000, max_contacts=2, seed=seed)
        noise = TorqueNoise(seed=seed, **ARM_NOISE)
        found = []
        for k, q in enumerate(touched.q):
            torque = touched.external_torque[k] if 20 <= k < 40 else alone[k]
            estimate = tracker.update(q, noise.measure(torque))
            found.append(estimate.contacts)
            for each in estimate.contacts:
                away = np.linalg.norm(touched.points[k] - each.point, axis=1).min()
                assert each.ambiguous or away < 0.05, (seed, k)
        error = [min(np.linalg.norm(c.point - touched.points[k, 0]) for c in f) for k, f in enumerate(found)]
        numbers.append([len(found[k]) for k in (19, 39, 59)])
        if error[19] < 0.01:
            during.append(error[39])
            after.append(error[59])
        # Let go.
        assert not tracker.update(touched.q[-1], np.zeros(7)).contacts
        # As at the start, whichever contact ended first.
        tracker.reset()
        for k in range(3):
            again = tracker.update(touched.q[k], alone[k])
        fresh = cs.ContactParticleFilter(arm, **tracker.options)
        for k in range(3):
            anew = fresh.update(touched.q[k], alone[k])
        np.testing.assert_array_equal(again.point, anew.point)
    assert np.median(numbers, axis=0).tolist() == [1, 2, 1]
    assert len(during) >= 8
    assert np.mean(np.array(during) < 0.01) >= 0.6
    assert np.mean(np.array(after) < 0.01) >= 0.8


def test_particles_and_copies(arm: cs.Robot) -> None:
    touched = record_several(arm, ("iiwa_link_4", "iiwa_link_7"), 2, 20, seed=7)
    tracker = cs.ContactParticleFilter(arm, particles=2000, max_contacts=2)
    assert tracker.options["max_contacts"] == 2
    for k, (q, torque) in enumerate(zip(touched.q, touched.external_torque, strict=True)):
        estimate = tracker.update(q, torque, time=float(k))
    assert len(estimate.contacts) == 2
    assert estimate.contacts[0] is estimate
    assert {each.time for each in estimate.contacts} == {19.0}
    copy = pickle.loads(pickle.dumps(estimate))
    assert [each.link for each in copy.contacts] == [each.link for each in estimate.contacts]
    particles = tracker.particles
    assert particles.contact.tolist() == [0] * 2000 + [1] * 2000
    assert particles.weight[2000:].sum() == pytest.approx(1.0)
    again = cs.ContactParticleFilter(arm, **tracker.options)
    for q, torque in zip(touched.q, touched.external_torque, strict=True):
        again.update(q, torque)
    np.testing.assert_array_equal(again.particles.point, particles.point)
    tracker.reset()
    for q, torque in zip(touched.q, touched.external_torque, strict=True):
        tracker.update(q, torque)
    np.testing.assert_array_equal(tracker.particles.point, particles.point)


def judged(robot: cs.Robot, links: tuple[str, ...], seed: int) -> Judged:
    touched = record_several(robot, links, 2, 40, q=atlas.posture(robot.model, seed), friction=0.3, seed=seed)
    tracker = cs.ContactParticleFilter(
        robot,
        particles=5000,
        max_contacts=3,
        links=links,
        measurement="friction_cone",
        friction=0.3,
        torque_noise=0.1,
        relative_noise=0.01,
        seed=seed,
    )
    noise = TorqueNoise(newton_metres=0.1, percent=1.0, seed=seed)
    for q, torque in zip(touched.q, touched.external_torque, strict=True):
        estimate = tracker.update(q, noise.measure(torque))
    return judge_several(estimate, touched, -1)


def test_two_contacts_on_a_humanoid() -> None:
    """On different limbs, with friction and noise."""
    robot = cs.Robot.named("atlas")
    links = ("l_larm", "l_hand", "r_larm", "r_hand", "utorso")
    trials = [judged(robot, links, seed) for seed in range(20, 30)]
    assert sum(trial.links_right for trial in trials) >= 8
    errors = [error for trial in trials for error in trial.errors]
    assert sum(error < 0.03 for error in errors) >= 16
    assert sum(trial.located for trial in trials) >= 8
    assert sum(trial.wrong for trial in trials) == 0


def test_bad_numbers_of_contacts_are_refused(arm: cs.Robot) -> None:
    for number in (0, 5, 1.5):
        with pytest.raises(cs.InputError, match="max_contacts"):
            cs.ContactParticleFilter(arm, max_contacts=number)
    with pytest.raises(cs.InputError, match="max_contacts: must be 1 where the likelihood is not Gaussian"):
        cs.ContactParticleFilter(arm, max_contacts=2, likelihood="exponential")


def test_bad_input_changes_nothing(arm: cs.Robot) -> None:
    touched = record_several(arm, ("iiwa_link_4", "iiwa_link_7"), 2, 12, seed=7)
    tracker, other = (cs.ContactParticleFilter(arm, particles=1000, max_contacts=2) for _ in range(2))
    for q, torque in zip(touched.q, touched.external_torque, strict=True):
        with pytest.raises(cs.InputError, match="tau_ext"):
            other.update(q, np.full(7, np.nan))
        np.testing.assert_array_equal(tracker.update(q, torque).point, other.update(q, torque).point)


def test_the_study_of_a_filter() -> None:
    options = Options(method="filter", links=("iiwa_link_4", "iiwa_link_7"), trials=2, particles=1000)
    study = run(options, processes=1)
    (score,) = (score for score in as_data(study)["scores"] if score["contacts"] == 1)
    assert score["trials"] == 2
    assert score["links_right"] == 1.0
    assert np.isnan(score["probability"])
    with pytest.raises(cs.InputError, match="method must be one of sampler, filter"):
        Options(method="map")
