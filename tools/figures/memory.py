"""Figures of the study of the sampler."""

from __future__ import annotations

from typing import Any

from .entry import Raw
from .long_studies import errors
from .markdown import table

KEPT = ("trials", "right_link", "mean", "median", "covered", "near")


def reduce(raw: Raw) -> Any:
    """By method and noise, the score of every link."""
    (study,) = raw[""]
    found: dict[str, dict[str, dict[str, Any]]] = {}
    for score in study["scores"]:
        case = found.setdefault(f"{score['method']}, {score['noise']:g} % noise", {})
        case[score["link"].rpartition("_")[2]] = {key: score[key] for key in KEPT}
    return found


def error_table(result: Any) -> str:
    """A row a method and noise, a column a link."""
    links = list(next(iter(result.values())))
    header = ("", f"link {links[0]}", *links[1:])
    return table(
        header, [[case, *(errors(scores[link]) for link in links)] for case, scores in result.items()]
    )
