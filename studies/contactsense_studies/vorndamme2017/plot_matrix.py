"""Two contacts by the pair of links touched, after Fig. 7."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap, ListedColormap
from matplotlib.figure import Figure

from contactsense._pictures import DETECTED, GREY, TEXT
from contactsense.sim._arrays import FloatArray

from .score import EXACT
from .study import Run, Study

DEFICIT_COLOURS = ("#FFFFFF", "#FBE3CF", "#F6C199", "#EE9C63", "#E37832", "#B44E00", "#7A3500")


def draw_matrix(figure: Figure, study: Study) -> None:
    """Below the diagonal: share located within 1 nm; above: rank deficit."""
    links = chain_order(study.robot.link_names)
    success = LinearSegmentedColormap.from_list("success", ["#F4F4F4", "#9CCBE6", DETECTED])
    deficits = ListedColormap(DEFICIT_COLOURS)
    panels = (("torques", "Joint torques alone"), ("both", "Joint torques and nine sensors"))
    axes = figure.subplots(1, 2, sharey=True)
    images: list[Any] = []
    for each, (method, title) in zip(axes, panels, strict=True):
        shares, deficit = matrices(study.run("pairs", method), links)  # type: ignore[arg-type]
        images = [
            each.imshow(shares, cmap=success, vmin=0.0, vmax=1.0),
            each.imshow(deficit, cmap=deficits, norm=BoundaryNorm(np.arange(-0.5, 7.0), 7)),
        ]
        _finish(each, links, title)
    figure.colorbar(
        images[0], ax=axes, location="bottom", shrink=0.35, aspect=30, anchor=(0.1, 0.0)
    ).set_label("below the diagonal: share of pairs with both points within 1 nm")
    bar = figure.colorbar(images[1], ax=axes, location="right", shrink=0.5, aspect=25, ticks=range(7))
    bar.set_label("above the diagonal: rank deficit")


def chain_order(names: tuple[str, ...]) -> list[str]:
    """Trunk and head, then limb by limb, from the trunk to the tip."""
    legs = ("glut", "leg", "talus", "foot")

    def chain(name: str) -> int:
        side = {"l_": 1, "r_": 2}.get(name[:2], 0)
        return side + 2 * (side > 0 and any(part in name for part in legs))

    return sorted(names, key=chain)


def matrices(run: Run, links: list[str]) -> tuple[FloatArray, FloatArray]:
    """Share exact (lower triangle) and rank deficit (upper), NaN elsewhere; `[row, column]` of `links`."""
    found: defaultdict[tuple[int, int], list[float]] = defaultdict(list)
    deficit = np.full((len(links), len(links)), np.nan)
    for verdict in run.verdicts:
        low, high = sorted(links.index(link) for link in verdict.links)
        found[high, low].append(float(verdict.error <= EXACT))
        deficit[low, high] = np.fmax(deficit[low, high], verdict.rank_deficit)
    shares = np.full_like(deficit, np.nan)
    for place, outcomes in found.items():
        shares[place] = np.mean(outcomes)
    return shares, deficit


def _finish(axes: Any, links: list[str], title: str) -> None:
    axes.set_title(title, weight="bold")
    axes.set_xticks(range(len(links)), links, rotation=90, fontsize=8, color=TEXT)
    axes.set_yticks(range(len(links)), links, fontsize=8, color=TEXT)
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    axes.plot([-0.5, len(links) - 0.5], [-0.5, len(links) - 0.5], color=GREY, lw=0.6)
    for edge in (5, 12, 19, 25):
        axes.axhline(edge - 0.5, color=GREY, lw=0.6)
        axes.axvline(edge - 0.5, color=GREY, lw=0.6)
