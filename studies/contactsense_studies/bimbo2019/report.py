"""The study as tables."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from ..harness import print_tables, scaled, sheet
from .experiments import MODELS, NOISES, PRINTED, Experiment, Filter
from .score import Outcome, score
from .study import Study

CONFIDENCE = (
    *("worst\ncm", "force\n%", "90 %\n%", "spread\ncm"),
    *("p\n%", "ambi-\nguous", "of wrong\n%", "mode\ncm"),
)
NOTES = (
    "cm: mean/median distance of the estimated point from the true one, at the end of the run.",
    "link: share of trials with the correct link, %. Printed: likelihood (5), explicit schedule.",
    "90 %: share of trials in which the 90 % region of the covariance contains the true point.",
    "spread: median of the standard deviation of the point that the estimate states.",
    "p: mean probability of the true link. ambiguous: share of trials, %; of wrong: the same, of the",
    "trials with a wrong link. mode: median distance of the nearest mode from the true point.",
)


def print_study(study: Study, console: Console) -> None:
    """All tables, and how to read them."""
    models, chosen = (*MODELS, PRINTED), study.options.chosen()
    balls = [experiment for experiment in chosen if experiment.obstacle == "sphere"]
    tables = [
        *(_errors(study, f"Motion models, {each.name}", [(each, kind) for kind in models]) for each in balls),
        *(
            _errors(study, f"Noise, {each.name}", [(each, kind) for kind in NOISES], "no noise")
            for each in balls
        ),
        _errors(study, "Obstacles", _obstacles(chosen, balls)),
        *(_confidence(study, experiment) for experiment in chosen),
    ]
    print_tables(console, tables, NOTES)


def _errors(
    study: Study, title: str, columns: Sequence[tuple[Experiment, Filter]], first: str | None = None
) -> Table:
    """Error and right-link rate, a pair of columns for each filter."""
    headers: list[str] = []
    obstacles = len({experiment.name for experiment, _ in columns}) > 1
    for number, (experiment, kind) in enumerate(columns):
        name = first if first and not number else kind.name
        if obstacles:
            name = (
                _obstacle(experiment)
                if kind is experiment.filters[0]
                else f"{_obstacle(experiment)}, {kind.name}"
            )
        headers += [f"{name}\ncm", "\nlink"]
    table = sheet(title, ("",), (*headers, "\nn"))
    for link in (*study.links, None):
        cells, counts = [], []
        for experiment, kind in columns:
            outcomes = study.outcomes(experiment, kind, link)
            cells += _cells(outcomes)
            counts.append(len(outcomes))
        if link is None:
            table.add_section()
        count = f"{min(counts)}" if min(counts) == max(counts) else f"{min(counts)}-{max(counts)}"
        table.add_row(study.short(link) if link else "all", *cells, count)
    return table


def _obstacles(chosen: Sequence[Experiment], balls: Sequence[Experiment]) -> list[tuple[Experiment, Filter]]:
    """Spheres beside the other obstacles, those with each filter that follows them."""
    first = [(each, each.filters[0]) for each in balls[:1]]
    return first + [(each, kind) for each in chosen if each not in balls for kind in each.filters]


def _obstacle(experiment: Experiment) -> str:
    return {"random": "sphere"}.get(experiment.name, experiment.name)


def _cells(outcomes: Sequence[Outcome]) -> list[str]:
    figures = score(outcomes)
    return [
        f"{scaled(figures.mean, 100, 1)}/{scaled(figures.median, 100, 1)}",
        scaled(figures.right_link, 100),
    ]


def _confidence(study: Study, experiment: Experiment) -> Table:
    """What the filter says of itself."""
    table = sheet(f"What the estimate says of itself: {experiment.name}", ("",), CONFIDENCE)
    for link in (*study.links, None):
        figures = score(study.outcomes(experiment, experiment.filters[0], link))
        if link is None:
            table.add_section()
        table.add_row(
            study.short(link) if link else "all",
            scaled(figures.worst, 100, 1),
            scaled(figures.force, 100),
            scaled(figures.covered, 100),
            scaled(figures.spread, 100, 1),
            scaled(figures.probability, 100),
            scaled(figures.ambiguous, 100),
            scaled(figures.flagged, 100),
            scaled(figures.mode, 100, 1),
        )
    return table
