"""Whether a probability means what it says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

BINS = 10


@dataclass(frozen=True)
class Bin:
    """Statements whose probabilities are alike."""

    count: int
    probability: float  # mean
    right: float  # share
    # Standard deviation that the share would have if the probabilities were right.
    chance: float


def reliability(statements: Sequence[tuple[float, bool]]) -> list[Bin]:
    """`BINS` bins of equal width over probability and whether it came true; empty ones are left out."""
    if not statements:
        return []
    probabilities, right = np.array(statements, dtype=float).T
    bins = np.minimum((probabilities * BINS).astype(int), BINS - 1)
    return [_bin(probabilities[bins == each], right[bins == each]) for each in np.unique(bins)]


def _bin(probabilities: np.ndarray, right: np.ndarray) -> Bin:
    variance = np.sum(probabilities * (1.0 - probabilities)) / len(right) ** 2
    return Bin(len(right), float(probabilities.mean()), float(right.mean()), float(np.sqrt(variance)))


def calibration_error(bins: Sequence[Bin]) -> float:
    """Expected calibration error: mean distance of the share from the probability, by count; NaN of none."""
    return _mean(bins, [abs(each.right - each.probability) for each in bins])


def calibration_error_by_chance(bins: Sequence[Bin]) -> float:
    """What right probabilities would show on average with as few statements; NaN of none."""
    # Mean magnitude of a Gaussian, where a bin has enough of them to be one.
    return _mean(bins, [np.sqrt(2.0 / np.pi) * each.chance for each in bins])


def _mean(bins: Sequence[Bin], values: Sequence[float]) -> float:
    return float(np.average(values, weights=[each.count for each in bins])) if bins else np.nan
