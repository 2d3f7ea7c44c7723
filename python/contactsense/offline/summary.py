"""One row a contact, of what was said of it in each of its ticks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core

# Of the class of a contact.
PROBABILITIES = ("clamped", "transient", "sustained", "intended")


@dataclass(frozen=True, eq=False)
class ReplayedContact:
    """One contact from its begin to its end.

    Args:
        id: which contact it is: the monitor's number.
        start: time of its onset, as the log's [s].
        end: time of its last tick [s].
        link: the likeliest link.
        link_probability: of that link; NaN where the monitor works out no posterior.
        located: whether 90 % of the posterior lie within the monitor's `locate_within` of the point.
        point: `(3,)`, world frame [m]; NaN where the torques tell no point.
        point_local: `(3,)`, in the link's frame [m].
        region_radius: of the region that holds 90 % of the posterior [m].
        peak_force: greatest force [N]; NaN where no force is known.
        force: `(3,)`, at that time, world frame, acting on the robot [N].
        kind: the likeliest of "clamped", "transient" and "sustained", as said at the contact's end; "unknown"
            where torques of several contacts are not known apart. Empty if contacts are not classified.
        clamped: probability that it is held between the robot and something fixed; NaN where not known.
        transient: probability that it ends by itself shortly.
        sustained: probability that it lasts with something that follows or yields.
        intended: probability that it is intended.

    Raises:
        TypeError: an argument is missing.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> q, still = np.tile(robot.neutral(), (600, 1)), np.zeros((600, 7))
        >>> tau = np.tile(robot.inverse_dynamics(q[0], still[0], still[0]), (600, 1))
        >>> push = robot.jacobian(q[0], "iiwa_link_3", point=[0.06, 0.0, 0.6])[:3].T @ [-40.0, 0.0, 0.0]
        >>> tau[200:400] -= push
        >>> log = cs.Log(np.arange(600) / 1000, q, still, tau)
        >>> result = cs.replay(log, cs.ContactMonitor(robot, dt=0.001))
        >>> [contact.id for contact in result.contacts]
        [0]
    """

    id: int
    start: float
    end: float
    link: str
    link_probability: float
    located: bool
    point: NDArray[np.float64]
    point_local: NDArray[np.float64]
    region_radius: float
    peak_force: float
    force: NDArray[np.float64]
    kind: str = field(default_factory=str)  # as a plain default it would be an attribute of the class
    clamped: float = math.nan
    transient: float = math.nan
    sustained: float = math.nan
    intended: float = math.nan

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name, as plain Python values; numbers that are not known are None.

        Those of the class are left out if contacts are not classified.
        """
        names = [each.name for each in fields(self)]
        if not self.kind:
            names = names[: names.index("kind")]
        return {name: _plain(getattr(self, name)) for name in names}


def contacts_of(
    ticks: Mapping[str, NDArray[Any]], classes: Mapping[int, _core.ContactClass] | None = None
) -> tuple[ReplayedContact, ...]:
    """The contacts in the order of their begin; `classes` by number, None if they are not classified.

    A contact's place is that of the last tick that locates it, else of the last that has one, since what is
    known of it grows. The first ticks, before there is a posterior, count only where there is none later. Its
    link is the one of most ticks where no tick has a place.
    """
    numbers, first = np.unique(ticks["id"], return_index=True)
    ordered = numbers[np.argsort(first, kind="stable")]
    return tuple(
        _contact(int(number), ticks, np.flatnonzero(ticks["id"] == number), classes) for number in ordered
    )


def _contact(
    number: int,
    ticks: Mapping[str, NDArray[Any]],
    rows: NDArray[np.intp],
    classes: Mapping[int, _core.ContactClass] | None,
) -> ReplayedContact:
    placed = rows[np.all(np.isfinite(ticks["point_local"][rows]), axis=1)]
    judged = placed[np.isfinite(ticks["region_radius"][placed])]
    placed = judged if len(judged) else placed
    located = placed[ticks["located"][placed]]
    forces = np.linalg.norm(ticks["force"][rows], axis=1)
    known = np.isfinite(forces)
    peak = rows[int(np.argmax(np.where(known, forces, -1.0)))] if known.any() else None
    if len(placed):
        told = int((located if len(located) else placed)[-1])
    else:
        links, counts = np.unique(ticks["link"][rows].astype(str), return_counts=True)
        most = links[int(np.argmax(counts))]
        told = int(rows[ticks["link"][rows] == most][-1])
    return ReplayedContact(
        id=number,
        start=float(ticks["time"][rows[0]]),
        end=float(ticks["time"][rows[-1]]),
        link=str(ticks["link"][told]),
        link_probability=float(ticks["link_probability"][told]),
        located=bool(ticks["located"][told]),
        point=ticks["point"][told].copy(),
        point_local=ticks["point_local"][told].copy(),
        region_radius=float(ticks["region_radius"][told]),
        peak_force=float(forces[known].max()) if known.any() else float("nan"),
        force=ticks["force"][peak].copy() if peak is not None else np.full(3, np.nan),
        **({} if classes is None else _class_of(classes.get(number))),
    )


def _class_of(found: _core.ContactClass | None) -> dict[str, Any]:
    if found is None:
        return {"kind": "unknown"}
    return {"kind": found.kind, **{name: getattr(found, name) for name in PROBABILITIES}}


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return [_plain(number) for number in value.tolist()]
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value
