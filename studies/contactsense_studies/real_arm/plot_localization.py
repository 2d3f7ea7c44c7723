"""Where contacts are, after calibration: links, points, regions, and whether probabilities are right."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from contactsense._pictures import DETECTED, GREY, JOINTS, NAMED, TEXT

from .estimate import JudgedEstimate
from .judge import JudgedContact
from .localization import WRONG, estimates, localization, reliability_of_links
from .reliability import Bin, calibration_error
from .score import contacts_of
from .study import Study

_MONITOR = "calibrated"
_WIDTH = 0.4
# Of the axes of distances [m]; what is beyond counts as the ends.
_SHORTEST, _LONGEST = 1e-3, 1.0
# The size of a dot is that of its count [points^2].
_DOT, _LEAST_DOT = 4.0, 12.0


def draw_localization(figure: Figure, study: Study) -> None:
    """Links, errors and radii above; reliability, coverage, and errors over radii below."""
    title = "Where the calibrated monitor finds its contacts on simulated arms with the errors of real ones"
    figure.suptitle(title, fontsize=14, weight="bold", x=0.01, ha="left")
    axes: Any = figure.subplots(2, 3, gridspec_kw={"hspace": 0.08, "wspace": 0.04})
    arms = {arm: contacts_of(study.of(arm)) for arm in study.arms if study.of(arm)}
    _links(axes[0, 0], arms)
    _distances(axes[0, 1], arms, lambda each: each.error)
    axes[0, 1].set_title("Error of the points")
    axes[0, 1].set_xlabel("distance from the true point [cm]")
    _distances(axes[0, 2], arms, lambda each: each.region_radius)
    axes[0, 2].set_title("Radius of the 90 % regions")
    axes[0, 2].set_xlabel("radius [cm]")
    everything = contacts_of(study.trials)
    _reliability(axes[1, 0], reliability_of_links(everything, _MONITOR))
    _coverage(axes[1, 1], arms)
    _errors_in_regions(axes[1, 2], arms)


def _links(axes: Any, arms: dict[str, list[JudgedContact]]) -> None:
    for place, contacts in enumerate(arms.values()):
        figures = localization(contacts, _MONITOR)
        for shift, share, colour, label in (
            (-0.5, figures.within_one, NAMED, "or a neighbour"),
            (-0.5, figures.exact, DETECTED, "the true link"),
            (0.5, figures.point, "#F0C27A", "a point is given"),
            (0.5, figures.located, "#E69F00", "located"),
        ):
            x, height = place + shift * _WIDTH, 100.0 * np.nan_to_num(share)
            axes.bar(x, height, 0.92 * _WIDTH, color=colour, label=None if place else label)
            _note(axes, f"{height:.0f}", x, height)
    axes.set_xticks(range(len(arms)), [arm.replace("_", "\n") for arm in arms])
    axes.tick_params(axis="x", length=0)
    axes.set_ylim(0.0, 132.0)
    axes.set_yticks(range(0, 101, 20))
    axes.set_ylabel("% of the detected contacts")
    axes.set_title("Links and points")
    axes.legend(frameon=False, ncols=2, fontsize=8.5, loc="upper center")
    _grid(axes)


def _note(axes: Any, text: str, x: float, y: float) -> None:
    axes.annotate(text, (x, y), (0, 2), textcoords="offset points", ha="center", fontsize=7.5, color=TEXT)


def _distances(
    axes: Any, arms: dict[str, list[JudgedContact]], of: Callable[[JudgedEstimate], float]
) -> None:
    """Share of the detected contacts with at most such a distance."""
    for number, (arm, contacts) in enumerate(arms.items()):
        detected = localization(contacts, _MONITOR).detected
        values = np.sort([of(each) for each in estimates(contacts, _MONITOR) if np.isfinite(of(each))])
        steps = np.clip(np.concatenate([[_SHORTEST], values, [_LONGEST]]), _SHORTEST, _LONGEST)
        shares = 100.0 * np.concatenate([np.arange(len(values) + 1), [len(values)]]) / max(detected, 1)
        axes.plot(100 * steps, shares, color=_colour(number), drawstyle="steps-post", lw=1.6, label=arm)
    axes.axvline(100 * WRONG, color=TEXT, lw=0.8, ls="--", label=f"{100 * WRONG:g} cm")
    _distance_axis(axes.set_xscale, axes.set_xlim, axes.xaxis)
    axes.set_ylim(0.0, 103.0)
    axes.set_ylabel("% of the detected contacts")
    axes.legend(frameon=False, fontsize=8.5, loc="upper left")
    _grid(axes)


def _reliability(axes: Any, bins: Sequence[Bin]) -> None:
    """Right links over their probability; bars: one standard deviation by chance."""
    axes.plot([0, 100], [0, 100], color=TEXT, lw=0.8, ls="--")
    x = 100.0 * np.array([each.probability for each in bins])
    y = 100.0 * np.array([each.right for each in bins])
    axes.errorbar(x, y, yerr=[100.0 * each.chance for each in bins], fmt="none", ecolor=GREY, lw=1.2)
    sizes = [_LEAST_DOT + _DOT * np.sqrt(each.count) ** 1.5 for each in bins]
    axes.scatter(x, y, s=sizes, color=DETECTED, zorder=3, clip_on=False)
    for each, right, above in zip(x, y, bins, strict=True):
        axes.annotate(
            str(above.count), (each, right), (7, -9), textcoords="offset points", fontsize=7.5, color=TEXT
        )
    axes.set_xlim(0.0, 103.0)
    axes.set_ylim(0.0, 103.0)
    axes.set_xlabel("probability of the named link, % (number: contacts)")
    axes.set_ylabel("% of these that are right")
    error = f"expected calibration error {calibration_error(bins):.3f}" if bins else "no probabilities"
    axes.set_title(f"Reliability, all arms: {error}")
    _grid(axes, both=True)


def _coverage(axes: Any, arms: dict[str, list[JudgedContact]]) -> None:
    for place, contacts in enumerate(arms.values()):
        figures = localization(contacts, _MONITOR)
        height = 100.0 * np.nan_to_num(figures.coverage)
        axes.bar(place, height, 1.5 * _WIDTH, color=DETECTED)
        axes.text(
            place, 4.0, f"{height:.0f} % of {figures.regions}", ha="center", fontsize=8.5, color="white"
        )
    axes.axhline(90.0, color=TEXT, lw=0.8, ls="--")
    axes.set_xticks(range(len(arms)), [arm.replace("_", "\n") for arm in arms])
    axes.tick_params(axis="x", length=0)
    axes.set_ylim(0.0, 103.0)
    axes.set_ylabel("% of the regions")
    axes.set_title("The 90 % region holds the true point")
    _grid(axes)


def _errors_in_regions(axes: Any, arms: dict[str, list[JudgedContact]]) -> None:
    axes.plot(
        [100 * _SHORTEST, 100 * _LONGEST], [100 * _SHORTEST, 100 * _LONGEST], color=TEXT, lw=0.8, ls="--"
    )
    for number, (arm, contacts) in enumerate(arms.items()):
        found = [each for each in estimates(contacts, _MONITOR) if each.covered is not None]
        radii = np.clip([each.region_radius for each in found], _SHORTEST, _LONGEST)
        errors = np.clip([each.error for each in found], _SHORTEST, _LONGEST)
        axes.scatter(100 * radii, 100 * errors, s=9, color=_colour(number), alpha=0.7, lw=0, label=arm)
    _distance_axis(axes.set_xscale, axes.set_xlim, axes.xaxis)
    _distance_axis(axes.set_yscale, axes.set_ylim, axes.yaxis)
    axes.set_xlabel("radius of the 90 % region [cm]")
    axes.set_ylabel("error of the point [cm]")
    axes.set_title("Error and region of each contact (below the line: held)")
    axes.legend(frameon=False, fontsize=8.5, loc="upper left")
    _grid(axes, both=True)


def _distance_axis(scale: Any, limits: Any, axis: Any) -> None:
    scale("log")
    limits(100 * _SHORTEST, 100 * _LONGEST)
    axis.set_major_formatter("{x:g}")


def _grid(axes: Any, *, both: bool = False) -> None:
    axes.grid(axis="both" if both else "y", color=GREY, alpha=0.25, lw=0.6)
    axes.set_axisbelow(True)


def _colour(number: int) -> str:
    return JOINTS[number % len(JOINTS)]
