"""Figures of many trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .metric import Outcome


@dataclass(frozen=True)
class Score:
    """Of several trials; shares from 0 to 1, lengths in m; NaN without a trial."""

    trials: int
    right_link: float
    mean: float  # error of the point
    median: float
    worst: float
    force: float  # median error, relative
    covered: float  # the 90 % region holds the point
    spread: float  # median of the estimate's own standard deviation
    ambiguous: float
    flagged: float  # of those on a wrong link, said to be ambiguous
    probability: float  # mean, of the true link
    mode: float  # median error of the nearest mode


def score(outcomes: Sequence[Outcome]) -> Score:
    """Of all outcomes."""
    wrong = [each.ambiguous for each in outcomes if not each.right]
    errors = [each.error for each in outcomes]
    return Score(
        trials=len(outcomes),
        right_link=_mean([each.right for each in outcomes]),
        mean=_mean(errors),
        median=_median(errors),
        worst=max(errors, default=np.nan),
        force=_median([each.force_error for each in outcomes]),
        covered=_mean([each.covered for each in outcomes]),
        spread=_median([each.spread for each in outcomes]),
        ambiguous=_mean([each.ambiguous for each in outcomes]),
        flagged=_mean(wrong),
        probability=_mean([each.probability for each in outcomes]),
        mode=_median([each.mode_error for each in outcomes]),
    )


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if len(values) else float(np.nan)


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if len(values) else float(np.nan)
