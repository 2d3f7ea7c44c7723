"""The known errors of simulated arms are found by calibration, and the stated uncertainty covers them."""

from __future__ import annotations

from pathlib import Path

import pytest
from rich.console import Console

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

import contactsense as cs
from contactsense import sim
from contactsense._plain import plain
from contactsense_studies.harness import save_pictures
from contactsense_studies.recovery import study as whole
from contactsense_studies.recovery.data import as_data
from contactsense_studies.recovery.options import Options
from contactsense_studies.recovery.plots import PICTURES
from contactsense_studies.recovery.recover import Recovery, linear, loaded, recover
from contactsense_studies.recovery.report import print_study
from contactsense_studies.recovery.score import table

IIWA = cs.Robot.named("iiwa14")
ARMS = 6


@pytest.fixture(scope="module")
def recovered() -> list[Recovery]:
    planned = cs.exciting_motion(IIWA, 30.0, dt=5e-3)
    motion = sim.JointMotion(planned.time, planned.q, planned.v, planned.a)
    arms = [
        loaded(IIWA, linear(sim.ImperfectArm.typical(IIWA, seed)), seed) for seed in range(100, 100 + ARMS)
    ]
    return [recover(IIWA, arm, motion, seed) for seed, arm in enumerate(arms)]


def test_errors_are_found(recovered: list[Recovery]) -> None:
    found = table(recovered)
    assert found["bias_90"] < 0.02
    assert found["coulomb"] < 0.05
    assert found["noise_90"] < 0.10
    assert found["com"] < 5e-3
    # The masses of the links, 2 % off, are part of what a payload seems to weigh.
    assert found["mass"] < 0.03


def test_their_uncertainty_is_stated(recovered: list[Recovery]) -> None:
    found = table(recovered)
    for name in ("bias", "coulomb", "mass", "com"):
        assert found[f"{name}_covered"] >= 0.8


def test_an_arm_without_payload_is_refused() -> None:
    motion = sim.random_moves(IIWA, 2.0)
    with pytest.raises(cs.InputError, match="arm: must have a payload"):
        recover(IIWA, sim.ImperfectArm.ideal(), motion, 0)


def test_the_study_shows_what_it_found(tmp_path: Path) -> None:
    study = whole.run(Options(("iiwa14",), runs=1), processes=1)
    assert study.complete
    assert list(study.found) == [("iiwa14", "linear"), ("iiwa14", "typical")]
    rows = plain(as_data(study))["scores"]
    assert [row["runs"] for row in rows] == [1, 1]
    assert all(row["mass"] < 0.5 for row in rows)
    console = Console(record=True, width=140)
    print_study(study, console)
    assert "typical" in console.export_text()
    (path,) = save_pictures(PICTURES, study, tmp_path)
    assert path.stat().st_size > 10_000


def test_ctrl_c_returns_what_there_is() -> None:
    def stop(stage: str, done: int, total: int) -> None:
        raise KeyboardInterrupt

    study = whole.run(Options(("iiwa14",), runs=1), processes=1, progress=stop)
    assert not study.complete
    assert study.found == {}


def test_an_unknown_robot_is_named() -> None:
    with pytest.raises(cs.InputError, match="robots: there is no 'r2d2'"):
        Options(("r2d2",))
