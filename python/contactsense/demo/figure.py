"""The picture of a run: three hits close up, and forces and detection over the whole run."""

from __future__ import annotations

import os
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from .._pictures import ESTIMATE, GREY, JOINTS, TEXT, TRUTH
from .figure_parts import (
    FORCE_LEGEND,
    TRUE_LINE,
    draw_bands,
    draw_force,
    draw_legend,
    rows_about,
    save_styled,
)
from .figure_robot import ROBOT_LEGEND, draw_robot
from .plan import LINKS
from .result import DemoResult, HitResult, Signals

# Shown about the start of a hit [ms].
_WINDOW = (-15.0, 95.0)


def save_figure(result: DemoResult, path: str | os.PathLike[str]) -> Path:
    """See `contactsense.demo.save_picture`."""
    return save_styled(lambda: _draw(result), path)


def _draw(result: DemoResult) -> Figure:
    figure = Figure(figsize=(12.0, 12.6))
    left = 0.075
    figure.text(left, 0.978, "An arm in fast motion feels where it is hit", fontsize=17, weight="bold")
    figure.text(left, 0.969, _subtitle(result), fontsize=10.5, color=TEXT, va="top", linespacing=1.4)
    sides = {"left": left, "right": 0.985, "wspace": 0.1, "hspace": 0.16}
    arms = figure.add_gridspec(1, 3, top=0.9, bottom=0.665, **sides)
    close = figure.add_gridspec(3, 3, height_ratios=(3.3, 2.6, 0.5), top=0.62, bottom=0.25, **sides)
    whole = figure.add_gridspec(2, 1, height_ratios=(2.6, 0.5), top=0.19, bottom=0.05, **sides)
    draw_legend(figure, ROBOT_LEGEND, 0.654)
    lines = [
        Line2D([], [], color=colour, lw=2.6, label=f"joint {number}")
        for number, colour in enumerate(JOINTS, 1)
    ]
    draw_legend(figure, [*lines, *FORCE_LEGEND], 0.632)
    rows: list[Axes] = []
    for column, link in enumerate(LINKS):
        hit = next(hit for hit in result.hits if hit.link == link)
        draw_robot(figure.add_subplot(arms[0, column], projection="3d"), result.robot, hit)
        shared: list[Axes] | list[None] = rows or [None, None, None]
        axes = [figure.add_subplot(close[row, column], sharey=shared[row]) for row in range(3)]
        _torques(axes[0], result.signals, hit)
        draw_force(axes[1], result.signals, hit, _WINDOW)
        draw_bands(axes[2], 1e3 * (result.signals.time - hit.start), result.signals)
        _finish(axes, first=not rows)
        rows = rows or axes
    _whole_run(figure, [figure.add_subplot(whole[row, 0]) for row in range(2)], result)
    return figure


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


def _torques(axes: Axes, signals: Signals, hit: HitResult) -> None:
    time, rows = rows_about(signals, hit, _WINDOW)
    for joint, torque in enumerate(signals.torque[rows].T):
        axes.plot(time, torque, color=JOINTS[joint], lw=2.6)
    for torque in signals.true_torque[rows].T:
        axes.plot(time, torque, **TRUE_LINE)


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
    draw_bands(bands, signals.time, signals)
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
