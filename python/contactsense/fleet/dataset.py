"""The data set of a fleet: Parquet tables, partitioned by robot, with one file a log.

    TABLE/robot=NAME/LOG.parquet

The file of a log in the table `logs` is written last: where it is, those in the other tables are complete.
"""

from __future__ import annotations

import hashlib
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

# Files under way are here, which readers of data sets pass over, until they are whole.
_UNFINISHED = ".unfinished"
LOGS = "logs"
_TABLES = (LOGS, "contacts", "contact_ticks", "ticks")
# Hexadecimal digits of a log's name: of a million logs, two share one with a chance of 3 in 10^8.
_DIGITS = 16


@dataclass(frozen=True)
class Part:
    """What a data set has of one log.

    Args:
        folder: of the data set.
        robot: name of the robot.
        log: its path, which must be absolute: the same from wherever it is replayed.
    """

    folder: Path
    robot: str
    log: Path

    @property
    def _file(self) -> Path:
        name = hashlib.sha256(str(self.log).encode()).hexdigest()[:_DIGITS]
        return Path(_partition(self.robot)) / f"{name}.parquet"

    def write(self, tables: Mapping[str, Any]) -> None:
        """Takes the place of what there was of the log; `tables` must end with the table `logs`."""
        import pyarrow.parquet

        # Each writer has a folder of its own: one that was left alive by a killed run cannot spoil the files.
        under_way = self.folder / _UNFINISHED / self._file.parent
        under_way.mkdir(parents=True, exist_ok=True)
        unfinished = Path(tempfile.mkdtemp(dir=under_way))
        for name, table in tables.items():
            pyarrow.parquet.write_table(table, unfinished / name)
        self.remove()
        for name in tables:
            wanted = self.folder / name / self._file
            wanted.parent.mkdir(parents=True, exist_ok=True)
            (unfinished / name).replace(wanted)
        unfinished.rmdir()

    def remove(self) -> None:
        """Removes what there is of the log, from the table on that says it is complete."""
        for name in _TABLES:
            (self.folder / name / self._file).unlink(missing_ok=True)

    def damage(self, made_from: str) -> str | None:
        """Where the log is broken, or ""; None where there are no results of this log and these settings."""
        import pyarrow
        import pyarrow.parquet

        try:
            table = pyarrow.parquet.ParquetFile(self.folder / LOGS / self._file).read(["input", "damage"])
        except (OSError, pyarrow.ArrowException):
            return None
        (row,) = table.to_pylist()
        return str(row["damage"]) if row["input"] == made_from else None


def clear_unfinished(folder: Path, robot: str) -> None:
    """Removes what a run that was killed has left under way."""
    shutil.rmtree(folder / _UNFINISHED / _partition(robot), ignore_errors=True)
    if (folder / _UNFINISHED).is_dir() and not any((folder / _UNFINISHED).iterdir()):
        (folder / _UNFINISHED).rmdir()


def _partition(robot: str) -> str:
    return f"robot={quote(robot, safe='')}"
