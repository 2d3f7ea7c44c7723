"""What the pictures of all robots share: style, legends, the force of one hit, strips of detection."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from .._pictures import DETECTED, ESTIMATE, GREY, TEXT, TRUTH, picture_file
from ..errors import InputError
from .result import HitResult, Signals

TRUE_LINE: dict[str, Any] = {"color": TRUTH, "lw": 0.9, "ls": (0, (4, 2))}
_FORCE_LINE: dict[str, Any] = {"color": ESTIMATE, "lw": 2.6}
# Beside the robots' legend, so that it hides nothing in the panels.
FORCE_LEGEND = (
    Line2D([], [], label="true, over time", **TRUE_LINE),
    Line2D([], [], label="estimated force, where located", **_FORCE_LINE),
)


def save_styled(draw: Callable[[], Figure], path: str | os.PathLike[str]) -> Path:
    """Draws and writes a picture; returns its absolute path.

    Raises:
        InputError: the file cannot be written.
    """
    target = picture_file("path", path)
    style: Any = {
        "font.size": 10,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.edgecolor": GREY,
        "axes.titlesize": 11,
    }
    with matplotlib.rc_context(style):
        figure = draw()
        FigureCanvasAgg(figure)
        try:
            figure.savefig(target, dpi=130, facecolor="white")
        except (OSError, ValueError) as cause:
            raise InputError(f"path: cannot write '{path}': {cause}") from cause
    return target


def draw_legend(figure: Figure, handles: Sequence[Artist], height: float) -> None:
    """In one row in the middle, at `height` of the figure."""
    place = (0.53, height)
    figure.legend(
        handles=handles, loc="center", bbox_to_anchor=place, ncols=len(handles), fontsize=9, frameon=False
    )


def rows_about(
    signals: Signals, hit: HitResult, window: tuple[float, float]
) -> tuple[NDArray[np.float64], slice]:
    """Milliseconds since the hit's start within `window` [ms], and the rows they stand for."""
    ends = np.searchsorted(signals.time, hit.start + 1e-3 * np.array(window))
    rows = slice(int(ends[0]), int(ends[1]))
    return 1e3 * (signals.time[rows] - hit.start), rows


def draw_force(axes: Axes, signals: Signals, hit: HitResult, window: tuple[float, float]) -> None:
    """Magnitude of the force about one hit, true and estimated."""
    time, rows = rows_about(signals, hit, window)
    axes.fill_between(time, signals.true_force[rows], color=TRUTH, alpha=0.12, lw=0)
    axes.plot(time, signals.true_force[rows], **TRUE_LINE)
    axes.set_ylim(-4.0, 110.0)
    axes.plot(time, signals.force[rows], **_FORCE_LINE)
    if not hit.located:
        note = "not felt" if hit.delay is None else "point and force\nnot determined"
        axes.text(0.97, 0.84, note, ha="right", va="top", transform=axes.transAxes, color=TEXT)


def draw_bands(axes: Axes, time: NDArray[np.float64], signals: Signals) -> None:
    """Two strips: truly hit, and detected."""
    hit = (signals.true_force > 0.0).tolist()
    axes.fill_between(time, 1.1, 1.9, where=hit, color=TRUTH, alpha=0.5, lw=0)
    axes.fill_between(time, 0.1, 0.9, where=signals.collision.tolist(), color=DETECTED, lw=0)
    axes.set_ylim(0.0, 2.0)
    axes.set_yticks((0.5, 1.5), ("detected", "true hit"), fontsize=9)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
