"""Figures of the study of several contacts."""

from __future__ import annotations

from typing import Any

from .entry import Raw
from .markdown import table


def reduce(raw: Raw) -> Any:
    """By number of contacts, the score."""
    (study,) = raw[""]
    return {str(score.pop("contacts")): score for score in study["scores"]}


def score_table(result: Any) -> str:
    """A row for each number of contacts."""
    header = ("contacts", "links", "within 3 cm", "median", "near", "among", "located", "wrong")
    rows = [
        [
            contacts,
            *(f"{100 * score[key]:.0f} %" for key in ("links_right", "close")),
            f"{1e3 * score['median']:.1f} mm",
            *(f"{100 * score[key]:.0f} %" for key in ("near", "among", "located", "wrong")),
        ]
        for contacts, score in result.items()
    ]
    return table(header, rows)
