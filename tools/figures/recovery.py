"""Figures of the study of known errors that calibration recovers."""

from __future__ import annotations

from typing import Any

from .entry import Raw
from .markdown import percent, table


def reduce(raw: Raw) -> list[dict[str, Any]]:
    """The scores of every robot and kind."""
    (study,) = raw[""]
    scores: list[dict[str, Any]] = study["scores"]
    return scores


def make_table(result: Any) -> str:
    """One row a robot and kind: median and 90th percentile of each error, and the share that is covered."""
    header = (
        *("Robot", "Arms", "Number", "Bias", "covered", "Noise", "Coulomb friction", "covered"),
        *("Payload mass", "covered", "Payload centre", "covered"),
    )
    return table(header, [_row(score) for score in result])


def _row(score: dict[str, Any]) -> list[str]:
    def both(name: str, scale: float, digits: int, unit: str) -> str:
        values = (f"{scale * score[key]:.{digits}f}" for key in (name, f"{name}_90"))
        return f"{'; '.join(values)} {unit}"

    return [
        score["robot"],
        score["kind"],
        str(score["runs"]),
        both("bias", 1e3, 0, "mNm"),
        percent(score["bias_covered"]),
        both("noise", 100, 1, "%"),
        both("coulomb", 100, 1, "%"),
        percent(score["coulomb_covered"]),
        both("mass", 100, 1, "%"),
        percent(score["mass_covered"]),
        both("com", 1e3, 1, "mm"),
        percent(score["com_covered"]),
    ]
