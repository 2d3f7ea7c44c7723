"""Figures in README and pages are those recorded, and each has a command that anyone can run."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tools.figures import __main__ as figures
from tools.figures import long_studies, marks, record
from tools.figures.entries import BY_NAME, FIGURES
from tools.figures.markdown import number, table

from contactsense.cli.app import run as run_cli

ROOT = Path(__file__).resolve().parents[1]


def test_the_text_is_what_is_recorded() -> None:
    assert figures.differences() == []


def test_names_differ() -> None:
    assert len(BY_NAME) == len(FIGURES)


@pytest.mark.parametrize("figure", FIGURES, ids=lambda figure: figure.name)
def test_commands_exist(figure: figures.Figure, capsys: pytest.CaptureFixture[str]) -> None:
    """Every option of a command is one that its help names."""
    for commands in figure.commands().values():
        for python, module, name, *arguments in commands:
            assert (python, module) == ("python", "-m")
            options = {part for part in arguments if part.startswith("--")}
            if name == "contactsense":
                words = arguments[: 2 if arguments[0] == "study" else 1]
                assert run_cli([*words, "--help"]) == 0
                told = capsys.readouterr().out
            else:
                command = [sys.executable, "-m", name, "--help"]
                told = (
                    subprocess.run(command, cwd=ROOT, capture_output=True, text=True).stdout
                    if options
                    else ""
                )
            assert not [option for option in options if option not in told], told


@pytest.fixture
def copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """README and docs in a folder of their own, which the tool takes for the repository."""
    shutil.copy(ROOT / "README.md", tmp_path)
    shutil.copytree(ROOT / "docs", tmp_path / "docs", ignore=shutil.ignore_patterns("*.png"))
    monkeypatch.setattr(record, "ROOT", tmp_path)
    monkeypatch.setattr(record, "FILE", tmp_path / "docs" / "figures.json")
    monkeypatch.setattr(figures, "PAGE", tmp_path / "docs" / "figures.md")
    return tmp_path


def test_a_table_that_was_changed_is_found_and_restored(
    copied: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = copied / "README.md"
    text = page.read_text(encoding="utf-8")
    one = marks.tables(text)["franka_touch"]
    page.write_text(marks.replaced(text, "franka_touch", one.replace("75 ms", "15 ms")), encoding="utf-8")
    assert figures.main(["--check"]) == 1
    assert "README.md: the table franka_touch is not what is recorded" in capsys.readouterr().out
    assert figures.main(["write"]) == 0
    assert page.read_text(encoding="utf-8") == text
    assert figures.main(["--check"]) == 0


def test_a_figure_without_an_entry_is_listed(copied: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = copied / "docs" / "observer.md"
    page.write_text(
        page.read_text() + "\n## Figures\n\nIt is late by 123.4 ms, in 4321 of 9999 cases.\n\n    x 77 ms\n"
    )
    assert figures.main(["--check"]) == 0
    assert "docs/observer.md: in the text, in no table: 123.4, 4321\n" in capsys.readouterr().out


def test_a_table_of_another_command_is_found(copied: Path) -> None:
    records = record.load()
    records["demo_arm"]["commands"] = ["python -m contactsense demo --seed 11"]
    record.save(records)
    assert "demo_arm: recorded of another command" in figures.differences()


def test_a_table_in_other_words_keeps_the_commit_of_its_numbers(copied: Path) -> None:
    page = copied / "docs" / "vorndamme2017.md"
    text, recorded = page.read_text(encoding="utf-8"), record.load()["vorndamme2017_time"]["recorded"]
    page.write_text(text.replace("| one contact | 4.8 / 15", "| 1 contact | 4.8 / 15"), encoding="utf-8")
    assert figures.main(["adopt", "vorndamme2017_time"]) == 0
    assert "| 1 contact |" in record.load()["vorndamme2017_time"]["table"]
    assert record.load()["vorndamme2017_time"]["recorded"] == recorded


def test_a_measured_table_is_not_taken_from_the_text(copied: Path) -> None:
    before = record.load()
    with pytest.raises(SystemExit, match="demo_arm: was measured"):
        figures.main(["adopt", "demo_arm"])
    assert record.load() == before


def test_an_unknown_name_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        figures.main(["run", "nothing"])
    assert "there is no figure 'nothing'" in capsys.readouterr().err


def test_numbers_are_rounded_to_significant_digits() -> None:
    shown = [number(value) for value in (0.0, 0.6443, 0.00996, 1.04, 9.96, 19.4, 127.3)]
    assert shown == ["0", "0.64", "0.010", "1.0", "10", "19", "130"]
    assert table(("a", "", ""), [("1", "", "")]) == "| a | | |\n|---|---|---|\n| 1 | | |"


def test_errors_of_a_study_are_in_centimetres() -> None:
    """Links beside each other; the share of right links where it is not all; infinite errors are none."""
    scores = {
        "arm_1": {"mean": 0.1234, "median": 0.0012, "right_link": 0.8},
        "arm_2": {"mean": None, "median": 0.02, "right_link": 1.0},
    }
    experiments: dict[str, dict[str, object]] = {}
    for experiment, kind, _ in long_studies.BIMBO_ROWS:
        experiments.setdefault(experiment, {})[kind] = scores
    lines = long_studies.bimbo2019_table(experiments).splitlines()
    assert lines[0] == "| | link 1 | 2 |"
    assert lines[2] == "| random, curvature | 12/0.1 80 % | -/2.0 |"


def test_times_have_two_digits_and_ratios_of_peers() -> None:
    def timing(name: str, median: float, ratio: float, tail: object = None) -> dict[str, object]:
        return {"name": name, "median_us": median, "ratio": ratio, "tail_us": tail}

    timings = [
        timing("contactsense", 0.634, 1.0, [55.2, 71.9]),
        timing("peer", 1234.0, 13.4),
        timing("contactsense, read too", 1.0, 1.5),
    ]
    shown = long_studies.speed_table(
        {
            "comparisons": [
                {"task": "observer, iiwa14, 7 joints", "timings": timings},
                {"task": "else", "timings": timings},
            ]
        }
    )
    assert (
        shown.splitlines()[2]
        == "| observer, iiwa14, 7 joints | 0.63 us, 99.9 % in 55 us, max 72 us | peer: 1.2 ms | 13 |"
    )
