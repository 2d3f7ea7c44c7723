"""Figures of several touches."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..harness import mean, median
from .touches import LogResult, TouchResult


@dataclass(frozen=True)
class Summary:
    """Figures of one log or of many; rates are shares of all touches. NaN: undefined for want of touches."""

    touches: int
    detected: int
    early: int  # of them, with an onset before the label's begin
    delay_median: float  # [s]
    delay_max: float  # [s]
    exact: float  # right link named
    within_one: float  # it or a neighbour
    link_error: float  # mean distance between the numbers of the link named and the right one
    located: float
    agreement: float  # share of a log's most frequent link, mean over logs
    scatter: float  # of a log's located points, median over logs [m]
    false_alarms: int
    false_alarms_per_minute: float  # of free time
    overrun: float  # time that the alarm stays on outside touches, per touch [s]


def summarise(results: Sequence[LogResult]) -> Summary:
    """The figures of these logs, touches pooled."""
    touches = [(log, touch) for log in results for touch in log.touches]
    delays = [touch.delay for _, touch in touches if touch.delay is not None]
    # A touch without a name counts as the base's.
    misses = [abs((touch.link or 0) - log.link) for log, touch in touches]
    free_time = sum(log.free_time for log in results)
    false_alarms = sum(len(log.false_onsets) for log in results)
    scatters = [spread for log in results if np.isfinite(spread := scatter(log.touches))]
    return Summary(
        touches=len(touches),
        detected=len(delays),
        early=sum(delay < 0 for delay in delays),
        delay_median=median(delays),
        delay_max=max(delays, default=np.nan),
        exact=mean([miss == 0 for miss in misses]),
        within_one=mean([miss <= 1 for miss in misses]),
        link_error=mean(misses),
        located=mean([touch.located for _, touch in touches]),
        agreement=mean([agreement(log.touches) for log in results]),
        scatter=median(scatters),
        false_alarms=false_alarms,
        false_alarms_per_minute=60.0 * false_alarms / free_time if free_time > 0 else np.nan,
        overrun=sum(log.free_alarm for log in results) / max(len(touches), 1),
    )


def most_frequent(touches: Sequence[TouchResult]) -> tuple[int | None, int]:
    """The link named most often, and how often."""
    return Counter(touch.link for touch in touches).most_common(1)[0] if touches else (None, 0)


def agreement(touches: Sequence[TouchResult]) -> float:
    """Share of the most frequent link."""
    return most_frequent(touches)[1] / len(touches) if touches else np.nan


def scatter(touches: Sequence[TouchResult]) -> float:
    """RMS distance from their mean of the points on the most frequent link [m]; NaN for fewer than three."""
    link, _ = most_frequent(touches)
    points = [touch.point for touch in touches if touch.point is not None and touch.link == link]
    if len(points) < 3:
        return np.nan
    apart = np.array(points) - np.mean(points, axis=0)
    return float(np.sqrt(np.mean(np.sum(apart**2, axis=1))))
