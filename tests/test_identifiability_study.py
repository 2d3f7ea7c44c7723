"""The study of identifiability, short: its scores, tables, JSON and picture, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the command needs MuJoCo: pip install contactsense[sim]")

import contactsense as cs
from contactsense.cli.app import run as command
from contactsense_studies.harness import save_pictures
from contactsense_studies.identifiability.data import as_data
from contactsense_studies.identifiability.options import Options
from contactsense_studies.identifiability.plots import PICTURES
from contactsense_studies.identifiability.score import ALL, NEAR, links
from contactsense_studies.identifiability.study import Study, run

SHORT = Options(robots=("iiwa14",), poses=3, samples=300)
ARGUMENTS = ["study", "identifiability", "--robot", "iiwa14", "--samples", "200", "--processes", "1"]


@pytest.fixture(scope="module")
def short() -> Study:
    return run(SHORT, processes=1)


def test_it_asks_the_map_at_random_poses(short: Study) -> None:
    noise = cs.NoiseModel(torque=0.1, model=0.0, relative=0.03)
    contact_map = cs.ContactMap(cs.Robot.named("iiwa14"), samples=300, noise=noise)
    assert len(short.poses) == 3
    for pose in short.poses:
        told = contact_map.identifiability(pose.q, force=10.0)
        np.testing.assert_array_equal(pose.told.point_std, told.point_std)
    assert not np.array_equal(short.poses[0].q, short.poses[1].q)


def test_scores_are_those_of_all_samples_of_a_link(short: Study) -> None:
    scores = {score.link: score for score in links(short.of("iiwa14"))}
    own = np.array(short.poses[0].told.links) == "iiwa_link_6"
    deviations = np.concatenate([pose.told.point_std[own] for pose in short.poses])
    score = scores["iiwa_link_6"]
    assert (score.samples, score.rank) == (own.sum(), 5)
    assert score.point_std == np.median(deviations)
    assert score.point_std_90 == pytest.approx(np.percentile(deviations, 90.0))
    assert score.near == np.mean(deviations <= NEAR)
    assert scores["iiwa_link_1"].rank == 1
    assert scores["iiwa_link_1"].point_std > 3.0 * scores["iiwa_link_7"].point_std
    assert scores["iiwa_link_1"].detectable < scores["iiwa_link_7"].detectable
    assert scores[ALL].samples == len(own)


def test_results_do_not_depend_on_the_number_of_processes(short: Study) -> None:
    assert as_data(run(SHORT, processes=2)) == as_data(short)


def test_it_prints_tables(capsys: pytest.CaptureFixture[str]) -> None:
    assert command([*ARGUMENTS, "--poses", "2", "--force", "25"]) == 0
    told = capsys.readouterr().out
    assert "iiwa14, 2 poses" in told
    assert "iiwa_link_7" in told
    assert "Contacts of 25 N" in told


def test_it_prints_json_of_one_given_pose(capsys: pytest.CaptureFixture[str]) -> None:
    assert command([*ARGUMENTS, "--q", "0.1,0.5,0,-1.2,0,0.9,0", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["complete"]
    assert told["robots"]["iiwa14"]["poses"] == 1
    assert [entry["link"] for entry in told["robots"]["iiwa14"]["links"]][-2:] == ["iiwa_link_7", ALL]


def test_a_robot_may_be_a_urdf_file(tmp_path: Path) -> None:
    file = tmp_path / "lever.urdf"
    file.write_text(
        "<robot name='lever'><link name='base'/><link name='rod'><inertial><mass value='1'/>"
        "<inertia ixx='0.1' ixy='0' ixz='0' iyy='0.1' iyz='0' izz='0.1'/></inertial><collision>"
        "<geometry><box size='1 0.1 0.1'/></geometry></collision></link><joint name='hinge' type='revolute'>"
        "<parent link='base'/><child link='rod'/><axis xyz='0 0 1'/>"
        "<limit lower='-1' upper='1' effort='9' velocity='1'/></joint></robot>"
    )
    study = run(Options(robots=(str(file),), poses=1, samples=100), processes=1)
    (score, _) = links(study.poses)
    assert (score.link, score.rank) == ("rod", 1)


def test_an_interrupt_leaves_what_there_is(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(stage: str, done: int, total: int) -> None:
        assert (stage, total) == ("poses", 3)
        if done == 2:
            raise KeyboardInterrupt

    study = run(SHORT, processes=1, progress=interrupt)
    assert not study.complete
    assert len(study.poses) == 1
    assert as_data(study)["robots"]["iiwa14"]["poses"] == 1


def test_its_picture_shows_deviations_in_colours(short: Study, tmp_path: Path) -> None:
    image = pytest.importorskip("matplotlib.image")
    (path,) = save_pictures(PICTURES, short, tmp_path)
    pixels = image.imread(path)[..., :3]
    colourful = pixels.max(axis=2) - pixels.min(axis=2) > 0.2
    assert 0.03 < colourful.mean() < 0.5


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--poses", "0"], "poses: "),
        (["--samples", "0"], "samples: "),
        (["--seed", "-1"], "seed: "),
        (["--force", "0"], "force: "),
        (["--friction", "-1"], "friction: "),
        (["--torque-noise", "0"], "torque_noise: "),
        (["--relative-noise", "-1"], "relative_noise: "),
        (["--q", "1,2"], "q: "),
        (["--q", "1,two"], "q: must be numbers"),
        (["--q", "0,0,0,0,0,0,0", "--robot", "atlas"], "q: is for one robot"),
        (["--robot", "nowhere.urdf"], ""),
    ],
)
def test_it_refuses(options: list[str], named: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command([*ARGUMENTS, *options]) == 2
    assert capsys.readouterr().err.lstrip().startswith(f"contactsense: {named}")


def test_defaults_are_an_arm_and_a_humanoid(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []

    def trials(function: Any, items: list[Any], *_: object) -> tuple[list[Any], bool]:
        seen.extend(items)
        return [], False

    monkeypatch.setattr("contactsense_studies.identifiability.study.run_trials", trials)
    assert run(Options(poses=2, samples=50)).robots == ()
    assert [item[1:] for item in seen] == [("iiwa14", 0), ("iiwa14", 1), ("atlas", 0), ("atlas", 1)]
