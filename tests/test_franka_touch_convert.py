"""The converter of the Franka logs, on a made-up checkout of the public repository."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import contactsense as cs
from contactsense_studies.franka_touch.convert import FILE, LABELLED, convert, main
from contactsense_studies.franka_touch.logs import log_files, read_log

# As the public files are laid out: torques first, commanded values between, an index before all.
SIGNALS = ("tau_J", "tau_J_d", "tau_ext", "q", "q_d", "dq", "dq_d", "e", "de", "etau_J")
HEADER = ("index", "time", *(f"{name}{joint}" for name in SIGNALS for joint in range(7)), "label")
ROWS = 12


def checkout(folder: Path, *names: str) -> np.ndarray:
    """Writes logs of random numbers; returns their table, with a touch in the middle."""
    table = np.random.default_rng(1).normal(size=(ROWS, len(HEADER)))
    table[:, 0] = np.arange(1, ROWS + 1)
    table[:, 1] = 0.005 * np.arange(ROWS)
    table[:, -1] = [0] * 4 + [1] * 4 + [0] * 4
    for name in names:
        path = folder / LABELLED / name / FILE
        path.parent.mkdir(parents=True)
        rows = [
            ",".join(HEADER),
            *(",".join(map(repr, row.tolist()[:-1])) + f",{row[-1]:.0f}" for row in table),
        ]
        path.write_text("\n".join(rows) + "\n")
    return table


def columns(table: np.ndarray, signal: str) -> np.ndarray:
    return table[:, [HEADER.index(f"{signal}{joint}") for joint in range(7)]]


def test_converted_logs_are_what_the_study_reads(tmp_path: Path) -> None:
    table = checkout(tmp_path, "a4", "g11")
    written = convert(tmp_path, tmp_path / "logs", ("a4", "g11"))
    assert [path.name for path in written] == ["a4.csv.gz", "g11.csv.gz"]
    first, second = (read_log(file, cs.Robot.named("iiwa14")) for file in log_files(tmp_path / "logs"))
    assert (first.link, second.link) == (7, 1)
    assert first.touches == [(4, 7)]
    np.testing.assert_allclose(first.time, table[:, 1], rtol=1e-6)
    np.testing.assert_allclose(first.measured.q, columns(table, "q"), rtol=1e-6)
    np.testing.assert_allclose(first.measured.v, columns(table, "dq"), rtol=1e-6)
    np.testing.assert_allclose(first.measured.tau, columns(table, "tau_J"), rtol=1e-6)
    np.testing.assert_allclose(first.vendor.external_torque, -columns(table, "tau_ext"), rtol=1e-6)


def test_the_same_log_makes_the_same_file(tmp_path: Path) -> None:
    checkout(tmp_path, "a4")
    (once,) = convert(tmp_path, tmp_path / "once", ["a4"])
    (again,) = convert(tmp_path, tmp_path / "again", ["a4"])
    assert once.read_bytes() == again.read_bytes()


def test_nothing_is_written_unless_all_can_be_read(tmp_path: Path) -> None:
    checkout(tmp_path, "a4")
    with pytest.raises(cs.InputError, match=r"b6.*cannot be read"):
        convert(tmp_path, tmp_path / "logs", ["a4", "b6"])
    assert not (tmp_path / "logs").exists()


def test_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path), str(tmp_path / "logs")]) == 2
    assert "should be a checkout of https://github.com/" in capsys.readouterr().err
    checkout(tmp_path, "a4")
    assert main([str(tmp_path), str(tmp_path / "logs"), "--logs", "../a4"]) == 2
    assert "'../a4' is no log" in capsys.readouterr().err
    assert main([str(tmp_path), str(tmp_path / "logs"), "--logs", "a4"]) == 0
    assert capsys.readouterr().out == f"{tmp_path / 'logs' / 'a4.csv.gz'}\n"
    (tmp_path / "file").write_text("")
    assert main([str(tmp_path), str(tmp_path / "file"), "--logs", "a4"]) == 2
    assert "cannot write into" in capsys.readouterr().err
