"""One row a contact, of what was said of it in each of its ticks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .contact import PROBABILITIES, ReplayedContact


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
