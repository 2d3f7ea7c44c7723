"""Figures of `contactsense demo`."""

from __future__ import annotations

from typing import Any

from .entry import Raw
from .markdown import number
from .markdown import table as markdown

HEADER = (
    "errors of the torques",
    "seeds",
    "detected",
    "delay",
    "correct link",
    "located",
    "largest point error",
    "largest force error",
    "false alarms",
)


IMPERFECT = "errors of a real arm, calibrated"


def reduce(raw: Raw) -> dict[str, Any]:
    """Counts and extremes of every label, all seeds pooled, and the counts of each seed."""
    pooled = {label: _pool(runs) for label, runs in raw.items()}
    others = [
        {**run["imperfect"], "seed": run["seed"]}
        for runs in raw.values()
        for run in runs
        if "imperfect" in run
    ]
    return {**pooled, IMPERFECT: _pool(others)} if others else pooled


def _pool(runs: Any) -> dict[str, Any]:
    hits = [hit for run in runs for hit in run["hits"]]
    located = [hit for hit in hits if hit["located"]]
    delays = [hit["delay_ms"] for hit in hits if hit["delay_ms"] is not None]
    return {
        "seeds": [run["seed"] for run in runs],
        "contacts": len(hits),
        "detected": len(delays),
        "delay_ms": [min(delays, default=None), max(delays, default=None)],
        "link_right": sum(hit["link_right"] for hit in hits),
        "located": len(located),
        "located_on_wrong_link": sum(not hit["link_right"] for hit in located),
        "worst_point_error_mm": _worst(located, "point_error_mm"),
        "worst_force_error_percent": _worst(located, "force_error_percent"),
        "false_alarms": sum(run["summary"]["false_alarms"] for run in runs),
        "kept_standing": all(run["standing"]["kept"] for run in runs if "standing" in run),
        "of_each_seed": {str(run["seed"]): run["summary"] for run in runs},
    }


def _worst(hits: Any, key: str) -> float | None:
    return max((hit[key] for hit in hits if hit[key] is not None), default=None)


def table(result: Any) -> str:
    """One row a label."""
    return markdown(HEADER, (_row(label, figures) for label, figures in result.items()))


def _row(label: str, figures: Any) -> list[str]:
    seeds, contacts = figures["seeds"], figures["contacts"]
    return [
        label,
        f"{seeds[0]} to {seeds[-1]}",
        f"{figures['detected']} of {contacts}",
        f"{number(figures['delay_ms'][0])} to {number(figures['delay_ms'][1])} ms",
        f"{figures['link_right']} of {contacts}",
        f"{figures['located']} of {contacts}",
        f"{number(figures['worst_point_error_mm'])} mm",
        f"{number(figures['worst_force_error_percent'])} %",
        str(figures["false_alarms"]),
    ]
