"""What a page shows of one instant, and where it comes from in a replay."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..offline import Replay

Rows = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Touch:
    """One contact.

    Args:
        link: the likeliest one.
        probability: of that link.
        located: whether 90 % of the posterior are near the point.
        point: `(3,)`, world frame [m]; NaN where it is not known.
        force: `(3,)`, world frame [N]; NaN where it is not known.
        region_radius: of the ball about the point that holds 90 % of the posterior [m].
    """

    link: str
    probability: float
    located: bool
    point: Rows
    force: Rows
    region_radius: float


@dataclass(frozen=True, eq=False)
class Moment:
    """One instant.

    Args:
        q: `(nq,)`, configuration.
        touches: the contacts.
        places: `(n, 3)`, where a single contact can be, world frame [m].
        likelihood: `(n,)`, of each place, as a share of the greatest.
    """

    q: Rows
    touches: tuple[Touch, ...]
    places: Rows
    likelihood: Rows


class ReplayMoments:
    """The instants of a replay, by row."""

    def __init__(self, result: Replay, contact_map: _core.ContactMap | None) -> None:
        self._result, self._map = result, contact_map
        ticks = result.contact_ticks
        rows = np.arange(len(result.ticks["time"]) + 1)
        # Contacts of row k are those from first[k] to first[k + 1].
        self._first = np.searchsorted(ticks["row"], rows)

    def __len__(self) -> int:
        return len(self._result.ticks["time"])

    def at(self, row: int) -> Moment:
        """The instant of a row."""
        ticks = self._result.contact_ticks
        touches = tuple(
            Touch(
                str(ticks["link"][k]),
                float(ticks["link_probability"][k]),
                bool(ticks["located"][k]),
                ticks["point"][k],
                ticks["force"][k],
                float(ticks["region_radius"][k]),
            )
            for k in range(self._first[row], self._first[row + 1])
        )
        places, likelihood = self._places(row) if len(touches) == 1 else (np.zeros((0, 3)), np.zeros(0))
        return Moment(self._result.log.q[row], touches, places, likelihood)

    def _places(self, row: int) -> tuple[Rows, Rows]:
        if self._map is None:
            return np.zeros((0, 3)), np.zeros(0)
        found = self._map.evaluate(self._result.log.q[row], self._result.ticks["external_torque"][row])
        return found.points, likelihood_of(found)


def likelihood_of(found: _core.MapEstimate) -> Rows:
    """Of each place of a map, as a share of the greatest."""
    return np.exp(found.log_posterior - np.max(found.log_posterior, initial=-np.inf))
