"""The study of a sampler beside a filter and a map, on one short run of it."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

from robots import IIWA14

from contactsense_studies.harness import save_pictures
from contactsense_studies.memory.data import as_data
from contactsense_studies.memory.methods import METHODS
from contactsense_studies.memory.options import Options
from contactsense_studies.memory.plots import PICTURES
from contactsense_studies.memory.report import print_study
from contactsense_studies.memory.study import Study, run

LINKS = ("iiwa_link_4", "iiwa_link_6")


@pytest.fixture(scope="module")
def study() -> Study:
    return run(Options(links=LINKS, trials=1, particles=2000, seed=5), processes=1)


def test_what_remembers_finds_the_point_whatever_the_noise(study: Study) -> None:
    for link in LINKS:
        for noise in study.options.noises():
            (found,) = study.found("sampler", noise, link)
            assert found.outcome.right
            assert found.outcome.error < 0.01
            assert found.near


@pytest.mark.shared
def test_a_contact_that_jumps_over_a_hollow_of_a_mesh_is_found_too() -> None:
    # With contacts followed by descent, and sides told by one face, three of these were on wrong places.
    robot = str(IIWA14.require().path)
    study = run(Options(robot=robot, links=("iiwa_link_3", "iiwa_link_6"), trials=4, seed=11))
    for link in study.links:
        for noise in study.options.noises():
            for found in study.found("sampler", noise, link):
                assert found.outcome.right, (link, noise, found)
                assert found.outcome.error < 0.02, (link, noise, found)


def test_one_pose_tells_less(study: Study) -> None:
    errors = {
        method.name: max(study.found(method.name, 0.0, link)[0].outcome.error for link in LINKS)
        for method in METHODS
    }
    assert errors["sampler"] < 0.3 * errors["map"]


def test_the_study_shows_what_it_found(study: Study, tmp_path: Path) -> None:
    shown = io.StringIO()
    print_study(study, Console(file=shown, width=100))
    assert all(method.name in shown.getvalue() for method in METHODS)
    data = as_data(study)
    assert data["complete"]
    assert len(data["scores"]) == len(LINKS) * len(METHODS) * 3 == len(data["trials"])
    (picture,) = save_pictures(PICTURES, study, tmp_path)
    assert picture.stat().st_size > 10_000


def test_an_imperfect_arm_is_calibrated_before(tmp_path: Path) -> None:
    study = run(
        Options(imperfect=True, links=("iiwa_link_5", "iiwa_link_7"), trials=2, particles=3000, seed=5)
    )
    errors = [found.outcome.error for link in study.links for found in study.found("sampler", 0.0, link)]
    assert len(errors) == 4
    assert sorted(errors)[1] < 0.02
    assert len(as_data(study)["scores"]) == 2 * len(METHODS)
    (picture,) = save_pictures(PICTURES, study, tmp_path)
    assert picture.stat().st_size > 10_000
