"""A person who pushes an arm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense.errors import InputError

from ._arrays import FloatArray, positive, vector


@dataclass(frozen=True, eq=False)
class PersonContact:
    """A force that rises smoothly, holds and falls, at a point that goes along with its link."""

    link: str
    point_local: FloatArray  # (3,) link frame [m]
    force_local: FloatArray  # (3,) the largest, on the robot, link frame [N]
    start: float  # [s]
    duration: float  # [s]
    rise: float  # time to the full force, and from it back to none [s]; at most half of the duration

    def __post_init__(self) -> None:
        for name in ("point_local", "force_local"):
            array = vector(name, getattr(self, name), 3)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        positive("duration", self.duration)
        positive("rise", self.rise)
        if self.rise > 0.5 * self.duration:
            raise InputError(
                f"rise: must be at most half of the duration, {0.5 * self.duration} s, not {self.rise}"
            )
        if not np.isfinite(self.start):
            raise InputError("start: must be finite")

    @property
    def end(self) -> float:
        """[s]."""
        return self.start + self.duration

    def share(self, time: FloatArray) -> FloatArray:
        """Share of the largest force at times (n,) [s]: from 0 to 1, with continuous second derivative."""
        edge = np.clip(np.minimum(time - self.start, self.end - time) / self.rise, 0.0, 1.0)
        return edge**3 * (10.0 + edge * (-15.0 + 6.0 * edge))

    def at(self, time: float, link_pose: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Point [m] and force [N] at `time`, world frame, for the link's pose (4, 4)."""
        rotation, origin = link_pose[:3, :3], link_pose[:3, 3]
        share = float(self.share(np.array([time]))[0])
        return origin + rotation @ self.point_local, share * (rotation @ self.force_local)
