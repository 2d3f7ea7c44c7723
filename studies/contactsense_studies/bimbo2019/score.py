"""How an estimate is judged, and figures of many trials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from contactsense.sim._arrays import FloatArray

from ..harness import mean, median

CHI2_90 = 6.251  # 90 % of a normal vector of three components is nearer (squared Mahalanobis distance)
GRAIN = 1e-3  # [m] standard deviation that is granted on top: points on a surface have none along its normal


@dataclass(frozen=True)
class Outcome:
    """The end of one trial."""

    link: str  # true
    found: str  # "": no contact is felt
    error: float  # of the point [m], infinite without an estimate
    force_error: float  # relative
    covered: bool  # the 90 % region holds the true point
    spread: float  # [m] of the point: root of the covariance's trace
    ambiguous: bool
    probability: float  # of the true link
    mode_error: float  # [m] of the nearest mode
    errors: tuple[float, ...] = ()  # of the point, after every update [m]

    @property
    def right(self) -> bool:
        """Whether the link is found."""
        return self.found == self.link


def judge(
    estimate: Any, link: str, point: FloatArray, force: FloatArray, errors: tuple[float, ...] = ()
) -> Outcome:
    """`estimate` against the true link, point and force, world frame."""
    error = point_error(estimate, point)
    if not np.isfinite(error):
        return Outcome(link, "", np.inf, np.inf, False, np.nan, False, 0.0, np.inf, errors)
    off = np.asarray(estimate.point) - point
    covariance = np.asarray(estimate.covariance)
    distance = float(off @ np.linalg.solve(covariance + GRAIN**2 * np.eye(3), off))
    return Outcome(
        link=link,
        found=estimate.link,
        error=error,
        force_error=float(np.linalg.norm(estimate.force - force) / np.linalg.norm(force)),
        covered=distance <= CHI2_90,
        spread=float(np.sqrt(max(np.trace(covariance), 0.0))),
        ambiguous=bool(estimate.ambiguous),
        probability=float(estimate.link_probabilities.get(link, 0.0)),
        mode_error=min((float(np.linalg.norm(mode.point - point)) for mode in estimate.modes), default=error),
        errors=errors,
    )


def point_error(estimate: Any, point: FloatArray) -> float:
    """Distance of the estimated point from the true one [m]; infinite where none is given."""
    if not estimate.contact or not estimate.link:
        return float(np.inf)
    distance = float(np.linalg.norm(np.asarray(estimate.point) - point))
    return distance if np.isfinite(distance) else float(np.inf)


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
        right_link=mean([each.right for each in outcomes]),
        mean=mean(errors),
        median=median(errors),
        worst=max(errors, default=np.nan),
        force=median([each.force_error for each in outcomes]),
        covered=mean([each.covered for each in outcomes]),
        spread=median([each.spread for each in outcomes]),
        ambiguous=mean([each.ambiguous for each in outcomes]),
        flagged=mean(wrong),
        probability=mean([each.probability for each in outcomes]),
        mode=median([each.mode_error for each in outcomes]),
    )
