"""Text files of numbers are read as people, programs and countries write them, as far as they are whole."""

from __future__ import annotations

import bz2
import csv
import gzip
import io
import lzma
from pathlib import Path

import numpy as np
import pytest
from mutations import check_broken, cuts, outcome
from robots import SHARED

from contactsense.errors import InputError
from contactsense.log.formats import text, unpack
from contactsense.log.recording import Recording

pa = pytest.importorskip("pyarrow")

ROWS = np.random.default_rng(1).normal(size=(40, 3)).round(6)


def plain(rows: np.ndarray = ROWS, end: str = "\n") -> str:
    return "".join(",".join(map(repr, map(float, row))) + end for row in rows)


def read(path: Path, data: str | bytes) -> Recording:
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return text.read(path)


def columns(recording: Recording) -> dict[str, list[float]]:
    (table,) = recording.tables
    return {name: column.tolist() for name, column in table.columns.items()}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "run 1.csv"


AB = {"a": [1.5, 2.5, -3.0], "b": [4.0, 5.0, 6.25]}


@pytest.mark.parametrize(
    "content",
    [
        "a,b\n1.5,4\n2.5,5\n-3,6.25\n",
        "a,b\r\n1.5,4\r\n2.5,5\r\n-3,6.25\r\n",
        "a,b\r1.5,4\r2.5,5\r-3,6.25\r",
        "a,b\n1.5,4\n2.5,5\n-3,6.25",
        "a;b\n1.5;4\n2.5;5\n-3;6.25\n",
        "a;b\n1,5;4\n2,5;5\n-3;6,25\n",
        "a\tb\n1.5\t4\n2.5\t5\n-3\t6.25\n",
        "a\tb\n1,5\t4\n2,5\t5\n-3\t6,25\n",
        "a|b\n1.5|4\n2.5|5\n-3|6.25\n",
        "a b\n1.5 4\n2.5 5\n-3 6.25\n",
        "  a     b\n 1.5  \t 4\n 2.5   5  \n  -3 6.25\n",
        "a b\n1,5 4\n2,5 5\n-3 6,25\n",
        "a, b\n1.5, 4\n 2.5, 5\n-3 , 6.25 \n",
        '"a","b"\n"1.5","4"\n"2.5","5"\n"-3","6.25"\n',
        '"a","b"\n"1,5","4"\n"2,5","5"\n"-3","6,25"\n',
        "# recorded on a Monday\n% with care\n\na,b\n1.5,4\n2.5,5\n-3,6.25\n",
        "# a b\n1.5 4\n2.5 5\n-3 6.25\n",
        "a,b\n+1.5,4.\n2.5e0,5E+00\n-30e-1,+6.25\n",
        "a,b\n1.5,4\n\n2.5,5\n\n-3,6.25\n\n",
        "a,b,\n1.5,4,\n2.5,5,\n-3,6.25,\n",
        "a,b\n[s],[rad]\n1.5,4\n2.5,5\n-3,6.25\n",
        "a,b\n1.5,4,\n2.5,5,\n-3,6.25,\n",
    ],
)
def test_dialects(file: Path, content: str) -> None:
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"):
        recording = read(file, content.encode(encoding))
        assert columns(recording) == AB
        assert recording.damage == recording.left_out == ()
        assert recording.tables[0].name == "run 1"
        assert recording.tables[0].received is None


@pytest.mark.parametrize(
    ("content", "names"),
    [
        ("1,2\n3,4\n", ["0", "1"]),
        ("- arm_1 ,τ [Nm]\n3,4\n", ["- arm_1", "τ [Nm]"]),
        ("q,q,q,q.1\n3,4,5,6\n", ["q", "q.1", "q.2", "q.1.1"]),
        (",q,\n3,4,5\n", ["0", "q", "2"]),
        ("q dq\nr1 3 4\nr2 5 6\n", ["q", "dq"]),
        ("q\n1\n2\n", ["q"]),
        ("1\n2\n", ["0"]),
        ("nan,2\n3,4\n", ["0", "1"]),
    ],
)
def test_names(file: Path, content: str, names: list[str]) -> None:
    assert list(columns(read(file, content))) == names


def test_latin_names(file: Path) -> None:
    assert list(columns(read(file, "Winkel [°],b\n1,2\n".encode("latin-1")))) == ["Winkel [°]", "b"]


@pytest.mark.parametrize(
    "missing", ["", "nan", "NaN", "NAN", "null", "NULL", "N/A", "None", " ", " nan", "-nan(ind)"]
)
def test_missing_cells(file: Path, missing: str) -> None:
    got = columns(read(file, f"a,b,c\n1,{missing},2\n3,4,5\n6,7,{missing}\n"))
    np.testing.assert_equal(got, {"a": [1, 3, 6], "b": [np.nan, 4, 7], "c": [2, 5, np.nan]})


def test_infinities_booleans_and_texts(file: Path) -> None:
    recording = read(file, "a,on,mode,b\n1,True,idle,inf\n2,false,move,-Infinity\n3,TRUE,5,ready\n4,,x,7\n")
    np.testing.assert_equal(
        columns(recording), {"a": [1, 2, 3, 4], "on": [1, 0, 1, np.nan], "b": [np.inf, -np.inf, np.nan, 7]}
    )
    assert recording.left_out == ("mode: a column of text",)


def test_text_far_below_the_beginning(file: Path) -> None:
    rows = ["a;b", *(f"{k};{k}" for k in range(3000)), "error;7,5", *(f"{k};0" for k in range(3000))]
    got = columns(read(file, "\n".join(rows) + "\n"))
    assert np.isnan(got["a"][3000])
    assert len(got["a"]) == 6001


def test_numbers_are_as_python_reads_them(file: Path) -> None:
    values = np.random.default_rng(2).normal(size=(2000, 5)) * 10.0 ** np.random.default_rng(3).integers(
        -300, 300, 5
    )
    got = np.stack(list(read(file, plain(values)).tables[0].columns.values()), 1)
    assert np.array_equal(got, values)


def test_rows_of_other_lengths_are_left_out_and_counted(file: Path) -> None:
    recording = read(file, 'a,b\n1,2\n3\n4,5,6\n7,"8\n9,10\n')
    assert columns(recording) == {"a": [1, 9], "b": [2, 10]}
    assert recording.damage == ("3 lines have not the 2 cells of the others: left out",)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_cut_files_give_all_whole_rows(file: Path, end: str) -> None:
    data = ("time,q,tau" + end + plain(end=end)).encode()
    first_row = data.index(end.encode()) + len(end)
    for cut in cuts(data, seed=4):
        whole = data[first_row:cut].replace(b"\r\n", b"\n").replace(b"\r", b"\n").count(b"\n")
        recording = outcome(text.read, file, data[:cut])
        if isinstance(recording, InputError):
            assert whole == 0
            continue
        if cut <= first_row:  # part of the header is a table of nothing
            continue
        got = np.stack(list(recording.tables[0].columns.values()), 1)
        assert len(got) in (whole, whole + 1)
        assert np.array_equal(got[:whole], ROWS[:whole])


def test_a_cut_row_is_named(file: Path) -> None:
    recording = read(file, "# made by hand\na,b\n1,2.25\n3,4.25\n5,6.2")
    assert columns(recording) == {"a": [1, 3], "b": [2.25, 4.25]}
    assert recording.damage == ("line 5 is cut: the 2 rows before it were read",)


def zstd(data: bytes) -> bytes:
    return bytes(pa.Codec("zstd").compress(data, asbytes=True))


@pytest.mark.parametrize(
    ("pack", "ending"), [(gzip.compress, "gz"), (bz2.compress, "bz2"), (lzma.compress, "xz"), (zstd, "zst")]
)
def test_compressed_files(tmp_path: Path, pack: object, ending: str) -> None:
    assert callable(pack)
    rows = np.random.default_rng(5).normal(size=(30_000, 3))
    packed, path = pack(plain(rows).encode()), tmp_path / f"log.csv.{ending}"
    recording = read(path, packed)
    assert recording.tables[0].name == "log"
    assert np.array_equal(np.stack(list(recording.tables[0].columns.values()), 1), rows)
    assert recording.damage == ()
    for cut in cuts(packed, seed=6, count=20):
        part = outcome(text.read, path, packed[:cut])
        if isinstance(part, Recording) and part.tables[0].rows > 1 and len(part.tables[0].columns) == 3:
            got = np.stack(list(part.tables[0].columns.values()), 1)
            assert np.array_equal(got, rows[: len(got)])
            assert part.damage


def test_a_compressed_file_cut_in_the_middle_gives_its_rows(tmp_path: Path) -> None:
    rows = np.random.default_rng(5).normal(size=(30_000, 3))
    packed = gzip.compress(plain(rows).encode())
    recording = read(tmp_path / "log.csv.gz", packed[: len(packed) // 2])
    assert 10_000 < recording.tables[0].rows < 20_000
    assert "could be unpacked" in recording.damage[0]


def test_members_one_after_another(tmp_path: Path) -> None:
    packed = b"".join(gzip.compress(row.encode()) for row in plain().splitlines(keepends=True))
    assert read(tmp_path / "a.csv.gz", packed + b"\0" * 512).tables[0].rows == len(ROWS)


@pytest.mark.parametrize("pack", [gzip.compress, bz2.compress, lzma.compress, zstd, bytes])
def test_a_bomb_is_refused(tmp_path: Path, pack: object, monkeypatch: pytest.MonkeyPatch) -> None:
    assert callable(pack)
    monkeypatch.setattr(unpack, "MOST_BYTES", 8 << 20)
    with pytest.raises(InputError, match="more than 8 MiB"):
        read(tmp_path / "a.csv.gz", pack(b"1,2\n" * (3 << 20)))


@pytest.mark.parametrize(
    "content", [b"", b"\n\n", b"# nothing\n", b"a,b\n", b"\x7fELF\x01\0\0\0\0\0", b"hello"]
)
def test_files_without_numbers(file: Path, content: bytes) -> None:
    with pytest.raises(InputError, match=r"^path: "):
        read(file, content)


@pytest.mark.parametrize("path", [Path("absent.csv"), Path("a\0b"), Path()])
def test_files_that_cannot_be_read(path: Path) -> None:
    with pytest.raises(InputError, match=r"^path: cannot read"):
        text.read(path)


def test_broken_files(file: Path) -> None:
    table = "time;q;mode;ok\n" + "".join(f"{k / 7:.4f};{k}e-3;idle;True\n" for k in range(50))
    quoted = '"a","b"\n' + '"1,5","x ""y"""\n' * 30
    whole = [plain(), table, table.replace(".", ","), quoted, plain(end="\r\n").replace(",", "  ")]
    packed = [
        gzip.compress(whole[0].encode()),
        bz2.compress(whole[1].encode()),
        lzma.compress(whole[2].encode()),
    ]
    texts = [content.encode() for content in whole]
    check_broken(text.read, file, [*texts, whole[0].encode("utf-16"), *packed, zstd(texts[1])], seed=7)


@pytest.mark.shared
def test_real_files() -> None:
    paths = sorted((SHARED / "real").glob("*/*.csv.gz"))
    assert len(paths) >= 13
    for path in paths:
        recording = text.read(path)
        with gzip.open(path, "rt", newline=None) as stream:
            header, *rows = csv.reader(io.StringIO(stream.read()))
        (table,) = recording.tables
        assert list(table.columns) == [name.strip() for name in header if name != "_id"]
        assert recording.damage == ()
        for index, name in enumerate(header):
            if name == "_id":
                continue
            expected = [float(row[index] or "nan") for row in rows]
            np.testing.assert_array_equal(table.columns[name.strip()], expected)
