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
LOCALIZATION_HEADER = (
    "arm",
    "detected",
    "link exact",
    "within one link",
    "both by area",
    "with a point",
    "error, median; 90 %",
    "located",
    "wrong of these",
    "90 % region: coverage",
    "its radius, median; 90 %",
    "calibration error of the link",
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


def reduce_localization(raw: Raw) -> dict[str, Any]:
    """Where the calibrated monitor found the contacts of each arm, and of all."""
    (study,) = raw[""]
    arms = {**study["arms"], "all": study["all"]}
    return {name: figures["localization"]["calibrated"] for name, figures in arms.items()}


def localization_table(result: Any) -> str:
    """One row for an arm."""
    return markdown(LOCALIZATION_HEADER, (_localization_row(arm, each) for arm, each in result.items()))


def _localization_row(arm: str, figures: Any) -> list[str]:
    _, middle, most = figures["region_radius"]
    error = figures["calibration_error"]
    return [
        arm,
        str(figures["detected"]),
        *(_share(figures[key]) for key in ("exact", "within_one")),
        ", ".join(_share(figures[key]) for key in ("exact_by_area", "within_one_by_area")),
        _share(figures["point"]),
        _lengths(figures["error"], figures["error_90"]),
        *(_share(figures[key]) for key in ("located", "located_wrong", "coverage")),
        _lengths(middle, most),
        "-" if error is None else f"{error:.3f}",
    ]


def _share(value: float | None) -> str:
    return "-" if value is None else percent(value)


def _lengths(middle: float | None, most: float | None) -> str:
    return "-" if middle is None or most is None else f"{100 * middle:.1f}; {100 * most:.1f} cm"
