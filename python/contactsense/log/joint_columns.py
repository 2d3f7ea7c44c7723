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
        places = [np.flatnonzero(robot.configuration({name: 0.25}) != self._neutral) for name in self.names]
        plain = [joint for joint, place in enumerate(places) if len(place) == 1]
        self._plain = np.array(plain, dtype=np.intp)  # joints whose coordinate is their position
        self._plain_q = np.array([places[joint][0] for joint in plain], dtype=np.intp)
        self._endless = [(joint, *place) for joint, place in enumerate(places) if len(place) == 2]
        velocities = [int(np.flatnonzero(robot.velocity({name: 1.0}))[0]) for name in self.names]
        self._v = np.array(velocities, dtype=np.intp)

    def configuration(self, positions: Rows) -> Rows:
        """`(n, nq)` of the joints' positions `(n, joints)` [rad, m]."""
        q = np.empty((len(positions), len(self._neutral)))
        q[:] = self._neutral
        q[:, self._plain_q] = positions[:, self._plain]
        for joint, cosine, sine in self._endless:
            q[:, cosine], q[:, sine] = np.cos(positions[:, joint]), np.sin(positions[:, joint])
        return q

    def velocity(self, velocities: Rows) -> Rows:
        """`(n, nv)` of the joints' velocities or torques `(n, joints)`."""
        v = np.zeros((len(velocities), self._nv))
        v[:, self._v] = velocities
        return v

    def positions(self, q: Rows) -> Rows:
        """`(n, joints)` of configurations `(n, nq)`: the inverse of `configuration`, within half a turn."""
        positions = np.empty((len(q), len(self.names)))
        positions[:, self._plain] = q[:, self._plain_q]
        for joint, cosine, sine in self._endless:
            positions[:, joint] = np.arctan2(q[:, sine], q[:, cosine])
        return positions

    def velocities(self, v: Rows) -> Rows:
        """`(n, joints)` of velocities or torques `(n, nv)`: the inverse of `velocity`.

        Torques may lack those of a floating base, `(n, nv - 6)`.
        """
        return np.ascontiguousarray(v[:, self._v - (self._nv - v.shape[1])])
