"""Contact as a spring between a link's true surface and an obstacle."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from contactsense import Robot
from contactsense.errors import InputError

from ._arrays import FloatArray, not_negative, positive
from .arm import SimulatedRobot
from .deepest import ContactQuery, DeepestPoint
from .noise import TorqueNoise
from .obstacles import Obstacle
from .sampling import Touch

# Time in which friction must not reverse the slip [s].
_TICK = 1e-3


@dataclass(frozen=True)
class ContactForce:
    """What an obstacle does to one link; world frame."""

    link: str
    point: FloatArray  # (3,) on the link's surface [m]
    normal: FloatArray  # (3,) unit, outward of the link
    penetration: float  # [m]
    force: FloatArray  # (3,) on the robot [N]


class PenaltyContact:
    """A penalty force at the deepest point of every link that touches the obstacle.

    Normal force `F = stiffness d (1 + dissipation d')` along the inward normal, never pulling (Hunt and
    Crossley 1975); `d` is the penetration. Friction `-friction F v_t / sqrt(|v_t|^2 + slip_speed^2)`,
    Coulomb's
    regularised: at rest there is none, so a link held still creeps at a speed far below `slip_speed`.

    Args:
        robot: its true surfaces touch.
        obstacle: stands still.
        stiffness: [N/m].
        friction: coefficient; 0 = frictionless.
        dissipation: [s/m].
        slip_speed: at least [m/s]. Where friction within 1 ms could turn the slip of the light link round, as
            explicit integration would make it do for ever, it is raised to that speed.
        links: that can touch; by default all that have a surface and move.

    Raises:
        InputError: names the argument.
    """

    def __init__(
        self,
        robot: Robot,
        obstacle: Obstacle,
        *,
        stiffness: float,
        friction: float = 0.0,
        dissipation: float = 0.0,
        slip_speed: float = 1e-3,
        links: tuple[str, ...] | None = None,
    ) -> None:
        self.robot, self.obstacle = robot, obstacle
        self.query = ContactQuery(robot, obstacle, links=links)
        self.stiffness = positive("stiffness", stiffness)
        self.friction = not_negative("friction", friction)
        self.dissipation = not_negative("dissipation", dissipation)
        self.slip_speed = positive("slip_speed", slip_speed)

    def forces(self, q: FloatArray, v: FloatArray) -> tuple[ContactForce, ...]:
        """One for each link that touches at position `q` (nq,) and velocity `v` (nv,), deepest first.

        Raises:
            InputError: the obstacle's core is reached, so that the force has no direction.
        """
        return tuple(self._force(q, v, contact) for contact in self.query.touching(q))

    def apply(self, arm: SimulatedRobot) -> tuple[ContactForce, ...]:
        """Put the forces of the coming tick on `arm`, at its mid-time; call `arm.clear_forces()` before."""
        # Forces of the tick's beginning would lag by half a tick, and feed energy into a stiff contact.
        q, v = arm.q, arm.v
        middle = q + 0.5 * arm.dt * v if q.size == v.size else q
        forces = self.forces(middle, v)
        for contact in forces:
            arm.apply_force(contact.link, contact.point, contact.force)
        return forces

    def arm(self, model: pin.Model, *, dt: float = 0.001, noise: TorqueNoise | None = None) -> SimulatedRobot:
        """A simulated robot to `apply` the forces to."""
        return SimulatedRobot(model, dt=dt, noise=noise)

    def present(self, arm: SimulatedRobot) -> tuple[ContactForce, ...]:
        """The forces on `arm` as it is now."""
        return self.forces(arm.q, arm.v)

    def to_dict(self) -> dict[str, Any]:
        """Plain values of its settings."""
        return {
            "contact": "penalty",
            "obstacle": self.obstacle.to_dict(),
            "stiffness": self.stiffness,
            "friction": self.friction,
            "dissipation": self.dissipation,
            "slip_speed": self.slip_speed,
        }

    def _mobility(self, q: FloatArray, contact: DeepestPoint) -> float:
        """The most that a force of 1 N across the normal accelerates the touched point [1/kg]."""
        jacobian = self.robot.jacobian(q, contact.link, contact.point)[:3]
        across = jacobian - np.outer(contact.normal, contact.normal @ jacobian)
        return float(np.linalg.norm(across @ np.linalg.solve(self.robot.mass_matrix(q), across.T), 2))

    def _force(self, q: FloatArray, v: FloatArray, contact: DeepestPoint) -> ContactForce:
        depth = contact.penetration
        if not contact.normal.any():
            raise InputError(
                f"stiffness: '{contact.link}' is {depth:.4g} m deep, as deep as the obstacle's rounding;"
                " the contact must be stiffer, or the obstacle rounder"
            )
        velocity = self.robot.jacobian(q, contact.link, contact.point)[:3] @ v
        inward = float(contact.normal @ velocity)
        size = max(self.stiffness * depth * (1.0 + self.dissipation * inward), 0.0)
        force = -size * contact.normal
        if self.friction > 0.0:
            slip = velocity - inward * contact.normal
            speed = max(self.slip_speed, self.friction * size * self._mobility(q, contact) * _TICK)
            force -= self.friction * size * slip / np.hypot(np.linalg.norm(slip), speed)
        return ContactForce(contact.link, contact.point, contact.normal, depth, force)


def joint_torque(robot: Robot, q: FloatArray, forces: Iterable[ContactForce | Touch]) -> FloatArray:
    """(nv,) external joint torque of `forces` at `q`: the sum of `J^T F` [Nm]."""
    total = np.zeros(robot.nv)
    for contact in forces:
        total += robot.jacobian(q, contact.link, contact.point)[:3].T @ contact.force
    return total
