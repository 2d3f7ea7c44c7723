"""The comparisons as a table or as JSON."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .timing import Comparison, Timing

HEADER = ("task", "", "us", "10 .. 90 %", "99.9 %", "max", "ratio", "10 .. 90 %", "limit", "")
VERDICTS = {None: "", True: "pass", False: "FAIL"}


def show(comparisons: Sequence[Comparison], about: dict[str, str]) -> None:
    """Prints a table: with rich if it is there, plain otherwise."""
    rows = [row for comparison in comparisons for row in _rows(comparison)]
    caption = ", ".join(f"{key} {value}" for key, value in about.items())
    try:
        from rich.console import Console
        from rich.table import Table
    except ImportError:
        _show_plain(rows)
        print(caption)
        return
    table = Table(*HEADER, box=None, pad_edge=False)
    for column in table.columns:
        column.no_wrap = True
    for column in table.columns[2:8]:
        column.justify = "right"
    for row in rows:
        table.add_row(*row)
    # A narrow terminal wraps whole lines, which reads better than cut cells.
    Console(width=sum(_widths(rows)) + 2 * len(HEADER)).print(table)
    print(caption)


def _show_plain(rows: Sequence[Sequence[str]]) -> None:
    widths = _widths(rows)
    for row in [HEADER, *rows]:
        cells = (
            cell.rjust(width) if 2 <= k < 8 else cell.ljust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        print("  ".join(cells).rstrip())


def _widths(rows: Sequence[Sequence[str]]) -> list[int]:
    return [max(len(row[k]) for row in [HEADER, *rows]) for k in range(len(HEADER))]


def _rows(comparison: Comparison) -> list[tuple[str, ...]]:
    ours = comparison.timings[0]
    limits = []
    if comparison.max_us is not None:
        limits.append(f"<= {comparison.max_us:g} {comparison.unit}")
    if comparison.min_ratio is not None:
        limits.append(f">= {comparison.min_ratio:g}x")
    if comparison.max_worst_us is not None:
        limits.append(f"max <= {comparison.max_worst_us:g} us")
    if comparison.max_tail_ratio is not None:
        limits.append(
            f"99.9 % is {comparison.tail_ratio:.2f}x <= {comparison.max_tail_ratio:g}x the second's"
        )
    if comparison.lost is not None:
        limits.append(f"{comparison.lost} lost <= 0")
    ends = ("", "", ", ".join(limits), VERDICTS[comparison.passed])
    task = comparison.task if comparison.unit == "us" else f"{comparison.task} [{comparison.unit}]"
    first = (task, ours.name, *_times(comparison, ours), *ends)
    return [first, *(_peer_row(comparison, timing) for timing in comparison.timings[1:])]


def _peer_row(comparison: Comparison, timing: Timing) -> tuple[str, ...]:
    low, high = comparison.ratio_spread(timing)
    ratio, spread = f"{comparison.ratio(timing):.1f}", f"{low:.1f} .. {high:.1f}"
    return ("", timing.name, *_times(comparison, timing), ratio, spread, "", "")


def _times(comparison: Comparison, timing: Timing) -> tuple[str, ...]:
    """Median, spread and tail; samples that are means of many calls have no tail worth printing."""
    tail = ("", "") if not has_tail(comparison) else tuple(_us(value) for value in timing.tail)
    return (_us(timing.median), _span(timing.spread), *tail)


def has_tail(comparison: Comparison) -> bool:
    """Whether its samples are of single calls."""
    limits = comparison.max_worst_us, comparison.max_tail_ratio
    return comparison.has_tail or any(limit is not None for limit in limits)


def _us(value: float) -> str:
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def _span(span: tuple[float, float]) -> str:
    return f"{_us(span[0])} .. {_us(span[1])}"


def as_json(comparisons: Sequence[Comparison], about: dict[str, str]) -> dict[str, Any]:
    """Everything in the table, for a program to read; in microseconds where `unit` names nothing else."""
    return {"about": about, "comparisons": [_comparison_json(comparison) for comparison in comparisons]}


def _comparison_json(comparison: Comparison) -> dict[str, Any]:
    timings = [
        {
            "name": timing.name,
            "median_us": timing.median,
            "spread_us": timing.spread,
            "tail_us": timing.tail if has_tail(comparison) else None,
            "ratio": comparison.ratio(timing),
            "ratio_spread": comparison.ratio_spread(timing),
        }
        for timing in comparison.timings
    ]
    return {
        "task": comparison.task,
        "unit": comparison.unit,
        "timings": timings,
        "max_us": comparison.max_us,
        "min_ratio": comparison.min_ratio,
        "max_worst_us": comparison.max_worst_us,
        "max_tail_ratio": comparison.max_tail_ratio,
        "lost": comparison.lost,
        "passed": comparison.passed,
    }
