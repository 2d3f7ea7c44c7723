"""The study as a table."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from ..harness import print_tables, scaled, sheet
from .judge import CLOSE, NEAR, PROBABLE, SPREADS, WRONG, score
from .study import Study

NOTES = (
    "A robot leans on spheres with different links, and moves its joints at random.",
    "links: trials with as many contacts as there are, all on the true links.",
    f"close: contacts whose point is within {CLOSE * 100:g} cm; median: error of the points, in mm.",
    f"near: trials in which a place of probability {PROBABLE:g} is within {NEAR * 100:g} cm of each contact.",
    f"among: trials in which it is, or its spread on the true link holds the contact ({SPREADS:g} spreads).",
    f"known: contacts that are not said to be ambiguous; wrong: of these, more than {WRONG * 100:g} cm off.",
    "number: mean probability of the true number of contacts. s: of an update, mean.",
)


def print_study(study: Study, console: Console) -> None:
    """A row for each number of contacts, and how to read them."""
    print_tables(console, [_table(study)], NOTES)


def _table(study: Study) -> Table:
    options = study.options
    figures = ("n", "links", "close", "median", "near", "among", "known", "wrong", "number", "s")
    noise = f"{options.percent:g} % and {options.newton_metres:g} Nm"
    title = f"{options.robot}, friction {options.friction:g}, noise of {noise}"
    shown = sheet(title, ("contacts",), figures)
    for contacts in options.contacts:
        if judged := study.judged(contacts):
            of = score(judged)
            shares = (of.near, of.among, of.located, of.wrong, of.probability)
            shown.add_row(
                str(contacts),
                str(of.trials),
                scaled(of.links_right, 100),
                scaled(of.close, 100),
                scaled(of.median, 1e3, 1),
                *(scaled(share, 100) for share in shares),
                scaled(of.seconds, 1.0, 2),
            )
    return shown
