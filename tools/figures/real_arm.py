"""Figures of `contactsense study real_arm`."""

from __future__ import annotations

from typing import Any

from .entry import Raw
from .markdown import number, percent
from .markdown import table as markdown

HEADER = (
    "arm",
    "monitor",
    "detected",
    "by chance",
    "5 to 10, 10 to 20, 20 to 40 N",
    "delay, median; 90 %",
    "false onsets per hour",
    "time with a false report",
    "false onsets after each contact",
)
MONITORS = {"default": "default thresholds", "thresholds": "its own thresholds", "calibrated": "calibrated"}


def reduce(raw: Raw) -> dict[str, Any]:
    """What each monitor did on each arm, and on all."""
    (study,) = raw[""]
    return {name: _kept(figures) for name, figures in {**study["arms"], "all": study["all"]}.items()}


def _kept(figures: Any) -> dict[str, Any]:
    return {key: figures[key] for key in ("contacts", "false_onsets", "forces")}


def table(result: Any) -> str:
    """One row for an arm and a monitor."""
    return markdown(
        HEADER,
        (
            _row(arm if name == "default" else "", name, figures)
            for arm, figures in result.items()
            for name in MONITORS
        ),
    )


def _row(arm: str, name: str, figures: Any) -> list[str]:
    contacts, false = figures["contacts"][name], figures["false_onsets"][name]
    bands = [percent(band[name]["detected"]) for band in figures["forces"].values()]
    delays = [contacts[key] for key in ("delay", "delay_90")]
    return [
        arm,
        MONITORS[name],
        percent(contacts["detected"]),
        percent(false["chance"]),
        ", ".join(bands),
        "-" if None in delays else f"{1e3 * delays[0]:.0f}; {1e3 * delays[1]:.0f} ms",
        f"{false['per_hour']:.0f}",
        percent(false["collision"]),
        number(false["per_contact"]),
    ]
