"""The picture."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from ..harness import Pictures
from .methods import METHODS
from .study import Study

COLOURS = {"map": "#8A8A8A", "filter": "#0072B2", "sampler": "#D55E00"}
# Beyond it an error is drawn at the edge, below it at the other [m].
_RANGE = (1e-4, 1.0)


def draw(figure: Figure, study: Study) -> None:
    """The error of every trial by link and method, a panel a noise."""
    figure.suptitle("Error of the contact point after random motions", x=0.01, ha="left", weight="bold")
    noises = study.options.noises()
    panels: Any = figure.subplots(1, len(noises), sharey=True, squeeze=False)[0]
    for axes, noise in zip(panels, noises, strict=True):
        for k, method in enumerate(METHODS):
            for number, link in enumerate(study.links):
                errors = [each.outcome.error for each in study.found(method.name, noise, link)]
                across = number + 0.25 * (k - 1)
                shown = [min(max(error, _RANGE[0]), _RANGE[1]) * 1e3 for error in errors]
                label = method.name if number == 0 else None
                style = {"ms": 4, "alpha": 0.6, "mec": "none", "color": COLOURS[method.name]}
                axes.plot([across] * len(shown), shown, "o", label=label, **style)
        axes.set_yscale("log")
        axes.axhline(10.0, color="#BBBBBB", lw=1, zorder=0)
        axes.set_title(study.options.title(noise), fontsize="medium")
        axes.set_xticks(range(len(study.links)), [number_of(link) for link in study.links])
        axes.set_xlabel("link")
    panels[0].set_ylabel("error [mm]")
    panels[0].legend(frameon=False, fontsize="small")


def number_of(link: str) -> str:
    """What tells the links of an arm apart."""
    return link.rpartition("_")[2] or link


PICTURES: Pictures = {"memory.png": ((13.0, 4.6), draw)}
