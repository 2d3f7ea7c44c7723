"""The picture of a run: every push close up, and what the feet carry over the whole run."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..._pictures import ESTIMATE, GREY, JOINTS, TEXT, TRUTH
from ..figure_parts import FORCE_LEGEND, draw_bands, draw_force, draw_legend, save_styled
from ..figure_robot import ROBOT_LEGEND, draw_robot
from ..result import DemoResult, HitResult, Standing

# Shown about the start of a push [ms].
_WINDOW = (-40.0, 360.0)
_SIZE = (15.0, 12.0)  # of the picture [inch]
_LEFT, _RIGHT = 0.06, 0.985
_ROBOT, _ROBOT_BOTTOM = (4.3 / _SIZE[0], 4.3 / _SIZE[1]), 0.547


def save_figure(result: DemoResult, path: str | os.PathLike[str]) -> Path:
    """See `contactsense.demo.save_picture`."""
    return save_styled(lambda: _draw(result), path)


def _draw(result: DemoResult) -> Figure:
    assert result.standing is not None
    figure = Figure(figsize=_SIZE)
    figure.text(_LEFT, 0.975, "A standing humanoid feels where it is pushed", fontsize=17, weight="bold")
    figure.text(
        _LEFT,
        0.966,
        _subtitle(result, result.standing),
        fontsize=10.5,
        color=TEXT,
        va="top",
        linespacing=1.4,
    )
    count = len(result.hits)
    sides = {"left": _LEFT, "right": _RIGHT, "wspace": 0.08, "hspace": 0.14}
    close = figure.add_gridspec(2, count, height_ratios=(2.6, 0.5), top=0.53, bottom=0.345, **sides)
    whole = figure.add_gridspec(3, 1, height_ratios=(2.2, 2.0, 0.5), top=0.285, bottom=0.05, **sides)
    draw_legend(figure, [*ROBOT_LEGEND, *FORCE_LEGEND], 0.553)
    first: list[Axes] = []
    for column, hit in enumerate(result.hits):
        axes = [
            figure.add_subplot(close[row, column], sharey=first[row] if first else None) for row in range(2)
        ]
        box = axes[0].get_position()
        place = (0.5 * (box.x0 + box.x1) - 0.5 * _ROBOT[0], _ROBOT_BOTTOM, *_ROBOT)
        draw_robot(figure.add_axes(place, projection="3d", zorder=-1), result.robot, hit, narrow=True)
        draw_force(axes[0], result.signals, hit, _WINDOW)
        axes[0].set_ylim(-4.0, 130.0)
        draw_bands(axes[1], 1e3 * (result.signals.time - hit.start), result.signals)
        _finish(axes, hit, leftmost=not first)
        first = first or axes
    _whole_run([figure.add_subplot(whole[row, 0]) for row in range(3)], result, result.standing)
    return figure


def _subtitle(result: DemoResult, standing: Standing) -> str:
    newtons, newton_metres = standing.sensor_noise
    noise = result.noise
    kept = "It keeps standing" if standing.kept else "It FALLS"
    return (
        f"{result.robot_name} in simulation, on the ground, seed {result.seed}; torque noise "
        f"{noise.percent:g} % + {noise.newton_metres:g} Nm, noise of its nine force/torque sensors "
        f"{newtons:g} N, {newton_metres:g} Nm. The ground's forces on the feet are wanted contacts.\n"
        f"{kept}: the pelvis moves by {1e3 * standing.moved:.0f} mm at most. {result.detected} of "
        f"{len(result.hits)} pushes felt, {result.links_right} links named right, "
        f"{len(result.located)} points located, {result.false_alarms} false alarms."
    )


def _finish(axes: list[Axes], hit: HitResult, *, leftmost: bool) -> None:
    for each in axes:
        each.set_xlim(*_WINDOW)
        each.tick_params(labelleft=leftmost, labelbottom=each is axes[-1])
    axes[0].axhline(0.0, color=GREY, lw=0.6, zorder=0)
    if hit.delay is not None:
        axes[0].text(
            0.97,
            0.96,
            f"felt after {1e3 * hit.delay:.0f} ms",
            ha="right",
            va="top",
            transform=axes[0].transAxes,
            color=TEXT,
        )
    axes[-1].set_xlabel("time since the push began [ms]")
    if leftmost:
        axes[0].set_ylabel("force [N]")


def _whole_run(axes: list[Axes], result: DemoResult, standing: Standing) -> None:
    signals = result.signals
    ground, force, bands = axes
    for number, foot in enumerate(standing.feet):
        label = f"ground on {foot.replace('_', ' ')}, measured"
        ground.plot(signals.time, standing.ground[:, number], color=JOINTS[number], lw=1.6, label=label)
    ground.set_ylim(0.0, 1.35 * float(standing.ground.max()))
    ground.legend(fontsize=9, frameon=False, loc="upper right", ncols=2)
    ground.set_ylabel("force [N]")
    ground.set_title("The whole run: the ground on the feet, and the pushes", loc="left", weight="bold")
    force.fill_between(signals.time, signals.true_force, color=TRUTH, alpha=0.3, lw=0)
    force.plot(signals.time, signals.force, color=ESTIMATE, lw=1.6)
    for hit in result.hits:
        force.annotate(
            f"{hit.link}\n{_said(hit)}",
            (hit.start + 0.5 * hit.duration, hit.force),
            (0, 4),
            textcoords="offset points",
            ha="center",
            fontsize=8.5,
            color=TEXT,
        )
    force.set_ylim(0.0, 1.6 * max(hit.force for hit in result.hits))
    force.set_ylabel("force [N]")
    draw_bands(bands, signals.time, signals)
    for each in axes:
        each.set_xlim(signals.time[0], signals.time[-1])
        each.tick_params(labelbottom=each is bands)
    bands.set_xlabel("time [s]")


def _said(hit: HitResult) -> str:
    if hit.named is None:
        return "not felt"
    if hit.point_error is not None and np.isfinite(hit.point_error):
        return f"{1e3 * hit.point_error:.1f} mm off"
    return "named" if hit.link_right else f"named {hit.named}"
