"""How the robot's controller goes on after a contact: along its path, to a stop, back, or softly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

Kind: TypeAlias = Literal["none", "stop", "retract", "soft"]


@dataclass
class PathClock:
    """The time along the path [s]: it runs on, stands still, or runs back.

    Args:
        kind: what the robot does.
        delay: from the first force to its begin [s].
        braking: until it stands still [s].
        pause: before it moves back [s].
        back: rate at which it moves back along its path.
        back_for: how far back [s of the path].
    """

    kind: Kind
    delay: float
    braking: float
    pause: float
    back: float
    back_for: float
    time: float = 0.0
    rate: float = 1.0
    _since: float | None = None

    def react(self, now: float) -> None:
        """The first force, at `now` [s]."""
        if self._since is None and self.kind != "none":
            self._since = now + self.delay

    def stop(self, now: float) -> None:
        """A protective stop of a robot that does not react otherwise."""
        if self.kind == "none":
            self.kind, self._since = "stop", now

    @property
    def retracts(self) -> bool:
        """Whether it moves back now."""
        return self.rate < 0.0

    def soft(self, now: float) -> bool:
        """Whether the joints are soft now."""
        return self.kind == "soft" and self._since is not None and now > self._since

    def step(self, now: float, dt: float) -> None:
        """Moves on."""
        if self._since is not None and now > self._since:
            age = now - self._since
            wanted = 0.0
            begin = self.braking + self.pause
            if self.kind == "retract" and begin < age < begin + self.back_for / self.back:
                wanted = -self.back
            change = dt / self.braking
            self.rate += max(-change, min(change, wanted - self.rate))
        self.time = max(0.0, self.time + dt * self.rate)
