"""Errors of two contacts by rank, and of five by their fifth link, after Figs. 8 and 9."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from contactsense._pictures import GREY, JOINTS, TEXT

from .judge import Verdict
from .scenes import FIFTH_LINKS
from .score import EXACT, by_deficit
from .study import Study

# Upper ends [m], names, colours: from exact to lost.
BINS = (
    (EXACT, "within 1 nm", "#08519C"),
    (0.01, "1 cm", "#4292C6"),
    (0.05, "5 cm", "#9ECAE1"),
    (0.15, "15 cm", "#FEE6CE"),
    (0.25, "25 cm", "#FDBE85"),
    (1e3, "farther", "#E6772E"),
    (np.inf, "no estimate", "#BDBDBD"),
)


def draw_pairs(figure: Figure, study: Study) -> None:
    """Shares of error classes by rank, one panel a method."""
    panels = (
        ("Joint torques", study.run("pairs", "torques")),
        ("Joint torques and nine sensors", study.run("pairs", "both")),
        ("Steps of the paper, links given*", study.baseline("pairs")),
    )
    axes = figure.subplots(1, 3)
    for each, (title, run) in zip(axes, panels, strict=True):
        groups = by_deficit(run.verdicts)
        rows = [(f"all ({len(run.verdicts):,})", run.verdicts)]
        rows += [(f"rank {12 - deficit} ({len(group):,})", group) for deficit, group in groups.items()]
        _bars(each, rows)
        each.set_title(title, weight="bold")
    handles = [axes[0].barh([0], [0], color=colour, label=name) for _, name, colour in BINS]
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=len(BINS),
        frameon=False,
        title="worse of the two contacts: distance from its point to the estimate (* true links given)",
    )


def _bars(axes: Any, rows: Sequence[tuple[str, Sequence[Verdict]]]) -> None:
    for place, (_, verdicts) in enumerate(rows):
        errors = np.array([verdict.error for verdict in verdicts])
        left, lower = 0.0, -1.0
        for upper, _, colour in BINS:
            share = float(np.mean((errors > lower) & (errors <= upper)))
            axes.barh(place, share, left=left, color=colour, height=0.74, edgecolor="white", lw=0.8)
            if share > 0.07:
                dark = colour in ("#08519C", "#4292C6")
                axes.text(
                    left + 0.5 * share,
                    place,
                    f"{100 * share:.0f}",
                    ha="center",
                    va="center",
                    fontsize=8.5,
                    color="white" if dark else TEXT,
                )
            left, lower = left + share, upper
    axes.set_yticks(range(len(rows)), [name for name, _ in rows])
    axes.set_ylim(len(rows) - 0.5, -0.5)
    axes.axhline(0.5, color=GREY, lw=0.8)
    axes.set_xticks(np.linspace(0.0, 1.0, 5), ["0", "25", "50", "75", "100 %"])
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)


def draw_fives(figure: Figure, study: Study) -> None:
    """Share of scenes whose five points are all within a distance, by the fifth link."""
    panels = (("torques", "Joint torques"), ("both", "With nine sensors"))
    axes = figure.subplots(1, 2, sharey=True)
    for each, (method, title) in zip(axes, panels, strict=True):
        run = study.run("fives", method)  # type: ignore[arg-type]
        for link, colour in zip(FIFTH_LINKS, JOINTS, strict=False):
            errors = [verdict.error for verdict in run.verdicts if verdict.links[-1] == link]
            _steps(each, errors, colour, link)
        baseline = [verdict.error for verdict in study.baseline("fives").verdicts]
        _steps(each, baseline, "0.45", "paper's steps,\nlinks given", ls=(0, (4, 2)))
        deficits = ", ".join(f"{deficit}" for deficit in by_deficit(run.verdicts))
        each.set_title(f"{title}: {len(run.verdicts):,} scenes, rank deficit {deficits}", weight="bold")
        each.set_xscale("log")
        each.set_xlim(1e-16, 2.0)
        each.set_ylim(0.0, 1.03)
        each.axvline(0.01, color=GREY, lw=0.8)
        each.text(0.013, 0.02, "1 cm", color=TEXT, fontsize=8.5)
        each.set_xlabel("worst of the five distances from point to estimate [m]")
    axes[0].set_ylabel("share of scenes within")
    axes[1].legend(frameon=False, fontsize=9, title="fifth contact on", loc="center")


def _steps(axes: Any, errors: Sequence[float], colour: str, label: str, **style: Any) -> None:
    values = np.sort([max(error, 1e-16) for error in errors])
    heights = np.arange(1, len(values) + 1) / max(len(values), 1)
    seen = np.isfinite(values)
    last = heights[seen][-1] if seen.any() else 0.0
    x = np.concatenate([[1e-16], values[seen], [10.0]])
    y = np.concatenate([[0.0], heights[seen], [last]])
    axes.step(x, y, where="post", color=colour, lw=1.8, label=label, **style)
