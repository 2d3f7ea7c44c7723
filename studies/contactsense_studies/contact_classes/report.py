"""The study as tables."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from ..harness import print_tables, scaled, sheet
from .arms import FITTED
from .judge import KINDS, VERDICT
from .score import Score, score
from .study import Study

NOTES = (
    f"The answer that counts is that of the contact's end, or at {VERDICT:g} s if it lasts longer.",
    f"The weights were found on {' and '.join(FITTED)}, on scenes of other seeds.",
    "either: contacts that are clamped or transient, and the share in which the likelier of the two is it.",
    "of three: share of all in which the likeliest of clamped, transient and sustained is it.",
    "missed: not detected; open: the scene ends before there is an answer.",
    "error: expected calibration error of the probability, over ten bins.",
)


def print_study(study: Study, console: Console) -> None:
    """All tables, and how to read them."""
    scores = {name: score(study.of(name)) for name in study.arms}
    everything = score(study.judged)
    print_tables(console, [_accuracy(scores | {"all": everything}), _confusion(everything)], NOTES)
    for name, missing in study.skipped.items():
        console.print(f"{name} was skipped: {missing}", highlight=False, soft_wrap=True)


def _accuracy(scores: dict[str, Score]) -> Table:
    figures = (
        *("\nn", "\nmissed", "\nopen", "either\nn", "either\n%", "of three\n%"),
        *("kind\nerror", "intended\n%", "intended\nerror"),
    )
    table = sheet("Contacts told apart", ("",), figures)
    for name, each in scores.items():
        table.add_row(
            name,
            str(each.contacts),
            str(each.missed),
            str(each.open),
            str(each.clamped_or_transient),
            scaled(each.right_kind, 100, 1),
            scaled(each.right_of_three, 100, 1),
            scaled(each.kind_error, 1, 3),
            scaled(each.right_intention, 100, 1),
            scaled(each.intention_error, 1, 3),
        )
    return table


def _confusion(all_of_them: Score) -> Table:
    table = sheet("All: true kind (rows) and what is said", ("",), KINDS)
    for kind, row in zip(KINDS, all_of_them.confusion, strict=True):
        table.add_row(kind, *(str(count) for count in row))
    return table
