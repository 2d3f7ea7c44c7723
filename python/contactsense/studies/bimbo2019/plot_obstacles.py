"""A cube and a pole in place of the sphere, after Figs. 6 and 7."""

from __future__ import annotations

from matplotlib.figure import Figure

from ...demo.style import TEXT
from ...sim import obstacle_from_dict
from ..robot_view import share_scale
from .experiments import BY_NAME
from .names import short
from .plot_bodies import best_eye, draw_moment
from .plot_errors import finish, grouped_bars
from .progress import watch
from .study import Study

SHOWN = ("cube", "pole")
BARS = (("sphere", "random"), ("cube", "cube"), ("smooth pole", "smooth pole"), ("pole", "pole"))
COLOURS = ("#D55E00", "#0072B2", "#009E73", "#CC79A7")


def draw_obstacles(figure: Figure, study: Study) -> None:
    """The end of a run with each, and the errors by link."""
    axes = figure.subplots(1, 3, width_ratios=(1, 1, 2))
    for each, name in zip(axes, SHOWN, strict=False):
        trial = study.recorded(name, len(study.links) // 2)
        if trial is None:
            each.set_axis_off()
            continue
        progress = watch(study.options, trial, (1.0,))
        moment, obstacle = progress.moments[-1], obstacle_from_dict(progress.run.settings["obstacle"])
        draw_moment(each, progress.arm, moment, obstacle, best_eye(moment))
        each.set_title(f"{name.capitalize()} at {short(trial.link, study.links)}: end of a run", color=TEXT)
    share_scale(axes[:2])
    bars = [(label, BY_NAME[name], BY_NAME[name].filters[0]) for label, name in BARS]
    grouped_bars(axes[2], study, bars, COLOURS)
    axes[2].set_title("Error of the point, cm")
    finish(figure, axes[2], len(bars))
