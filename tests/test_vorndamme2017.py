"""The study of Vorndamme 2017, short: scenes, judging, and what the isolator makes of them."""

from __future__ import annotations

import json
from collections import Counter
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import contactsense as cs
from contactsense.cli.app import run as command
from contactsense.sim.atlas import SENSOR_LINKS
from contactsense.sim.sampling import Touch, blocked
from contactsense_studies.vorndamme2017.hits import ideal_series, scaled
from contactsense_studies.vorndamme2017.information import rank_deficit
from contactsense_studies.vorndamme2017.instruments import external_torque, external_wrenches
from contactsense_studies.vorndamme2017.isolation import Setting, Task, make_sensors, run_tasks
from contactsense_studies.vorndamme2017.judge import Answer, Verdict, assign, judge, judge_answers
from contactsense_studies.vorndamme2017.noise import Noise
from contactsense_studies.vorndamme2017.noisy_settings import stated_settings
from contactsense_studies.vorndamme2017.physics import simulate
from contactsense_studies.vorndamme2017.scenes import Scene, fives, pairs, singles, standing_pose
from contactsense_studies.vorndamme2017.score import by_deficit, score
from contactsense_studies.vorndamme2017.time_series import GAIN, filtered_half_sine, half_sine

EXACT = 1e-9  # [m]


@pytest.fixture(scope="module")
def robot() -> cs.Robot:
    return cs.Robot.named("atlas")


def verdicts(scenes: list[Scene], setting: Setting, seed: int = 0) -> list[Verdict]:
    (found,), _ = run_tasks([Task(setting, scenes, 0, seed)], processes=1)
    return found


def depths(robot: cs.Robot, scene: Scene) -> list[float]:
    """Cosine of each push against the outward normal: -1 is straight in."""
    found = []
    for touch in scene.touches:
        pose = robot.link_pose(scene.q, touch.link)
        closest = robot.surface(touch.link).closest_points((touch.point - pose[:3, 3]) @ pose[:3, :3])
        assert closest.distances[0] < 1e-12
        found.append(float(pose[:3, :3] @ closest.normals[0] @ touch.force / np.linalg.norm(touch.force)))
    return found


@pytest.mark.parametrize("random_poses", [False, True])
def test_scenes_push_where_a_straight_line_can(robot: cs.Robot, random_poses: bool) -> None:
    for draw, contacts in ((singles, 1), (pairs, 2), (fives, 5)):
        scenes = draw(robot, 60, 411, random_poses=random_poses)
        assert len(scenes) == 60
        for scene in scenes:
            assert len({touch.link for touch in scene.touches}) == contacts
            # On a rounded link, the facet's normal and the closest point's are not quite the same.
            assert max(depths(robot, scene)) < -np.cos(np.radians(36.0))
            for touch in scene.touches:
                assert 1.0 <= np.linalg.norm(touch.force) <= 50.0
                along = touch.force / np.linalg.norm(touch.force)
                assert not blocked(robot, scene.q, touch.link, touch.point[None], along[None])[0]


def test_every_pair_of_links_occurs(robot: cs.Robot) -> None:
    met = Counter(tuple(sorted(scene.links)) for scene in pairs(robot, 1000, 412))
    assert set(met) == {tuple(sorted(pair)) for pair in combinations(robot.link_names, 2)}
    assert max(met.values()) - min(met.values()) <= 1


def test_touches_are_uniform_over_the_free_surface(robot: cs.Robot) -> None:
    links = Counter(scene.links[0] for scene in singles(robot, 3000, 413))
    # Of the upper torso's area about half is free, of a shin's nearly all.
    expected = robot.surface("l_lleg").area / (robot.surface("l_lleg").area + robot.surface("r_lleg").area)
    shins = links["l_lleg"] + links["r_lleg"]
    assert abs(links["l_lleg"] / shins - expected) < 4 * np.sqrt(0.25 / shins)
    assert links["utorso"] > 800


def test_the_same_seed_gives_the_same_scenes(robot: cs.Robot) -> None:
    first, again, other = (pairs(robot, 30, seed, by="area") for seed in (1, 1, 2))
    assert all(
        np.array_equal(a.touches[1].point, b.touches[1].point) for a, b in zip(first, again, strict=True)
    )
    assert not np.array_equal(first[0].touches[0].point, other[0].touches[0].point)


def test_scenes_refuse(robot: cs.Robot) -> None:
    with pytest.raises(cs.InputError, match="count"):
        singles(robot, 0)
    with pytest.raises(cs.InputError, match="by"):
        pairs(robot, 1, by="weight")  # type: ignore[arg-type]
    with pytest.raises(cs.InputError, match="Atlas"):
        fives(cs.Robot.named("iiwa14"), 1)


def test_rank_deficits_are_the_papers(robot: cs.Robot) -> None:
    q = standing_pose(robot)
    # "only 10 nonzero columns" for pelvis and lower leg, 12 with the foot (VI-C).
    assert rank_deficit(robot, q, ["pelvis", "l_lleg"]) == 2
    assert rank_deficit(robot, q, ["pelvis", "l_foot"]) == 0
    assert rank_deficit(robot, q, ["l_hand", "l_lfarm"]) == 5
    assert rank_deficit(robot, q, ["l_hand", "r_hand", "l_foot", "r_foot", "utorso"]) == 0
    assert rank_deficit(robot, q, ["l_hand", "l_lfarm"], "both") == 0
    assert rank_deficit(robot, q, ["l_hand"], "sensors") == 0
    assert rank_deficit(robot, q, ["pelvis"], "sensors") == 6
    assert rank_deficit(robot, q, ["l_larm", "l_scap"], "sensors") == 6
    assert rank_deficit(robot, q, ["pelvis", "l_lleg"], "distal") == 2
    assert rank_deficit(robot, q, ["pelvis", "l_lleg"], "both") == 0


def test_wrenches_and_torques_of_a_scene_agree(robot: cs.Robot) -> None:
    """Behind a hand's sensor there is the hand alone: its wrench makes all of the torque."""
    for scene in singles(robot, 400, 414):
        if scene.links == ("l_hand",):
            wrench = external_wrenches(robot, scene)[SENSOR_LINKS.index("l_hand")]
            tau = robot.jacobian(scene.q, "l_hand").T @ wrench
            np.testing.assert_allclose(tau, external_torque(robot, scene), atol=1e-12)
            assert np.count_nonzero(external_wrenches(robot, scene).any(axis=1)) == 3  # and l_clav, utorso


def test_estimates_are_assigned_one_to_one() -> None:
    assert assign(np.array([[0.0, 1.0], [0.1, 5.0]])) == [1, 0]
    assert assign(np.array([[0.3], [0.1]])) == [None, 0]
    assert assign(np.array([[np.inf, 2.0]])) == [1]
    assert assign(np.empty((2, 0))) == [None, None]


def test_judging_knows_open_and_false_contacts(robot: cs.Robot) -> None:
    (scene,) = pairs(robot, 1, 415)
    one, two = scene.touches
    nowhere = np.full(3, np.nan)
    far = two.point + np.array([0.0, 0.0, 0.05])

    def answers(*second: np.ndarray, located: bool) -> list[Answer]:
        estimate = second[0] if second else nowhere
        return [
            Answer(one.link, one.point, one.force, True, [one.point]),
            Answer(two.link, estimate, two.force, located, list(second)),
        ]

    right = judge_answers(scene, answers(two.point, located=True), 0)
    assert right.error == 0.0
    assert right.all_located
    assert not right.wrong
    assert right.links_right
    false = judge_answers(scene, answers(far, located=True), 0)
    assert false.wrong
    assert false.error == pytest.approx(0.05)
    guess = judge_answers(scene, answers(far, two.point, located=False), 0)
    assert not guess.wrong
    assert guess.among_candidates
    assert not guess.all_located
    assert judge_answers(scene, answers(located=False), 0).error == np.inf
    assert score([guess]).missed == 1.0
    assert judge(robot, scene, cs.ContactIsolator(robot).isolate(scene.q, np.zeros(36))).error == np.inf


def test_any_number_of_processes_gives_the_same_answer(robot: cs.Robot) -> None:
    tasks = [
        Task(Setting(noise=Noise(0.01)), pairs(robot, 120, 416), 0, 3),
        Task(Setting(), singles(robot, 30, 416), 0, 3),
    ]
    one, two = (run_tasks(tasks, processes) for processes in (1, 2))
    # NaN is not equal to itself.
    assert repr(one) == repr(two)


def test_the_filter_answers_as_its_dynamics_say() -> None:
    fine = np.linspace(0.0, 0.04, 40_001)
    r, step = np.zeros_like(fine), fine[1]
    force = half_sine(fine)
    for k in range(len(fine) - 1):
        middle = 0.5 * (force[k] + force[k + 1])
        r[k + 1] = middle + (r[k] - middle) * np.exp(-GAIN * step)
    np.testing.assert_allclose(filtered_half_sine(fine), r, atol=1e-7)


def test_simulated_readings_are_weight_inertia_and_the_hit(robot: cs.Robot) -> None:
    """Pinocchio's joint wrenches against the library's compensation, with the true acceleration."""
    (scene,) = (scene for scene in singles(robot, 40, 423)[:1])
    record = simulate(scaled(scene, 50.0), lambda time: float(half_sine(np.array(time))), speed=0.5)
    compensator = cs.LoadCompensator(robot, make_sensors("both"))
    for row in range(0, len(record.time), 7):
        told = compensator.update(record.q[row], record.v[row], record.a[row], record.readings[row])
        hit = Touch(scene.links[0], record.q[row], record.point[row], record.force[row])
        np.testing.assert_allclose(told, external_wrenches(robot, Scene(record.q[row], [hit])), atol=1e-9)


def test_the_acceleration_errs_as_equation_10_says(robot: cs.Robot) -> None:
    """The error that the ideal hits assume, against observer and simulation."""
    (scene,) = singles(robot, 1, 424)
    record = simulate(scaled(scene, 50.0), lambda time: float(half_sine(np.array(time))))
    observer = cs.MomentumObserver(robot, dt=0.001, gain=GAIN)
    true = half_sine(record.time)
    seen = filtered_half_sine(np.clip(record.time, 0.0, None))
    for row, (q, v, tau) in enumerate(zip(record.q, record.v, record.tau, strict=True)):
        observer.update(q, v, tau)
        pulse = (
            robot.jacobian(q, scene.links[0], record.point[row])[:3].T @ scaled(scene, 50.0).touches[0].force
        )
        reach = np.linalg.solve(robot.mass_matrix(q), pulse)
        expected = (true[row] - seen[row]) * reach
        np.testing.assert_allclose(
            record.a[row] - observer.acceleration, expected, atol=0.02 * np.abs(reach).max()
        )


def test_single_contacts_are_located_from_torques(robot: cs.Robot) -> None:
    found = score(verdicts(singles(robot, 500, 417), Setting()))
    assert found.exact == found.links_right == 1.0
    assert found.located > 0.8  # the lines of the others enter the surface twice
    assert found.claim_error < EXACT
    assert found.force_error < 1e-9


def test_pairs_of_full_rank_are_exact_and_others_near(robot: cs.Robot) -> None:
    groups = by_deficit(verdicts(pairs(robot, 930, 418), Setting()))
    assert set(groups) == {0, 1, 2, 3, 4, 5}
    determined = score(groups[0])
    assert determined.exact == 1.0
    assert determined.wrong == 0.0
    rest = score([verdict for deficit, group in groups.items() if deficit for verdict in group])
    # 80 % within 25 cm, at four standard deviations.
    assert rest.fair > 0.8 - 4 * np.sqrt(0.16 / rest.scenes)


def test_five_contacts_are_exact(robot: cs.Robot) -> None:
    found = score(verdicts(fives(robot, 300, 419), Setting()))
    assert found.exact == 1.0
    assert found.wrong == 0.0


def test_noise_of_a_hundredth_leaves_the_links_right(robot: cs.Robot) -> None:
    scenes = singles(robot, 400, 420)
    noise = Noise(0.01)
    for setting in (Setting(noise=noise), stated_settings(robot, scenes, "torques", noise)[0]):
        found = score(verdicts(scenes, setting, seed=5))
        assert found.links_right > 0.95
        assert found.near > 0.85


def test_a_hit_over_time_is_seen_within_three_milliseconds(robot: cs.Robot) -> None:
    for scene in singles(robot, 5, 421):
        for amplitude in (1.0, 50.0):
            hit = ideal_series(robot, scaled(scene, amplitude), ["torques"])
            assert 0.001 <= hit.peak_delay("torques") <= 0.003
            assert 0.001 < hit.delay("torques") < 0.003
            assert hit.right_share("torques") == 1.0


def test_the_command_prints_and_draws(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--singles", "40", "--pairs", "60", "--fives", "10", "--hits", "5", "--seed", "422"]
    assert command(["study", "vorndamme2017", *options, "--json", "--png", str(tmp_path)]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["options"]["pairs"] == 60
    ideal = next(run for run in data["runs"] if run["scenes"] == "singles" and run["method"] == "torques")
    assert ideal["all"]["exact"] == 1.0
    assert len(list(tmp_path.glob("*.png"))) == 5
    assert command(["study", "vorndamme2017", *options]) == 0
    assert "Five contacts" in capsys.readouterr().out


@pytest.mark.parametrize("options", [["--singles", "0"], ["--noise", "2"], ["--cone", "120"]])
def test_the_command_refuses(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["study", "vorndamme2017", *options]) == 2
    assert "contactsense:" in capsys.readouterr().err
