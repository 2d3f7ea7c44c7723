"""One hit's truth against what the monitor said while it lasted."""

from __future__ import annotations

from collections import Counter

import numpy as np

from .. import Contact, ContactReport, Robot
from ..sim import Push
from .result import HitResult
from .settings import FloatArray

# After the force ends the observed torque has yet to fade, and detection to let go [s].
FADING = 0.1


def strongest(report: ContactReport) -> Contact | None:
    """The located contact with the largest force; where none is located, the first of all, if any."""
    located = [contact for contact in report.contacts if contact.located]
    if located:
        return max(located, key=lambda contact: float(np.linalg.norm(contact.force)))
    return report.contacts[0] if report.contacts else None


class HitScorer:
    """Watches the ticks of one hit."""

    def __init__(
        self, robot: Robot, push: Push, number: int, threshold: FloatArray, idle_q: FloatArray
    ) -> None:
        self._robot, self._push, self._number, self._threshold = robot, push, number, threshold
        self._elsewhere: Counter[str] = Counter()
        self._delay: float | None = None
        self._strength = 0.0
        self._time: float | None = None
        self._q = idle_q
        self._contact: Contact | None = None

    @property
    def end(self) -> float:
        """When detections no longer belong to this contact [s]."""
        return self._push.start + self._push.duration + FADING

    def covers(self, time: float) -> bool:
        """Whether a detection at `time` [s] belongs to this hit."""
        return self._push.start <= time <= self.end

    def update(self, time: float, q: FloatArray, report: ContactReport) -> None:
        """One tick that this hit covers."""
        if not report.collision:
            return
        if self._delay is None:
            # A report that began before the hit, and goes on, does not detect it.
            if not report.onset:
                return
            self._delay = time - self._push.start
        named = {contact.link for contact in report.contacts}
        self._elsewhere.update(named - {self._push.link})
        strength = float(np.linalg.norm(report.collision_torque / self._threshold))
        # Detection holds for some time after the last signal; isolation answers only to a present one.
        if report.contacts and strength > self._strength:
            self._strength, self._time, self._q = strength, time, q.copy()
            self._contact = strongest(report)

    def result(self) -> HitResult:
        """The score."""
        push, contact = self._push, self._contact
        pose = self._robot.link_pose(self._q, push.link)
        true_point, _ = push.force_at(push.start, pose)
        turn = pose[:3, :3] if push.frame == "local" else np.eye(3)
        true_force = push.peak_force * (turn @ push.direction)
        located = contact is not None and contact.located
        point = contact.point if contact is not None and located else None
        force = contact.force if contact is not None and located else None
        return HitResult(
            number=self._number,
            start=push.start,
            duration=push.duration,
            link=push.link,
            force=push.peak_force,
            delay=self._delay,
            named=None if contact is None else contact.link,
            located=located,
            time=self._time,
            point_error=None if point is None else float(np.linalg.norm(point - true_point)),
            point_std=contact.point_std if contact is not None and located else None,
            force_error=None
            if force is None
            else float(np.linalg.norm(force - true_force)) / push.peak_force,
            q=self._q,
            true_point=true_point,
            true_force=true_force,
            point=point,
            estimated_force=force,
            elsewhere=dict(self._elsewhere),
        )
