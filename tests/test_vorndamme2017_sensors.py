"""The study of Vorndamme 2017 with force/torque sensors, short."""

from __future__ import annotations

import numpy as np
import pytest

import contactsense as cs
from contactsense.sim.atlas import SENSOR_LINKS
from contactsense_studies.vorndamme2017.hits import ideal_series, scaled, simulated_series
from contactsense_studies.vorndamme2017.instruments import carries
from contactsense_studies.vorndamme2017.isolation import Setting, Task, run_tasks
from contactsense_studies.vorndamme2017.judge import Verdict
from contactsense_studies.vorndamme2017.noise import Noise
from contactsense_studies.vorndamme2017.noisy_settings import stated_settings
from contactsense_studies.vorndamme2017.scenes import Scene, fives, pairs, singles
from contactsense_studies.vorndamme2017.score import score
from contactsense_studies.vorndamme2017.time_series import Series

EXACT = 1e-9  # [m]


@pytest.fixture(scope="module")
def robot() -> cs.Robot:
    return cs.Robot.named("atlas")


def verdicts(scenes: list[Scene], setting: Setting, seed: int = 0) -> list[Verdict]:
    (found,), _ = run_tasks([Task(setting, scenes, 0, seed)], processes=1)
    return found


def hits_behind_sensors(robot: cs.Robot, count: int, seed: int) -> list[Scene]:
    def felt(scene: Scene) -> bool:
        return any(carries(robot, sensor, scene.links[0]) for sensor in SENSOR_LINKS)

    return [scene for scene in singles(robot, 2 * count, seed) if felt(scene)][:count]


def test_single_contacts_are_located_with_sensors(robot: cs.Robot) -> None:
    found = score(verdicts(singles(robot, 400, 517), Setting("both")))
    assert found.exact == found.links_right == 1.0
    assert found.located > 0.8  # the lines of the others enter the surface twice
    assert found.claim_error < EXACT


def test_sensors_alone_locate_what_is_behind_them(robot: cs.Robot) -> None:
    judged = verdicts(singles(robot, 400, 518), Setting("sensors"))
    seen = score([verdict for verdict in judged if verdict.rank_deficit == 0])
    unseen = [verdict for verdict in judged if verdict.rank_deficit > 0]
    assert seen.exact == 1.0
    assert seen.located > 0.8
    assert {verdict.links[0] for verdict in unseen} <= {"pelvis", "ltorso", "mtorso"}
    assert unseen
    assert all(verdict.named == () for verdict in unseen)


def test_sensors_add_pairs_that_torques_leave_open(robot: cs.Robot) -> None:
    scenes = pairs(robot, 465, 519)
    torques, both = (verdicts(scenes, Setting(method)) for method in ("torques", "both"))
    determined = [verdict for verdict in both if verdict.rank_deficit == 0]
    assert score(determined).exact == 1.0
    assert score(both).wrong == 0.0
    assert score(both).exact > score(torques).exact


def test_five_contacts_are_exact_with_sensors(robot: cs.Robot) -> None:
    found = score(verdicts(fives(robot, 200, 520), Setting("both")))
    assert found.exact == 1.0
    assert found.wrong == 0.0


def test_noise_leaves_the_links_right(robot: cs.Robot) -> None:
    scenes = singles(robot, 400, 521)
    noise = Noise(0.01)
    for setting in (Setting("both", noise), stated_settings(robot, scenes, "both", noise)[0]):
        assert score(verdicts(scenes, setting, seed=5)).links_right > 0.95


def test_sensors_see_a_hit_without_delay(robot: cs.Robot) -> None:
    for scene in hits_behind_sensors(robot, 10, 522):
        hit = ideal_series(robot, scaled(scene, 1.0), ["sensors", "both"], late=False)
        for method in ("sensors", "both"):
            assert hit.peak_delay(method) == pytest.approx(0.0, abs=1e-12)
            assert hit.delay(method) == 0.0
            assert hit.right_share(method) == 1.0


def test_the_monitor_follows_a_hit_on_a_robot_in_motion(robot: cs.Robot) -> None:
    series: list[Series] = [
        simulated_series(robot, scaled(scene, 50.0), ["torques", "both"])
        for scene in hits_behind_sensors(robot, 5, 523)
    ]
    assert np.mean([hit.right_share("torques") for hit in series]) > 0.9
    for hit in series:
        assert hit.signals["torques"].right(0.01)[hit.time > 0.0].any()
        assert not np.isfinite(hit.signals["torques"].point_error[hit.time <= 0.0]).any()
