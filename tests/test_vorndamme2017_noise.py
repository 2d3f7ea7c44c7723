"""The study of Vorndamme 2017 on noisy measurements, short."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs
from contactsense_studies.vorndamme2017.instruments import METHODS, external_torque, observed
from contactsense_studies.vorndamme2017.isolation import Task, run_tasks
from contactsense_studies.vorndamme2017.judge import Answer, judge_answers
from contactsense_studies.vorndamme2017.noise import NONE, Noise, noise_cases
from contactsense_studies.vorndamme2017.noisy_score import NoisyScore, noisy_score
from contactsense_studies.vorndamme2017.noisy_settings import stated_settings
from contactsense_studies.vorndamme2017.scenes import Scene, pairs, singles


@pytest.fixture(scope="module")
def robot() -> cs.Robot:
    return cs.Robot.named("atlas")


def scores(scenes: list[Scene], method: str, noise: Noise) -> list[NoisyScore]:
    """Of the determined scenes, for both ways to state the noise."""
    (known,) = [each for each in METHODS if each == method]
    robot = cs.Robot.named("atlas")
    tasks = [Task(setting, scenes, 0, 7) for setting in stated_settings(robot, scenes, known, noise)]
    found, _ = run_tasks(tasks, processes=1)
    return [noisy_score([each for each in verdicts if each.rank_deficit == 0]) for verdicts in found]


def test_noise_has_the_stated_deviation(robot: cs.Robot) -> None:
    (scene,) = pairs(robot, 1, 601)
    noise = Noise(0.1, 0.5, 2.0, 0.2)
    ideal_tau, ideal_wrenches = observed(robot, scene, "both")
    assert ideal_wrenches is not None
    np.testing.assert_array_equal(ideal_tau, external_torque(robot, scene))
    rows = [observed(robot, scene, "both", noise, [seed]) for seed in range(1000)]
    tau_std = np.std([tau for tau, _ in rows], axis=0)
    wrench_std = np.std([wrenches for _, wrenches in rows if wrenches is not None], axis=0)
    np.testing.assert_allclose(tau_std, np.hypot(0.1 * ideal_tau, 0.5), rtol=0.12)
    floor = np.array([2.0] * 3 + [0.2] * 3)
    np.testing.assert_allclose(wrench_std, np.hypot(0.1 * ideal_wrenches, floor), rtol=0.12)
    np.testing.assert_array_equal(observed(robot, scene, "torques", NONE, [3])[0], ideal_tau)


def test_thresholds_are_three_deviations_of_the_noise(robot: cs.Robot) -> None:
    scenes = singles(robot, 50, 602)
    absolute = noise_cases(0.01)[2]
    thresholds, model = stated_settings(robot, scenes, "both", absolute)
    assert thresholds.torque_threshold == pytest.approx((0.3,) * robot.nv)
    assert thresholds.wrench_threshold == pytest.approx(np.tile([1.5] * 3 + [0.15] * 3, (9, 1)))
    assert model.torque_threshold is None
    relative, _ = stated_settings(robot, scenes, "torques", noise_cases(0.01)[0])
    torques = np.array([external_torque(robot, scene) for scene in scenes])
    usual = np.sqrt((torques[:, 2] ** 2).mean())
    assert isinstance(relative.torque_threshold, tuple)
    assert relative.torque_threshold[2] == pytest.approx(3 * np.hypot(0.01 * usual, 0.01))


def test_claims_are_judged_by_what_they_state(robot: cs.Robot) -> None:
    (scene,) = pairs(robot, 1, 603)
    one, _ = scene.touches

    def answer(point_std: float) -> Answer:
        off = one.point + np.array([0.0, 0.0, 0.02])
        return Answer(one.link, off, 1.1 * one.force, True, [off], point_std)

    found = noisy_score([judge_answers(scene, [answer(std)], 0) for std in (0.001, 0.004)])
    assert (found.scenes, found.contacts, found.claims) == (2, 4, 2)
    assert (found.counted, found.links_right, found.located) == (0.0, 0.0, 0.5)
    assert found.wrong == 0.5
    assert found.point_error == pytest.approx(0.02)
    assert found.force_error == pytest.approx(0.1)
    assert np.isnan(noisy_score([judge_answers(scene, [], 0)]).wrong)


@pytest.mark.parametrize(("method", "located"), [("torques", 0.6), ("both", 0.6)])
def test_located_single_contacts_are_right_in_noise(robot: cs.Robot, method: str, located: float) -> None:
    for found in scores(singles(robot, 300, 604), method, noise_cases(0.01)[0]):
        assert found.links_right > 0.94
        assert found.located > located
        assert found.wrong <= 0.01


@pytest.mark.parametrize(("method", "located"), [("torques", 0.35), ("both", 0.6)])
def test_located_pairs_are_right_in_noise(robot: cs.Robot, method: str, located: float) -> None:
    for found in scores(pairs(robot, 465, 605), method, noise_cases(0.01)[0]):
        # 85 % of many; at four standard deviations.
        assert found.links_right > 0.85 - 4 * np.sqrt(0.85 * 0.15 / found.scenes)
        assert found.located > located
        assert found.wrong <= 0.01


@pytest.mark.parametrize("case", [1, 2])
def test_more_noise_locates_less_and_not_more_wrongly(robot: cs.Robot, case: int) -> None:
    scenes = pairs(robot, 300, 606)
    little, much = (scores(scenes, "torques", noise_cases(0.01)[each])[0] for each in (0, case))
    assert 0.0 < much.located < little.located
    assert much.wrong <= 0.02
