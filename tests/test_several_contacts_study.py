"""Several contacts at the same time, with noise, on an arm and on a humanoid."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from parts_of_runs import torque_of

import contactsense as cs
from contactsense.sim import TorqueNoise, atlas
from contactsense_studies.several_contacts.judge import judge_several
from contactsense_studies.several_contacts.runs import SeveralRun, record_several


def followed(
    robot: cs.Robot, run: SeveralRun, noise: TorqueNoise, **options: object
) -> cs.StaticObstacleSampler:
    sampler = cs.StaticObstacleSampler(robot, **options)
    for q, torque in zip(run.q, run.external_torque, strict=True):
        sampler.update(q, noise.measure(torque))
    return sampler


@pytest.fixture(scope="module")
def arm() -> cs.Robot:
    return cs.Robot.named("iiwa14")


@pytest.mark.parametrize("seed", [11, 12])
def test_two_contacts_on_an_arm(arm: cs.Robot, seed: int) -> None:
    links = tuple(f"iiwa_link_{k}" for k in (4, 5, 6, 7))
    run = record_several(arm, links, 2, 30, seed=seed)
    noise = TorqueNoise(newton_metres=0.02, percent=3.0, seed=seed)
    sampler = followed(arm, run, noise, particles=3000, max_contacts=2)
    estimate = sampler.estimate
    assert sampler.number_probabilities.shape == (2,)
    assert sampler.number_probabilities[1] > 0.9
    judged = judge_several(estimate, run, -1)
    assert judged.links_right
    assert max(judged.errors) < 0.03, judged
    # As plain values, and copied.
    assert estimate.contacts[0] is estimate
    assert [each["link"] for each in estimate.to_dict()["contacts"]] == [
        each.link for each in estimate.contacts
    ]
    copy = pickle.loads(pickle.dumps(estimate))
    assert [each.link for each in copy.contacts] == [each.link for each in estimate.contacts]
    particles = sampler.particles
    assert particles.contact.tolist() == [0] * 3000 + [1] * 3000
    assert particles.weight.sum() == pytest.approx(2.0)


def test_one_contact_is_not_taken_for_two(arm: cs.Robot) -> None:
    run = record_several(arm, ("iiwa_link_5",), 1, 20, seed=3)
    noise = TorqueNoise(newton_metres=0.02, percent=3.0, seed=3)
    sampler = followed(arm, run, noise, particles=4000, max_contacts=2)
    assert sampler.number_probabilities[0] > 0.9
    assert len(sampler.estimate.contacts) == 1
    assert judge_several(sampler.estimate, run, -1).links_right
    # Let go.
    assert not sampler.update(run.q[-1], np.zeros(7)).contacts
    assert not sampler.number_probabilities.any()


def test_two_contacts_on_a_humanoid() -> None:
    robot = cs.Robot.named("atlas")
    links = ("l_larm", "l_hand", "r_larm", "r_hand", "utorso")
    run = record_several(robot, links, 2, 15, q=atlas.posture(robot.model, 5), friction=0.3, seed=5)
    noise = TorqueNoise(newton_metres=0.1, percent=1.0, seed=5)
    sampler = followed(
        robot,
        run,
        noise,
        particles=3000,
        max_contacts=2,
        links=links,
        measurement="friction_cone",
        friction=0.3,
        torque_noise=0.1,
        relative_noise=0.01,
    )
    judged = judge_several(sampler.estimate, run, -1)
    assert judged.links_right
    assert max(judged.errors) < 0.03, judged
    assert judged.wrong == 0


def test_contacts_come_and_go(arm: cs.Robot) -> None:
    run = record_several(arm, ("iiwa_link_4", "iiwa_link_7"), 2, 24, seed=7)
    alone = torque_of(arm, run, 1)
    sampler = cs.StaticObstacleSampler(arm, particles=4000, max_contacts=2)
    noise = TorqueNoise(newton_metres=0.02, percent=3.0, seed=7)
    numbers, events = [], []
    for k in range(len(run.q)):
        torque = alone[k] if k < 10 else run.external_torque[k]
        estimate = sampler.update(run.q[k], noise.measure(torque))
        numbers.append(len(estimate.contacts))
        events.append(estimate.event)
    assert numbers[9] == 1
    assert numbers[-1] == 2
    assert events[10] == "changed"
    assert judge_several(estimate, run, -1).links_right


def test_bad_numbers_of_contacts_are_refused(arm: cs.Robot) -> None:
    for number in (0, 5, 1.5):
        with pytest.raises(cs.InputError, match="max_contacts"):
            cs.StaticObstacleSampler(arm, max_contacts=number)
    with pytest.raises(cs.InputError, match=r"models: must be 'obstacle' alone"):
        cs.StaticObstacleSampler(arm, max_contacts=2, models=("obstacle", "person"))
