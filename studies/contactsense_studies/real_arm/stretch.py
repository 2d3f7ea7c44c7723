"""A stretch of time for the picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contactsense.sim import ImperfectRun

from .monitors import Heard

# Shown before the first contact, and in all [s]; one row in so many is kept of the torques.
BEFORE, SHOWN, THINNED = 1.0, 20.0, 4


@dataclass(frozen=True, eq=False)
class Stretch:
    """Some seconds of a record with contacts, `n` rows; time from the start of the stretch."""

    time: NDArray[np.float64]  # (n,) [s]
    contact: NDArray[np.bool_]  # (n,) whether there is one
    torque: dict[str, NDArray[np.float64]]  # by monitor, (n, nv) [Nm]
    collision: dict[str, NDArray[np.bool_]]  # by monitor, (n,)
    contacts: tuple[tuple[float, float, str, float], ...]  # start, end [s], link, force [N]


def cut(run: ImperfectRun, heard: Mapping[str, Heard]) -> Stretch:
    """From shortly before the first contact."""
    truth = run.truth
    begin = min(each.contact.start for each in truth.contacts) - BEFORE
    first, last = np.searchsorted(truth.time, [begin, begin + SHOWN])
    thin = slice(first, last, THINNED)
    return Stretch(
        time=truth.time[thin] - begin,
        contact=~truth.contact_free[thin],
        torque={name: told.external_torque[thin] for name, told in heard.items()},
        collision={name: told.collision[thin] for name, told in heard.items()},
        contacts=tuple(
            (
                each.contact.start - begin,
                each.contact.end - begin,
                each.contact.link,
                float(np.linalg.norm(each.force)),
            )
            for each in truth.contacts
            if each.contact.start < begin + SHOWN
        ),
    )
