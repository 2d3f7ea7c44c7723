"""Files of MATLAB 7.3 are read as MATLAB shows them, and nothing outside them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mutations import CASES, check_broken, cuts, outcome

from contactsense.errors import InputError
from contactsense.log.formats import matlab

h5py = pytest.importorskip("h5py")
ROWS = np.random.default_rng(1).normal(size=(60, 7))
HEAD = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Nov  2 2026 HDF5 schema 1.00 .".ljust(512)


def put(group: object, name: str, value: object, kind: str = "double", **options: object) -> None:
    """Writes a value as MATLAB does: axes in the order of Fortran, at least two of them, and its class."""
    array = np.atleast_2d(np.asarray(value))
    data = group.create_dataset(name, data=array.T, **options)  # type: ignore[attr-defined]
    data.attrs["MATLAB_class"] = np.bytes_(kind)


def made(path: Path, fill: Callable[[object], None], head: bytes = HEAD) -> bytes:
    with h5py.File(path, "w", userblock_size=len(head)) as file:
        fill(file)
    data = head + path.read_bytes()[len(head) :]
    path.write_bytes(data)
    return data


def robot(file: object) -> None:
    put(file, "t", ROWS[:, :1], compression="gzip", shuffle=True)
    log = file.create_group("log")  # type: ignore[attr-defined]
    put(log, "q", ROWS, chunks=(7, 16), compression="gzip", fletcher32=True)
    put(log, "on", ROWS[:, 0] > 0, "logical")
    put(log.create_group("tip"), "force", ROWS[:, :3].T.astype(np.float32), "single")
    put(log, "name", np.frombuffer("arm".encode("utf-16-le"), np.uint16), "char")
    put(log, "dt", 0.001)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "run.mat"


@pytest.mark.parametrize("head", [HEAD, b""])
def test_structures_and_axes(file: Path, head: bytes) -> None:
    made(file, robot, head)
    recording = matlab.read(file)
    (table,) = recording.tables
    got = table.columns
    assert set(got) == {
        "t",
        "log.on",
        *(f"log.q[{k}]" for k in range(7)),
        *(f"log.tip.force[{k}]" for k in range(3)),
    }
    assert (table.name, table.kind, table.rows, table.received) == ("run", "", 60, None)
    assert np.array_equal(np.stack([got[f"log.q[{k}]"] for k in range(7)], 1), ROWS)
    assert np.array_equal(got["t"], ROWS[:, 0])
    assert np.array_equal(got["log.on"], ROWS[:, 0] > 0)
    # Signals in rows: time is the axis that other vectors have.
    assert np.array_equal(got["log.tip.force[2]"], ROWS[:, 2].astype(np.float32))
    assert sorted(recording.left_out) == ["log.dt: a single value", "log.name: of MATLAB's class char"]
    assert recording.damage == ()


def test_a_matrix_alone_has_its_rows(file: Path) -> None:
    made(file, lambda root: put(root, "q", ROWS))
    columns = matlab.read(file).tables[0].columns
    assert np.array_equal(np.stack(list(columns.values()), 1), ROWS)


def test_tables_of_several_lengths(file: Path) -> None:
    def fill(root: object) -> None:
        for name, rows in (("slow", 10), ("fast", 100)):
            group = root.create_group(name)  # type: ignore[attr-defined]
            put(group, "t", np.arange(rows))
            put(group, "q", ROWS[:10].repeat(rows // 10, 0))

    made(file, fill)
    tables = matlab.read(file).tables
    assert [(table.name, table.rows) for table in tables] == [("fast", 100), ("slow", 10)]
    assert "fast.q[6]" in tables[0].columns


def test_complex_numbers(file: Path) -> None:
    def fill(root: object) -> None:
        pairs = np.zeros((1, 5), [("real", "f8"), ("imag", "f8")])
        pairs["imag"] = np.arange(5)
        put(root, "z", pairs)

    made(file, fill)
    columns = matlab.read(file).tables[0].columns
    assert np.array_equal(columns["z.imag"], np.arange(5))
    assert list(columns) == ["z.real", "z.imag"]


def test_cells_and_empty_arrays_are_left_out(file: Path) -> None:
    def fill(root: object) -> None:
        robot(root)
        cell = root.create_dataset("cell", (2, 1), dtype=h5py.ref_dtype)  # type: ignore[attr-defined]
        cell[0, 0] = root["t"].ref  # type: ignore[index]
        put(root, "none", np.zeros(2, np.uint64))
        root["none"].attrs["MATLAB_empty"] = 1  # type: ignore[index]
        put(root.create_group("#refs#"), "a", ROWS)  # type: ignore[attr-defined]
        root["soft"] = h5py.SoftLink("/t")  # type: ignore[index]

    made(file, fill)
    recording = matlab.read(file)
    assert len(recording.tables[0].columns) == 12
    assert {"cell: of type object", "none: empty", "soft: refers to another place"} < set(recording.left_out)


def external_link(root: object) -> None:
    root["away"] = h5py.ExternalLink("/etc/passwd", "/")  # type: ignore[index]


def external_numbers(root: object) -> None:
    root.create_dataset("away", (10,), "u1", external=[("/etc/passwd", 0, 10)])  # type: ignore[attr-defined]


def virtual(root: object) -> None:
    layout = h5py.VirtualLayout((10,), "f8")
    layout[:] = h5py.VirtualSource("other.h5", "a", (10,))
    root.create_virtual_dataset("away", layout)  # type: ignore[attr-defined]


@pytest.mark.parametrize("fill", [external_link, external_numbers, virtual])
def test_other_files_are_not_opened(file: Path, fill: Callable[[object], None]) -> None:
    def both(root: object) -> None:
        robot(root)
        fill(root)

    made(file, both)
    with pytest.raises(InputError, match="another file, which is not opened"):
        matlab.read(file)


def test_groups_in_a_circle(file: Path) -> None:
    def fill(root: object) -> None:
        root["again"] = root  # type: ignore[index]

    made(file, fill)
    with pytest.raises(InputError, match="circle"):
        matlab.read(file)


def test_arrays_that_are_not_in_the_file(file: Path) -> None:
    def fill(root: object) -> None:
        put(root, "t", ROWS[:, 0])
        root.create_dataset("huge", (1 << 40, 8), "f8", chunks=(1024, 8))  # type: ignore[attr-defined]

    made(file, fill)
    recording = matlab.read(file)
    assert recording.left_out == (f"huge: its {8 * 8 << 40} bytes are not in the file",)


def test_a_bomb_is_refused(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made(file, lambda root: put(root, "a", np.zeros((1 << 20, 2)), compression="gzip"))
    monkeypatch.setattr(matlab, "MOST_BYTES", 8 << 20)
    with pytest.raises(InputError, match="more than 8 MiB"):
        matlab.read(file)


def test_older_versions_say_how_to_save(file: Path) -> None:
    file.write_bytes(b"MATLAB 5.0 MAT-file, Platform: PCWIN64".ljust(200))
    with pytest.raises(InputError, match=r"save it with -v7\.3"):
        matlab.read(file)


@pytest.mark.parametrize("data", [b"", b"t,q\n1,2\n", HEAD, HEAD + b"\x89HDF\r\n\x1a\n"])
def test_files_without_numbers(file: Path, data: bytes) -> None:
    assert isinstance(outcome(matlab.read, file, data), InputError)


def test_an_absent_file() -> None:
    with pytest.raises(InputError, match="cannot read"):
        matlab.read(Path("absent.mat"))


def test_cut_files_are_refused(file: Path) -> None:
    data = made(file, robot)
    for cut in cuts(data, seed=2):
        error = outcome(matlab.read, file, data[:cut])
        assert isinstance(error, InputError)
        assert cut < 600 or f"it is cut: {cut} of {len(data)} bytes" in str(error)


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("import os; os.abort()", "it is broken: HDF5 ended with -6"),
        ("while True: pass", "HDF5 came to no end in 1 s"),
        ("raise RuntimeError('why')", "it is broken: HDF5 ended with 1 RuntimeError: why"),
    ],
)
def test_what_ends_hdf5_does_not_end_this_process(
    file: Path, program: str, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    made(file, robot)
    (file.parent / "program.py").write_text(program)
    monkeypatch.setattr(matlab, "_PROGRAM", file.parent / "program.py")
    monkeypatch.setattr(matlab, "_PATIENCE", 1 if "while" in program else 60)
    with pytest.raises(InputError, match=message):
        matlab.read(file)


def test_broken_files(file: Path) -> None:
    whole = [made(file, robot), made(file, robot, b""), made(file, lambda root: put(root, "q", ROWS))]
    # A tenth, as each starts a program.
    check_broken(matlab.read, file, whole, seed=3, cases=CASES // 10)
