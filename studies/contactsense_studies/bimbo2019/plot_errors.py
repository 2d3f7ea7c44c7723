"""Errors by link after Figs. 4 and 5, by update, and whether the covariance holds the truth."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from contactsense._pictures import GREY, JOINTS, TEXT

from .experiments import BY_NAME, CURVATURE, MODELS, NOISES, PRINTED, Experiment, Filter
from .study import Study

COLOURS = ("#D55E00", "#0072B2", "#56B4E9", "#E69F00")
NOISE_COLOURS = ("#D55E00", "#E69F00", "#8A8200")
TOP = 0.25  # [m] of the axes; beyond it a number says how much
PANELS = (("random", "random poses, points and motions"), ("deliberate", "motions that move the contact"))
ASKED = 0.8
CONFIDENCE = (("random", "#0072B2"), ("deliberate", "#E69F00"))

Bar = tuple[str, Experiment, Filter]


def draw_models(figure: Figure, study: Study) -> None:
    """Motion models side by side, one panel a set-up."""
    _draw(figure, study, (*MODELS, PRINTED), COLOURS, "Error of the point by motion model")


def draw_noise(figure: Figure, study: Study) -> None:
    """Noise of the torques, one panel a set-up."""
    _draw(figure, study, NOISES, NOISE_COLOURS, "Noise of the external torques")


def _draw(figure: Figure, study: Study, kinds: Sequence[Filter], colours: Sequence[str], title: str) -> None:
    figure.suptitle(title, fontsize=13, weight="bold", x=0.02, ha="left")
    panels = [panel for panel in PANELS if BY_NAME[panel[0]] in study.options.chosen()] or PANELS
    axes = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    for each, (name, about) in zip(axes, panels, strict=True):
        rows = [(_label(kind, kinds), BY_NAME[name], kind) for kind in kinds]
        grouped_bars(each, study, rows, colours)
        each.set_title(f"Sphere, {about}")
    axes[0].set_ylabel("error of the point, cm")
    finish(figure, axes[0], len(kinds))


def _label(kind: Filter, kinds: Sequence[Filter]) -> str:
    return "no noise" if any(each.noise for each in kinds) and not kind.noise else kind.name


def grouped_bars(axes: Any, study: Study, bars: Sequence[Bar], colours: Sequence[str]) -> None:
    """Mean as a bar, median as a line across it, every trial as a dot; share of right links beneath."""
    width = 0.84 / len(bars)
    for number, ((label, experiment, kind), colour) in enumerate(zip(bars, colours, strict=False)):
        for place, link in enumerate(study.links):
            outcomes = study.outcomes(experiment, kind, link)
            if not outcomes:
                continue
            errors = 100 * np.minimum([outcome.error for outcome in outcomes], 10.0)
            x = place + (number - 0.5 * (len(bars) - 1)) * width
            mean, middle, top = float(errors.mean()), float(np.median(errors)), 100 * TOP
            axes.bar(
                x, min(mean, top), 0.92 * width, color=colour, alpha=0.55, label=label if place == 0 else None
            )
            axes.plot([x - 0.46 * width, x + 0.46 * width], 2 * [min(middle, top)], color=colour, lw=2.2)
            spread = x + 0.3 * width * np.linspace(-1, 1, len(errors))
            axes.scatter(spread, np.minimum(errors, top), s=5, color=TEXT, linewidths=0, zorder=3)
            right = 100 * np.mean([outcome.right for outcome in outcomes])
            if right < 100:
                _note(axes, f"{right:.0f}", (x, 0), -4, colour)
            if mean > top:
                _note(axes, f"{mean:.0f}", (x, top), 9, colour)
    axes.set_xticks(range(len(study.links)), [study.short(link) for link in study.links])
    axes.tick_params(axis="x", length=0, pad=14)
    axes.set_xlim(-0.6, len(study.links) - 0.4)
    axes.set_ylim(0, 100 * TOP)
    axes.grid(axis="y", color=GREY, alpha=0.25)
    axes.set_axisbelow(True)


def _note(axes: Any, text: str, place: tuple[float, float], up: float, colour: str) -> None:
    """`up` of `place` [points]."""
    axes.annotate(
        text, place, (0, up), textcoords="offset points", ha="center", va="top", fontsize=7, color=colour
    )


def finish(figure: Figure, axes: Any, columns: int) -> None:
    """The legend beneath all."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles,
        labels,
        loc="outside lower center",
        ncols=columns,
        frameon=False,
        title="bar: mean; line: median; dot: a trial; below: trials with the correct link, %, if not all",
    )


def draw_confidence(figure: Figure, study: Study) -> None:
    """Median error by update in both set-ups; coverage of the 90 % region by link."""
    axes = figure.subplots(1, 3, width_ratios=(1, 1, 1.2))
    for each, (name, _) in zip(axes, CONFIDENCE, strict=False):
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
        axes.plot(np.arange(1, length + 1), errors, color=colour, label=study.short(link), lw=1.4)
    axes.set_yscale("log")
    axes.set_ylim(0.02, 100)
    axes.set_xlabel("update")
    axes.grid(color=GREY, alpha=0.25)
    axes.set_title(f"Sphere, {name}")


def _coverage(axes: Any, study: Study) -> None:
    for number, (name, colour) in enumerate(CONFIDENCE):
        shares = []
        for link in study.links:
            covered = [outcome.covered for outcome in study.outcomes(BY_NAME[name], CURVATURE, link)]
            shares.append(100 * np.mean(covered) if covered else 0.0)
        x = np.arange(len(shares)) + 0.4 * (number - 0.5)
        axes.bar(x, shares, 0.36, color=colour, alpha=0.8, label=name)
    axes.axhline(100 * ASKED, color=TEXT, lw=0.8, ls="--")
    axes.set_xticks(range(len(study.links)), [study.short(link) for link in study.links])
    axes.set_ylim(0, 105)
    axes.set_title("The 90 % region contains the true point, % of trials")
    axes.legend(frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.08), ncols=2)
