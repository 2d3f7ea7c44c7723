"""From one column a joint to the order of a robot's vectors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import _core

Rows = NDArray[np.float64]


class JointColumns:
    """Where each actuated joint is in configurations and velocities.

    Attributes:
        names: of the joints, in the robot's order.
        turns: whether each turns; the others slide.
    """

    def __init__(self, robot: _core.Robot) -> None:
        self.names = robot.actuated_joint_names
        self._neutral = np.asarray(robot.neutral())
        self._nv = robot.nv
        kinds = dict(zip(robot.joint_names, robot.joint_kinds, strict=True))
        self.turns = [kinds[name] != "prismatic" for name in self.names]
        self._q = [np.flatnonzero(robot.configuration({name: 0.25}) != self._neutral) for name in self.names]
        self._v = [int(np.flatnonzero(robot.velocity({name: 1.0}))[0]) for name in self.names]

    def configuration(self, positions: Rows) -> Rows:
        """`(n, nq)` of the joints' positions `(n, joints)` [rad, m]."""
        q = np.tile(self._neutral, (len(positions), 1))
        for joint, places in enumerate(self._q):
            angle = positions[:, joint]
            if len(places) == 2:
                q[:, places[0]], q[:, places[1]] = np.cos(angle), np.sin(angle)
            else:
                q[:, places[0]] = angle
        return q

    def velocity(self, velocities: Rows) -> Rows:
        """`(n, nv)` of the joints' velocities or torques `(n, joints)`."""
        v = np.zeros((len(velocities), self._nv))
        v[:, self._v] = velocities
        return v

    def positions(self, q: Rows) -> Rows:
        """`(n, joints)` of configurations `(n, nq)`: the inverse of `configuration`, within half a turn."""
        angles = [
            np.arctan2(q[:, places[1]], q[:, places[0]]) if len(places) == 2 else q[:, places[0]]
            for places in self._q
        ]
        return np.column_stack(angles)

    def velocities(self, v: Rows) -> Rows:
        """`(n, joints)` of velocities or torques `(n, nv)`: the inverse of `velocity`.

        Torques may lack those of a floating base, `(n, nv - 6)`.
        """
        return np.ascontiguousarray(v[:, np.array(self._v) - (self._nv - v.shape[1])])
