"""Figures of the study of classes of contacts."""

from __future__ import annotations

from typing import Any

from .entry import Raw
from .markdown import percent, table

NAMES = {"panda": "Panda", "ur5": "UR5", "talos": "left arm of Talos", "all": "all"}
# Ages of running contacts in the second table [s].
AGES = (0.05, 0.1, 0.2, 0.3, 0.5)
# What the tables state of a score.
KEPT = (
    *("contacts", "missed", "clamped_or_transient", "right_kind", "right_of_three", "right_intention"),
    *("intention_error", "kind_error"),
)


def reduce(raw: Raw) -> Any:
    """The scores of every arm and of all."""
    (study,) = raw[""]
    scores = {**study["arms"], "all": study["all"]}
    return {name: {key: score[key] for key in KEPT} for name, score in scores.items()}


def accuracy_table(result: Any) -> str:
    """One row an arm."""
    header = (
        *("Robot", "Contacts", "Not detected", "Clamped or transient", "Told apart", "Kind of three"),
        *("Intended or accidental", "Calibration error of `intended`", "of the kind"),
    )
    rows = [
        [
            NAMES[name],
            *(str(score[key]) for key in ("contacts", "missed", "clamped_or_transient")),
            *(f"{100 * score[key]:.1f} %" for key in ("right_kind", "right_of_three", "right_intention")),
            *(f"{score[key]:.3f}" for key in ("intention_error", "kind_error")),
        ]
        for name, score in result.items()
    ]
    return table(header, rows)


def reduce_ages(raw: Raw) -> Any:
    """Of running contacts of all arms by age: contacts, and shares that are right."""
    (study,) = raw[""]
    found = {}
    for age in AGES:
        said = [
            (contact["truth"], answer)
            for contact in study["contacts"]
            for answer in contact["answers"]
            if answer["age"] == age
        ]
        apart = [
            (answer["kinds"][0] > answer["kinds"][1]) == (truth["kind"] == "clamped")
            for truth, answer in said
            if truth["kind"] != "sustained"
        ]
        intention = [(answer["intended"] > 0.5) == truth["intended"] for truth, answer in said]
        found[str(age)] = {
            "contacts": len(said),
            "right_kind": sum(apart) / len(apart),
            "right_intention": sum(intention) / len(intention),
        }
    return found


def age_table(result: Any) -> str:
    """One column an age."""
    rows = [
        ["contacts that run", *(str(score["contacts"]) for score in result.values())],
        ["clamped or transient, told apart", *(percent(score["right_kind"]) for score in result.values())],
        ["intended or accidental", *(percent(score["right_intention"]) for score in result.values())],
    ]
    return table(("Age [s]", *result), rows)
