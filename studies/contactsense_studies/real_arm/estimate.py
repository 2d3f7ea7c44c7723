"""Where a contact was, as a monitor reported it, and how far that is from the truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense.sim import ImperfectRun, RecordedContact

from .chain import Chain
from .monitors import Latest


@dataclass(frozen=True)
class JudgedEstimate:
    """What the judged report said of one contact, beside the truth."""

    link: str
    steps: int  # from the true link along the chain; 0: the link is right
    error: float  # of the point [m]; NaN where none is given
    located: bool
    link_probabilities: dict[str, float]  # empty where the monitor gives none
    region_radius: float  # [m] that holds 90 % of the posterior; NaN where none is given
    age: float  # from the onset to the report [s]
    contacts: int  # that the report had; the first is judged

    @property
    def probability(self) -> float:
        """Of the named link; NaN where the monitor gives none."""
        return self.link_probabilities.get(self.link, 0.0) if self.link_probabilities else np.nan

    @property
    def covered(self) -> bool | None:
        """Whether the 90 % region holds the true point; None where there is no region."""
        return None if np.isnan(self.region_radius + self.error) else self.error <= self.region_radius


def judge_estimate(
    run: ImperfectRun, chain: Chain, contact: RecordedContact, latest: Latest
) -> JudgedEstimate:
    """The first contact of a report against the true point in the pose of its tick."""
    told = latest.contacts[0]
    truth = contact.contact
    pose = run.truth.robot.link_pose(run.truth.q[latest.row], truth.link)
    point = pose[:3, :3] @ truth.point_local + pose[:3, 3]
    return JudgedEstimate(
        link=told.link,
        steps=chain.steps(truth.link, told.link),
        error=float(np.linalg.norm(told.point - point)),
        located=told.located,
        link_probabilities=told.link_probabilities,
        region_radius=told.region_radius,
        age=float(run.truth.time[latest.row] - run.truth.time[latest.onset]),
        contacts=len(latest.contacts),
    )
