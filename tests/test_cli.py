"""The command line: help, errors, exit codes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from contactsense import __version__
from contactsense.cli.app import run

STUDY = ["study", "franka_touch"]


@pytest.mark.parametrize("command", [[], ["study"], STUDY])
def test_help(command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*command, "--help"]) == 0
    assert "Usage" in capsys.readouterr().out


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["--version"]) == 0
    assert capsys.readouterr().out == f"contactsense {__version__}\n"


@pytest.mark.parametrize("arguments", [["nosuch"], ["study", "nosuch"], STUDY, [*STUDY, "--nosuch"]])
def test_wrong_command_line(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(arguments) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_an_error_is_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run([*STUDY, "--data", str(tmp_path / "absent")]) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("contactsense: data: there is no folder")
    assert told.err.count("\n") == 1


@pytest.mark.parametrize(
    ("hidden", "arguments", "extra"),
    [
        ("typer", ["--help"], "contactsense[cli]"),
        ("rich", ["--help"], "contactsense[cli]"),
        ("matplotlib", [*STUDY, "--data", ".", "--png", "x.png"], "contactsense[study]"),
    ],
)
def test_a_missing_package_is_named(hidden: str, arguments: list[str], extra: str) -> None:
    hide = f"import sys; sys.modules[{hidden!r}] = None; from contactsense.cli import main; main()"
    ended = subprocess.run(
        [sys.executable, "-c", hide, *arguments], capture_output=True, text=True, timeout=60, check=False
    )
    assert ended.returncode == 2
    assert extra in ended.stderr
    assert "Traceback" not in ended.stderr


def test_single_contacts_prints_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["study", "single_contacts", "--robot", "iiwa14", "--points", "5", "--json"]) == 0
    results = {entry["link"]: entry for entry in json.loads(capsys.readouterr().out)}
    assert results["iiwa_link_7"]["outcomes"] == {"located": 5}
    assert results["iiwa_link_7"]["point_error_m"] < 1e-9


def test_single_contacts_prints_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["study", "single_contacts", "--points", "2"]) == 0
    assert "l_hand" in capsys.readouterr().out


@pytest.mark.parametrize("options", [["--robot", "nowhere.urdf"], ["--points", "0"]])
def test_single_contacts_refuses(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["study", "single_contacts", *options]) == 2
    assert "contactsense:" in capsys.readouterr().err
