"""What an imperfect arm measured, and what was true."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contactsense import Robot
from contactsense.log import Log

from ._arrays import FloatArray
from .imperfect_arm import ImperfectArm
from .person_contact import PersonContact


@dataclass(frozen=True, eq=False)
class RecordedContact:
    """A contact as it was; values are those at the largest force, world frame."""

    contact: PersonContact
    rows: slice  # of the log, while it lasted
    time: float  # of the values below [s]
    point: FloatArray  # (3,) [m]
    force: FloatArray  # (3,) on the robot [N]
    external_torque: FloatArray  # (nv,) [Nm]


@dataclass(frozen=True, eq=False)
class Truth:
    """What was true in each of the `n` rows of a log."""

    time: FloatArray  # (n,) without the jitter of the log's [s]
    q: FloatArray  # (n, nq)
    v: FloatArray  # (n, nv)
    a: FloatArray  # (n, nv)
    tau: FloatArray  # (n, nv) of the rigid-body dynamics and the rotors, without friction [Nm]
    friction: FloatArray  # (n, nv) all of it, whether the torque sensor sees it or not [Nm]
    external_torque: FloatArray  # (n, nv) [Nm]
    contact: NDArray[np.intp]  # (n,) which of `contacts` there is, -1 without; the last of several at once
    contacts: tuple[RecordedContact, ...]
    robot: Robot  # the true one: masses, rotors, payload
    arm: ImperfectArm  # all the other errors

    @property
    def contact_free(self) -> NDArray[np.bool_]:
        """(n,) rows in which nobody pushes."""
        return self.contact < 0


@dataclass(frozen=True, eq=False)
class ImperfectRun:
    """A log and its truth, row by row."""

    log: Log
    truth: Truth

    def __len__(self) -> int:
        return len(self.log)
