"""The picture."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from ..harness import Pictures
from .judge import CLOSE
from .study import Study

# Beyond it an error is drawn at the edge, below it at the other [m].
_RANGE = (1e-4, 1.0)
_RIGHT, _WRONG = "#0072B2", "#D55E00"


def draw(figure: Figure, study: Study) -> None:
    """The errors of all contacts by their number, in rising order."""
    figure.suptitle(f"Error of each contact point, {study.options.robot}", x=0.01, ha="left", weight="bold")
    axes: Any = figure.subplots()
    for contacts in study.options.contacts:
        rows = [(error, each.links_right) for each in study.judged(contacts) for error in each.errors]
        rows.sort()
        for k, (error, right) in enumerate(rows):
            across = contacts - 0.35 + 0.7 * (k + 0.5) / len(rows)
            shown = 1e3 * min(max(error, _RANGE[0]), _RANGE[1])
            axes.plot(across, shown, "o", ms=4, mec="none", color=_RIGHT if right else _WRONG)
    axes.axhline(1e3 * CLOSE, color="#BBBBBB", lw=1, zorder=0)
    axes.set_yscale("log")
    axes.set_xticks(study.options.contacts)
    axes.set_xlabel("contacts at the same time")
    axes.set_ylabel("error [mm]")
    axes.plot([], [], "o", color=_RIGHT, label="all links right")
    axes.plot([], [], "o", color=_WRONG, label="not all links right")
    axes.legend(frameon=False, fontsize="small")


PICTURES: Pictures = {"several_contacts.png": ((7.0, 4.6), draw)}
