"""A hit over time, after Fig. 10."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from contactsense._pictures import DETECTED, ESTIMATE, GREY, NAMED, TRUTH
from contactsense.sim.atlas import SENSOR_LINKS

from .instruments import Method, carries
from .study import Hits, Kind, Study
from .time_series import DURATION, Series, half_sine

COLOURS: dict[Method, str] = {"torques": ESTIMATE, "both": DETECTED, "sensors": NAMED}
LABELS: dict[Method, str] = {
    "torques": "joint torques",
    "both": "joint torques and sensors",
    "sensors": "sensors alone",
}
# In the order they are drawn.
WIDTHS: dict[Method, float] = {"sensors": 4.5, "torques": 2.0, "both": 2.0}
FLOOR = 1e-17  # [m]
SHOWN = (-1.0, 36.0)  # [ms]
TITLES: dict[Kind, str] = {
    "late": "{0} impacts, delayed as in (6) and (10)",
    "prompt": "{0} impacts, acceleration without delay",
    "simulated": "{0} simulated impacts of {1:g} N, in motion",
}


def draw_series(figure: Figure, study: Study) -> None:
    """Hits of three kinds: force above, error of the point below."""
    columns = [
        (title, hits.amplitude, _felt(study, hits))
        for kind, title in TITLES.items()
        for hits in [[each for each in study.hits if each.kind == kind][-1]]
    ]
    axes = figure.subplots(2, 3, sharex=True, sharey="row")
    for (force, point), (title, amplitude, hits) in zip(axes.T, columns, strict=True):
        time = 1e3 * hits[0].time
        for method in (each for each in WIDTHS if each in hits[0].signals):
            _forces(force, time, hits, method, amplitude)
            _errors(point, time, np.array([hit.signals[method].point_error for hit in hits]), method)
        fine = np.linspace(*SHOWN, 400)
        force.plot(fine, half_sine(1e-3 * fine), color=TRUTH, lw=1.3, ls=(0, (4, 2)), label="true", zorder=4)
        force.axhline(0.0, color=GREY, lw=0.6)
        force.set_title(title.format(len(hits), amplitude), weight="bold")
        point.set_xlabel("time since the impact began [ms]")
        for each in (force, point):
            each.axvspan(0.0, 1e3 * DURATION, color="0.95", lw=0, zorder=0)
            each.set_xlim(*SHOWN)
    axes[0, 0].set_ylabel("estimated force / largest true force")
    axes[1, 0].set_ylabel("error of the located point [m]")
    axes[1, 0].set_yscale("log")
    axes[1, 0].set_ylim(FLOOR / 2, 5.0)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        loc="outside lower center",
        ncols=len(labels),
        frameon=False,
        title="medians, and 90 % of the impacts shaded; below, every sample with a located point is a dot",
    )


def _felt(study: Study, hits: Hits) -> list[Series]:
    """Hits that a sensor feels, or all if there are none."""

    def sensed(hit: Series) -> bool:
        return any(carries(study.robot, sensor, hit.scene.links[0]) for sensor in SENSOR_LINKS)

    return [hit for hit in hits.series if sensed(hit)] or hits.series


def _forces(axes: Any, time: Any, hits: Sequence[Series], method: Method, amplitude: float) -> None:
    along = np.array([np.nan_to_num(hit.signals[method].force) @ hit.direction for hit in hits]) / amplitude
    axes.plot(time, np.median(along, axis=0), color=COLOURS[method], lw=WIDTHS[method], label=LABELS[method])
    low, high = np.percentile(along, (5, 95), axis=0)
    axes.fill_between(time, low, high, color=COLOURS[method], alpha=0.2, lw=0)


def _errors(axes: Any, time: Any, errors: Any, method: Method) -> None:
    rows, columns = np.nonzero(np.isfinite(errors))
    shown = np.maximum(errors[rows, columns], FLOOR)
    axes.plot(time[columns], shown, "o", ms=2 + WIDTHS[method] / 2, color=COLOURS[method], alpha=0.6, mew=0)
