"""How many small motions a particle filter needs to locate a contact: planned by `next_motion`, or at random.

A sphere presses on a link. The arm moves in straight lines of its joints, slowly enough that only the
contact counts, and the filter is given the external torques on the way and at rest afterwards, with noise.
The trial is over when, after a motion, the estimated point is within a centimetre of the true one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from contactsense import ContactParticleFilter, InputError, Robot, next_motion
from contactsense.sim import TorqueNoise, touch_scene
from contactsense.sim._arrays import FloatArray
from contactsense.sim.penalty import ContactForce, PenaltyContact, joint_torque
from contactsense.sim.scene import TouchScene

from .bimbo2019.score import point_error
from .harness import median

Way: TypeAlias = Literal["planned", "planned by modes", "random", "random admissible"]

CLOSE = 0.01  # error of the point at which a trial is over [m]
MOST = 40  # motions of a trial
ON_THE_WAY, AT_REST = 5, 5  # updates of the filter, each motion
FORCES = (10.0, 30.0)  # of the first pose [N]
STIFFNESS = (1e3, 1e4)  # of the contact [N/m]
LEAST_TORQUE = 1.0  # of the contact [Nm]
LEAST_FORCE = 1.0  # of a random motion: the contact is kept [N]
DRAWS, SHORTER = 20, 0.8  # random motions that are tried before shorter ones are
NOISE = (3.0, 0.02)  # of each torque [%, Nm]
SCENES = 10  # that are tried for a trial


@dataclass(frozen=True)
class Outcome:
    """One trial."""

    link: str
    motions: int | None  # until the point was close; None: never
    greatest_force: float  # [N], of the true contact
    lost: bool  # the true contact, or another link touched


class Touched:
    """An arm that touches an obstacle: the truth."""

    def __init__(self, robot: Robot, link: str, seed: int) -> None:
        self.robot = robot
        self.scene: TouchScene = touch_scene(
            robot,
            link,
            kind="sphere",
            force_range=FORCES,
            stiffness_range=STIFFNESS,
            least_torque=LEAST_TORQUE,
            seed=seed,
        )
        self._contact: PenaltyContact = self.scene.contact(robot)
        percent, newton_metres = NOISE
        self._noise = TorqueNoise(percent=percent, newton_metres=newton_metres, seed=seed)

    def forces(self, q: FloatArray) -> tuple[ContactForce, ...]:
        """Of the resting arm; none where it is too deep for a force."""
        try:
            return self._contact.forces(q, np.zeros(self.robot.nv))
        except InputError:
            return ()

    def torques(self, q: FloatArray, count: int) -> FloatArray:
        """(count, nv) external torques that are measured at rest."""
        true = joint_torque(self.robot, q, self.forces(q))
        return np.array([self._noise.measure(true) for _ in range(count)])

    def keeps(self, q: FloatArray, step: FloatArray, max_force: float) -> bool:
        """Whether the link alone touches all the way, with a force within bounds."""
        for share in np.arange(1, ON_THE_WAY + 1) / ON_THE_WAY:
            found = self.forces(q + share * step)
            if [contact.link for contact in found] != [self.scene.link]:
                return False
            if not LEAST_FORCE <= np.linalg.norm(found[0].force) <= max_force:
                return False
        return True


def random_step(
    touched: Touched, q: FloatArray, max_force: float, max_step: float, rng: np.random.Generator
) -> FloatArray | None:
    """Each joint uniform, drawn until the true contact is kept and the true force within its bound."""
    low, high = touched.robot.position_limits.T
    size = max_step
    while size > 0.01 * max_step:
        for _ in range(DRAWS):
            step = np.clip(q + size * rng.uniform(-1.0, 1.0, q.size), low, high) - q
            if touched.keeps(q, step, max_force):
                return step
        size *= SHORTER
    return None


def locate(
    robot: Robot,
    link: str,
    way: Way,
    *,
    seed: int,
    max_force: float,
    max_step: float,
    particles: int = 10_000,
    most: int = MOST,
) -> Outcome:
    """One trial; the same seed is the same contact for every `way`.

    Args:
        robot: an arm.
        link: that is touched.
        way: how motions are chosen.
        seed: of everything random.
        max_force: [N].
        max_step: of a joint [rad].
        particles: of the filter.
        most: motions, after which the trial ends.

    Raises:
        InputError: the link cannot be touched so.
    """
    touched = Touched(robot, link, seed)
    tracker = ContactParticleFilter(robot, particles=particles, seed=seed)
    rng = np.random.default_rng(seed)
    q, greatest = touched.scene.q, float(np.linalg.norm(touched.scene.force))
    for torque in touched.torques(q, AT_REST):
        estimate = tracker.update(q, torque)
    for motion in range(1, most + 1):
        step = _step(way, touched, tracker, estimate, q, max_force, max_step, rng)
        if step is None:
            continue  # the arm stays
        start = q
        for share in np.arange(1, ON_THE_WAY + 1) / ON_THE_WAY:
            q = start + share * step
            found = touched.forces(q)
            if [contact.link for contact in found] != [link]:
                return Outcome(link, None, greatest, True)
            greatest = max(greatest, float(np.linalg.norm(found[0].force)))
            estimate = tracker.update(q, touched.torques(q, 1)[0])
        for torque in touched.torques(q, AT_REST):
            estimate = tracker.update(q, torque)
        if point_error(estimate, found[0].point) <= CLOSE:
            return Outcome(link, motion, greatest, False)
    return Outcome(link, None, greatest, False)


def _step(
    way: Way,
    touched: Touched,
    tracker: ContactParticleFilter,
    estimate: Any,
    q: FloatArray,
    max_force: float,
    max_step: float,
    rng: np.random.Generator,
) -> FloatArray | None:
    """How far each joint moves; None where no motion is found."""
    if way == "random":
        return random_step(touched, q, max_force, max_step, rng)
    motion = next_motion(
        touched.robot,
        estimate,
        q,
        max_force=max_force,
        max_step=max_step,
        count=1 if way == "random admissible" else 64,
        seed=int(rng.integers(2**32)),
        particles=None if way == "planned by modes" else tracker.particles,
        dt=0.1,
    )
    if not motion:
        return None
    step: FloatArray = motion.q[-1] - q
    return step


def trials(
    robot: Robot,
    links: Sequence[str],
    way: Way,
    count: int,
    *,
    seed: int = 0,
    max_force: float = 60.0,
    max_step: float = np.deg2rad(1.0),
    particles: int = 10_000,
    most: int = MOST,
) -> list[Outcome]:
    """Trials on the links in turn."""
    outcomes = []
    for number in range(count):
        entropy = np.random.SeedSequence([seed, number]).generate_state(SCENES).tolist()
        for chance in entropy:
            try:
                outcome = locate(
                    robot,
                    links[number % len(links)],
                    way,
                    seed=chance,
                    max_force=max_force,
                    max_step=max_step,
                    particles=particles,
                    most=most,
                )
            except InputError:
                continue  # such a contact was not found
            outcomes.append(outcome)
            break
    return outcomes


def median_motions(outcomes: Sequence[Outcome]) -> float:
    """Until the point is close; trials in which it never is count as one more than the most motions."""
    return median([MOST + 1 if outcome.motions is None else outcome.motions for outcome in outcomes])
