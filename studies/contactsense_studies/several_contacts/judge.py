"""How estimates of several contacts are judged."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np

from ..harness import mean, median
from .runs import SeveralRun

# A point is found within `CLOSE`; one that is said to be known is wrong beyond `WRONG` [m].
CLOSE, WRONG = 0.03, 0.05
# A probable place counts as near the truth. The truth is among the probable places if it is near one, or
# within so many of its spreads.
PROBABLE, NEAR, SPREADS = 0.1, 0.02, 2.0


@dataclass(frozen=True)
class Judged:
    """The end of one trial."""

    links: tuple[str, ...]  # true
    found: tuple[str, ...]  # as many as were found
    errors: tuple[float, ...]  # of each true contact [m], infinite where none was found for it
    near: tuple[bool, ...]  # a probable place is near, for each true contact
    among: tuple[bool, ...]  # it is near, or its spread on the true link holds the truth
    located: int  # contacts that are not said to be ambiguous
    wrong: int  # of these, far from every true contact
    probability: float  # of the true number of contacts
    seconds: float = 0.0  # of an update, mean

    @property
    def links_right(self) -> bool:
        """Whether as many contacts were found as there are, all on the true links."""
        return sorted(self.links) == sorted(self.found)


def judge_several(
    estimate: Any, run: SeveralRun, row: int, probability: float = np.nan, seconds: float = 0.0
) -> Judged:
    """`estimate` against the true contacts at a row of the run, each beside the found one that fits best."""
    found, true = estimate.contacts, run.points[row]
    distance = np.array([[float(np.linalg.norm(each.point - point)) for each in found] for point in true])
    size = max(len(found), len(true))
    padded = np.full((len(true), size), np.inf)
    padded[:, : len(found)] = distance.reshape(len(true), len(found))
    capped = np.minimum(padded, 1.0)
    rows = np.arange(len(true))
    order = min(
        permutations(range(size), len(true)), key=lambda order: float(capped[rows, list(order)].sum())
    )
    places = [mode for each in found for mode in each.modes if mode.probability >= PROBABLE]
    away = [[float(np.linalg.norm(place.point - point)) for place in places] for point in true]
    near = [any(each <= NEAR for each in row) for row in away]
    held = [
        any(
            each <= SPREADS * place.spread and place.link == link
            for each, place in zip(row, places, strict=True)
        )
        for row, link in zip(away, run.links, strict=True)
    ]
    sure = [k for k, each in enumerate(found) if not each.ambiguous]
    return Judged(
        links=run.links,
        found=tuple(each.link for each in found),
        errors=tuple(float(padded[k, order[k]]) for k in rows),
        near=tuple(near),
        among=tuple(one or other for one, other in zip(near, held, strict=True)),
        located=len(sure),
        wrong=sum(bool(distance[:, k].min() > WRONG) for k in sure),
        probability=probability,
        seconds=seconds,
    )


@dataclass(frozen=True)
class Score:
    """Of several trials; shares from 0 to 1."""

    trials: int
    links_right: float  # trials with all links right, and no other contact
    close: float  # contacts whose point is found
    near: float  # trials in which a probable place is near each contact
    among: float  # trials in which each contact is among the probable places
    median: float  # error of the points [m]
    located: float  # contacts that are said to be known
    wrong: float  # of these, far from every true contact
    probability: float  # mean, of the true number
    seconds: float  # of an update, mean


def score(judged: list[Judged]) -> Score:
    """Of all trials."""
    errors = [error for each in judged for error in each.errors]
    located = sum(each.located for each in judged)
    return Score(
        trials=len(judged),
        links_right=mean([each.links_right for each in judged]),
        close=mean([error <= CLOSE for error in errors]),
        near=mean([all(each.near) for each in judged]),
        among=mean([all(each.among) for each in judged]),
        median=median(errors),
        located=located / len(errors) if errors else np.nan,
        wrong=sum(each.wrong for each in judged) / located if located else np.nan,
        probability=mean([each.probability for each in judged]),
        seconds=mean([each.seconds for each in judged]),
    )
