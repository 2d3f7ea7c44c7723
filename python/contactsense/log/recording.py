"""What a file holds before anything in it has a meaning: tables of numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Table:
    """One table of a file, or all messages of one topic that have the same columns.

    Args:
        name: the topic, or the file's name without its ending.
        kind: the message type as ROS writes it, such as `sensor_msgs/msg/JointState`; empty for other files.
        columns: `(n,)` each, by name. Those of messages are named by field, such as `wrench.force.x`;
            elements of arrays are named as `tau_J[0]`, and those of a `JointState` by joint, as
            `position[panda_joint1]`. The message's own stamp is `header.stamp` [s].
        received: `(n,)`, when each message was received [s]; None for files other than bags.
        frames: the names of frames in the messages, by field: `header.frame_id`, `child_frame_id`.
    """

    name: str
    kind: str
    columns: Mapping[str, Column]
    received: Column | None = None
    frames: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(next(iter(self.columns.values()), ()))


@dataclass(frozen=True)
class Recording:
    """All that could be read of a file or a folder.

    Args:
        tables: in the order of the file.
        left_out: what else the file has, one line each: topics of types without numbers, or without a
            definition.
        damage: where the file is broken, one line each, with what could be read nevertheless; empty for a
            whole one.
    """

    tables: tuple[Table, ...]
    left_out: tuple[str, ...] = ()
    damage: tuple[str, ...] = ()


def listing(recording: Recording) -> str:
    """The first columns of all tables, for messages."""
    shown = 12
    tables = []
    for table in recording.tables:
        names = [f"'{name}'" for name in list(table.columns)[:shown]]
        more = len(table.columns) - shown
        tables.append(f"{table.name}: {', '.join(names)}{f' and {more} more' if more > 0 else ''}")
    return "; ".join(tables) or "no columns of numbers"
