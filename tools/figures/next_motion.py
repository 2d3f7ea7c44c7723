"""Figures of the study of motions that are chosen for what they tell."""

from __future__ import annotations

from typing import Any

from .entry import Raw
from .markdown import table

KEPT = ("trials", "motions", "never", "lost", "greatest_force")


def reduce(raw: Raw) -> Any:
    """By method and way, the score of every link."""
    (study,) = raw[""]
    found: dict[str, Any] = {"most": study["options"]["motions"], "scores": {}}
    for score in study["scores"]:
        case = found["scores"].setdefault(f"{score['method']}, {score['way']}", {})
        case[score["link"].rpartition("_")[2]] = {key: score[key] for key in KEPT}
    return found


def motions_table(result: Any) -> str:
    """A row a method and way, a column a link: median number of motions, how often they are not enough."""
    scores = result["scores"]
    links = list(next(iter(scores.values())))
    header = ("", f"link {links[0]}", *links[1:], "greatest force [N]")
    rows = [
        [case, *(_cell(of[link], result["most"]) for link in links), _force(of.values())]
        for case, of in scores.items()
    ]
    return table(header, rows)


def _cell(score: Any, most: int) -> str:
    motions = score["motions"]
    shown = f"> {most}" if motions is None else f"{motions:g}"
    return f"{shown} ({100 * score['never']:.0f} %)"


def _force(scores: Any) -> str:
    return f"{max(score['greatest_force'] for score in scores):.0f}"
