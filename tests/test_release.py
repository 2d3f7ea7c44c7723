"""What is shipped may be shipped, and the tools that say so work."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml
from tools import licences, lowest

ROOT = Path(__file__).parents[1]


def test_licences_of_all_parts_are_allowed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["licences", "--sbom", str(tmp_path / "sbom.json")])
    assert licences.main() == 0
    rows = [line.split("\t") for line in capsys.readouterr().out.splitlines()]
    names = {row[1] for row in rows}
    assert {"nalgebra", "parry3d-f64", "pyo3", "urdf-rs", "numpy", "pin"} <= names
    # For tests only.
    assert not names & {"proptest", "criterion", "cbindgen", "pytest"}
    bill = json.loads((tmp_path / "sbom.json").read_text())
    assert {part["name"] for part in bill["components"]} == names


@pytest.mark.parametrize(
    ("expression", "is_allowed"),
    [
        ("MIT", True),
        ("MIT/Apache-2.0", True),
        ("GPL-3.0-only", False),
        ("GPL-3.0-only OR MIT", True),
        ("GPL-3.0-only AND MIT", False),
        ("(MIT OR GPL-3.0-only) AND Unicode-3.0", True),
        ("(MIT AND GPL-3.0-only) OR LGPL-3.0-only", False),
        ("Apache-2.0 WITH LLVM-exception OR MIT", True),
        ("", False),
        ("MIT OR", True),
        ("(MIT", False),
        ("MIT Apache-2.0", False),
    ],
)
def test_expressions_of_licences(expression: str, is_allowed: bool) -> None:
    assert licences.allowed(expression, licences.ALLOWED) is is_allowed


def test_a_licence_that_is_not_allowed_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["licences"])
    monkeypatch.setattr(licences, "crates", lambda: [licences.Part("crate", "odd", "1.0", "AGPL-3.0-only")])
    assert licences.main() == 1
    assert "crate odd 1.0: licence 'AGPL-3.0-only' is not allowed" in capsys.readouterr().err


def test_lowest_versions_are_those_of_the_project() -> None:
    pins = lowest.lowest()
    assert {"numpy", "pyyaml", "typer", "mujoco", "matplotlib", "rosbags"} <= {
        pin.split("==")[0] for pin in pins
    }
    assert all((ROOT / "tests" / name).exists() for name in lowest.TESTS)


def test_workflows_call_what_is_there() -> None:
    makefile = (ROOT / "Makefile").read_text()
    for file in sorted((ROOT / ".github" / "workflows").glob("*.yml")):
        for job in yaml.safe_load(file.read_text())["jobs"].values():
            for step in job["steps"]:
                words = step.get("run", "").split()
                if words[:1] == ["make"]:
                    assert f"\n{words[1]}:" in makefile, (file.name, words)
