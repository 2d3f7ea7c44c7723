"""Interleaved timing: every contestant in every round, so that a noisy moment strikes all of them.

The clock counts the time that this process spends on its core, not what others take from it; on a quiet
machine that is the time on the wall. No contestant waits for anything.
"""

from __future__ import annotations

import time
import timeit
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Contestant:
    """A statement to time; one run of it does `count` operations."""

    name: str
    statement: str
    names: Mapping[str, Any]
    count: int = 1


@dataclass(frozen=True)
class Timing:
    """Time of one operation [us], one sample a round."""

    name: str
    samples: NDArray[np.float64]

    @property
    def median(self) -> float:
        return float(np.median(self.samples))

    @property
    def spread(self) -> tuple[float, float]:
        """The 10th and 90th percentile [us]."""
        low, high = np.percentile(self.samples, [10, 90])
        return float(low), float(high)

    @property
    def tail(self) -> tuple[float, float]:
        """The 99.9th percentile and the maximum [us]."""
        return float(np.percentile(self.samples, 99.9)), float(self.samples.max())


@dataclass(frozen=True)
class Pace:
    """How long to measure."""

    rounds: int
    round_time: float  # of one contestant [s]
    contacts: int  # places that the monitors are touched at
    scenes: int  # of noisy contacts a robot and kind
    clock: Callable[[], float] = time.process_time
    log_rows: int = 600_000  # of the log that is read: ten minutes at 1 kHz


@dataclass(frozen=True)
class Comparison:
    """The timings of one task, ours first, and what is asked of them."""

    task: str
    timings: Sequence[Timing]
    max_us: float | None = None  # of ours
    min_ratio: float | None = None  # of the second to ours
    max_worst_us: float | None = None  # of our slowest call, where `samples` are of single calls
    max_tail_ratio: float | None = None  # of our 99.9th percentile to the second's
    lost: int | None = None  # messages that ours did not pass on, of which there may be none
    has_tail: bool = False  # whether `samples` are of single calls where nothing is asked of the slowest
    unit: str = "us"  # of samples and limits, where they are no times

    def ratio(self, timing: Timing) -> float:
        """Of the medians: how many times as long as ours it takes."""
        return timing.median / self.timings[0].median

    def ratio_spread(self, timing: Timing) -> tuple[float, float]:
        """The 10th and 90th percentile of the ratio within a round."""
        low, high = np.percentile(timing.samples / self.timings[0].samples, [10, 90])
        return float(low), float(high)

    @property
    def tail_ratio(self) -> float:
        """Of the 99.9th percentiles: how many times as long as the second ours takes."""
        return self.timings[0].tail[0] / self.timings[1].tail[0]

    @property
    def passed(self) -> bool | None:
        """None where nothing is asked."""
        limits = self.max_us, self.min_ratio, self.max_worst_us, self.max_tail_ratio, self.lost
        if all(it is None for it in limits):
            return None
        fast = self.max_us is None or self.timings[0].median <= self.max_us
        fast = fast and (self.max_worst_us is None or self.timings[0].tail[1] <= self.max_worst_us)
        fast = fast and not self.lost
        fast = fast and (self.max_tail_ratio is None or self.tail_ratio <= self.max_tail_ratio)
        return fast and (self.min_ratio is None or self.ratio(self.timings[1]) >= self.min_ratio)


def interleave(contestants: Sequence[Contestant], pace: Pace) -> list[Timing]:
    """Times all contestants round by round, every other round in reverse order."""
    timers = [timeit.Timer(c.statement, timer=pace.clock, globals=dict(c.names)) for c in contestants]
    runs = [_runs(timer, pace.round_time) for timer in timers]
    samples = np.empty((len(contestants), pace.rounds))
    for index in range(pace.rounds):
        order = range(len(contestants))
        for k in order if index % 2 == 0 else reversed(order):
            seconds = timers[k].timeit(runs[k])
            samples[k, index] = 1e6 * seconds / (runs[k] * contestants[k].count)
    return [Timing(c.name, row) for c, row in zip(contestants, samples, strict=True)]


def time_calls(
    contestants: Sequence[tuple[str, Callable[[], Sequence[Callable[[], object]]]]], repeats: int
) -> list[Timing]:
    """Times single calls: each contestant is a name and a function that makes its calls anew, in order.

    A sample is the fastest of `repeats` times that the same call was made, in microseconds of this process on
    its core: what the call takes itself, not what a pause of the system does. So the tail is the work of the
    worst input.
    """
    best: list[NDArray[np.float64]] = []
    for repeat in range(repeats):
        for k, (_, prepare) in enumerate(contestants):
            calls = prepare()
            taken = np.empty(len(calls))
            for index, call in enumerate(calls):
                start = time.process_time_ns()
                call()
                taken[index] = 1e-3 * (time.process_time_ns() - start)
            if repeat == 0:
                best.append(taken)
            else:
                np.minimum(best[k], taken, out=best[k])
    return [Timing(name, row) for (name, _), row in zip(contestants, best, strict=True)]


def _runs(timer: timeit.Timer, round_time: float) -> int:
    """Runs of the statement that fill a round; warms up by the way."""
    runs = 1
    while (seconds := timer.timeit(runs)) < 0.5 * round_time:
        runs *= 2
    return max(1, round(runs * round_time / seconds))
