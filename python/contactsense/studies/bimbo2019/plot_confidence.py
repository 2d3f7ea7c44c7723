"""How fast the error falls, and whether the covariance holds the truth."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ...demo.style import GREY, JOINTS, TEXT
from .experiments import BY_NAME, CURVATURE
from .names import short
from .study import Study

ASKED = 0.8
SHOWN = (("random", "#0072B2"), ("deliberate", "#E69F00"))


def draw_confidence(figure: Figure, study: Study) -> None:
    """Median error by update in both set-ups; coverage of the 90 % region by link."""
    axes = figure.subplots(1, 3, width_ratios=(1, 1, 1.2))
    for each, (name, _) in zip(axes, SHOWN, strict=False):
        _convergence(each, study, name)
    axes[0].set_ylabel("median error of the point, cm")
    if axes[1].lines:
        axes[1].legend(frameon=False, fontsize=8.5, ncols=2)
    _coverage(axes[2], study)


def _convergence(axes: Any, study: Study, name: str) -> None:
    for place, link in enumerate(study.links):
        outcomes = study.outcomes(BY_NAME[name], CURVATURE, link)
        if not outcomes:
            continue
        length = min(len(outcome.errors) for outcome in outcomes)
        errors = 100 * np.median([np.array(outcome.errors)[:length] for outcome in outcomes], axis=0)
        colour = JOINTS[place % len(JOINTS)]
        axes.plot(np.arange(1, length + 1), errors, color=colour, label=short(link, study.links), lw=1.4)
    axes.set_yscale("log")
    axes.set_ylim(0.02, 100)
    axes.set_xlabel("update")
    axes.grid(color=GREY, alpha=0.25)
    axes.set_title(f"Sphere, {name}")


def _coverage(axes: Any, study: Study) -> None:
    for number, (name, colour) in enumerate(SHOWN):
        shares = []
        for link in study.links:
            covered = [outcome.covered for outcome in study.outcomes(BY_NAME[name], CURVATURE, link)]
            shares.append(100 * np.mean(covered) if covered else 0.0)
        x = np.arange(len(shares)) + 0.4 * (number - 0.5)
        axes.bar(x, shares, 0.36, color=colour, alpha=0.8, label=name)
    axes.axhline(100 * ASKED, color=TEXT, lw=0.8, ls="--")
    axes.set_xticks(range(len(study.links)), [short(link, study.links) for link in study.links])
    axes.set_ylim(0, 105)
    axes.set_title("The 90 % region holds the true point, % of trials")
    axes.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=2)
