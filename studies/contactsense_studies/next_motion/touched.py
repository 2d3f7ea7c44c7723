"""An arm that touches an obstacle at rest, and how far it may move at random."""

from __future__ import annotations

import numpy as np

from contactsense import InputError, Robot
from contactsense.sim import TorqueNoise, touch_scene
from contactsense.sim._arrays import FloatArray
from contactsense.sim.penalty import ContactForce, PenaltyContact, joint_torque
from contactsense.sim.scene import TouchScene

FORCES = (10.0, 30.0)  # of the first pose [N]
STIFFNESS = (1e3, 1e4)  # of the contact [N/m]
LEAST_TORQUE = 1.0  # of the contact [Nm]
LEAST_FORCE = 1.0  # of a random motion: the contact is kept [N]
DRAWS, SHORTER = 20, 0.8  # random motions that are tried before shorter ones are
NOISE = (3.0, 0.02)  # of each torque [%, Nm]
ON_THE_WAY = 5  # poses of a motion


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
        for pose in on_the_way(q, step):
            found = self.forces(pose)
            if [contact.link for contact in found] != [self.scene.link]:
                return False
            if not LEAST_FORCE <= np.linalg.norm(found[0].force) <= max_force:
                return False
        return True


def on_the_way(q: FloatArray, step: FloatArray) -> list[FloatArray]:
    """Poses of a straight motion of the joints; the last is its end."""
    return [q + share * step for share in np.arange(1, ON_THE_WAY + 1) / ON_THE_WAY]


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
