"""The newest instant of a control loop, in memory that two processes share."""

from __future__ import annotations

import mmap
import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .moment import Touch

Rows = NDArray[np.float64]

# As many contacts are shown.
MOST = 8
# Of a contact: number of its link, probability, located, radius, point, force.
_FIELDS = 10


class Slot:
    """Room for one instant: written without waiting, and read whole or not at all.

    A number counts the writings, twice each: it is odd while one is under way. A reader that finds it odd, or
    another one after it has read, has read in vain, and tries again later.
    """

    def __init__(self, path: Path, robot: _core.Robot, *, creates: bool = False) -> None:
        size = 8 * (2 + robot.nq + robot.nv + MOST * _FIELDS)
        if creates:
            path.write_bytes(bytes(size))
        self._links = list(robot.link_names)
        self._number_of = {link: k for k, link in enumerate(self._links)}
        with path.open("r+b") as file:
            self._memory = mmap.mmap(file.fileno(), size)
        numbers = np.frombuffer(self._memory, dtype=np.float64)
        self._count = np.frombuffer(self._memory, dtype=np.int64, count=1)
        self._contacts = numbers[1:2]
        self._q = numbers[2 : 2 + robot.nq]
        self._torque = numbers[2 + robot.nq : 2 + robot.nq + robot.nv]
        self._touches = numbers[-MOST * _FIELDS :].reshape(MOST, _FIELDS)

    def write(self, q: Rows, report: _core.ContactReport) -> None:
        """Puts an instant in place of the one before."""
        self._count[0] += 1
        self._q[:] = q
        self._torque[:] = report.external_torque
        contacts = report.contacts[:MOST]
        self._contacts[0] = len(contacts)
        for k, contact in enumerate(contacts):
            link = contact.link
            row = self._touches[k]
            row[0] = self._number_of[link]
            row[1] = contact.link_probabilities.get(link, np.nan)
            row[2], row[3] = contact.located, contact.region_radius
            row[4:7], row[7:10] = contact.point, contact.force
        self._count[0] += 1

    def read(self) -> tuple[int, Rows, Rows, tuple[Touch, ...]] | None:
        """Number of writings, configuration, external torque and contacts; None while these change."""
        before = int(self._count[0])
        if before % 2 or not before:
            return None
        q, torque, rows = self._q.copy(), self._torque.copy(), self._touches[: int(self._contacts[0])].copy()
        if int(self._count[0]) != before:
            return None
        touches = tuple(
            Touch(self._links[int(row[0])], float(row[1]), bool(row[2]), row[4:7], row[7:10], float(row[3]))
            for row in rows
        )
        return before, q, torque, touches


def slot_file() -> Path:
    """Where a file is memory, if the system has such a place."""
    import tempfile

    shared = Path("/dev/shm")
    handle, name = tempfile.mkstemp(prefix="contactsense-", dir=shared if shared.is_dir() else None)
    os.close(handle)
    return Path(name)
