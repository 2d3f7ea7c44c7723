"""Figures of many contacts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..real_arm.reliability import Bin, calibration_error, reliability
from .judge import Judged, probabilities


@dataclass(frozen=True)
class Score:
    """Of contacts; shares are NaN of none."""

    contacts: int
    missed: int  # not detected
    open: int  # still running, and younger than the verdict
    clamped_or_transient: int  # number that are either
    right_kind: float  # share of these that are told apart
    right_of_three: float  # share of all whose kind is the likeliest of three
    right_intention: float
    intention_error: float  # expected calibration error of `intended`
    kind_error: float  # of the probability of the likeliest kind
    confusion: tuple[tuple[int, ...], ...]  # rows: true kinds; columns: said
    bins: tuple[Bin, ...]  # of `intended`
    kind_bins: tuple[Bin, ...]


def score(judged: Sequence[Judged]) -> Score:
    """All figures."""
    kinds, true, intended, wanted = probabilities(judged)
    said = kinds.argmax(axis=1)
    either = true < 2
    right = (kinds[either, 0] > kinds[either, 1]) == (true[either] == 0)
    confusion = np.zeros((3, 3), dtype=int)
    np.add.at(confusion, (true, said), 1)
    bins = reliability(list(zip(intended, wanted, strict=True)))
    kind_bins = reliability(list(zip(kinds.max(axis=1), said == true, strict=True))) if len(true) else []
    missed = sum(not each.answers for each in judged)
    return Score(
        contacts=len(judged),
        missed=missed,
        open=len(judged) - missed - len(true),
        clamped_or_transient=int(either.sum()),
        right_kind=_mean(right),
        right_of_three=_mean(said == true),
        right_intention=_mean((intended > 0.5) == wanted),
        intention_error=calibration_error(bins),
        kind_error=calibration_error(kind_bins),
        confusion=tuple(tuple(int(count) for count in row) for row in confusion),
        bins=tuple(bins),
        kind_bins=tuple(kind_bins),
    )


def _mean(values: np.ndarray) -> float:
    return float(values.mean()) if len(values) else float("nan")
