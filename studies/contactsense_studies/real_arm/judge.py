"""What monitors said, against the truth."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contactsense.sim import ImperfectRun, RecordedContact

from .chain import Chain
from .estimate import JudgedEstimate, judge_estimate
from .monitors import SETTLING, Heard

# After a contact the observer's output falls with its time constant: an onset then is not counted as one of
# its own [s].
LINGERING = 0.1


@dataclass(frozen=True)
class JudgedContact:
    """One contact: the truth, how long each monitor took, and where it found the contact."""

    link: str
    force: float  # the largest [N]
    duration: float  # [s]
    # Largest external torque of a joint at the largest force, in standard deviations of the noise of its
    # torque sensor: where it is small, no monitor can see the contact.
    signal: float
    # How many times as often its link would be touched if points were uniform by area over the whole arm, and
    # not on every link equally often.
    weight_by_area: float
    delays: dict[str, float | None]  # by monitor, from the start of the force to an onset [s]; None: missed
    # By monitor, whether a contact was reported already when this one began, so that it could give no onset.
    reported_before: dict[str, bool]
    # By monitor; None where it was missed, or no report had a contact.
    estimates: dict[str, JudgedEstimate | None]


@dataclass(frozen=True)
class FreeMotion:
    """What one monitor said where nobody touched."""

    seconds: float  # judged [s]
    onsets: int
    share: float  # of the time in collision
    chance: float  # share of the contacts in whose place an onset would have been without them
    between: int  # onsets outside contacts in the record with contacts
    between_share: float  # of the time outside contacts in that record, in collision
    rms: tuple[float, ...]  # (nv,) of the external torque [Nm]


def judge_contacts(run: ImperfectRun, heard: Mapping[str, Heard]) -> tuple[JudgedContact, ...]:
    """A contact is detected if an onset falls into it.

    Its place is judged by the last report with a contact before it ends, at most `REACTION` after the onset.
    """
    chain = Chain(run.truth.robot)
    robot = run.truth.robot
    noise = run.truth.arm.per_joint("torque_noise", robot.nv)
    areas = {link: robot.surface(link).area for link in robot.link_names}
    mean_area = float(np.mean(list(areas.values())))
    return tuple(
        JudgedContact(
            link=each.contact.link,
            force=float(np.linalg.norm(each.force)),
            duration=each.contact.duration,
            signal=float(np.max(np.abs(each.external_torque) / noise)),
            weight_by_area=areas[each.contact.link] / mean_area,
            delays={name: _delay(run, told, each) for name, told in heard.items()},
            reported_before={
                name: bool(told.collision[max(each.rows.start - 1, 0)]) for name, told in heard.items()
            },
            estimates={name: _estimate(run, chain, told, number) for name, told in heard.items()},
        )
        for number, each in enumerate(run.truth.contacts)
    )


def _estimate(run: ImperfectRun, chain: Chain, heard: Heard, number: int) -> JudgedEstimate | None:
    latest = heard.latest.get(number)
    return None if latest is None else judge_estimate(run, chain, run.truth.contacts[number], latest)


def _delay(run: ImperfectRun, heard: Heard, contact: RecordedContact) -> float | None:
    onsets = run.truth.time[contact.rows][heard.onset[contact.rows]]
    return float(onsets[0] - contact.contact.start) if len(onsets) else None


def judge_free(run: ImperfectRun, heard: Heard, touched: ImperfectRun, heard_touched: Heard) -> FreeMotion:
    """Of a run without contact, and of the pauses of one with contacts."""
    time = run.truth.time
    settled, pauses = time > time[0] + SETTLING, _pauses(touched)
    return FreeMotion(
        seconds=float(time[-1] - time[0] - SETTLING),
        onsets=int(heard.onset[settled].sum()),
        share=float(heard.collision[settled].mean()),
        chance=_by_chance(time, time[heard.onset & settled], touched),
        between=int(heard_touched.onset[pauses].sum()),
        between_share=float(heard_touched.collision[pauses].mean()),
        rms=tuple(np.sqrt(np.mean(heard.external_torque[settled] ** 2, axis=0)).tolist()),
    )


def _by_chance(time: NDArray[np.float64], onsets: NDArray[np.float64], touched: ImperfectRun) -> float:
    """Share of the contacts' times, laid over a record without contact, that an onset falls into."""
    hits = []
    for each in touched.truth.contacts:
        room = time[-1] - SETTLING - each.contact.duration
        start = SETTLING + each.contact.start % room
        hits.append(bool(((onsets > start) & (onsets < start + each.contact.duration)).any()))
    return float(np.mean(hits))


def _pauses(touched: ImperfectRun) -> NDArray[np.bool_]:
    """Rows outside contacts."""
    time = touched.truth.time
    outside: NDArray[np.bool_] = time > time[0] + SETTLING
    for each in touched.truth.contacts:
        outside &= (time < each.contact.start) | (time > each.contact.end + LINGERING)
    return outside
