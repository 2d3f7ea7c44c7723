"""The picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from contactsense._pictures import GREY

from ..harness import Pictures
from .arms import KINDS
from .recover import Recovery
from .score import table
from .study import Study

_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00")
_STYLES = dict(zip(KINDS, ("--", "-"), strict=True))
_COVERED = ("bias", "coulomb", "mass", "com")


def draw(figure: Figure, study: Study) -> None:
    """Errors of mass and centre of the payload as distributions, and how often the stated ones cover them."""
    figure.suptitle("Payloads that calibration recovers", x=0.01, ha="left", weight="bold")
    axes: Any = figure.subplots(1, 3)
    colours = {robot: _COLOURS[k % len(_COLOURS)] for k, robot in enumerate(study.robots)}
    for (robot, kind), runs in study.found.items():
        line = {"color": colours[robot], "ls": _STYLES[kind], "label": f"{robot}, {kind}"}
        _shares(axes[0], [100.0 * abs(each.mass) for each in runs], line)
        _shares(axes[1], [1e3 * float(np.linalg.norm(each.com)) for each in runs], line)
        _coverage(axes[2], runs, {**line, "marker": "o", "ms": 4})
    axes[0].set(xlabel="error of the mass [%]", ylabel="share of arms with a smaller one", xscale="log")
    axes[1].set(xlabel="error of the centre [mm]", xscale="log")
    axes[2].axhline(0.9, color=GREY, lw=1)
    axes[2].set_xticks(range(len(_COVERED)), ("bias", "Coulomb", "mass", "centre"))
    axes[2].set(ylim=(0.0, 1.03), ylabel="covered by the stated 90 %")
    axes[0].legend(frameon=False, fontsize="small")


def _shares(axes: Any, errors: list[float], line: dict[str, Any]) -> None:
    axes.plot(np.sort(errors), (np.arange(len(errors)) + 0.5) / len(errors), marker=".", **line)
    axes.set_ylim(0.0, 1.0)


def _coverage(axes: Any, runs: list[Recovery], line: dict[str, Any]) -> None:
    found = table(runs)
    axes.plot([found[f"{name}_covered"] for name in _COVERED], **line)


PICTURES: Pictures = {"recovery.png": ((13.0, 4.6), draw)}
