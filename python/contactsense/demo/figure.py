"""The picture of a run: three hits close up, and forces and detection over the whole run."""

from __future__ import annotations

import os
from collections.abc import Sequence
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

from ..errors import InputError
from .figure_arm import ARM_LEGEND, draw_arm
from .plan import LINKS
from .result import DemoResult, HitResult, Signals
from .style import DETECTED, ESTIMATE, GREY, JOINTS, TEXT, TRUTH

# Shown about the start of a hit [ms].
_WINDOW = (-15.0, 95.0)
_TRUE_LINE: dict[str, Any] = {"color": TRUTH, "lw": 0.9, "ls": (0, (4, 2))}


def save_figure(result: DemoResult, path: str | os.PathLike[str]) -> Path:
    """See `contactsense.demo.save_picture`."""
    target = Path(path).resolve()
    style: Any = {
        "font.size": 10,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.edgecolor": GREY,
        "axes.titlesize": 11,
    }
    with matplotlib.rc_context(style):
        figure = _draw(result)
        try:
            figure.savefig(target, dpi=130, facecolor="white")
        except (OSError, ValueError) as cause:
            raise InputError(f"out: cannot write '{path}': {cause}") from cause
    return target


def _draw(result: DemoResult) -> Figure:
    figure = Figure(figsize=(12.0, 12.6))
    FigureCanvasAgg(figure)
    left = 0.075
    figure.text(left, 0.978, "An arm in fast motion feels where it is hit", fontsize=17, weight="bold")
    figure.text(left, 0.969, _subtitle(result), fontsize=10.5, color=TEXT, va="top", linespacing=1.4)
    sides = {"left": left, "right": 0.985, "wspace": 0.1, "hspace": 0.16}
    arms = figure.add_gridspec(1, 3, top=0.9, bottom=0.665, **sides)
    close = figure.add_gridspec(3, 3, height_ratios=(3.3, 2.6, 0.5), top=0.62, bottom=0.25, **sides)
    whole = figure.add_gridspec(2, 1, height_ratios=(2.6, 0.5), top=0.19, bottom=0.05, **sides)
    _legend(figure, ARM_LEGEND, 0.654)
    lines = [
        Line2D([], [], color=colour, lw=2.6, label=f"joint {number}")
        for number, colour in enumerate(JOINTS, 1)
    ]
    _legend(figure, [*lines, Line2D([], [], label="true", **_TRUE_LINE)], 0.632)
    rows: list[Axes] = []
    for column, link in enumerate(LINKS):
        hit = next(hit for hit in result.hits if hit.link == link)
        draw_arm(figure.add_subplot(arms[0, column], projection="3d"), result.robot, hit)
        shared: list[Axes] | list[None] = rows or [None, None, None]
        axes = [figure.add_subplot(close[row, column], sharey=shared[row]) for row in range(3)]
        _torques(axes[0], result.signals, hit)
        _force(axes[1], result.signals, hit)
        _bands(axes[2], 1e3 * (result.signals.time - hit.start), result.signals)
        _finish(axes, first=not rows)
        rows = rows or axes
    _whole_run(figure, [figure.add_subplot(whole[row, 0]) for row in range(2)], result)
    return figure


def _legend(figure: Figure, handles: Sequence[Artist], height: float) -> None:
    place = (0.53, height)
    figure.legend(
        handles=handles, loc="center", bbox_to_anchor=place, ncols=len(handles), fontsize=9, frameon=False
    )


def _subtitle(result: DemoResult) -> str:
    noise = result.noise
    kind = (
        "no torque noise" if noise.none else f"torque noise {noise.percent:g} % + {noise.newton_metres:g} Nm"
    )
    return (
        f"{result.robot_name} in simulation, joints at up to {result.planned_speed:.1f} rad/s, {kind}, seed "
        f"{result.seed}. Only joint positions, velocities and torques are used.\n"
        f"{result.detected} of {len(result.hits)} hits felt, {result.links_right} links named right, "
        f"{len(result.located)} points located."
    )


def _rows(signals: Signals, hit: HitResult) -> tuple[NDArray[np.float64], slice]:
    """Milliseconds since the hit's start, and the rows they stand for."""
    ends = np.searchsorted(signals.time, hit.start + 1e-3 * np.array(_WINDOW))
    rows = slice(int(ends[0]), int(ends[1]))
    return 1e3 * (signals.time[rows] - hit.start), rows


def _torques(axes: Axes, signals: Signals, hit: HitResult) -> None:
    time, rows = _rows(signals, hit)
    for joint, torque in enumerate(signals.torque[rows].T):
        axes.plot(time, torque, color=JOINTS[joint], lw=2.6)
    for torque in signals.true_torque[rows].T:
        axes.plot(time, torque, **_TRUE_LINE)


def _force(axes: Axes, signals: Signals, hit: HitResult) -> None:
    time, rows = _rows(signals, hit)
    axes.fill_between(time, signals.true_force[rows], color=TRUTH, alpha=0.12, lw=0)
    axes.plot(time, signals.true_force[rows], label="true", **_TRUE_LINE)
    axes.set_ylim(-4.0, 110.0)
    axes.plot(time, signals.force[rows], color=ESTIMATE, lw=2.6, label="estimated, where located")
    if not hit.located:
        note = "not felt" if hit.delay is None else "point open, and so\nis the force"
        axes.text(0.97, 0.9, note, ha="right", va="top", transform=axes.transAxes, color=TEXT)


def _bands(axes: Axes, time: NDArray[np.float64], signals: Signals) -> None:
    """Two strips: truly hit, and detected."""
    hit = (signals.true_force > 0.0).tolist()
    axes.fill_between(time, 1.1, 1.9, where=hit, color=TRUTH, alpha=0.5, lw=0)
    axes.fill_between(time, 0.1, 0.9, where=signals.collision.tolist(), color=DETECTED, lw=0)
    axes.set_ylim(0.0, 2.0)
    axes.set_yticks((0.5, 1.5), ("detected", "true hit"), fontsize=9)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)


def _finish(axes: list[Axes], *, first: bool) -> None:
    for each in axes:
        each.set_xlim(*_WINDOW)
        each.tick_params(labelleft=first, labelbottom=each is axes[-1])
    for each in axes[:-1]:
        each.axhline(0.0, color=GREY, lw=0.6, zorder=0)
    axes[-1].set_xlabel("time since the hit began [ms]")
    if first:
        axes[0].set_ylabel("external torque [Nm]")
        axes[1].set_ylabel("force [N]")
        axes[1].legend(fontsize=9, frameon=False, loc="upper right", ncols=2, handlelength=1.6)


def _whole_run(figure: Figure, axes: list[Axes], result: DemoResult) -> None:
    signals = result.signals
    force, bands = axes
    force.fill_between(signals.time, signals.true_force, color=TRUTH, alpha=0.3, lw=0)
    force.plot(signals.time, signals.force, color=ESTIMATE, lw=1.6)
    for hit in result.hits:
        middle = hit.start + 0.5 * hit.duration
        force.annotate(
            f"{hit.number}: {_short(hit.link)}\n{_said(hit)}",
            (middle, hit.force),
            (0, 4),
            textcoords="offset points",
            ha="center",
            fontsize=8.5,
            color=TEXT,
        )
    _bands(bands, signals.time, signals)
    for each in axes:
        each.set_xlim(signals.time[0], signals.time[-1])
    force.set_ylim(0.0, 1.45 * max(hit.force for hit in result.hits))
    force.tick_params(labelbottom=False)
    force.set_ylabel("force [N]")
    force.set_title("The whole run", loc="left", weight="bold")
    bands.set_xlabel("time [s]")


def _short(link: str) -> str:
    return link.removeprefix("iiwa_").replace("_", " ")


def _said(hit: HitResult) -> str:
    if hit.named is None:
        return "not felt"
    if hit.point_error is not None:
        return f"{1e3 * hit.point_error:.1f} mm off"
    return "named" if hit.link_right else f"named {_short(hit.named)}"
