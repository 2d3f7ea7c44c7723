"""The task of a fleet: one log, from its file to its part of the data set."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import ContactSenseError
from ..log import read_log
from ..offline import Replay, replay
from ..offline.monitor_of import classifier_of, monitor_of
from ..offline.parquet import as_table, replay_tables
from .dataset import LOGS, Part
from .settings import Settings


@dataclass(frozen=True)
class Outcome:
    """What became of one log.

    Args:
        failure: why it could not be replayed; empty where it was.
        damage: where its file is broken; empty where it is whole.
    """

    failure: str = ""
    damage: str = ""


def replay_log(settings: Settings, path: Path) -> Outcome:
    """Replays a log, and writes its part; whatever goes wrong is an outcome, so that others go on."""
    try:
        made_from = settings.input_of(path)
        log = read_log(path, settings.robot, **settings.reading)
        monitor = monitor_of(log, settings.robot, **settings.monitor)
        result = replay(log, monitor, classifier=classifier_of(monitor, settings.classifier))
        if result.interrupted:
            return Outcome(failure="interrupted")
        damage = "" if log.reading is None else "; ".join(log.reading.damage)
        Part(settings.folder, settings.name, path).write(
            _tables(result, path, made_from, damage, settings.ticks)
        )
    except ContactSenseError as error:
        return Outcome(failure=str(error))
    except Exception as error:
        return Outcome(failure=f"{type(error).__name__}: {error}")
    return Outcome(damage=damage)


def _tables(result: Replay, path: Path, made_from: str, damage: str, ticks: bool) -> dict[str, Any]:
    """Arrow tables by name; each has the log's path as its first column."""
    import pyarrow as pa

    time, collision = result.ticks["time"], result.ticks["collision"]
    seconds = float(time[-1] - time[0])
    row = {
        "start": float(time[0]),
        "seconds": seconds,
        "rows": len(time),
        "contacts": len(result.contacts),
        "contact_seconds": float(np.mean(collision)) * seconds,
        "damage": damage,
        "input": made_from,
    }
    found = replay_tables(result.contacts, result.contact_ticks, result.ticks)
    tables = {name: as_table(columns) for name, columns in found.items()}
    if not ticks:
        del tables["ticks"]
    tables[LOGS] = pa.table({name: [value] for name, value in row.items()})
    log = pa.scalar(str(path))
    return {
        name: table.add_column(0, "log", pa.repeat(log, table.num_rows)) for name, table in tables.items()
    }
