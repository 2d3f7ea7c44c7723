"""The demo: its figures within bounds, honest at noise, and the command's outputs."""

from __future__ import annotations

import json
import sys
from functools import lru_cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from contactsense import InputError, demo
from contactsense.cli.app import run as run_command
from contactsense.demo.arm import FORCE_RANGE, LINKS, ROUNDS, choose
from contactsense.demo.score import HitScorer
from contactsense.demo.settings import noise_passed
from contactsense.demo.table import print_result
from contactsense.sim import Push, TorqueNoise

NOISE = (2.0, 0.1)


@lru_cache
def result(seed: int, noise: tuple[float, float] = (0.0, 0.0)) -> demo.DemoResult:
    return demo.run(seed=seed, noise=noise, imperfect=False)


@lru_cache
def imperfect(seed: int) -> demo.DemoResult:
    return demo.run(seed=seed)


FEW_JOINTS = "iiwa_link_4"
LOCATE_WITHIN = 0.05  # of the monitor [m]


@pytest.mark.parametrize("seed", [1, 4])
def test_without_noise(seed: int) -> None:
    # Over 20 seeds: delay up to 3.2 ms, median point error 0.6 mm, worst force error 10 %.
    run = result(seed)
    assert len(run.hits) == len(LINKS) * ROUNDS
    assert run.detected == len(run.hits)
    assert run.false_alarms == 0
    assert run.links_right >= len(run.hits) - 2
    assert len(run.located) >= 4
    assert max(hit.delay for hit in run.hits) < 0.006
    assert np.median([hit.point_error for hit in run.located]) < 0.003
    # Where fewer joints than unknowns move the link, the force follows from what friction can be.
    assert max(hit.force_error for hit in run.located if hit.link != FEW_JOINTS) < 0.15


@pytest.mark.parametrize("seed", [1, 4])
def test_with_noise(seed: int) -> None:
    # Over 20 seeds: delay up to 19 ms, median point error 1.9 mm, errors up to 2.9 of the stated deviations.
    run = result(seed, NOISE)
    assert run.detected == len(run.hits)
    assert run.false_alarms == 0
    assert run.links_right >= 5
    assert len(run.located) >= 2
    assert max(hit.delay for hit in run.hits) < 0.030
    assert np.median([hit.point_error for hit in run.located]) < 0.010
    assert all(hit.point_error < 5 * hit.point_std for hit in run.located)
    assert max(hit.force_error for hit in run.located) < 0.40


@pytest.mark.parametrize("noise", [(0.0, 0.0), NOISE])
def test_what_is_open_has_no_figures(noise: tuple[float, float]) -> None:
    run = result(1, noise)
    few_joints = [hit for hit in run.hits if hit.link == FEW_JOINTS]
    assert len(few_joints) == ROUNDS
    # Closed forms do not determine the point; where the posterior does, it is within the distance asked for.
    assert not all(hit.located for hit in few_joints)
    assert all(hit.point_error < LOCATE_WITHIN for hit in few_joints if hit.located)
    for hit in run.hits:
        given = (hit.point, hit.point_error, hit.point_std, hit.force_error, hit.estimated_force)
        assert all((value is not None) == hit.located for value in given)


def test_the_truth_is_the_hit_on_the_surface() -> None:
    run = result(1)
    for hit in run.hits:
        pose = run.robot.link_pose(hit.q, hit.link)
        local = (hit.true_point - pose[:3, 3]) @ pose[:3, :3]
        closest = run.robot.surface(hit.link).closest_points(local[None])
        assert closest.distances[0] == pytest.approx(0.0, abs=1e-9)
        inward = -(pose[:3, :3] @ closest.normals[0])
        assert hit.true_force @ inward / hit.force > np.cos(np.pi / 6) - 1e-6
        assert FORCE_RANGE[0] <= hit.force <= FORCE_RANGE[1]
        during = (run.signals.time > hit.start) & (run.signals.time < hit.start + hit.duration)
        assert run.signals.true_force[during].max() == pytest.approx(hit.force, rel=0.01)


def test_same_seed_same_result() -> None:
    def data(run: demo.DemoResult) -> dict[str, object]:
        return {**demo.as_data(run), "monitor": None}

    assert data(demo.run(seed=1, noise=NOISE, imperfect=False)) == data(result(1, NOISE))
    assert data(result(1, NOISE)) != data(result(4, NOISE))


def test_progress() -> None:
    seen: list[demo.Progress] = []
    run = demo.run(seed=1, on_progress=seen.append)
    assert [len(progress.hits) for progress in seen] == sorted(len(progress.hits) for progress in seen)
    times = [progress.time for progress in seen]
    assert times == sorted(times)
    assert seen[0].time == 0.0
    assert seen[-1].time > 0.98 * seen[-1].end
    assert seen[-1].planned == len(seen[-1].hits) == len(run.hits)

    assert [progress.imperfect for progress in seen] == [False] * (len(seen) - 1) + [True]
    assert demo.as_data(run)["imperfect"] == demo.as_data(imperfect(1))["imperfect"]


def test_an_imperfect_arm_has_the_same_contacts() -> None:
    run = imperfect(1)
    other = run.imperfect
    assert other is not None
    assert [(hit.link, hit.force, hit.start) for hit in other.hits] == [
        (hit.link, hit.force, hit.start) for hit in run.hits
    ]
    peak = [hit.force for hit in run.hits]
    assert other.signals.true_force.max() == pytest.approx(max(peak), rel=0.01)
    # Nothing of the ideal run changes.
    assert {**demo.as_data(run), "monitor": None, "imperfect": None} == {
        **demo.as_data(result(1)),
        "monitor": None,
        "imperfect": None,
    }
    # Most impacts are detected, later than with ideal torques, and false alarms are few.
    assert other.detected >= 5
    assert other.false_alarms <= 6
    assert np.median([hit.delay for hit in other.hits if hit.delay is not None]) < 0.03
    # A located contact may be off, not without saying so.
    assert all(hit.point_error < 5 * hit.point_std for hit in other.located)
    assert result(1).imperfect is None


def test_a_report_that_began_before_a_hit_does_not_detect_it() -> None:
    run = result(1)
    push = Push("iiwa_link_7", [0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 50.0, 1.0, 0.05)
    threshold = np.full(7, 0.05)

    def scored(*onsets: bool) -> demo.HitResult:
        scorer = HitScorer(run.robot, push, 1, threshold, np.zeros(7))
        for tick, onset in enumerate(onsets):
            report = SimpleNamespace(collision=True, onset=onset, contacts=(), collision_torque=np.ones(7))
            scorer.update(1.0 + 1e-3 * tick, np.zeros(7), report)
        return scorer.result()

    assert scored(False, False).delay is None
    assert scored(False, True).delay == pytest.approx(1e-3)


def test_an_imperfect_arm_is_for_the_arm_alone() -> None:
    assert "imperfect" not in demo.as_data(result(1))
    assert "imperfect" in demo.as_data(imperfect(1))


def test_thresholds_follow_the_noise() -> None:
    torque = np.array([0.0, 100.0])
    exact = choose(TorqueNoise(), torque)
    noisy = choose(TorqueNoise(percent=1.0, newton_metres=0.5), torque)
    assert (exact.torque_threshold == 0.05).all()
    assert noisy.observer_gain < exact.observer_gain
    expected = 6.0 * noise_passed(noisy.observer_gain) * np.hypot([0.0, 1.0], 0.5)
    np.testing.assert_allclose(noisy.torque_threshold, expected)


def test_noise_passed_is_the_observers() -> None:
    noise = np.random.default_rng(0).standard_normal(400_000)
    decay, observed, values = np.exp(-250.0 * 1e-3), 0.0, []
    for mean in 0.5 * (noise[1:] + noise[:-1]):
        observed = mean + decay * (observed - mean)
        values.append(observed)
    assert noise_passed(250.0) == pytest.approx(np.std(values), rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"robot": "talos"}, r"robot: .*'talos'; there is iiwa14, atlas"),
        ({"sensor_noise": (1.0, 0.0)}, "sensor_noise: 'iiwa14' has no force/torque sensors"),
        ({"seed": -1}, "seed"),
        ({"noise": (-1.0, 0.0)}, "noise: percent"),
        ({"noise": (0.0, np.nan)}, "noise: newton_metres"),
        ({"gain": 0.0}, "gain"),
    ],
)
def test_wrong_arguments(arguments: dict[str, object], named: str) -> None:
    with pytest.raises(InputError, match=named):
        demo.run(**arguments)


def test_json_and_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "demo.png"
    assert run_command(["demo", "--seed", "1", "--noise", "2", "0.1", "--out", str(picture), "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert data["picture"] == str(picture)
    assert data["noise"] == {"percent": 2.0, "newton_metres": 0.1}
    assert len(data["torque_threshold"]) == 7
    assert len(data["hits"]) == data["summary"]["hits"] == 9
    for hit in data["hits"]:
        assert (hit["point_error_mm"] is None) == (not hit["located"])
        assert hit["link_right"] == (hit["named"] == hit["link"])
    assert data["summary"]["located"] == sum(hit["located"] for hit in data["hits"])
    assert data["monitor"]["calls"] == 8000
    other = data["imperfect"]
    assert other["calibration_s"] == 30.0
    assert [hit["link"] for hit in other["hits"]] == [hit["link"] for hit in data["hits"]]
    assert other["summary"]["detected"] == sum(hit["delay_ms"] is not None for hit in other["hits"])
    assert 0 < data["monitor"]["mean_us"] <= data["monitor"]["max_us"]


def test_table_without_a_terminal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "demo.png"
    assert run_command(["demo", "--seed", "1", "--no-imperfect", "--out", str(picture)]) == 0
    told = capsys.readouterr().out
    assert told.count("true link") == 1
    assert "\x1b" not in told
    assert "9 of 9 contacts detected" in told
    # Units in brackets are text, not markup.
    assert told.count("[mm]") == 2
    assert "Picture:" in told
    assert picture.exists()


def test_tables_say_which_torques_are_ideal(capsys: pytest.CaptureFixture[str]) -> None:
    print_result(Console(width=100), imperfect(1), "demo.png")
    told = capsys.readouterr().out
    assert told.index("Ideal torques") < told.index("errors of a real one")
    assert told.count("true link") == 2
    compared = told[told.index("imperfect arm,") :]
    ideal, other = imperfect(1), imperfect(1).imperfect
    assert other is not None
    (line,) = [line for line in compared.splitlines() if line.strip().startswith("detected")]
    assert f"{ideal.detected} of 9" in line
    assert f"{other.detected} of 9" in line
    assert "Ideal torques: 9 of 9 contacts detected" in told


@pytest.mark.parametrize("arguments", [["--robot", "talos"], ["--noise", "x", "1"], ["--gain", "-1"]])
def test_wrong_command_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command(["demo", *arguments]) == 2
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.parametrize("name", ["absent/demo.png", "demo.nosuch"])
def test_picture_that_cannot_be_written(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(["demo", "--seed", "1", "--out", str(tmp_path / name)]) == 2
    assert capsys.readouterr().err.startswith("contactsense: out: cannot write")


@pytest.mark.parametrize("package", ["mujoco", "matplotlib"])
def test_a_missing_package_is_named(
    package: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, package, None)  # as if it could not be found
    assert run_command(["demo"]) == 2
    told = capsys.readouterr().err
    assert package in told
    assert "contactsense[demo]" in told
