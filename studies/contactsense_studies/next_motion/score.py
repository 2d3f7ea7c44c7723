"""Figures of several trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..harness import mean, median
from .trial import Outcome


@dataclass(frozen=True)
class Score:
    """Of several trials; shares from 0 to 1, NaN without a trial."""

    trials: int
    motions: float  # median until the point is close; infinite where it is not in half of the trials
    never: float  # share in which it is not within the most motions
    lost: float  # share in which the contact ended, or another link touched
    greatest_force: float  # of all trials [N]


def score(outcomes: Sequence[Outcome]) -> Score:
    """Of all outcomes; trials in which the point is never close are longer than any other."""
    lengths = [np.inf if each.motions is None else float(each.motions) for each in outcomes]
    return Score(
        trials=len(outcomes),
        motions=median(lengths),
        never=mean([np.isinf(length) for length in lengths]),
        lost=mean([each.lost for each in outcomes]),
        greatest_force=max((each.greatest_force for each in outcomes), default=np.nan),
    )


def errors_after(outcomes: Sequence[Outcome], motions: int) -> list[float]:
    """The median error of the point after 0, 1, ... motions [m]; a trial that is over keeps its last one."""
    return [
        median([each.errors[min(number, len(each.errors) - 1)] for each in outcomes])
        for number in range(motions + 1)
    ]
