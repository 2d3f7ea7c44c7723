"""Figures of the study of identifiability."""

from __future__ import annotations

from typing import Any

from .entry import Raw
from .markdown import percent, table


def reduce(raw: Raw) -> Any:
    """The scores of every link, by robot."""
    (study,) = raw[""]
    return {name: robot["links"] for name, robot in study["robots"].items()}


def study_table(result: Any) -> str:
    """Every link of the arm; a humanoid in one row."""
    arm, *bodies = result
    shown = [(score["link"], score) for score in result[arm] if score["link"] != "all"]
    shown += [(f"{name}, all links", result[name][-1]) for name in bodies]
    rows = [
        [
            label,
            f"{_centimetres(score['point_std'])} / {_centimetres(score['point_std_90'])}",
            percent(score["near"]),
            str(score["rank"]),
            percent(score["detectable"]),
        ]
        for label, score in shown
    ]
    header = ("link", "std of the point, median / 90 %", "at most 5 cm", "rank", "detectable")
    return table(header, rows)


def point_errors(raw: Raw) -> Any:
    """The root mean squares as they are."""
    return raw[""][0]


def point_errors_table(result: Any) -> str:
    """One row a link."""
    rows = [
        [link, *(_centimetres(score[key]) for key in ("stated", "error", "spread"))]
        for links in result.values()
        for link, score in links.items()
    ]
    return table(("link", "stated", "error of the posterior's mean", "spread of the posterior"), rows)


def _centimetres(length: float) -> str:
    return f"{100 * length:.1f} cm"
