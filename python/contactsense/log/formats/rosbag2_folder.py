"""Bags of rosbag2 that are a folder: all parts as one recording."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

from ..._extras import require
from ...errors import InputError
from ..recording import Recording
from . import mcap_file, rosbag2_sqlite
from .collect import Collector
from .mapping import ZSTD_ENDINGS
from .messages import IsWanted

METADATA = "metadata.yaml"
MAX_METADATA = 2**22  # bytes; the files of a bag with hundreds of topics have 2^18
PARTS = {".mcap": mcap_file.add, ".db3": rosbag2_sqlite.add}


def read(path: Path, is_wanted: IsWanted | None = None) -> Recording:
    """Reads all parts of a bag; `is_wanted(topic, type)` chooses other topics than usual.

    Raises:
        InputError: the folder has no readable part of a bag.
        MissingExtraError: rosbags is not installed.
    """
    require("log", "rosbags")
    collector = Collector(is_wanted)
    parts = _listed(path, collector.damage) or _found(path)
    errors = []
    for part in parts:
        try:
            PARTS[_ending(part.name)](part, collector)
        except (InputError, FileNotFoundError) as error:
            text = (
                str(error)
                if isinstance(error, InputError)
                else f"{part.name}: is listed in {METADATA}, but not there"
            )
            errors.append(text)
            collector.broken(text)
    if len(errors) == len(parts):
        raise InputError(errors[0] if errors else f"{path.name}: must have parts of a bag, .mcap or .db3")
    return collector.recording()


def _listed(path: Path, damage: list[str]) -> list[Path]:
    """The parts the bag's own list names, as far as they are plain names of files in the folder."""
    file = path / METADATA
    if not file.is_file():
        return []
    try:
        with file.open("rb") as opened:
            text = opened.read(MAX_METADATA + 1)
        if len(text) > MAX_METADATA:
            raise ValueError("too large")
        content: Any = yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
        names = content["rosbag2_bagfile_information"]["relative_file_paths"]
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise ValueError("no names")
    except (yaml.YAMLError, ValueError, KeyError, TypeError, RecursionError, AttributeError):
        damage.append(f"{METADATA}: is not readable; the parts are taken in the order of their names")
        return []
    parts = []
    for name in dict.fromkeys(names):
        if name == Path(name).name and "\\" not in name and "\0" not in name and _ending(name):
            parts.append(_as_stored(path / name))
        else:
            damage.append(
                f"{METADATA}: a part is left out, for its name is not that of a bag's file in the folder"
            )
    return parts


def _as_stored(part: Path) -> Path:
    """The part itself, or where it was compressed or unpacked since, that file."""
    if part.exists():
        return part
    others = (
        [part.with_suffix("")]
        if part.suffix in ZSTD_ENDINGS
        else [Path(f"{part}{end}") for end in ZSTD_ENDINGS]
    )
    return next((other for other in others if other.exists()), part)


def _found(path: Path) -> list[Path]:
    """All parts in the folder in natural order; one that is there packed and unpacked counts once."""
    parts: dict[str, Path] = {}
    for part in sorted(path.iterdir(), key=lambda part: (_natural(part.name), part.name)):
        if _ending(part.name) and part.is_file():
            parts.setdefault(re.sub(r"\.zstd?$", "", part.name, flags=re.I), part)
    return list(parts.values())


def _ending(name: str) -> str:
    plain = re.sub(r"\.zstd?$", "", name, flags=re.I)
    ending = Path(plain).suffix.lower()
    return ending if ending in PARTS else ""


def _natural(name: str) -> list[tuple[int, str]]:
    """Numbers within a name by their value: part 10 comes after part 9."""
    pieces = re.split(r"0*([0-9]+)", name)  # every second one is a number
    return [(len(piece) if i % 2 else 0, piece) for i, piece in enumerate(pieces)]
