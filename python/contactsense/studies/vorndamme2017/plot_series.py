"""A hit over time, after Fig. 10."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ...demo.style import DETECTED, ESTIMATE, GREY, NAMED, TEXT, TRUTH
from .instruments import SENSOR_LINKS, Method, carries
from .study import Study
from .time_series import DURATION, Series

COLOURS: dict[Method, str] = {"torques": ESTIMATE, "both": DETECTED, "sensors": NAMED}
LABELS: dict[Method, str] = {
    "torques": "joint torques",
    "both": "joint torques and sensors",
    "sensors": "sensors alone",
}


def draw_series(figure: Figure, study: Study) -> None:
    """Left: one hit's force and point error; right: the point errors of all hits that sensors feel."""
    amplitude, hits = study.hits[0].amplitude, study.hits[0].series
    felt = [hit for hit in hits if _sensed(study, hit)] or hits
    one = next((hit for hit in felt if hit.scene.links[0] not in ("utorso", "head")), felt[0])
    axes = figure.subplots(2, 2, sharex=True)
    force, point = axes[:, 0]
    axis = int(np.argmax(np.abs(one.scene.touches[0].force)))
    milliseconds = 1e3 * one.time
    force.plot(milliseconds, one.force[:, axis], color=TRUTH, lw=1.2, ls=(0, (4, 2)), label="true")
    for method, signal in one.signals.items():
        force.plot(
            milliseconds, signal.force[:, axis], "o-", ms=3, color=COLOURS[method], label=LABELS[method]
        )
    force.set_ylabel(f"{'xyz'[axis]} component of the force [N]")
    force.set_title(f"A hit of {amplitude:g} N on {one.scene.links[0]}", weight="bold")
    force.legend(frameon=False, fontsize=9)
    spread = axes[0, 1]
    for method in one.signals:
        peaks = np.array([np.nan_to_num(hit.signals[method].force) for hit in felt])
        along = np.einsum("ijk,ik->ij", peaks, np.array([_direction(hit) for hit in felt])) / amplitude
        _band(spread, milliseconds, along, COLOURS[method])
    spread.plot(milliseconds, one.force @ _direction(one) / amplitude, color=TRUTH, lw=1.2, ls=(0, (4, 2)))
    spread.set_ylabel("force found / greatest true force")
    spread.set_title(f"{len(felt)} hits that a sensor feels: median, 90 %", weight="bold")
    for method, signal in one.signals.items():
        _errors(point, milliseconds, signal.point_error[None], COLOURS[method])
        together = np.array([hit.signals[method].point_error for hit in felt])
        _errors(axes[1, 1], milliseconds, together, COLOURS[method])
    for each in axes[1]:
        each.set_yscale("log")
        each.set_ylim(1e-17, 2.0)
        each.set_xlabel("time since the hit began [ms]")
        each.set_ylabel("point to estimate [m]")
    for each in axes.ravel():
        each.axvspan(0.0, 1e3 * DURATION, color="0.95", lw=0, zorder=0)
        each.set_xlim(-0.5, milliseconds[-1])
    for each in axes[0]:
        each.axhline(0.0, color=GREY, lw=0.6)
    axes[1, 1].text(
        0.99, 0.96, "gaps: no point claimed", transform=axes[1, 1].transAxes, ha="right", va="top", color=TEXT
    )


def _sensed(study: Study, hit: Series) -> bool:
    return any(carries(study.robot, sensor, hit.scene.links[0]) for sensor in SENSOR_LINKS)


def _direction(hit: Series) -> Any:
    force = hit.scene.touches[0].force
    return force / np.linalg.norm(force)


def _band(axes: Any, time: Any, values: Any, colour: str) -> None:
    axes.plot(time, np.median(values, axis=0), color=colour, lw=2.0)
    axes.fill_between(time, *np.percentile(values, (5, 95), axis=0), color=colour, alpha=0.2, lw=0)


def _errors(axes: Any, time: Any, errors: Any, colour: str) -> None:
    rows, columns = np.nonzero(np.isfinite(errors))
    axes.plot(
        time[columns], np.maximum(errors[rows, columns], 1e-17), "o", ms=3, color=colour, alpha=0.7, mew=0
    )
