"""Figures of many verdicts: shares of scenes, worst errors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .judge import NEAR, Verdict

EXACT = 1e-9  # [m]
FAR = 0.25  # [m], the paper's measure for pairs that are not determined


@dataclass(frozen=True)
class Score:
    """Shares are of `scenes`. An estimate is what `judge.Verdict` says; a claim is a located contact."""

    scenes: int
    exact: float  # every true point within 1 nm of an estimate
    near: float  # within 1 cm
    fair: float  # within 25 cm
    lost: float  # some contact has no estimate
    among_candidates: float  # every true point within 1 cm of a candidate
    identified: float  # every force within 1 %
    detected: float  # some contact is reported
    links_right: float  # just the links touched are named
    located: float  # as many contacts are claimed as there are
    missed: float  # determined, but not all located
    wrong: float  # some claim is more than 1 cm off
    claim_error: float  # [m] worst distance of a claim from the truth
    force_error: float  # relative, worst where all are located


def score(verdicts: Sequence[Verdict]) -> Score:
    """The figures of these scenes; NaN for shares of none."""

    def share(holds: Callable[[Verdict], bool]) -> float:
        return float(np.mean([holds(verdict) for verdict in verdicts])) if verdicts else np.nan

    forces = [max(verdict.force_errors) for verdict in verdicts if verdict.all_located]
    return Score(
        scenes=len(verdicts),
        exact=share(lambda verdict: verdict.error <= EXACT),
        near=share(lambda verdict: verdict.error <= NEAR),
        fair=share(lambda verdict: verdict.error <= FAR),
        lost=share(lambda verdict: not np.isfinite(verdict.error)),
        among_candidates=share(lambda verdict: verdict.among_candidates),
        identified=share(lambda verdict: max(verdict.force_errors) <= 0.01),
        detected=share(lambda verdict: bool(verdict.named)),
        links_right=share(lambda verdict: verdict.links_right),
        located=share(lambda verdict: verdict.all_located),
        missed=share(lambda verdict: verdict.rank_deficit == 0 and not verdict.all_located),
        wrong=share(lambda verdict: verdict.wrong),
        claim_error=max((verdict.located_error for verdict in verdicts), default=0.0),
        force_error=max(forces, default=0.0),
    )


def by_deficit(verdicts: Sequence[Verdict]) -> dict[int, list[Verdict]]:
    """Verdicts by the rank deficit of their true contacts, least first."""
    groups: dict[int, list[Verdict]] = {}
    for verdict in verdicts:
        groups.setdefault(verdict.rank_deficit, []).append(verdict)
    return dict(sorted(groups.items()))
