"""Figures of verdicts on noisy measurements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..harness import mean, median
from .judge import NEAR, Claim, Verdict

SIGMAS_OFF = 3.0  # a point may be off by so many of its standard deviations, and 1 cm


@dataclass(frozen=True)
class NoisyScore:
    """Shares of scenes, of true contacts, and of claims: contacts that are said to be located."""

    scenes: int
    counted: float  # as many contacts are reported as there are
    links_right: float  # just the links touched are named
    contacts: int
    located: float  # claims a true contact
    claims: int
    wrong: float  # of the claims, those off by more than 1 cm and three `point_std`
    point_error: float  # [m], median of the claims
    force_error: float  # relative, median of the claims


def noisy_score(verdicts: Sequence[Verdict]) -> NoisyScore:
    """The figures of these scenes; NaN for shares and medians of none."""
    claims = [claim for verdict in verdicts for claim in verdict.claims]
    contacts = sum(len(verdict.links) for verdict in verdicts)
    return NoisyScore(
        scenes=len(verdicts),
        counted=mean([len(verdict.named) == len(verdict.links) for verdict in verdicts]),
        links_right=mean([verdict.links_right for verdict in verdicts]),
        contacts=contacts,
        located=len(claims) / contacts if contacts else np.nan,
        claims=len(claims),
        wrong=mean([is_wrong(claim) for claim in claims]),
        point_error=median([claim.error for claim in claims]),
        force_error=median([claim.force_error for claim in claims]),
    )


def is_wrong(claim: Claim) -> bool:
    """Whether a claim is off by more than it says."""
    return claim.error > NEAR + SIGMAS_OFF * claim.point_std
