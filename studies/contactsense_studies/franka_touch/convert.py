"""Makes the logs of this study from the public ones of MindLabZHAW/tactileGestureDetection (MIT licence).

The logs of the published figures, about 30 MB, without the rest of the repository:

    git clone --filter=blob:none --no-checkout https://github.com/MindLabZHAW/tactileGestureDetection
    cd tactileGestureDetection/
    logs=dataset/labeledData/configuration1
    git checkout d8aae2fbf69f290a71c931c3d9808473b16124cc -- $logs/a4 $logs/b6 $logs/c2 $logs/c5 $logs/f2
    git checkout 2a3ecad21211e8cacb48a24155dc98f0c2800233 -- $logs/a5 $logs/b8 $logs/d5
    python -m contactsense_studies.franka_touch.convert . ../franka_touch

The study then runs with `contactsense study franka_touch --data ../franka_touch`.
"""

from __future__ import annotations

import argparse
import gzip
import os
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from contactsense import ContactSenseError, InputError

from .logs import COLUMNS, FILE_NAME, read_table

REPOSITORY = "https://github.com/MindLabZHAW/tactileGestureDetection"
# Inside the public repository; each log has a folder of its own.
LABELLED = Path("dataset/labeledData/configuration1")
FILE = "labeled_data.csv"
# The logs of the published figures, of the sixteen there.
LOGS = ("a4", "a5", "b6", "b8", "c2", "c5", "d5", "f2")
# The sensors' torques are single precision, whose numbers have seven digits.
DIGITS = 7


def convert(
    source: str | os.PathLike[str], target: str | os.PathLike[str], logs: Sequence[str] = LOGS
) -> list[Path]:
    """Writes logs of a checkout of the public repository as `NAME.csv.gz` into a folder; returns the files.

    Nothing is written unless all logs can be read.

    Raises:
        InputError: a log is not there or cannot be used, or the folder cannot be written to.
    """
    folder = Path(source) / LABELLED
    if not folder.is_dir():
        raise InputError(
            f"source: '{source}' has no folder {LABELLED}; it should be a checkout of {REPOSITORY}"
        )
    tables = {}
    for name in logs:
        if not FILE_NAME.fullmatch(f"{name}.csv"):
            raise InputError(f"logs: '{name}' is no log; a name is the letter of the link and a number: a4")
        tables[name] = read_table(folder / name / FILE)
    written = []
    try:
        Path(target).mkdir(parents=True, exist_ok=True)
        for name, table in tables.items():
            path = Path(target) / f"{name}.csv.gz"
            _write(path, table)
            written.append(path)
    except OSError as cause:
        raise InputError(f"target: cannot write into '{target}': {cause.strerror or cause}") from cause
    return written


def _write(path: Path, table: np.ndarray) -> None:
    # Without a time stamp the same log always makes the same file.
    with path.open("wb") as raw, gzip.GzipFile(fileobj=raw, mode="wb", filename="", mtime=0) as file:
        np.savetxt(file, table, f"%.{DIGITS}g", ",", header=",".join(COLUMNS), comments="")


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line; returns the exit code."""
    parser = argparse.ArgumentParser(
        prog="python -m contactsense_studies.franka_touch.convert",
        description="Converts the labelled logs of MindLabZHAW/tactileGestureDetection.",
    )
    parser.add_argument("source", help=f"checkout of {REPOSITORY}, with its folder {LABELLED}")
    parser.add_argument("target", help="folder to write NAME.csv.gz to")
    parser.add_argument("--logs", nargs="+", default=LOGS, metavar="NAME", help=f"default: {' '.join(LOGS)}")
    given = parser.parse_args(arguments)
    try:
        for path in convert(given.source, given.target, given.logs):
            print(path)
    except ContactSenseError as error:
        print(f"convert: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
