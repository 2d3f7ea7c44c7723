"""What a fleet has felt, by robot and by link."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_HOUR = 3600.0  # [s]


@dataclass(frozen=True)
class RobotSummary:
    """One robot: number of logs, their time [h], number of contacts, and the share of time in contact."""

    robot: str
    logs: int
    hours: float
    contacts: int
    in_contact: float

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name."""
        return asdict(self)


@dataclass(frozen=True)
class LinkSummary:
    """One link: number of contacts, contacts an hour, share located, median of the peak forces [N]."""

    robot: str
    link: str
    contacts: int
    an_hour: float
    located: float
    peak_force: float

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name; None where no force is known."""
        return {**asdict(self), "peak_force": self.peak_force if np.isfinite(self.peak_force) else None}


def robots_of(folder: str | os.PathLike[str]) -> list[RobotSummary]:
    """One row a robot of a data set, by name."""
    logs = _columns(folder, "logs", "robot", "seconds", "contacts", "contact_seconds")
    found = []
    for robot in np.unique(logs["robot"]):
        own = logs["robot"] == robot
        seconds, contacts = float(logs["seconds"][own].sum()), int(logs["contacts"][own].sum())
        in_contact = float(logs["contact_seconds"][own].sum()) / seconds
        found.append(RobotSummary(str(robot), int(own.sum()), seconds / _HOUR, contacts, in_contact))
    return found


def links_of(folder: str | os.PathLike[str]) -> list[LinkSummary]:
    """One row a link of a data set; of each robot, those that are touched most often first."""
    contacts = _columns(folder, "contacts", "robot", "link", "located", "peak_force")
    found = []
    for robot in robots_of(folder):
        own = contacts["robot"] == robot.robot
        links, counts = np.unique(contacts["link"][own], return_counts=True)
        for link, count in sorted(zip(links, counts, strict=True), key=lambda pair: -pair[1]):
            rows = own & (contacts["link"] == link)
            forces = contacts["peak_force"][rows]
            forces = forces[np.isfinite(forces)]
            peak = float(np.median(forces)) if len(forces) else np.nan
            located = float(np.mean(contacts["located"][rows]))
            found.append(LinkSummary(robot.robot, str(link), int(count), count / robot.hours, located, peak))
    return found


def places_of(
    folder: str | os.PathLike[str], robot: str
) -> tuple[list[str], NDArray[np.float64], NDArray[np.float64]]:
    """Links, points `(n, 3)` in their frames [m] and peak forces [N] of a robot's contacts with a point."""
    contacts = _columns(folder, "contacts", "robot", "link", "point_local", "peak_force")
    points = np.array(contacts["point_local"].tolist(), dtype=np.float64).reshape(-1, 3)
    rows = (contacts["robot"] == robot) & np.all(np.isfinite(points), axis=1)
    return contacts["link"][rows].tolist(), points[rows], contacts["peak_force"][rows]


def _columns(folder: str | os.PathLike[str], table: str, *names: str) -> dict[str, NDArray[Any]]:
    import pyarrow as pa
    import pyarrow.dataset as ds

    # A robot may be named by a number.
    names_of_robots = ds.partitioning(pa.schema([("robot", pa.string())]), flavor="hive")
    data = ds.dataset(Path(folder) / table, partitioning=names_of_robots, format="parquet")
    found = data.to_table(columns=list(names))
    return {
        name: column.to_numpy() if pa.types.is_primitive(column.type) else np.array(column.to_pylist())
        for name, column in zip(names, found.columns, strict=True)
    }
