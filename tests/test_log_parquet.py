"""Parquet files are read with all that has numbers in them, and refused where they are broken."""

from __future__ import annotations

import datetime
import io
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest
from mutations import check_broken, cuts, outcome

from contactsense.errors import InputError
from contactsense.log.formats import parquet

pa = pytest.importorskip("pyarrow")
ROWS = np.random.default_rng(1).normal(size=(500, 3))


def packed(table: object, **options: object) -> bytes:
    from pyarrow import parquet as writer

    sink = io.BytesIO()
    writer.write_table(table, sink, **options)
    return sink.getvalue()


def plain(**options: object) -> bytes:
    columns = {"time": ROWS[:, 0], "q": list(ROWS), "name": ["x"] * len(ROWS)}
    return packed(pa.table(columns), **options)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "run.parquet"


def test_all_kinds_of_numbers(file: Path) -> None:
    second = datetime.datetime(1970, 1, 2, 0, 0, 1, 500_000)
    table = pa.table(
        {
            "f": [1.5, None, float("nan")],
            "half": pa.array(np.array([1, 2, 3], np.float16)),
            "i": pa.array([1, None, -3], pa.int32()),
            "u": pa.array([1, 2**63, 3], pa.uint64()),
            "b": [True, False, None],
            "d": [Decimal("1.25"), None, Decimal("-2.50")],
            "t": pa.array([second, None, second], pa.timestamp("us")),
            "zone": pa.array([second, None, second], pa.timestamp("ns", tz="UTC")),
            "dt": pa.array([datetime.timedelta(milliseconds=20)] * 3, pa.duration("ms")),
            "clock": pa.array([datetime.time(0, 1, 2)] * 3, pa.time32("ms")),
            "day": pa.array([datetime.date(1970, 1, 3)] * 3),
            "same": pa.array([2.5, 2.5, None]).dictionary_encode(),
            "nothing": pa.nulls(3),
            "text": ["1", "2", "3"],
            "s": [{"text": "x", "n": 1}] * 3,
        }
    )
    file.write_bytes(packed(table))
    recording = parquet.read(file)
    (got,) = recording.tables
    nan = np.nan
    expected = {
        "f": [1.5, nan, nan],
        "half": [1, 2, 3],
        "i": [1, nan, -3],
        "u": [1, 2.0**63, 3],
        "b": [1, 0, nan],
        "d": [1.25, nan, -2.5],
        "t": [86401.5, nan, 86401.5],
        "zone": [86401.5, nan, 86401.5],
        "dt": [0.02] * 3,
        "clock": [62] * 3,
        "day": [172800] * 3,
        "same": [2.5, 2.5, nan],
        "nothing": [nan] * 3,
        "s.n": [1] * 3,
    }
    assert list(got.columns) == list(expected)
    np.testing.assert_equal({name: column.tolist() for name, column in got.columns.items()}, expected)
    assert recording.left_out == ("text: a column of type string", "s.text: a column of type string")
    assert (got.name, got.kind, got.received, recording.damage) == ("run", "", None, ())


def test_structures_and_lists(file: Path) -> None:
    table = pa.table(
        {
            "pose": [
                {"p": {"x": 1.0, "y": 2.0}, "q": [1, 2]},
                None,
                {"p": {"x": 3.0, "y": None}, "q": [3, 4]},
            ],
            "m": [[[1, 2], [3, 4]], [[5, 6], [7, 8]], None],
            "fixed": pa.array([[1.0, 2.0], [3.0, 4.0], None], pa.list_(pa.float64(), 2)),
            "ragged": [[1], [1, 2], []],
            "empty": pa.array([None, None, None], pa.list_(pa.int8())),
        }
    )
    file.write_bytes(packed(table))
    recording = parquet.read(file)
    nan = np.nan
    expected = {
        "pose.p.x": [1, nan, 3],
        "pose.p.y": [2, nan, nan],
        "pose.q[0]": [1, nan, 3],
        "pose.q[1]": [2, nan, 4],
        "m[0][0]": [1, 5, nan],
        "m[0][1]": [2, 6, nan],
        "m[1][0]": [3, 7, nan],
        "m[1][1]": [4, 8, nan],
        "fixed[0]": [1, 3, nan],
        "fixed[1]": [2, 4, nan],
    }
    got = {name: column.tolist() for name, column in recording.tables[0].columns.items()}
    np.testing.assert_equal(got, expected)
    assert recording.left_out == ("ragged: lists of several lengths", "empty: lists of length []")


@pytest.mark.parametrize(
    "options", [{}, {"row_group_size": 7}, {"compression": "zstd"}, {"compression": "none"}]
)
def test_row_groups_and_compression(file: Path, options: dict[str, object]) -> None:
    file.write_bytes(plain(**options))
    got = parquet.read(file).tables[0].columns
    assert list(got) == ["time", "q[0]", "q[1]", "q[2]"]
    assert np.array_equal(got["time"], ROWS[:, 0])
    assert np.array_equal(np.stack([got[f"q[{k}]"] for k in range(3)], 1), ROWS)


def test_cut_files_say_so(file: Path) -> None:
    data = plain(row_group_size=100)
    for cut in cuts(data, seed=2):
        error = outcome(parquet.read, file, data[:cut])
        assert isinstance(error, InputError)
        assert cut < 8 or "is cut" in str(error)


def test_a_bomb_is_refused(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = packed(pa.table({"a": np.zeros(1 << 21)}))
    assert len(data) < 20_000
    monkeypatch.setattr(parquet, "MOST_BYTES", 8 << 20)
    error = outcome(parquet.read, file, data)
    assert isinstance(error, InputError)
    assert "more than 8 MiB" in str(error)


@pytest.mark.parametrize("data", [b"", b"PAR1", b"PAR1PAR1", b"a,b\n1,2\n", packed(pa.table({"a": ["x"]}))])
def test_files_without_numbers(file: Path, data: bytes) -> None:
    assert isinstance(outcome(parquet.read, file, data), InputError)


def test_an_absent_file() -> None:
    with pytest.raises(InputError, match="cannot read"):
        parquet.read(Path("absent.parquet"))


def test_broken_files(file: Path) -> None:
    whole = [
        plain(),
        plain(row_group_size=100, compression="zstd", write_page_checksum=True),
        plain(version="1.0"),
    ]
    whole.append(packed(pa.table({"a": [{"b": [1, 2]}] * 20, "t": [datetime.datetime(2020, 1, 1)] * 20})))
    check_broken(parquet.read, file, whole, seed=3)
