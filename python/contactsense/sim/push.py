"""A push of a hand or an obstacle: one point, a direction, a force that swells and fades."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from contactsense import Surface
from contactsense.errors import InputError

from ._arrays import FloatArray, positive, tangents, unit_vector, vector
from .arm import SimulatedRobot


@dataclass(frozen=True)
class Push:
    """A half-sine of force at a point that goes along with the link.

    `force(t) = peak_force sin(pi (t - start) / duration)` while it lasts, acting on the robot.
    """

    link: str
    point_local: FloatArray  # (3,) in the link's frame [m]
    direction: FloatArray  # (3,) of the force on the robot; made a unit vector
    peak_force: float  # [N]
    start: float  # [s]
    duration: float  # [s]
    frame: Literal["local", "world"] = "local"  # of `direction`

    def __post_init__(self) -> None:
        object.__setattr__(self, "point_local", vector("point_local", self.point_local, 3))
        object.__setattr__(self, "direction", unit_vector("direction", self.direction))
        positive("peak_force", self.peak_force)
        positive("duration", self.duration)
        if self.frame not in ("local", "world"):
            raise InputError(f"frame must be 'local' or 'world', not {self.frame!r}")

    def magnitude(self, time: float) -> float:
        """[N] at `time` [s]; zero before and after."""
        phase = (time - self.start) / self.duration
        return self.peak_force * float(np.sin(np.pi * phase)) if 0.0 < phase < 1.0 else 0.0

    def force_at(self, time: float, link_pose: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Point [m] and force [N] in the world frame, each (3,), for the link's pose (4, 4) at `time`."""
        rotation, origin = link_pose[:3, :3], link_pose[:3, 3]
        direction = rotation @ self.direction if self.frame == "local" else self.direction
        return origin + rotation @ self.point_local, self.magnitude(time) * direction

    def apply(self, robot: SimulatedRobot) -> tuple[FloatArray, FloatArray]:
        """Put the push of the coming tick on `robot`, at its mid-time; returns point and force, world frame.

        Call `robot.clear_forces()` before each tick.
        """
        point, force = self.force_at(robot.time + 0.5 * robot.dt, robot.link_pose(self.link))
        if force.any():
            robot.apply_force(self.link, point, force)
        return point, force


def random_push(
    link: str,
    surface: Surface,
    *,
    peak_force: float,
    start: float,
    duration: float,
    cone_angle: float = np.pi / 6,
    seed: int = 0,
) -> Push:
    """A push at a random point of the link's surface, inward, fixed to the link.

    Args:
        link: the link that is pushed.
        surface: of `link`, in its frame.
        peak_force: [N].
        start: [s].
        duration: [s].
        cone_angle: largest angle [rad] between force and inward normal, below pi/2; directions are uniform in
            the cone. The arctangent of the friction coefficient makes it the friction cone.
        seed: same seed, same push.
    """
    if not 0.0 <= cone_angle < np.pi / 2:
        raise InputError(f"cone_angle must be from 0 to below pi/2, not {cone_angle}")
    samples = surface.sample(1, seed=seed)
    inward = -unit_vector("surface normal", samples.normals[0])
    generator = np.random.default_rng(seed)
    cosine = generator.uniform(np.cos(cone_angle), 1.0)
    turn = generator.uniform(0.0, 2 * np.pi)
    first, second = tangents(inward)
    side = np.cos(turn) * first + np.sin(turn) * second
    direction = cosine * inward + np.sqrt(1.0 - cosine**2) * side
    return Push(link, samples.points[0], direction, peak_force, start, duration)
