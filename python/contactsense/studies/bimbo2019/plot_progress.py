"""The particles of one run at several moments, after Fig. 3."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ...demo.style import ESTIMATE, GREY, TEXT, TRUTH
from ...sim import obstacle_from_dict
from ..robot_view import share_scale
from .names import short
from .plot_bodies import COLOURS, WORST, best_eye, draw_moment
from .progress import Moment, watch
from .study import Study

SHARES = (0.0, 0.02, 0.06, 0.15, 0.4, 1.0)
TRUE_LINK = 3  # counted from the base, as in the paper's figure


def draw_progress(figure: Figure, study: Study) -> None:
    """Upper row: on the body; lower row: force over distance from the base."""
    chosen = study.options.chosen()
    name = next((each.name for each in chosen if each.setup == "deliberate"), chosen[0].name)
    trial = study.recorded(name, TRUE_LINK - 1)
    if trial is None:
        return
    progress = watch(study.options, trial, SHARES)
    figure.suptitle(
        f"A contact on {short(trial.link, study.links)}: what the filter holds possible while the arm moves",
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
    figure.colorbar(dots, ax=axes, label="torques not explained, share", shrink=0.8, pad=0.01)
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
