"""Answers beside the truth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .listen import Said
from .truth import Truth

KINDS = ("clamped", "transient", "sustained")
# The answer that counts: of the contact's end, or at this age if it lasts longer [s].
VERDICT = 0.5
# A report so long before the contact or after it is of another one [s].
EARLY, LATE = 0.005, 0.05


@dataclass(frozen=True)
class Answer:
    """Probabilities of one contact at an age (None: its end), and the features as the weights take them."""

    age: float | None
    kinds: tuple[float, float, float]
    intended: float
    scaled: tuple[float, ...]


@dataclass(frozen=True)
class Judged:
    """A contact and what was said of it; no answers where it was not detected."""

    arm: str
    truth: Truth
    answers: tuple[Answer, ...]

    @property
    def verdict(self) -> Answer | None:
        """Of the end, or at `VERDICT`."""
        early = [each for each in self.answers if each.age is None or each.age == VERDICT]
        return early[0] if early else None


def judge(arm: str, truth: Truth, said: Sequence[Said]) -> Judged:
    """The strongest of the contacts that were reported while the true one lasted."""
    near = [
        each
        for each in said
        if each.since + each.duration >= truth.start - EARLY and each.since <= truth.end + LATE
    ]
    if not near:
        return Judged(arm, truth, ())
    peaks: dict[float, float] = {}
    for each in near:
        peaks[each.since] = max(peaks.get(each.since, 0.0), each.answer.features["peak"])
    strongest = max(peaks, key=lambda since: peaks[since])
    return Judged(arm, truth, tuple(_answer(each) for each in near if each.since == strongest))


def _answer(said: Said) -> Answer:
    answer = said.answer
    kinds = (answer.clamped, answer.transient, answer.sustained)
    return Answer(said.age, kinds, answer.intended, tuple(answer._scaled))


def probabilities(judged: Sequence[Judged]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Of the verdicts: kinds (n, 3), true kinds (n,), intended (n,), whether it is (n,)."""
    found = [(each.verdict, each.truth) for each in judged]
    rows = [(verdict, truth) for verdict, truth in found if verdict is not None]
    return (
        np.array([verdict.kinds for verdict, _ in rows]).reshape(len(rows), 3),
        np.array([KINDS.index(truth.kind) for _, truth in rows], dtype=int),
        np.array([verdict.intended for verdict, _ in rows]),
        np.array([truth.intended for _, truth in rows], dtype=bool),
    )
