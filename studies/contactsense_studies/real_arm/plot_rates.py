"""All arms in short: contacts detected, false onsets, delays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contactsense._pictures import GREY, TEXT

from .monitors import MONITORS, TITLES
from .records import FORCE
from .score import contacts_of, detection, false_onsets
from .study import Study, Trial

COLOURS = {"default": "#999999", "thresholds": "#E69F00", "calibrated": "#0072B2"}
_WIDTH = 0.27


def draw_detection(axes: Any, study: Study) -> None:
    """Share of the contacts, and what of it is chance."""

    def chance(trials: list[Trial], name: str) -> float:
        return 100.0 * false_onsets(trials, name).chance

    _bars(axes, study, lambda trials, name: 100.0 * detection(contacts_of(trials), name).detected)
    axes.set_ylim(0.0, 108.0)
    _bars(axes, study, chance, text=False, facecolor="none", edgecolor="black", hatch="////", lw=0.6)
    axes.bar(0, 0, facecolor="none", edgecolor="black", hatch="////", lw=0.6, label="by chance")
    axes.set_ylabel("%")
    low, high = FORCE
    axes.set_title(f"Contacts of {low:g} to {high:g} N detected")


def draw_false_onsets(axes: Any, study: Study) -> None:
    """Per hour of free motion."""
    axes.set_yscale("symlog", linthresh=10.0)
    _bars(axes, study, lambda trials, name: false_onsets(trials, name).per_hour)
    axes.set_ylim(0.0, 4.0 * max(10.0, axes.dataLim.y1))
    axes.set_ylabel("per hour of motion without contact")
    axes.set_title("False onsets in free motion")


def draw_between(axes: Any, study: Study) -> None:
    """After each contact."""
    axes.set_yscale("symlog", linthresh=1.0)
    _bars(axes, study, lambda trials, name: false_onsets(trials, name).per_contact, digits=1)
    axes.set_ylim(0.0, 2.0 * max(1.0, axes.dataLim.y1))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_ylabel("per contact, from 0.1 s after it to the next")
    axes.set_title("False onsets between contacts")


def draw_time_in_contact(axes: Any, study: Study) -> None:
    """Share of free motion."""
    _bars(axes, study, lambda trials, name: 100.0 * false_onsets(trials, name).collision)
    axes.set_ylim(0.0, 108.0)
    axes.set_ylabel("% of motion without contact")
    axes.set_title("Time with a false report")


def draw_delays(axes: Any, study: Study) -> None:
    """Median, and a line to where 90 % are detected."""
    _bars(axes, study, lambda trials, name: 1e3 * detection(contacts_of(trials), name).delay, text=False)
    longest = 0.0
    for place, arm in enumerate(_arms(study)):
        for number, name in enumerate(MONITORS):
            figures = detection(contacts_of(study.of(arm)), name)
            ends = 1e3 * np.array([figures.delay, figures.delay_90])
            axes.plot(2 * [_x(place, number)], ends, color=COLOURS[name], lw=1.5)
            if np.isnan(figures.delay):
                axes.text(_x(place, number), 0.0, "none", rotation=90, ha="center", va="bottom", fontsize=8)
            # Chance onsets of a monitor that reports all the time may be late without end.
            longest = max(longest, 1e3 * figures.delay_90 if name != "default" else 0.0)
    axes.set_ylim(0.0, 1.05 * longest if longest else None)
    axes.set_ylabel("ms after the start of the force")
    axes.set_title("Delay: median, line up to 90 %")


def _bars(
    axes: Any,
    study: Study,
    value: Callable[[list[Trial], str], float],
    *,
    text: bool = True,
    digits: int = 0,
    **style: Any,
) -> None:
    arms = _arms(study)
    for number, name in enumerate(MONITORS):
        heights = np.nan_to_num([value(study.of(arm), name) for arm in arms])
        places = [_x(place, number) for place in range(len(arms))]
        look = style or {"color": COLOURS[name], "label": TITLES[name]}
        axes.bar(places, heights, 0.92 * _WIDTH, **look)
        if text:
            for place, height in zip(places, heights, strict=True):
                axes.annotate(
                    f"{height:.{digits}f}",
                    (place, height),
                    (0, 2),
                    textcoords="offset points",
                    ha="center",
                    fontsize=7.5,
                    color=TEXT,
                )
    axes.set_xticks(range(len(arms)), [arm.replace("_", "\n") for arm in arms])
    axes.tick_params(axis="x", length=0)
    axes.grid(axis="y", color=GREY, alpha=0.25, lw=0.6)
    axes.set_axisbelow(True)


def _arms(study: Study) -> list[str]:
    return [arm for arm in study.arms if study.of(arm)]


def _x(place: int, number: int) -> float:
    return place + (number - 1) * _WIDTH
