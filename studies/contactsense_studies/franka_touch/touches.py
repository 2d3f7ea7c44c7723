"""Every touch of a log: when it was felt, and on which link."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense import ContactIsolator, Replay, Robot

from .logs import BoolArray, FloatArray, TouchLog
from .settings import Settings

# Labels are by hand: an onset this long before a label's begin is still that touch's [s].
EARLY = 0.25
# A touch's strongest part: rows where the norm of the external torque reaches this share of its greatest.
STRONG_SHARE = 0.8


@dataclass(frozen=True)
class TouchResult:
    """One labelled touch."""

    start: float  # label's begin [s]
    end: float  # label's end [s]
    delay: float | None  # first onset after the label's begin (negative: before) [s]; None: not felt
    link: int | None  # link named; None: no joint feels the mean torque, or no contact was reported
    located: bool
    point: FloatArray | None  # (3,) in the frame of the link named [m], where located


@dataclass(frozen=True)
class LogResult:
    """All touches of one log."""

    name: str
    link: int  # of the mark
    tuning: bool  # whether settings were chosen on this file
    repeated: float  # share of rows without news
    touches: tuple[TouchResult, ...]
    false_onsets: tuple[float, ...]  # [s]
    free_time: float  # outside touches and the time before them that counts as theirs [s]
    free_alarm: float  # of it, with the alarm on (a touch's end that lasts longer than its label) [s]


def judge(robot: Robot, log: TouchLog, told: Replay, settings: Settings, tuning: bool) -> LogResult:
    """Matches onsets to touches and names each touch's link.

    An onset belongs to a touch if it lies between `EARLY` before the label's begin and the label's end. A
    touch whose alarm merely continues from before has no onset: missed. All other onsets are false alarms.
    """
    ticks = told.ticks
    onsets = log.time[ticks["onset"]]
    claimed = np.zeros(len(onsets), dtype=bool)
    free = np.ones(len(log.time), dtype=bool)
    isolator = ContactIsolator(robot, torque_threshold=settings.isolation_threshold, samples=0)
    results = []
    for first, last in log.touches:
        start, end = float(log.time[first]), float(log.time[last])
        own = (onsets >= start - EARLY) & (onsets <= end)
        claimed |= own
        free &= (log.time < start - EARLY) | (log.time > end)
        delay = float(onsets[own][0]) - start if own.any() else None
        rows = slice(first, last + 1)
        if settings.source == "calibrated":
            link, point = last_contact(robot, told, start, end)
        else:
            link, point = name_link(robot, isolator, log.measured.q[rows], ticks["external_torque"][rows])
        results.append(TouchResult(start, end, delay, link, point is not None, point))
    return LogResult(
        log.name,
        log.link,
        tuning,
        log.repeated,
        tuple(results),
        tuple(float(time) for time in onsets[~claimed]),
        duration(log, free),
        duration(log, free & ticks["collision"]),
    )


def name_link(
    robot: Robot, isolator: ContactIsolator, q: FloatArray, torque: FloatArray
) -> tuple[int | None, FloatArray | None]:
    """Link and, where located, point in its frame, from the mean torque over a touch's strongest part."""
    size = np.linalg.norm(torque, axis=1)
    strong = size >= STRONG_SHARE * size.max()
    contacts = isolator.isolate(q[strong].mean(axis=0), torque[strong].mean(axis=0)).contacts
    if not contacts:
        return None, None
    contact = contacts[0]
    return link_number(robot, contact.link), contact.point_local if contact.located else None


def last_contact(
    robot: Robot, told: Replay, start: float, end: float
) -> tuple[int | None, FloatArray | None]:
    """Link and, where located, point in its frame, of the last contact that goes on between two times [s]."""
    during = [contact for contact in told.contacts if contact.start <= end and contact.end >= start]
    if not during:
        return None, None
    contact = during[-1]
    return link_number(robot, contact.link), contact.point_local if contact.located else None


def link_number(robot: Robot, link: str) -> int:
    """How many of an arm's joints move a link; a hand counts with the last link, being one body with it."""
    moved = np.any(robot.jacobian(robot.neutral(), link) != 0.0, axis=0)
    return int(np.flatnonzero(moved)[-1]) + 1 if moved.any() else 0


def duration(log: TouchLog, rows: BoolArray) -> float:
    """Time of the rows [s], each lasting to the next."""
    return float(np.diff(log.time)[rows[:-1]].sum())
