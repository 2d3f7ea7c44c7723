"""The study as a table and as data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from ..harness import print_tables, scaled, sheet
from .study import Evaluation, Study
from .summary import Summary, most_frequent, summarise
from .touches import EARLY, TouchResult

SOURCES = {
    "measured": "momentum observer on measured torques",
    "vendor": "the vendor's external torque",
    "calibrated": "the vendor's torque, calibrated",
}
FIGURES = (
    *("detec-\nted", "early", "onset\nms", "false\n/min", "cor-\nrect"),
    *("or\nnext", "most\noften", "share", "loca-\nted", "spread\nmm"),
)


def print_study(study: Study, console: Console, *, touches: bool = False) -> None:
    """All evaluations as tables, and how to read them; `touches` adds a table of every touch."""
    tables = [table(evaluation) for evaluation in study.evaluations]
    repeated = np.mean([log.repeated for log in study.logs])
    notes = (
        "* The settings were chosen with these files alone; calibrated: detection has no setting,",
        "noise and levels come from the untouched stretches of the other files, and links and",
        "points are those of the monitor's last report of a touch.",
        "Onset: delay of the detection after the start of the label, median/maximum. Labels",
        f"were set by hand: an onset up to {EARLY:g} s earlier belongs to the contact (early).",
        "False: onsets at any other time, per minute of that time.",
        "Correct, or next: share of the contacts for which the estimated link is the contact",
        "link, or that link or a neighbour. Most often, share: the link that is estimated most",
        "often. Located: share of the contacts with a located point (+ in the table of all",
        "contacts). Spread: RMS distance of a file's located points from their mean.",
        f"{repeated:.0%} of the rows repeat the row before; the monitor received all of them.",
    )
    print_tables(console, [touch_table(study), *tables] if touches else tables, notes)


def table(evaluation: Evaluation) -> Table:
    """One row a file."""
    title = f"Contacts of a Franka arm, {SOURCES[evaluation.settings.source]}"
    result = sheet(title, ("file\nlink",), FIGURES)
    for log in evaluation.logs:
        link, _ = most_frequent(log.touches)
        cells = _cells(summarise([log]), "-" if link is None else str(link))
        result.add_row(f"{log.name}{'*' if log.tuning else ' '} {log.link}", *cells)
    result.add_section()
    if any(not log.tuning for log in evaluation.logs):
        result.add_row("held out", *_cells(evaluation.held_out, ""))
    result.add_row("all", *_cells(evaluation.overall, ""), style="bold")
    return result


def touch_table(study: Study) -> Table:
    """One row a touch, both evaluations side by side."""
    figures = ("observer:\nonset, ms", "esti-\nmated", "vendor:\nonset, ms", "esti-\nmated")
    result = sheet("Every contact", ("file", "link", "label, s"), figures)
    for own, other in zip(study.measured.logs, study.vendor.logs, strict=True):
        for mine, theirs in zip(own.touches, other.touches, strict=True):
            label = f"{mine.start:.2f} to {mine.end:.2f}"
            cells = [cell for touch in (mine, theirs) for cell in _touch_cells(touch, own.link)]
            result.add_row(own.name + ("*" if own.tuning else ""), str(own.link), label, *cells)
        result.add_section()
    return result


def _touch_cells(touch: TouchResult, link: int) -> tuple[Text, Text]:
    delay = Text("missed", "red") if touch.delay is None else Text(f"{1e3 * touch.delay:.0f}")
    place = "+" if touch.located else " "
    named = Text(
        "-" if touch.link is None else f"{touch.link}{place}", "green" if touch.link == link else "red"
    )
    return delay, named


def _cells(figures: Summary, named: str) -> list[str]:
    onset = f"{1e3 * figures.delay_median:.0f}/{1e3 * figures.delay_max:.0f}" if figures.detected else "-"
    return [
        f"{figures.detected}/{figures.touches}",
        f"{figures.early}",
        onset,
        f"{figures.false_alarms_per_minute:.1f}",
        f"{figures.exact:.0%}",
        f"{figures.within_one:.0%}",
        named,
        f"{figures.agreement:.0%}",
        f"{figures.located:.0%}",
        scaled(figures.scatter, 1e3),
    ]


def as_data(study: Study) -> dict[str, Any]:
    """Everything for `print_json`, in SI units."""
    return {
        "study": "franka_touch",
        "measured": _evaluation_data(study.measured),
        "vendor": _evaluation_data(study.vendor),
        "calibrated": None if study.calibrated is None else _evaluation_data(study.calibrated),
    }


def _evaluation_data(evaluation: Evaluation) -> dict[str, Any]:
    files = [{**asdict(log), "summary": asdict(summarise([log]))} for log in evaluation.logs]
    held_out = [log for log in evaluation.logs if not log.tuning]
    return {
        "settings": asdict(evaluation.settings),
        "files": files,
        "held_out": asdict(evaluation.held_out) if held_out else None,
        "overall": asdict(evaluation.overall),
    }
