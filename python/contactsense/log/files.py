"""Which reader a file needs, by its first bytes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path

from ..errors import InputError
from .recording import Recording

_BAGS = (".db3", ".mcap", ".db3.zstd", ".mcap.zstd")
_MAGIC = (
    (b"\x89MCAP0\r\n", "mcap_file"),
    (b"SQLite format 3\x00", "rosbag2_sqlite"),
    (b"#ROSBAG V", "rosbag1"),
    (b"PAR1", "parquet"),
    (b"PK\x03\x04", "numpy_file"),
    (b"\x93NUMPY", "numpy_file"),
    (b"\x89HDF\r\n\x1a\n", "matlab"),
    (b"MATLAB ", "matlab"),
)
# Readers that look at wanted topics alone.
_WITH_TOPICS = frozenset({"mcap_file", "rosbag2_sqlite", "rosbag1", "rosbag2_folder"})


def read_recording(paths: Sequence[Path], topics: Sequence[str] | None = None) -> Recording:
    """All tables of some files; with `topics`, those alone.

    Raises:
        InputError: a file cannot be read, or none of its tables is one of `topics`.
        MissingExtraError: a format needs a package of the extra `log`.
    """
    if not paths:
        raise InputError("path: no file")
    parts = [part for path in paths for part in _read(path, topics)]
    tables = [table for part in parts for table in part.tables]
    if topics is not None:
        names = dict.fromkeys(table.name for table in tables)
        missing = [topic for topic in topics if topic not in names]
        if missing:
            raise InputError(
                f"topics: there is no {', '.join(missing)}; there are {', '.join(names) or 'none'}"
            )
        tables = [table for table in tables if table.name in topics]
    left_out = tuple(line for part in parts for line in part.left_out)
    damage = tuple(line for part in parts for line in part.damage)
    return Recording(tuple(tables), left_out, damage)


def _read(path: Path, topics: Sequence[str] | None) -> list[Recording]:
    if not path.is_dir():
        return [_reader(kind_of(path), topics)(path)]
    files = sorted(file for file in path.iterdir() if file.is_file())
    if any(file.name.endswith(_BAGS) for file in files):
        return [_reader("rosbag2_folder", topics)(path)]
    tables = [file for file in files if _is_table(file)]
    if not tables:
        raise InputError(f"path: the folder '{path}' has neither a bag nor files of numbers")
    return [_reader(kind_of(file), topics)(file) for file in tables]


def kind_of(path: Path) -> str:
    """The module of `formats` that reads a file."""
    with path.open("rb") as file:
        start = file.read(16)
    known = next((kind for magic, kind in _MAGIC if start.startswith(magic)), None)
    if known is None and path.name.endswith(_BAGS):
        return "mcap_file" if ".mcap" in path.name else "rosbag2_sqlite"
    return known or "text"


def _is_table(file: Path) -> bool:
    endings = (".csv", ".tsv", ".txt", ".dat", ".parquet", ".npz", ".npy", ".mat")
    packed = ("", ".gz", ".bz2", ".xz", ".zst")
    return any(file.name.lower().endswith(ending + end) for ending in endings for end in packed)


def _reader(kind: str, topics: Sequence[str] | None) -> Callable[[Path], Recording]:
    read: Callable[..., Recording] = import_module(f".formats.{kind}", __package__).read
    if topics is None or kind not in _WITH_TOPICS:
        return read
    return lambda path: read(path, lambda topic, _: topic in topics)
