"""Recordings of MindLabZHAW/tactileGestureDetection as the logs that `contactsense study franka_touch` reads.

    python -m tools.franka_touch RECORDINGS LOGS

RECORDINGS holds one folder per recording with a `labeled_data.csv`, or one file `NAME.csv` per recording. A
recording is named by the letter of the contact link (a: link 7, to g: link 1) and a number: a4. See
docs/franka_logs.md.
"""

from __future__ import annotations

import argparse
import csv
import gzip
import re
import sys
from pathlib import Path

JOINTS = 7
COLUMNS = (
    "time",
    *(f"{name}{joint}" for name in ("q", "dq", "tau_J", "tau_ext") for joint in range(JOINTS)),
    "label",
)
NAME = re.compile(r"[a-g]\d+")
DIGITS = 7  # significant digits; the robot sends single precision


class RecordingError(ValueError):
    """A recording that cannot be converted; the message names the file."""


def recordings(folder: Path) -> dict[str, Path]:
    """The files of all recordings by name.

    Raises:
        RecordingError: there is none.
    """
    files = {path.parent.name: path for path in sorted(folder.glob("*/labeled_data.csv"))}
    files |= {path.stem: path for path in sorted(folder.glob("*.csv"))}
    named = {name: path for name, path in files.items() if NAME.fullmatch(name)}
    if not named:
        raise RecordingError(
            f"'{folder}' holds no recording such as a4/labeled_data.csv or a4.csv (letters a to g)"
        )
    return named


def convert(source: Path, target: Path) -> int:
    """Writes the columns of the study, gzipped; returns the number of rows.

    Raises:
        RecordingError: a column is missing or a value is not a number; names row and column.
    """
    with source.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        missing = [column for column in COLUMNS if column not in (reader.fieldnames or ())]
        if missing:
            raise RecordingError(f"'{source}' lacks the columns {', '.join(missing)}")
        lines = [",".join(COLUMNS)]
        for number, row in enumerate(reader, start=1):
            lines.append(",".join(_value(source, number, column, row[column]) for column in COLUMNS))
    # Without name and time of the file, equal recordings give equal logs.
    with target.open("wb") as file, gzip.GzipFile("", "wb", fileobj=file, mtime=0) as packed:
        packed.write(("\n".join(lines) + "\n").encode())
    return len(lines) - 1


def _value(source: Path, row: int, column: str, text: str | None) -> str:
    try:
        value = float(text or "")
    except ValueError:
        raise RecordingError(f"'{source}', row {row}, column {column}: '{text}' is not a number") from None
    # A label may be the number of a gesture; the study asks only whether there is a contact.
    return str(int(value != 0)) if column == "label" else f"{value:.{DIGITS}g}"


def main() -> int:
    """Runs the command line; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tools.franka_touch", description=__doc__.splitlines()[0])
    parser.add_argument("recordings", type=Path, help="folder of the recordings")
    parser.add_argument("logs", type=Path, help="folder to write to")
    arguments = parser.parse_args()
    try:
        arguments.logs.mkdir(parents=True, exist_ok=True)
        for name, path in recordings(arguments.recordings).items():
            rows = convert(path, arguments.logs / f"{name}.csv.gz")
            print(f"{name}.csv.gz: {rows} rows")
    except (RecordingError, OSError) as error:
        print(f"franka_touch: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
