"""Figures of several contacts on noisy measurements."""

from __future__ import annotations

from typing import Any

from .entry import Raw
from .markdown import percent, table

CONTACTS = {"singles": "one", "pairs": "two", "fives": "five"}
METHODS = {"torques": "torques", "both": "and nine sensors"}
HEADER = (
    *("Noise", "Contacts", "Measured", "Number correct", "Links correct", "Located"),
    *("Located wrongly", "Point error", "Force error"),
)


def reduce(raw: Raw) -> list[dict[str, Any]]:
    """One entry a row: the scores for both ways to state the noise."""
    (study,) = raw[""]
    rows: dict[tuple[Any, ...], dict[str, Any]] = {}
    for run in study["runs"]:
        if run["stated"] == "nothing":
            continue
        parts = {"": "all_claims"}
        if run["scenes"] == "pairs":
            parts = {", full rank": "determined_claims", ", any rank": "all_claims"}
        for part, key in parts.items():
            noise = {name: run["noise"][name] for name in ("relative", "torque")}
            label = {"noise": noise, "contacts": CONTACTS[run["scenes"]] + part, "method": run["method"]}
            row = rows.setdefault((*noise.values(), label["contacts"], run["method"]), label)
            row[run["stated"]] = run[key]
    # Absolute noise comes last.
    return sorted(rows.values(), key=lambda row: row["noise"]["relative"] or 1.0)


def make_table(result: Any) -> str:
    """Both ways in one cell: thresholds / noise model."""
    return table(HEADER, [_row(row) for row in result])


def _row(row: dict[str, Any]) -> list[str]:
    noise = row["noise"]
    ways = row["thresholds"], row["noise model"]

    def both(figure: str, scale: float, digits: int, unit: str) -> str:
        values = ["-" if score[figure] is None else f"{scale * score[figure]:.{digits}f}" for score in ways]
        return f"{values[0]} / {values[1]} {unit}"

    return [
        percent(noise["relative"]) if noise["relative"] else f"{noise['torque']:g} Nm",
        row["contacts"],
        METHODS[row["method"]],
        *(both(figure, 100, 0, "%") for figure in ("counted", "links_right", "located")),
        both("wrong", 100, 1, "%"),
        both("point_error", 1e3, 1, "mm"),
        both("force_error", 100, 1, "%"),
    ]
