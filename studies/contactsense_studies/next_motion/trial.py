"""One contact, located while the arm moves a little: by one method, in motions of one kind.

A sphere presses on a link. The arm moves in straight lines of its joints, slowly enough that only the
contact counts, and the method is given the external torques on the way and at rest afterwards, with noise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from contactsense import Robot, next_motion
from contactsense.sim._arrays import FloatArray

from ..bimbo2019.score import point_error
from ..memory.methods import Locator, Method, Setting
from .options import Options
from .touched import Touched, on_the_way, random_step

Way: TypeAlias = Literal["chosen", "random"]
WAYS: tuple[Way, ...] = ("chosen", "random")

CLOSE = 0.01  # error of the point at which a contact counts as located [m]
AT_REST = 5  # torques that are measured before the first motion and after each


@dataclass(frozen=True)
class Outcome:
    """One trial."""

    # Of the point, before the first motion and after each; infinite without a point [m].
    errors: tuple[float, ...]
    greatest_force: float  # of the true contact [N]
    lost: bool  # the true contact, or another link touched

    @property
    def motions(self) -> int | None:
        """Until the point was close for the first time; None: never."""
        close = [number for number, error in enumerate(self.errors) if number and error <= CLOSE]
        return close[0] if close else None


def locate(robot: Robot, link: str, method: Method, way: Way, options: Options, seed: int) -> Outcome:
    """A trial ends when the point is close, or after the most motions of `options`.

    The same seed is the same contact for every method and way.

    Raises:
        InputError: the link cannot be touched so.
    """
    touched = Touched(robot, link, seed)
    locator = method.make(robot, Setting(options.particles, seed))
    rng = np.random.default_rng(seed)
    q, point = touched.scene.q, touched.scene.point
    greatest = float(np.linalg.norm(touched.scene.force))
    estimate = _told(locator, method, [q] * AT_REST, touched)
    errors = [point_error(estimate, point)]
    for _ in range(options.motions):
        step = _step(way, touched, locator, estimate, q, options, rng)
        if step is not None:  # otherwise the arm stays
            poses = on_the_way(q, step)
            q = poses[-1]
            for pose in poses:
                found = touched.forces(pose)
                if [contact.link for contact in found] != [link]:
                    return Outcome(tuple(errors), greatest, True)
                greatest = max(greatest, float(np.linalg.norm(found[0].force)))
            point = found[0].point
            estimate = _told(locator, method, poses + [q] * AT_REST, touched)
        errors.append(point_error(estimate, point))
        if errors[-1] <= CLOSE:
            break
    return Outcome(tuple(errors), greatest, False)


def _told(locator: Locator, method: Method, poses: list[FloatArray], touched: Touched) -> Any:
    """The estimate after torques at all poses: the method is given one in so many, and the last."""
    for left, pose in zip(reversed(range(len(poses))), poses, strict=True):
        torque = touched.torques(pose, 1)[0]
        if left % method.every == 0:
            estimate = locator.update(pose, torque)
    return estimate


def _step(
    way: Way,
    touched: Touched,
    locator: Locator,
    estimate: Any,
    q: FloatArray,
    options: Options,
    rng: np.random.Generator,
) -> FloatArray | None:
    """How far each joint moves; None where no motion is found."""
    max_step = np.deg2rad(options.max_step)
    if way == "random":
        return random_step(touched, q, options.max_force, max_step, rng)
    motion = next_motion(
        touched.robot,
        estimate,
        q,
        max_force=options.max_force,
        max_step=max_step,
        seed=int(rng.integers(2**32)),
        particles=locator.particles(),
        dt=0.1,
    )
    if not motion:
        return None
    step: FloatArray = motion.q[-1] - q
    return step
