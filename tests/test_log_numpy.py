"""Files of NumPy are read without running anything in them, as far as they are whole."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest
from mutations import check_broken, cuts, outcome
from numpy.lib import format as npy

from contactsense.errors import InputError
from contactsense.log.formats import numpy_file, unpack
from contactsense.log.recording import Recording

ROWS = np.random.default_rng(1).normal(size=(50, 3))
FIELDS = np.zeros(
    20, [("time", "f8"), ("q", ">f4", (2,)), ("name", "U4"), ("tip", [("x", "i2"), ("z", "?")])]
)
FIELDS["time"], FIELDS["q"], FIELDS["tip"]["x"] = np.arange(20), np.arange(40).reshape(20, 2), 7


def single(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def archive(**arrays: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **arrays)  # type: ignore[arg-type]
    return stream.getvalue()


def compressed(**arrays: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)  # type: ignore[arg-type]
    return stream.getvalue()


def read(path: Path, data: bytes) -> Recording:
    path.write_bytes(data)
    return numpy_file.read(path)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "run.npz"


@pytest.mark.parametrize(
    "array",
    [ROWS, np.asfortranarray(ROWS), ROWS.astype(">f8"), (9 * ROWS).astype("i2"), ROWS > 0, ROWS.astype("f2")],
)
def test_one_array(file: Path, array: np.ndarray) -> None:
    recording = read(file, single(array))
    (table,) = recording.tables
    assert (table.name, table.kind, list(table.columns)) == ("run", "", ["0", "1", "2"])
    assert np.array_equal(np.stack(list(table.columns.values()), 1), array.astype(float))
    assert recording.damage == recording.left_out == ()


def test_names_of_columns(file: Path) -> None:
    def names(array: np.ndarray) -> list[str]:
        return list(read(file, single(array)).tables[0].columns)

    assert names(ROWS[:, 0]) == ["0"]
    assert names(ROWS.reshape(25, 3, 2)) == ["[0][0]", "[0][1]", "[1][0]", "[1][1]", "[2][0]", "[2][1]"]
    assert names(FIELDS) == ["time", "q[0]", "q[1]", "tip.x", "tip.z"]
    assert names(ROWS[:, 0] + 1j) == ["real", "imag"]


def test_fields(file: Path) -> None:
    recording = read(file, single(FIELDS))
    (table,) = recording.tables
    assert np.array_equal(table.columns["q[1]"], np.arange(1, 41, 2))
    assert np.array_equal(table.columns["tip.x"], [7] * 20)
    assert recording.left_out == ("name: of type <U4",)


def test_times_become_seconds(file: Path) -> None:
    start = np.datetime64("1970-01-02T00:00:00.5")
    times = np.array([start, "NaT"], "M8[ns]")
    steps = np.array([3, "NaT"], "m8[10ms]")
    months = np.array(["2020-01"] * 2, "M8[M]")
    recording = read(file, archive(t=times, dt=steps, months=months))
    got = recording.tables[0].columns
    np.testing.assert_allclose(got["t"], [86400.5, np.nan], rtol=1e-15)
    np.testing.assert_allclose(got["dt"], [0.03, np.nan], rtol=1e-15)
    assert recording.left_out == ("months: of type datetime64[M]",)


@pytest.mark.parametrize("pack", [archive, compressed])
def test_archives(file: Path, pack: object) -> None:
    assert callable(pack)
    data = pack(time=ROWS[:, 0], q=ROWS, names=np.array(["a", "b"]), dt=np.array(0.1), force=np.ones(7))
    recording = read(file, data)
    assert [(table.name, list(table.columns)) for table in recording.tables] == [
        ("run", ["time", "q[0]", "q[1]", "q[2]"]),
        ("run.1", ["force"]),
    ]
    assert np.array_equal(recording.tables[0].columns["q[2]"], ROWS[:, 2])
    assert recording.left_out == ("names: of type <U1", "dt: a single value")


def test_objects_of_python_are_refused(file: Path) -> None:
    objects = np.array([{}, print], dtype=object)
    with pytest.raises(InputError, match="objects of Python"):
        read(file, single(objects))
    recording = read(file, archive(q=ROWS, evil=objects))
    assert list(recording.tables[0].columns) == ["q[0]", "q[1]", "q[2]"]
    assert "objects of Python" in recording.left_out[0]


@pytest.mark.parametrize("array", [ROWS, FIELDS, ROWS[:, 0]])
def test_cut_arrays_give_all_whole_rows(file: Path, array: np.ndarray) -> None:
    data = single(array)
    start = len(data) - array.nbytes
    for cut in cuts(data, seed=2):
        whole = max(cut - start, 0) // (array.nbytes // len(array))
        recording = outcome(numpy_file.read, file, data[:cut])
        if isinstance(recording, InputError):
            assert whole == 0
            continue
        assert recording.tables[0].rows == whole
        first = next(iter(recording.tables[0].columns.values()))
        expected = array["time"] if array.dtype.names else array.reshape(len(array), -1)[:, 0]
        assert np.array_equal(first, expected[:whole])
        assert recording.damage == (f"the array is cut: {whole} of {len(array)} rows were read",)


@pytest.mark.parametrize("pack", [archive, compressed])
def test_cut_archives_give_all_whole_arrays(file: Path, pack: object) -> None:
    assert callable(pack)
    arrays = {f"a{k}": ROWS[:, k] + k for k in range(3)} | {"q": ROWS}
    data = pack(**arrays)
    ends = [info.header_offset for info in zipfile.ZipFile(io.BytesIO(data)).infolist()][1:]
    for cut in cuts(data, seed=3):
        recording = outcome(numpy_file.read, file, data[:cut])
        if isinstance(recording, InputError):
            assert cut < ends[0]
            continue
        columns = recording.tables[0].columns
        for name, end in zip(arrays, ends, strict=False):
            assert (name in columns) == (end <= cut)
            assert name not in columns or np.array_equal(columns[name], arrays[name])
        assert recording.damage or "q[2]" in columns


@pytest.mark.parametrize("shape", [(1 << 40,), (1 << 62, 1 << 62), (-1,), (2, -3), (1 << 40, 0), (0,) * 70])
@pytest.mark.parametrize("descr", ["<f8", "|V0", "|S0", [("a", "<f8", (0,))]])
def test_headers_that_ask_for_much(file: Path, shape: tuple[int, ...], descr: object) -> None:
    stream = io.BytesIO()
    npy.write_array_header_2_0(stream, {"descr": descr, "fortran_order": False, "shape": shape})  # type: ignore[arg-type]
    recording = outcome(numpy_file.read, file, stream.getvalue())
    assert isinstance(recording, InputError)


def test_a_bomb_is_refused(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(unpack, "MOST_BYTES", 8 << 20)
    data = compressed(a=np.zeros(1 << 19), b=np.zeros(1 << 20))
    for part in (data, data[:-60]):
        with pytest.raises(InputError, match="more than 8 MiB"):
            read(file, part)


@pytest.mark.parametrize("data", [b"", b"PK\x03\x04", b"a,b\n1,2\n", archive(), archive(a=np.array("x"))])
def test_files_without_numbers(file: Path, data: bytes) -> None:
    with pytest.raises(InputError, match="path: "):
        read(file, data)


def test_an_absent_file() -> None:
    with pytest.raises(InputError, match="cannot read"):
        numpy_file.read(Path("absent.npy"))


def test_broken_files(file: Path) -> None:
    several = {"time": ROWS[:, 0], "q": ROWS, "f": FIELDS}
    whole = [single(ROWS), single(FIELDS), archive(**several), compressed(**several)]
    check_broken(numpy_file.read, file, [*whole, single(np.asfortranarray(ROWS))], seed=4)
