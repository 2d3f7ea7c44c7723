"""The study of imperfect arms, short: judging against the truth, and what three monitors make of one arm."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

import contactsense as cs
from contactsense import sim
from contactsense._extras import MissingExtraError
from contactsense.cli.app import run as command
from contactsense_studies.real_arm import arms, study
from contactsense_studies.real_arm.arms import ARMS, described
from contactsense_studies.real_arm.data import as_data
from contactsense_studies.real_arm.judge import LINGERING, JudgedContact, judge_contacts, judge_free
from contactsense_studies.real_arm.monitors import (
    MARGIN,
    MONITORS,
    REACTION,
    SETTLING,
    Heard,
    hear,
    thresholds,
)
from contactsense_studies.real_arm.options import Options
from contactsense_studies.real_arm.plots import PICTURES
from contactsense_studies.real_arm.records import DT, record
from contactsense_studies.real_arm.score import BANDS, detection, false_onsets, in_band
from contactsense_studies.real_arm.study import Study, run, trial_seed

SHORT = Options(arms=("iiwa14",), trials=2, contacts=5, calibration_seconds=10, free_seconds=10)
IIWA = cs.Robot.named("iiwa14")


@pytest.fixture(scope="module")
def short() -> Study:
    return run(SHORT, processes=2)


@pytest.fixture(scope="module")
def touched() -> sim.ImperfectRun:
    """Two contacts, far apart."""
    motion = sim.random_moves(IIWA, 6.0, seed=1)
    contacts = [
        sim.PersonContact("iiwa_link_6", [0.0, 0.0, 0.0], [30.0, 0.0, 0.0], start, 0.5, 0.1)
        for start in (1.0, 4.0)
    ]
    return sim.record_imperfect(IIWA, sim.ImperfectArm(torque_noise=0.2), motion, contacts)


def heard(run: sim.ImperfectRun, *onsets: float, collision: tuple[float, float] = (0.0, 0.0)) -> Heard:
    """Onsets at times, and a contact reported between two [s]."""
    time = run.truth.time
    onset = np.zeros(len(time), dtype=bool)
    onset[np.searchsorted(time, onsets)] = True
    return Heard(onset, (time >= collision[0]) & (time < collision[1]), np.full((len(time), 7), 0.5))


def judged(force: float, delay: float | None, signal: float = 10.0) -> JudgedContact:
    return JudgedContact(
        "iiwa_link_6", force, 0.5, signal, 1.0, {"calibrated": delay}, {"calibrated": delay is None}, {}
    )


def test_a_contact_is_detected_by_an_onset_within_it(touched: sim.ImperfectRun) -> None:
    told = {
        "early": heard(touched, 0.9, collision=(0.9, 5.0)),
        "prompt": heard(touched, 1.03, 1.2, 4.45),
        "late": heard(touched, 1.51),
    }
    first, second = judge_contacts(touched, told)
    assert first.delays == {"early": None, "prompt": pytest.approx(0.03, abs=2e-3), "late": None}
    # An onset before the contact hides it: what is reported goes on.
    assert second.reported_before == {"early": True, "prompt": False, "late": False}
    assert second.delays["prompt"] == pytest.approx(0.45, abs=2e-3)
    assert (first.link, first.force, first.duration) == ("iiwa_link_6", pytest.approx(30.0), 0.5)


def test_the_signal_is_the_largest_torque_in_its_noise(touched: sim.ImperfectRun) -> None:
    first, _ = judge_contacts(touched, {})
    rows = touched.truth.contacts[0].rows
    assert first.signal == pytest.approx(np.abs(touched.truth.external_torque[rows]).max() / 0.2, rel=0.1)


def test_onsets_in_free_motion_are_false(touched: sim.ImperfectRun) -> None:
    free = sim.record_imperfect(IIWA, sim.ImperfectArm(), sim.random_moves(IIWA, 10.0, seed=2))
    # The first falls into the settling, the second where the first contact would be, 0.5 s later for it.
    said = heard(free, 0.1, SETTLING + 1.2, collision=(5.0, 6.0))
    # One onset between the contacts, one while the first fades, one within the second.
    pauses = heard(touched, 1.5 + 0.5 * LINGERING, 3.0, 4.1, collision=(3.0, 3.5))
    figures = judge_free(free, said, touched, pauses)
    assert figures.onsets == 1
    assert figures.between == 1
    assert figures.between_share == pytest.approx(0.5 / (6.0 - SETTLING - 2 * (0.5 + LINGERING)), rel=1e-2)
    assert figures.chance == 0.5
    assert figures.seconds == pytest.approx(10.0 - SETTLING)
    assert figures.share == pytest.approx(1.0 / (10.0 - SETTLING), rel=1e-2)
    assert figures.rms == pytest.approx([0.5] * 7)


def test_scores_count_what_is_in_the_torques() -> None:
    contacts = [judged(7.0, None, signal=1.0), judged(15.0, 0.04), judged(40.0, 0.08), judged(20.0, None)]
    figures = detection(contacts, "calibrated")
    assert (figures.contacts, figures.detected, figures.in_torques) == (4, 0.5, 3)
    assert figures.detected_in_torques == pytest.approx(2 / 3)
    assert (figures.delay, figures.delay_90) == (pytest.approx(0.06), pytest.approx(0.076))
    assert figures.reported_before == 0.5
    assert [len(in_band(contacts, band)) for band in BANDS] == [1, 1, 2]
    assert np.isnan(detection([], "calibrated").detected)


def test_thresholds_are_above_all_of_the_free_motion() -> None:
    log = sim.PersonScene(seconds=5.0, contacts=0, seed=3).record(IIWA, sim.ImperfectArm.typical(IIWA)).log
    chosen = thresholds(IIWA, log)
    told = hear(IIWA, log, torque_threshold=chosen)
    settled = log.time > log.time[0] + SETTLING
    np.testing.assert_allclose(np.abs(told.external_torque[settled]).max(axis=0) * MARGIN, chosen)
    assert not told.onset[settled].any()


def test_records_are_of_one_arm_and_differ() -> None:
    arm = ARMS["iiwa14"].errors(IIWA, 5)
    # What the study says of its arms.
    assert (arm.mass_error, arm.encoder_bits, arm.velocity_cutoff) == (0.02, 17, 60.0)
    records = record(IIWA, arm, Options(contacts=3, calibration_seconds=10, free_seconds=10), 5)
    assert records.free.truth.contacts == ()
    assert len(records.contacts.truth.contacts) == 3
    assert all(5.0 <= np.linalg.norm(each.force) <= 40.0 for each in records.contacts.truth.contacts)
    assert not np.array_equal(records.everyday.q[0], records.free.log.q[0])
    assert float(records.exciting.time[-1]) == pytest.approx(10.0, abs=0.01)


def test_a_calibration_quiets_the_arm(short: Study) -> None:
    default, own, calibrated = (false_onsets(short.trials, name) for name in MONITORS)
    assert default.collision > 0.3
    assert calibrated.collision < 0.05
    assert own.seconds == calibrated.seconds == pytest.approx(2 * (10.0 - SETTLING), abs=0.01)
    for trial in short.trials:
        # At the wrist, where bias and friction are most of the error.
        assert trial.free["calibrated"].rms[6] < 0.5 * trial.free["thresholds"].rms[6]
    assert [trial.stretch is None for trial in short.trials] == [False, True]


def test_what_is_detected_is_judged_from_a_report_of_its_own(short: Study) -> None:
    contacts = [(each, name) for trial in short.trials for each in trial.contacts for name in MONITORS]
    found = [(each, name, each.estimates[name]) for each, name in contacts if each.estimates[name]]
    assert [each for each, name, _ in found if name == "calibrated"]
    for each, name, estimate in found:
        assert estimate is not None
        assert each.delays[name] is not None
        assert 0.0 <= estimate.age <= min(REACTION, each.duration) + DT
        assert estimate.link in IIWA.link_names
        assert (estimate.steps == 0) == (estimate.link == each.link)
        assert not estimate.located or np.isfinite(estimate.error)


def test_the_number_of_processes_changes_nothing(short: Study) -> None:
    again = run(SHORT, processes=1)
    assert json.dumps(plain(again)) == json.dumps(plain(short))
    assert again.complete


def plain(result: Study) -> Any:
    from contactsense._plain import plain as as_plain

    return as_plain(as_data(result))


def test_every_trial_has_a_seed_of_its_own() -> None:
    seeds = {
        trial_seed(Options(seed=seed), arm, number)
        for seed in range(3)
        for arm in ARMS
        for number in range(9)
    }
    assert len(seeds) == 3 * len(ARMS) * 9


def test_arms_that_are_not_installed_are_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    def absent() -> cs.Robot:
        raise MissingExtraError("example-robot-data")

    described.cache_clear()
    kinds = {name: arms.ArmKind(kind.about, absent, kind.errors) for name, kind in ARMS.items()}
    for module in (arms, study):
        monkeypatch.setattr(module, "ARMS", {**kinds, "iiwa14": ARMS["iiwa14"]})
    monkeypatch.setattr(study, "run_trials", lambda function, items, *others: ([], True))
    result = run(Options())
    assert result.arms == ("iiwa14",)
    assert set(result.skipped) == {"panda", "ur5", "kinova", "ur5_currents"}
    assert all("pip install example-robot-data" in told for told in result.skipped.values())
    with pytest.raises(MissingExtraError, match="example-robot-data"):
        run(Options(arms=("ur5",)))


def test_the_command_prints_and_draws(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    times = ["--contacts", "2", "--calibration-seconds", "10", "--free-seconds", "10"]
    options = ["--arm", "iiwa14", "--trials", "1", *times, "--processes", "1"]
    assert command(["study", "real_arm", *options, "--json", "--png", str(tmp_path)]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["complete"]
    (arm,) = data["arms"].values()
    assert arm["contacts"]["calibrated"]["contacts"] == 2
    (trial,) = arm["trials"]
    assert trial["errors"]["encoder_bits"] == 17
    assert len(trial["contacts"]) == 2
    assert set(trial["contacts"][0]["delays"]) == set(trial["contacts"][0]["estimates"]) == set(MONITORS)
    assert set(arm["localization"]) == set(arm["reliability"]) == set(arm["named_links"]) == set(MONITORS)
    for name in PICTURES:
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
    assert command(["study", "real_arm", *options]) == 0
    told = capsys.readouterr().out
    assert "Contacts of 5 to 40 N" in told
    for title in ("Motion without contact", "Links of the detected", "Points of the detected"):
        assert title in told
    assert max(map(len, told[: told.index("A: ")].splitlines())) <= 80


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["--trials", "0"], "trials"),
        (["--contacts", "0"], "contacts"),
        (["--calibration-seconds", "5"], "calibration_seconds"),
        (["--free-seconds", "5"], "free_seconds"),
        (["--seed", "-1"], "seed"),
        (["--arm", "talos"], "arms"),
    ],
)
def test_the_command_refuses(options: list[str], named: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["study", "real_arm", *options]) == 2
    told = capsys.readouterr().err
    assert "contactsense:" in told
    assert named in told
