"""The picture."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from ..harness import Pictures
from ..memory.plots import COLOURS, number_of
from .score import errors_after
from .study import Study, wanted
from .trial import CLOSE, WAYS

_STYLES = {"chosen": "-", "random": ":"}
# Beyond it an error is drawn at the edge, below it at the other [m].
_RANGE = (1e-3, 1.0)


def draw(figure: Figure, study: Study) -> None:
    """The median error after each motion, a panel a link."""
    figure.suptitle("Median error of the contact point after each motion", x=0.01, ha="left", weight="bold")
    panels: Any = figure.subplots(1, len(study.links), sharey=True, squeeze=False)[0]
    after = range(study.options.motions + 1)
    for axes, link in zip(panels, study.links, strict=True):
        axes.axhline(CLOSE * 1e3, color="#BBBBBB", lw=1, zorder=0)
        for method in wanted(study.options):
            for way in WAYS:
                errors = errors_after(study.outcomes(link, method.name, way), study.options.motions)
                shown = [1e3 * min(max(error, _RANGE[0]), _RANGE[1]) for error in errors]
                axes.plot(
                    after, shown, _STYLES[way], color=COLOURS[method.name], label=f"{method.name}, {way}"
                )
        axes.set_yscale("log")
        axes.set_title(f"link {number_of(link)}", fontsize="medium")
        axes.set_xlabel("motions")
    panels[0].set_ylabel("error [mm]")
    panels[-1].legend(frameon=False, fontsize="small")


PICTURES: Pictures = {"next_motion.png": ((13.0, 4.6), draw)}
