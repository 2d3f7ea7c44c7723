"""The study of Bimbo 2019, short: judging, trials, and what the filter makes of them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from robots import BY_NAME as ROBOTS

import contactsense as cs
from contactsense.cli.app import run as command
from contactsense.sim import ContactRun
from contactsense_studies.bimbo2019.arm import load_arm
from contactsense_studies.bimbo2019.experiments import BY_NAME, CURVATURE, EXPERIMENTS, MODELS, PRINTED
from contactsense_studies.bimbo2019.options import Options
from contactsense_studies.bimbo2019.score import judge, score
from contactsense_studies.bimbo2019.study import Study, run, trial_seed
from contactsense_studies.bimbo2019.tracking import track
from contactsense_studies.bimbo2019.trials import record

LINK = "iiwa_link_5"
OPTIONS = Options(particles=3000)


@pytest.fixture(scope="module")
def recorded() -> ContactRun:
    arm = load_arm(OPTIONS)
    return record(arm, BY_NAME["random"], LINK, 0, trial_seed(OPTIONS.seed, "random", LINK, 0))


@pytest.fixture(scope="module")
def short() -> Study:
    options = Options(trials=1, particles=1000, links=("iiwa_link_4", "iiwa_link_7"), experiments=("random",))
    return run(options, processes=2)


def beside(point: np.ndarray, distance: float) -> np.ndarray:
    return point + np.array([0.0, distance, 0.0])


def estimate(point: np.ndarray, spread: float, **others: Any) -> SimpleNamespace:
    given = {
        "contact": True,
        "link": LINK,
        "point": point,
        "force": np.array([0.0, 0.0, -8.0]),
        "covariance": spread**2 * np.eye(3),
        "ambiguous": False,
        "link_probabilities": {LINK: 0.75, "iiwa_link_4": 0.25},
        "modes": (SimpleNamespace(point=point), SimpleNamespace(point=np.array([0.0, 0.0, 0.99]))),
    }
    return SimpleNamespace(**given | others)


def test_judging_measures_from_the_true_point() -> None:
    true, force = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -10.0])
    near = judge(estimate(beside(true, 0.03), 0.01), LINK, true, force)
    assert near.error == pytest.approx(0.03)
    assert near.right
    assert near.force_error == pytest.approx(0.2)
    assert near.probability == 0.75
    assert near.mode_error == pytest.approx(0.01)
    assert near.spread == pytest.approx(0.01 * np.sqrt(3.0))
    # Three standard deviations are beyond the 90 % region, whose radius is 2.5 of them; two are not.
    assert not near.covered
    assert judge(estimate(beside(true, 0.02), 0.01), LINK, true, force).covered
    assert not judge(estimate(true, 0.01, link="iiwa_link_4"), LINK, true, force).right
    nothing = judge(estimate(true, 0.01, contact=False), LINK, true, force)
    assert nothing.error == np.inf
    assert not nothing.covered
    assert not nothing.right


def test_the_region_holds_nine_tenths_of_a_normal_vector() -> None:
    rng = np.random.default_rng(0)
    true, force = np.zeros(3), np.array([0.0, 0.0, -10.0])
    covered = [judge(estimate(0.1 * rng.normal(size=3), 0.1), LINK, true, force).covered for _ in range(4000)]
    assert np.mean(covered) == pytest.approx(0.9, abs=0.02)


def test_scores_are_of_all_trials() -> None:
    true, force = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -10.0])
    right = judge(estimate(beside(true, 0.01), 0.01), LINK, true, force)
    wrong = judge(estimate(beside(true, 0.2), 0.3, ambiguous=True, link="iiwa_link_4"), LINK, true, force)
    found = score([right, right, wrong])
    assert (found.trials, found.right_link) == (3, pytest.approx(2 / 3))
    assert (found.mean, found.median, found.worst) == pytest.approx((0.22 / 3, 0.01, 0.2))
    assert (found.ambiguous, found.flagged) == (pytest.approx(1 / 3), 1.0)
    assert np.isnan(score([right]).flagged)
    assert np.isnan(score([]).mean)


def test_every_trial_has_a_seed_of_its_own() -> None:
    seeds = {
        trial_seed(seed, experiment.name, link, number)
        for seed in range(3)
        for experiment in EXPERIMENTS
        for link in load_arm(OPTIONS).links
        for number in range(20)
    }
    assert len(seeds) == 3 * len(EXPERIMENTS) * 7 * 20


def test_links_are_those_that_move() -> None:
    assert load_arm(Options()).links == tuple(f"iiwa_link_{number}" for number in range(1, 8))
    panda = ROBOTS["panda"].require()
    other = load_arm(Options(str(panda.path), tuple(str(folder) for folder in panda.package_dirs)))
    assert "panda_link0" not in other.links
    assert "panda_hand" in other.links


def test_a_trial_keeps_its_contact_and_moves_it(recorded: ContactRun) -> None:
    robot = load_arm(OPTIONS).robot
    assert set(recorded.link) == {LINK}
    assert len(recorded) > 100
    places = []
    for q, point, force, torque in zip(
        recorded.q, recorded.point, recorded.force, recorded.true_external_torque, strict=True
    ):
        pose = robot.link_pose(q, LINK)
        places.append((point - pose[:3, 3]) @ pose[:3, :3])
        np.testing.assert_allclose(robot.jacobian(q, LINK, point)[:3].T @ force, torque, atol=1e-9)
    distances = robot.surface(LINK).closest_points(np.array(places)).distances
    assert distances.max() < 1e-9
    assert np.ptp(places, axis=0).max() > 0.002
    # The observer is late, and has no other error.
    error = recorded.external_torque - recorded.true_external_torque
    assert np.sqrt(np.mean(error**2)) < 0.05 * np.sqrt(np.mean(recorded.true_external_torque**2))


def test_the_curvature_model_finds_the_point(recorded: ContactRun) -> None:
    arm = load_arm(OPTIONS)
    outcomes = {kind.name: track(arm, recorded, kind, OPTIONS, 7) for kind in (*MODELS, PRINTED)}
    ours = outcomes[CURVATURE.name]
    assert ours.right
    assert ours.error < 0.015
    assert ours.covered
    assert len(ours.errors) == len(recorded)
    assert ours.errors[-1] == pytest.approx(ours.error, abs=1e-6)
    assert ours.error <= min(outcome.error for outcome in outcomes.values()) + 0.01
    noisy = track(arm, recorded, replace(CURVATURE, noise=10.0), OPTIONS, 7)
    assert noisy.right
    assert noisy.error < 0.02
    assert noisy.errors != ours.errors


def test_the_number_of_processes_changes_nothing(short: Study) -> None:
    assert [trial.link for trial in short.trials] == ["iiwa_link_4", "iiwa_link_7"]
    again = run(short.options, processes=1)
    assert repr(again.trials) == repr(short.trials)


def test_outcomes_are_found_by_filter_and_link(short: Study) -> None:
    experiment = BY_NAME["random"]
    assert len(short.outcomes(experiment, CURVATURE)) == 2
    (one,) = short.outcomes(experiment, PRINTED, "iiwa_link_7")
    assert one.link == "iiwa_link_7"
    assert short.outcomes(BY_NAME["cube"], CURVATURE) == []


def test_the_command_prints_and_draws(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--trials", "1", "--particles", "500", "--link", LINK, "--experiment", "random"]
    assert command(["study", "bimbo2019", *options, "--json", "--png", str(tmp_path)]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["options"]["particles"] == 500
    (experiment,) = data["experiments"]
    assert [kind["name"] for kind in experiment["filters"]][:4] == [kind.name for kind in (*MODELS, PRINTED)]
    ours = experiment["filters"][0]["links"][LINK]
    assert ours["trials"] == 1
    assert 0.0 <= ours["mean"] < 1.0
    pictures = {"confidence.png", "models.png", "noise.png", "obstacles.png", "progress.png"}
    assert {path.name for path in tmp_path.glob("*.png")} == pictures
    assert command(["study", "bimbo2019", *options]) == 0
    assert "Motion models, random" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--trials", "0"], "trials"),
        (["--particles", "0"], "particles"),
        (["--seed", "-1"], "seed"),
        (["--link", "elbow"], "links"),
        (["--experiment", "tube"], "experiments"),
        (["--robot", "atlas"], "robot"),
        (["--robot", "absent.urdf"], "absent.urdf"),
    ],
)
def test_the_command_refuses(options: list[str], named: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["study", "bimbo2019", *options]) == 2
    told = capsys.readouterr().err
    assert "contactsense:" in told
    assert named in told


def test_unknown_options_are_input_errors() -> None:
    with pytest.raises(cs.InputError, match="random, deliberate, cube, smooth pole, pole"):
        Options(experiments=("tube",))
