"""What a robot touches, along one line: a thing that is free or held, or the hand of a person."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass
class Thing:
    """A mass on the way of a point of the robot; it moves along the line of the contact only.

    Args:
        mass: [kg]; infinite for what does not move at all.
        skin: stiffness of the contact itself [N/m].
        loss: damping of the contact as a share of its force for a closing speed of 1 m/s (Hunt and Crossley).
        spring: that holds it where it was [N/m].
        damper: that holds it [N s/m].
        gap: to a wall behind it [m]; None: there is none.
        wall: stiffness of the wall [N/m].
        leaves: time after the first touch at which a person draws back [s]; None: never.
        pull: the force of drawing back [N].
    """

    mass: float
    skin: float
    loss: float = 0.5
    spring: float = 0.0
    damper: float = 0.0
    gap: float | None = None
    wall: float = 1e5
    leaves: float | None = None
    pull: float = 0.0
    _place: float = field(default=0.0, init=False)
    _speed: float = field(default=0.0, init=False)
    _touched: float = field(default=0.0, init=False)

    def force(self, place: float, speed: float, dt: float) -> float:
        """Moves on; returns the force on the robot against the line [N], `place` past the first touch [m].

        The point is taken where it will be at the end of the step, which keeps stiff contacts stable.
        """
        depth = place + dt * speed - self._place
        closing = 1.0 + self.loss * (speed - self._speed)
        force = self.skin * depth * float(np.clip(closing, 0.0, 3.0)) if depth > 0.0 else 0.0
        if force > 0.0 or self._touched > 0.0:
            self._touched += dt
        if np.isfinite(self.mass):
            self._move(force, dt)
        return force

    def _move(self, force: float, dt: float) -> None:
        push = force - self.spring * self._place - self.damper * self._speed
        if self.leaves is not None and self._touched > self.leaves:
            push += self.pull
        if self.gap is not None and self._place > self.gap:
            deep = self._place - self.gap
            push -= self.wall * deep * float(np.clip(1.0 + 0.5 * self._speed, 0.0, 3.0))
        self._speed += dt * push / self.mass
        self._place += dt * self._speed


@dataclass(frozen=True)
class Hand:
    """A force that a person exerts on purpose: it rises, holds with some unrest, and falls.

    Args:
        peak: [N].
        rise, hold, fall: [s].
        unrest: relative amplitude of slow changes while it lasts.
        rate: of these [Hz].
        phase: of these [rad].
    """

    peak: float
    rise: float
    hold: float
    fall: float
    unrest: float = 0.0
    rate: float = 1.0
    phase: float = 0.0

    @property
    def duration(self) -> float:
        """[s]."""
        return self.rise + self.hold + self.fall

    def force(self, time: float) -> float:
        """[N] at `time` after the begin [s]."""
        edge = min(time / self.rise, (self.duration - time) / self.fall, 1.0)
        if edge <= 0.0:
            return 0.0
        smooth = edge**3 * (10.0 + edge * (-15.0 + 6.0 * edge))
        return (
            self.peak
            * smooth
            * (1.0 + self.unrest * float(np.sin(2 * np.pi * self.rate * time + self.phase)))
        )


@dataclass(frozen=True)
class Lead:
    """A hand that takes hold and leads: a spring and a damper to a point that moves off smoothly.

    Args:
        way: how far and where to, world frame (3,) [m].
        duration: of the way [s]; the hand then holds as long as `hold` [s] and lets go.
        hold: [s].
        spring: [N/m]; damper: [N s/m].
        most: the largest force [N].
    """

    way: tuple[float, float, float]
    duration: float
    hold: float
    spring: float
    damper: float
    most: float

    def force(self, time: float, moved: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """(3,) [N] on the robot's point, which has moved by `moved` (3,) [m] since the hand took hold."""
        left = self.duration + self.hold - time
        if time < 0.0 or left <= 0.0:
            return np.zeros(3)
        x = min(time / self.duration, 1.0)
        ahead = np.array(self.way) * x**3 * (10.0 + x * (-15.0 + 6.0 * x))
        force = self.spring * (ahead - moved) - self.damper * velocity
        force *= min(1.0, time / 0.1, left / 0.15)
        size = float(np.linalg.norm(force))
        return np.asarray(force * min(1.0, self.most / max(size, 1e-9)))
