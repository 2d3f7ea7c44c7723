"""The study as tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table

from .experiments import MODELS, NOISES, PRINTED, Experiment, Filter
from .metric import Outcome
from .names import short
from .score import score
from .study import Study

NOTES = (
    "cm: mean/median distance of the estimated point from the true one, at the end of the run.",
    "link: share of trials with the right link, %. Printed: likelihood (5), explicit schedule.",
    "90 %: share of trials where the 90 % region of the covariance holds the true point.",
    "spread: median standard deviation that the estimate gives for its point.",
    "p: mean probability of the true link. open: share said to be ambiguous; of wrong: the same, of",
    "the trials on a wrong link. mode: median distance of the nearest mode from the true point.",
)


def print_study(study: Study, console: Console) -> None:
    """All tables, and how to read them."""
    models, chosen = (*MODELS, PRINTED), study.options.chosen()
    balls = [experiment for experiment in chosen if experiment.obstacle == "sphere"]
    sheets = [
        *(_errors(study, f"Motion models, {each.name}", [(each, kind) for kind in models]) for each in balls),
        *(
            _errors(study, f"Noise, {each.name}", [(each, kind) for kind in NOISES], "no noise")
            for each in balls
        ),
        _errors(study, "Obstacles", _obstacles(chosen, balls)),
        *(_confidence(study, experiment) for experiment in chosen),
    ]
    for sheet in sheets:
        console.print(sheet)
        console.print()
    console.print("\n".join(NOTES), style="dim", highlight=False, soft_wrap=True)


def _errors(
    study: Study, title: str, columns: Sequence[tuple[Experiment, Filter]], first: str | None = None
) -> Table:
    """Error and right-link rate, a pair of columns for each filter."""
    sheet = _sheet(title)
    obstacles = len({experiment.name for experiment, _ in columns}) > 1
    for number, (experiment, kind) in enumerate(columns):
        name = first if first and not number else kind.name
        if obstacles:
            name = (
                _obstacle(experiment)
                if kind is experiment.filters[0]
                else f"{_obstacle(experiment)}, {kind.name}"
            )
        sheet.add_column(f"{name}\ncm", justify="right", no_wrap=True)
        sheet.add_column("\nlink", justify="right", no_wrap=True)
    sheet.add_column("\nn", justify="right")
    for link in (*study.links, None):
        cells, counts = [], []
        for experiment, kind in columns:
            outcomes = study.outcomes(experiment, kind, link)
            cells += _cells(outcomes)
            counts.append(len(outcomes))
        if link is None:
            sheet.add_section()
        count = f"{min(counts)}" if min(counts) == max(counts) else f"{min(counts)}-{max(counts)}"
        sheet.add_row(short(link, study.links) if link else "all", *cells, count)
    return sheet


def _obstacles(chosen: Sequence[Experiment], balls: Sequence[Experiment]) -> list[tuple[Experiment, Filter]]:
    """Spheres beside the other obstacles, those with each filter that follows them."""
    first = [(each, each.filters[0]) for each in balls[:1]]
    return first + [(each, kind) for each in chosen if each not in balls for kind in each.filters]


def _obstacle(experiment: Experiment) -> str:
    return {"random": "sphere"}.get(experiment.name, experiment.name)


def _cells(outcomes: Sequence[Outcome]) -> list[str]:
    figures = score(outcomes)
    return [f"{_centimetres(figures.mean)}/{_centimetres(figures.median)}", percent(figures.right_link)]


def _confidence(study: Study, experiment: Experiment) -> Table:
    """What the filter says of itself."""
    sheet = _sheet(f"What the estimate says of itself: {experiment.name}")
    for column in (
        "worst\ncm",
        "force\n%",
        "90 %\n%",
        "spread\ncm",
        "p\n%",
        "open\n%",
        "of wrong\n%",
        "mode\ncm",
    ):
        sheet.add_column(column, justify="right", no_wrap=True)
    for link in (*study.links, None):
        figures = score(study.outcomes(experiment, experiment.filters[0], link))
        if link is None:
            sheet.add_section()
        sheet.add_row(
            short(link, study.links) if link else "all",
            _centimetres(figures.worst),
            percent(figures.force),
            percent(figures.covered),
            _centimetres(figures.spread),
            percent(figures.probability),
            percent(figures.ambiguous),
            percent(figures.flagged),
            _centimetres(figures.mode),
        )
    return sheet


def percent(share: float) -> str:
    """In %, whole; "-" where there is none."""
    return f"{100 * share:.0f}" if np.isfinite(share) else "-"


def _centimetres(length: float) -> str:
    return f"{100 * length:.1f}" if np.isfinite(length) else "-"


def _sheet(title: str) -> Table:
    sheet = Table(
        title=title,
        title_justify="left",
        box=box.SIMPLE_HEAD,
        show_edge=False,
        padding=(0, 1, 0, 0),
        pad_edge=False,
    )
    sheet.add_column("", no_wrap=True)
    return sheet
