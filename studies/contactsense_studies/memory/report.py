"""The study as tables."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from ..bimbo2019.score import score
from ..harness import print_tables, scaled, sheet
from .methods import METHODS, NEAR, PROBABLE
from .study import Study

NOTES = (
    "Random motions of an arm that leans on a sphere. Nothing is said of noise in per cent.",
    "map: the last pose alone; filter: forgets; sampler: remembers.",
    "right: on the true link. mean, median: of the point, in mm.",
    "90 %: the stated region holds the point. unsure: said to be ambiguous.",
    f"near: a place of probability {PROBABLE:g} is within {NEAR * 100:g} cm.",
)


def print_study(study: Study, console: Console) -> None:
    """A table a noise, and how to read them."""
    print_tables(console, [_table(study, noise) for noise in study.options.noises()], NOTES)


def _table(study: Study, noise: float) -> Table:
    figures = ("n", "right", "mean", "median", "90 %", "unsure", "near")
    friction = study.options.friction
    title = study.options.title(noise) + (f", friction {friction:g}" if friction else "")
    shown = sheet(title, ("link", "method"), figures)
    for link in study.links:
        for method in METHODS:
            found = study.found(method.name, noise, link)
            if not found:
                continue
            of = score([each.outcome for each in found])
            shares = (of.covered, of.ambiguous, sum(each.near for each in found) / len(found))
            errors = (scaled(of.mean, 1e3, 1), scaled(of.median, 1e3, 1))
            row = (str(of.trials), scaled(of.right_link, 100), *errors, *(scaled(x, 100) for x in shares))
            shown.add_row(link, method.name, *row)
    return shown
