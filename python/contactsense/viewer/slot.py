"""The newest instant of a control loop, in memory that two processes share."""

from __future__ import annotations

import mmap
import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .moment import Cloud, Moment, Touch

Rows = NDArray[np.float64]

# As many contacts are shown.
MOST = 8
# As many particles are shown: enough to see where they are, and little to send.
MOST_PARTICLES = 10_000
# Of a contact: number of its link, probability, located, radius, point, force.
_FIELDS = 10


class Slot:
    """Room for one instant: written without waiting, and read whole or not at all.

    A number counts the writings, twice each: it is odd while one is under way. A reader that finds it odd, or
    another one after it has read, has read in vain, and tries again later.
    """

    def __init__(self, path: Path, robot: _core.Robot, sensors: int = 0, *, creates: bool = False) -> None:
        parts = [1, 2, robot.nq, robot.nv, MOST * _FIELDS, 6 * sensors]
        # Particles are of single precision: two numbers in the room of one.
        size = 8 * (sum(parts) + 2 * MOST_PARTICLES)
        if creates:
            path.write_bytes(bytes(size))
        self._links = list(robot.link_names)
        self._number_of = {link: k for k, link in enumerate(self._links)}
        with path.open("r+b") as file:
            self._memory = mmap.mmap(file.fileno(), size)
        numbers = np.frombuffer(self._memory, dtype=np.float64, count=sum(parts))
        self._count = np.frombuffer(self._memory, dtype=np.int64, count=1)
        _, self._sizes, self._q, self._torque, touches, wrenches = np.split(numbers, np.cumsum(parts)[:-1])
        self._touches, self._wrenches = touches.reshape(MOST, _FIELDS), wrenches.reshape(sensors, 6)
        particles = np.frombuffer(self._memory, dtype=np.float32, offset=8 * sum(parts))
        points, self._shares = np.split(particles, [3 * MOST_PARTICLES])
        self._points = points.reshape(MOST_PARTICLES, 3)

    def write(self, q: Rows, report: _core.ContactReport, particles: Cloud | None = None) -> None:
        """Puts an instant in place of the one before; it has at most `MOST_PARTICLES`."""
        self._count[0] += 1
        self._q[:] = q
        self._torque[:] = report.external_torque
        contacts = report.contacts[:MOST]
        self._sizes[0] = len(contacts)
        for k, contact in enumerate(contacts):
            link = contact.link
            row = self._touches[k]
            row[0] = self._number_of[link]
            row[1] = contact.link_probabilities.get(link, np.nan)
            row[2], row[3] = contact.located, contact.region_radius
            row[4:7], row[7:10] = contact.point, contact.force
        if len(self._wrenches):
            self._wrenches[:] = report.wrenches
        number = 0 if particles is None else len(particles.points)
        self._sizes[1] = number
        if particles is not None:
            self._points[:number], self._shares[:number] = particles.points, particles.shares
        self._count[0] += 1

    @property
    def count(self) -> int:
        """Changes with every writing."""
        return int(self._count[0])

    def read(self) -> tuple[int, Rows, Moment] | None:
        """Count, external torque and what was written; None while this changes."""
        before = self.count
        if before % 2 or not before:
            return None
        q, torque, wrenches = self._q.copy(), self._torque.copy(), self._wrenches.copy()
        rows = self._touches[: int(self._sizes[0])].copy()
        number = int(self._sizes[1])
        particles = Cloud(self._points[:number].copy(), self._shares[:number].copy())
        if self.count != before:
            return None
        touches = tuple(
            Touch(self._links[int(row[0])], float(row[1]), bool(row[2]), row[4:7], row[7:10], float(row[3]))
            for row in rows
        )
        return before, torque, Moment(q, touches, particles=particles, wrenches=wrenches)


def slot_file() -> Path:
    """Where a file is memory, if the system has such a place."""
    import tempfile

    shared = Path("/dev/shm")
    handle, name = tempfile.mkstemp(prefix="contactsense-", dir=shared if shared.is_dir() else None)
    os.close(handle)
    return Path(name)
