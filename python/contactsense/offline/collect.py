"""Columns of what a monitor says, tick by tick."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..log import Log
from .result import Replay
from .summary import PROBABILITIES, contacts_of

Column = NDArray[np.float64]

# Of a contact, in the order of the columns.
_NUMBERS = ("probability", "point_std", "region_radius")
_VECTORS = ("point", "point_local", "force")
_NOT_KNOWN = (np.nan,) * len(PROBABILITIES)


class Collector:
    """Takes in the reports of a log's rows."""

    def __init__(self, log: Log, monitor: _core.ContactMonitor, *, classified: bool) -> None:
        robot = monitor.robot
        self._log, self._robot, self._sensors = log, robot, monitor.sensors
        rows = len(log)
        self._collision = np.zeros(rows, dtype=bool)
        self._onset = np.zeros(rows, dtype=bool)
        self._significance = np.full(rows, np.nan)
        self._external = np.zeros((rows, robot.nv))
        # One number for each contact in each tick: contacts themselves would take kilobytes.
        self._rows, self._ids = array("q"), array("q")
        self._links: list[str] = []
        self._located = array("b")
        self._values = array("d")
        self._classes = array("d") if classified else None
        # The last class of each contact of the classifier, and the contacts of the monitor that it was.
        self._last: dict[int, _core.ContactClass] = {}
        self._classified: dict[int, set[int]] = {}
        self._done = 0
        self._episodes = 0
        # Of contacts that the monitor does not follow: by episode and place in the report.
        self._unnamed: dict[tuple[int, int], int] = {}
        # The row of each onset, and of each contact's begin; the last episode with a contact.
        self._onsets, self._begins = array("q"), dict[int, int]()
        self._filled = 0

    def add(
        self,
        rows: slice,
        collision: Column,
        onset: Column,
        significance: Column,
        external: Column,
        contacts: Sequence[tuple[int, tuple[_core.Contact, ...]]],
        classes: Sequence[tuple[int, int, int | None, _core.ContactClass]],
    ) -> None:
        """What the monitor says of the next rows; `contacts` has those of each row that has some.

        `classes` has for each row, contact of the classifier and place among the row's contacts its class.
        """
        self._collision[rows] = collision
        self._onset[rows] = onset
        self._significance[rows] = significance
        self._external[rows] = external.reshape(-1, self._external.shape[1])
        episodes = self._episodes + np.cumsum(onset)
        self._onsets.extend(rows.start + np.flatnonzero(onset))
        self._last |= {which: each for _, which, _, each in classes}
        placed = {(row, place): (which, each) for row, which, place, each in classes if place is not None}
        for row, several in contacts:
            for k, contact in enumerate(several):
                number = self._add_contact(rows.start + row, (int(episodes[row]), k), contact)
                self._add_class(number, placed.get((row, k)))
        self._episodes = int(episodes[-1])
        self._done = rows.stop

    def _add_contact(self, row: int, unnamed: tuple[int, int], contact: _core.Contact) -> int:
        number = contact.id
        if number is None:
            number = self._unnamed.setdefault(unnamed, len(self._unnamed))
        episode, _ = unnamed
        # The first contact of an episode began with it: its first ticks may not tell a place yet.
        begin = self._onsets[episode - 1] if episode > self._filled else row
        self._begins.setdefault(number, begin)
        self._filled = episode
        self._rows.append(row)
        self._ids.append(number)
        self._links.append(contact.link)
        self._located.append(contact.located)
        self._values.append(contact.link_probabilities.get(contact.link, np.nan))
        for name in _NUMBERS:
            self._values.append(getattr(contact, name))
        for name in _VECTORS:
            self._values.extend(getattr(contact, name))
        return number

    def _add_class(self, number: int, found: tuple[int, _core.ContactClass] | None) -> None:
        if self._classes is None:
            return
        if found is None:
            self._classes.extend(_NOT_KNOWN)
            return
        which, each = found
        self._classified.setdefault(number, set()).add(which)
        self._classes.extend(getattr(each, name) for name in PROBABILITIES)

    def result(self, interrupted: bool) -> Replay:
        """All that was taken in."""
        done = slice(self._done)
        ticks: dict[str, NDArray[Any]] = {
            "time": self._log.time[done],
            "collision": self._collision[done],
            "onset": self._onset[done],
            "significance": self._significance[done],
            "external_torque": self._external[done],
        }
        columns = self._columns()
        contacts = tuple(
            replace(contact, start=float(self._log.time[self._begins[contact.id]]))
            for contact in contacts_of(columns, self._final_classes())
        )
        return Replay(self._log, self._robot, ticks, columns, contacts, interrupted, self._sensors)

    def _final_classes(self) -> dict[int, _core.ContactClass] | None:
        """What was last said of each contact; of one that is several to the classifier, of the strongest."""
        if self._classes is None:
            return None
        return {
            number: max((self._last[which] for which in several), key=lambda each: each.features["peak"])
            for number, several in self._classified.items()
        }

    def _columns(self) -> Mapping[str, NDArray[Any]]:
        rows = np.array(self._rows, dtype=np.int64)
        numbers = 1 + len(_NUMBERS)
        values = np.array(self._values).reshape(len(rows), numbers + 3 * len(_VECTORS))
        columns: dict[str, NDArray[Any]] = {
            "row": rows,
            "time": self._log.time[rows],
            "id": np.array(self._ids, dtype=np.int64),
            "link": np.array(self._links, dtype=object),
            "located": np.array(self._located, dtype=bool),
            "link_probability": values[:, 0].copy(),
        }
        columns |= {name: values[:, 1 + k].copy() for k, name in enumerate(_NUMBERS)}
        for k, name in enumerate(_VECTORS):
            columns[name] = values[:, numbers + 3 * k : numbers + 3 * (k + 1)].copy()
        if self._classes is not None:
            classes = np.array(self._classes).reshape(len(rows), len(PROBABILITIES))
            columns |= {name: classes[:, k].copy() for k, name in enumerate(PROBABILITIES)}
        return columns
