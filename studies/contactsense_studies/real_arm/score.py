"""Trials in figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..harness import mean
from .judge import JudgedContact
from .study import Trial

# Of the largest force [N].
BANDS = ((5.0, 10.0), (10.0, 20.0), (20.0, 40.0))
# A contact is in the torques if one of them is so many standard deviations of the noise.
IN_TORQUES = 3.0


@dataclass(frozen=True)
class Detection:
    """Of some contacts, by one monitor. NaN where there are none."""

    contacts: int
    detected: float  # share
    in_torques: int  # contacts whose signal is `IN_TORQUES` or more
    detected_in_torques: float  # share of those
    delay: float  # median of the detected [s]
    delay_90: float  # 90 % of the detected are at least so quick [s]
    reported_before: float  # share at whose start a contact was reported already


@dataclass(frozen=True)
class FalseOnsets:
    """Of some trials, by one monitor."""

    seconds: float  # judged [s]
    onsets: int
    per_hour: float
    collision: float  # share of the time in collision
    chance: float  # share of contacts that would be detected if they were not there
    between: int  # onsets outside contacts in the records with contacts
    per_contact: float  # such onsets for each contact
    between_share: float  # share of the time outside contacts in collision


def detection(contacts: Sequence[JudgedContact], monitor: str) -> Detection:
    """Figures of a monitor."""
    delays = [each.delays[monitor] for each in contacts]
    found = np.array([delay for delay in delays if delay is not None])
    strong = [each.delays[monitor] is not None for each in contacts if each.signal >= IN_TORQUES]
    return Detection(
        contacts=len(contacts),
        detected=mean([delay is not None for delay in delays]),
        in_torques=len(strong),
        detected_in_torques=mean(strong),
        delay=float(np.median(found)) if len(found) else np.nan,
        delay_90=float(np.quantile(found, 0.9)) if len(found) else np.nan,
        reported_before=mean([each.reported_before[monitor] for each in contacts]),
    )


def false_onsets(trials: Sequence[Trial], monitor: str) -> FalseOnsets:
    """Figures of a monitor."""
    free = [trial.free[monitor] for trial in trials]
    between, contacts = sum(each.between for each in free), sum(len(trial.contacts) for trial in trials)
    seconds, onsets = sum(each.seconds for each in free), sum(each.onsets for each in free)
    return FalseOnsets(
        seconds=seconds,
        onsets=onsets,
        per_hour=3600.0 * onsets / seconds if seconds else np.nan,
        collision=mean([each.share for each in free]),
        chance=mean([each.chance for each in free]),
        between=between,
        per_contact=between / contacts if contacts else np.nan,
        between_share=mean([each.between_share for each in free]),
    )


def contacts_of(trials: Sequence[Trial]) -> list[JudgedContact]:
    """Those of all trials."""
    return [contact for trial in trials for contact in trial.contacts]


def in_band(contacts: Sequence[JudgedContact], band: tuple[float, float]) -> list[JudgedContact]:
    """Those whose force is in a band; the last band has its upper end."""
    low, high = band
    top = np.inf if band == BANDS[-1] else high
    return [each for each in contacts if low <= each.force < top or (band == BANDS[0] and each.force < low)]


def links_of(contacts: Sequence[JudgedContact]) -> list[str]:
    """Links with contacts, by name."""
    return sorted({each.link for each in contacts})


def rms(trials: Sequence[Trial], monitor: str) -> list[float]:
    """(nv,) of the external torque without contact over all trials of one arm [Nm]."""
    squares = np.square([trial.free[monitor].rms for trial in trials])
    return np.sqrt(squares.mean(axis=0)).tolist()  # type: ignore[no-any-return]
