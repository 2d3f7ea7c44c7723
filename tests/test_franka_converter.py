"""The converter of the public Franka recordings, on made-up files in their format."""

from __future__ import annotations

import gzip
from pathlib import Path

import pytest
from tools.franka_touch import COLUMNS, RecordingError, convert, recordings

SIGNALS = ("tau_J", "tau_J_d", "tau_ext", "q", "q_d", "dq", "dq_d", "e", "de", "etau_J")
HEADER = ["index", "time", *(f"{name}{joint}" for name in SIGNALS for joint in range(7)), "label"]


def recording(folder: Path, header: list[str] = HEADER, label: str = "1") -> Path:
    """Two rows; every value of a signal tells its column."""
    folder.mkdir()
    rows = []
    for number in (0, 1):
        values = {name: str(column + number / 10) for column, name in enumerate(HEADER)}
        values |= {"time": str(0.005 * number), "label": label if number else "0"}
        rows.append(",".join(values[name] for name in header))
    path = folder / "labeled_data.csv"
    path.write_text("\n".join([",".join(header), *rows]) + "\n")
    return path


def test_columns_are_chosen_by_name(tmp_path: Path) -> None:
    source = recording(tmp_path / "a4")
    assert recordings(tmp_path) == {"a4": source}
    assert convert(source, tmp_path / "a4.csv.gz") == 2
    header, first, second = gzip.decompress((tmp_path / "a4.csv.gz").read_bytes()).decode().splitlines()
    assert tuple(header.split(",")) == COLUMNS
    values = dict(zip(COLUMNS, map(float, first.split(",")), strict=True))
    assert values["q3"] == HEADER.index("q3")
    assert values["tau_ext6"] == HEADER.index("tau_ext6")
    assert second.split(",")[0] == "0.005"
    assert (first[-2:], second[-2:]) == (",0", ",1")


def test_a_gesture_is_a_contact(tmp_path: Path) -> None:
    convert(recording(tmp_path / "b6", label="3"), tmp_path / "b6.csv.gz")
    assert gzip.decompress((tmp_path / "b6.csv.gz").read_bytes()).decode().splitlines()[-1].endswith(",1")


def test_what_cannot_be_converted_is_named(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="holds no recording"):
        recordings(tmp_path)
    with pytest.raises(RecordingError, match="lacks the columns q2"):
        convert(recording(tmp_path / "c2", [name for name in HEADER if name != "q2"]), tmp_path / "out")
    with pytest.raises(RecordingError, match="row 2, column label: 'x' is not a number"):
        convert(recording(tmp_path / "c5", label="x"), tmp_path / "out")
