"""The particles of runs: at several moments (Fig. 3), and at the end with other obstacles (Figs. 6, 7)."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from contactsense._pictures import ESTIMATE, GREY, TEXT, TRUTH
from contactsense._robot_view import share_scale
from contactsense.sim import obstacle_from_dict

from .experiments import BY_NAME
from .plot_bodies import COLOURS, WORST, best_eye, draw_moment
from .plot_errors import finish, grouped_bars
from .progress import Moment, watch
from .study import Study

SHARES = (0.0, 0.02, 0.06, 0.15, 0.4, 1.0)
TRUE_LINK = 3  # counted from the base, as in the paper's figure
OBSTACLES = ("cube", "pole")
OBSTACLE_BARS = (("sphere", "random"), ("cube", "cube"), ("smooth pole", "smooth pole"), ("pole", "pole"))
OBSTACLE_COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7")


def draw_progress(figure: Figure, study: Study) -> None:
    """Upper row: on the body; lower row: force over distance from the base."""
    chosen = study.options.chosen()
    name = next((each.name for each in chosen if each.setup == "deliberate"), chosen[0].name)
    trial = study.recorded(name, TRUE_LINK - 1)
    if trial is None:
        return
    progress = watch(study.options, trial, SHARES)
    figure.suptitle(
        f"A contact on {study.short(trial.link)}: the particles of the filter while the arm moves",
        fontsize=13,
        weight="bold",
        x=0.02,
        ha="left",
    )
    axes = figure.subplots(2, len(progress.moments), height_ratios=(1.1, 1))
    view = best_eye(progress.moments[0])
    obstacle = obstacle_from_dict(progress.run.settings["obstacle"])
    for (above, below), moment in zip(axes.T, progress.moments, strict=True):
        dots = draw_moment(above, progress.arm, moment, obstacle, view)
        above.set_title(f"update {moment.update + 1}, {moment.time:.1f} s", loc="center", color=TEXT)
        _plane(below, moment)
    share_scale(axes[0])
    limits = _limits(progress.moments)
    for below in axes[1]:
        below.set(xlim=limits[0], ylim=limits[1], xlabel="distance from the base, m")
        if below is not axes[1, 0]:
            below.set_yticklabels([])
    axes[1, 0].set_ylabel("force, N")
    figure.colorbar(dots, ax=axes, label="share of the torques that is not explained", shrink=0.8, pad=0.01)
    handles = [
        axes[1, 0].plot([], [], "-", color=ESTIMATE, lw=2, label="true point and force")[0],
        axes[1, 0].plot([], [], "o", mfc="none", mec=TRUTH, ms=8, label="estimate")[0],
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)


def _plane(axes: Any, moment: Moment) -> None:
    order = np.argsort(-moment.misfit)
    axes.scatter(
        np.linalg.norm(moment.points, axis=1)[order],
        moment.forces[order],
        c=moment.misfit[order],
        cmap=COLOURS,
        vmin=0.0,
        vmax=WORST,
        s=3,
        linewidths=0,
    )
    axes.plot(
        np.linalg.norm(moment.true_point),
        np.linalg.norm(moment.true_force),
        "P",
        ms=9,
        color=ESTIMATE,
        mec="w",
    )
    axes.grid(color=GREY, alpha=0.25)


def _limits(moments: tuple[Moment, ...]) -> tuple[tuple[float, float], tuple[float, float]]:
    far = max(float(np.linalg.norm(moment.points, axis=1).max()) for moment in moments)
    high = max(float(np.percentile(moment.forces, 98)) for moment in moments)
    high = max(high, max(float(np.linalg.norm(moment.true_force)) for moment in moments))
    return (0.0, 1.05 * far), (0.0, 1.15 * high)


def draw_obstacles(figure: Figure, study: Study) -> None:
    """The end of a run with each, and the errors by link."""
    axes = figure.subplots(1, 3, width_ratios=(1, 1, 2))
    for each, name in zip(axes, OBSTACLES, strict=False):
        trial = study.recorded(name, len(study.links) // 2)
        if trial is None:
            each.set_axis_off()
            continue
        progress = watch(study.options, trial, (1.0,))
        moment, obstacle = progress.moments[-1], obstacle_from_dict(progress.run.settings["obstacle"])
        draw_moment(each, progress.arm, moment, obstacle, best_eye(moment))
        each.set_title(f"{name.capitalize()} at {study.short(trial.link)}: end of a run", color=TEXT)
    share_scale(axes[:2])
    bars = [(label, BY_NAME[name], BY_NAME[name].filters[0]) for label, name in OBSTACLE_BARS]
    grouped_bars(axes[2], study, bars, OBSTACLE_COLOURS)
    axes[2].set_title("Error of the point, cm")
    finish(figure, axes[2], len(bars))
