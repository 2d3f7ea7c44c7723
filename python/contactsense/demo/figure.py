"""The picture of a run: robots and signals of single hits, and the whole run."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from .._pictures import DETECTED, ESTIMATE, GREY, JOINTS, TEXT, TRUTH, picture_file, save_picture
from .._robot_view import share_scale
from .figure_robot import ROBOT_LEGEND, draw_robot
from .result import DemoResult, HitResult, ImperfectResult, Scored, Signals, Standing

_LEFT, _RIGHT = 0.07, 0.985
_TRUE_LINE: dict[str, Any] = {"color": TRUTH, "lw": 0.9, "ls": (0, (4, 2))}
_FORCE_LINE: dict[str, Any] = {"color": ESTIMATE, "lw": 2.6}
# Beside the robots' legend, so that it hides nothing in the panels.
_FORCE_LEGEND = (
    Line2D([], [], label="true, over time", **_TRUE_LINE),
    Line2D([], [], label="estimated force, where located", **_FORCE_LINE),
)


@dataclass(frozen=True)
class _Layout:
    """What differs between an arm in motion and a humanoid that stands; heights as shares of the picture."""

    size: tuple[float, float]  # [inch]
    title: str
    whole_title: str
    window: tuple[float, float]  # shown about the start of a hit [ms]
    force_top: float  # of the axes [N]
    robots: tuple[float, float]  # top and bottom, and so on
    legend: float
    close: tuple[float, float]
    whole: tuple[float, float]
    torques: bool  # whether joint torques are shown for each hit
    top: float = 0.977  # foot of the title
    row: float = 0.022  # of a legend
    beneath: float = 0.0  # height for the run of the imperfect arm [inch]


_ARM = _Layout(
    size=(12.0, 12.6),
    title="Contacts of an arm in fast motion, from joint torques",
    whole_title="The whole run",
    window=(-15.0, 95.0),
    force_top=110.0,
    robots=(0.885, 0.67),
    legend=0.654,
    close=(0.62, 0.25),
    whole=(0.19, 0.05),
    torques=True,
    beneath=2.9,
)
_HUMANOID = _Layout(
    size=(15.0, 12.0),
    title="Contacts of a standing humanoid, from its own measurements",
    whole_title="The whole run: the ground's forces on the feet, and the contacts",
    window=(-40.0, 360.0),
    force_top=130.0,
    robots=(0.87, 0.575),
    legend=0.553,
    close=(0.53, 0.345),
    whole=(0.285, 0.05),
    torques=False,
)


def _with_room(layout: _Layout) -> _Layout:
    """Taller, with everything as far from the top as before and `beneath` at the foot."""
    width, height = layout.size
    taller = height + layout.beneath

    def moved(place: float) -> float:
        return 1.0 - (1.0 - place) * height / taller

    return replace(
        layout,
        size=(width, taller),
        top=moved(layout.top),
        robots=(moved(layout.robots[0]), moved(layout.robots[1])),
        legend=moved(layout.legend),
        row=layout.row * height / taller,
        close=(moved(layout.close[0]), moved(layout.close[1])),
        whole=(moved(layout.whole[0]), moved(layout.whole[1])),
    )


def save_figure(result: DemoResult, path: str | os.PathLike[str]) -> Path:
    """See `contactsense.demo.save_picture`."""
    layout = _ARM if result.standing is None else _HUMANOID
    if result.imperfect is not None:
        layout = _with_room(layout)
    target = picture_file("path", path)
    return save_picture(
        "path", target, layout.size, lambda figure: _draw(figure, result, layout), constrained=False
    )


def _draw(figure: Figure, result: DemoResult, layout: _Layout) -> None:
    figure.text(_LEFT, layout.top, layout.title, fontsize=17, weight="bold")
    subtitle = _moving(result) if result.standing is None else _standing(result, result.standing)
    figure.text(
        _LEFT, layout.top - 0.4 * layout.row, subtitle, fontsize=10.5, color=TEXT, va="top", linespacing=1.4
    )
    # An arm is hit on the same links again and again: the first hit of each is shown close up.
    hits = list({hit.link: hit for hit in reversed(result.hits)}.values())[::-1]
    heights = (3.3, 2.6, 0.5) if layout.torques else (2.6, 0.5)

    def grid(rows: int, columns: int, ends: tuple[float, float], **options: Any) -> Any:
        sides = {"left": _LEFT, "right": _RIGHT, "wspace": 0.09, "hspace": 0.15}
        return figure.add_gridspec(rows, columns, top=ends[0], bottom=ends[1], **sides, **options)

    robots = grid(1, len(hits), layout.robots)
    close = grid(len(heights), len(hits), layout.close, height_ratios=heights)
    views = [figure.add_subplot(robots[0, column]) for column in range(len(hits))]
    first: list[Axes] | None = None
    for column, hit in enumerate(hits):
        draw_robot(views[column], result.robot, hit)
        axes = [
            figure.add_subplot(close[row, column], sharey=first[row] if first else None)
            for row in range(len(heights))
        ]
        if layout.torques:
            _torques(axes[0], result.signals, hit, layout)
        _force(axes[-2], result.signals, hit, layout)
        _bands(axes[-1], 1e3 * (result.signals.time - hit.start), result.signals)
        _finish(axes, hit, layout, leftmost=first is None)
        first = first or axes
    share_scale(views)
    if layout.torques:
        _legend(figure, ROBOT_LEGEND, layout.legend)
        joints = [
            Line2D([], [], color=colour, lw=2.6, label=f"joint {number}")
            for number, colour in enumerate(JOINTS, 1)
        ]
        _legend(figure, [*joints, *_FORCE_LEGEND], layout.legend - layout.row)
    else:
        _legend(figure, [*ROBOT_LEGEND, *_FORCE_LEGEND], layout.legend)
    heights = (2.6, 0.5) if result.standing is None else (2.2, 2.0, 0.5)
    whole = grid(len(heights), 1, layout.whole, height_ratios=heights)
    axes = [figure.add_subplot(whole[row, 0]) for row in range(len(heights))]
    if result.standing is not None:
        _ground(axes[0], result.signals, result.standing)
    # A force panel of one run has the scale of the other's.
    top = 1.6 * max(hit.force for hit in result.hits)
    _whole_run(axes, result, layout.whole_title if result.imperfect is None else _title(result), top)
    if result.imperfect is not None:
        room = layout.beneath / layout.size[1]
        beneath = grid(2, 1, (0.82 * room, 0.24 * room), height_ratios=heights)
        axes = [figure.add_subplot(beneath[row, 0]) for row in range(2)]
        _whole_run(axes, result.imperfect, _imperfect_title(result.imperfect), top)


def _moving(result: DemoResult) -> str:
    noise = result.noise
    kind = "ideal torques" if noise.none else f"torque noise {noise.percent:g} % + {noise.newton_metres:g} Nm"
    return (
        f"{result.robot_name} in simulation, joints at up to {result.planned_speed:.1f} rad/s, {kind}, seed "
        f"{result.seed}. Only joint positions, velocities and torques are used.\n"
        f"{result.detected} of {len(result.hits)} contacts detected, {result.links_right} links correct, "
        f"{len(result.located)} points located."
        + ("" if result.imperfect is None else " The lowest panel: the same with the errors of a real arm.")
    )


def _standing(result: DemoResult, standing: Standing) -> str:
    noise, sensors = result.noise, result.sensor_noise
    kept = "It keeps standing" if standing.kept else "It FALLS"
    return (
        f"{result.robot_name} in simulation, on the ground, seed {result.seed}; torque noise "
        f"{noise.percent:g} % + {noise.newton_metres:g} Nm, noise of its nine force/torque sensors "
        f"{sensors.newtons:g} N, {sensors.newton_metres:g} Nm. The ground's forces on the feet are wanted "
        f"contacts.\n{kept}: the pelvis moves by {1e3 * standing.moved:.0f} mm at most. {result.detected} of "
        f"{len(result.hits)} contacts detected, {result.links_right} links correct, "
        f"{len(result.located)} points located, {result.false_alarms} false alarms."
    )


def _legend(figure: Figure, handles: Sequence[Artist], height: float) -> None:
    """In one row in the middle, at `height` of the figure."""
    place = (0.53, height)
    figure.legend(
        handles=handles, loc="center", bbox_to_anchor=place, ncols=len(handles), fontsize=9, frameon=False
    )


def _rows_about(
    signals: Signals, hit: HitResult, window: tuple[float, float]
) -> tuple[NDArray[np.float64], slice]:
    """Milliseconds since the hit's start within `window` [ms], and the rows they stand for."""
    ends = np.searchsorted(signals.time, hit.start + 1e-3 * np.array(window))
    rows = slice(int(ends[0]), int(ends[1]))
    return 1e3 * (signals.time[rows] - hit.start), rows


def _torques(axes: Axes, signals: Signals, hit: HitResult, layout: _Layout) -> None:
    time, rows = _rows_about(signals, hit, layout.window)
    for joint, torque in enumerate(signals.torque[rows].T):
        axes.plot(time, torque, color=JOINTS[joint], lw=2.6)
    for torque in signals.true_torque[rows].T:
        axes.plot(time, torque, **_TRUE_LINE)


def _force(axes: Axes, signals: Signals, hit: HitResult, layout: _Layout) -> None:
    """Magnitude of the force about one hit, true and estimated."""
    time, rows = _rows_about(signals, hit, layout.window)
    axes.fill_between(time, signals.true_force[rows], color=TRUTH, alpha=0.12, lw=0)
    axes.plot(time, signals.true_force[rows], **_TRUE_LINE)
    axes.set_ylim(-4.0, layout.force_top)
    axes.plot(time, signals.force[rows], **_FORCE_LINE)
    if not hit.located:
        note = "not detected" if hit.delay is None else "point and force\nnot determined"
        axes.text(0.97, 0.84, note, ha="right", va="top", transform=axes.transAxes, color=TEXT)


def _bands(axes: Axes, time: NDArray[np.float64], signals: Signals) -> None:
    """Two strips: truly hit, and detected."""
    hit = (signals.true_force > 0.0).tolist()
    axes.fill_between(time, 1.1, 1.9, where=hit, color=TRUTH, alpha=0.5, lw=0)
    axes.fill_between(time, 0.1, 0.9, where=signals.collision.tolist(), color=DETECTED, lw=0)
    axes.set_ylim(0.0, 2.0)
    axes.set_yticks((0.5, 1.5), ("detected", "true contact"), fontsize=9)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)


def _finish(axes: list[Axes], hit: HitResult, layout: _Layout, *, leftmost: bool) -> None:
    for each in axes:
        each.set_xlim(*layout.window)
        each.tick_params(labelleft=leftmost, labelbottom=each is axes[-1])
    for each in axes[:-1]:
        each.axhline(0.0, color=GREY, lw=0.6, zorder=0)
    if hit.delay is not None:
        place: Any = {"ha": "right", "va": "top", "transform": axes[-2].transAxes}
        axes[-2].text(0.97, 0.97, f"detected after {1e3 * hit.delay:.0f} ms", color=TEXT, **place)
    axes[-1].set_xlabel("time since the contact began [ms]")
    if leftmost:
        axes[-2].set_ylabel("force [N]")
        if layout.torques:
            axes[0].set_ylabel("external torque [Nm]")


def _title(result: DemoResult) -> str:
    kind = "ideal torques" if result.noise.none else "noisy torques"
    return f"The whole run, as above ({kind}): {_counts(result)}"


def _imperfect_title(result: ImperfectResult) -> str:
    return (
        "The same contacts on an arm with the errors of a real one, calibrated with "
        f"{result.calibration_seconds:.0f} s of other motion:\n{_counts(result)}"
    )


def _counts(run: Scored) -> str:
    alarms = f"{run.false_alarms} false alarm{'' if run.false_alarms == 1 else 's'}"
    return (
        f"{run.detected} of {len(run.hits)} detected, {run.links_right} links correct, "
        f"{len(run.located)} located, {alarms}"
    )


def _whole_run(axes: list[Axes], run: Scored, title: str, top: float) -> None:
    """Forces and detection from start to end, in the last two of `axes`."""
    signals, (force, bands) = run.signals, axes[-2:]
    force.fill_between(signals.time, signals.true_force, color=TRUTH, alpha=0.3, lw=0)
    force.plot(signals.time, signals.force, color=ESTIMATE, lw=1.6)
    for hit in run.hits:
        force.annotate(
            f"{hit.number}: {_short(hit.link)}\n{_estimate(hit)}",
            (hit.start + 0.5 * hit.duration, hit.force),
            (0, 4),
            textcoords="offset points",
            ha="center",
            fontsize=8.5,
            color=TEXT,
        )
    force.set_ylim(0.0, top)
    force.set_ylabel("force [N]")
    _bands(bands, signals.time, signals)
    for each in axes:
        each.set_xlim(signals.time[0], signals.time[-1])
        each.tick_params(labelbottom=each is bands)
    axes[0].set_title(title, weight="bold")
    bands.set_xlabel("time [s]")


def _ground(axes: Axes, signals: Signals, standing: Standing) -> None:
    for number, foot in enumerate(standing.feet):
        label = f"ground on {foot.replace('_', ' ')}, measured"
        axes.plot(signals.time, standing.ground[:, number], color=JOINTS[number], lw=1.6, label=label)
    axes.set_ylim(0.0, 1.35 * float(standing.ground.max()))
    axes.legend(fontsize=9, frameon=False, loc="upper right", ncols=2)
    axes.set_ylabel("force [N]")


def _short(link: str) -> str:
    return link.removeprefix("iiwa_").replace("_", " ")


def _estimate(hit: HitResult) -> str:
    if hit.named is None:
        return "not detected" if hit.delay is None else "no link named"
    if hit.point_error is not None:
        return f"{1e3 * hit.point_error:.1f} mm off"
    return "link only" if hit.link_right else f"wrong link: {_short(hit.named)}"
