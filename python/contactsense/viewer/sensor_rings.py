"""Force/torque sensors as objects of a viser scene: a ring at each, and what it measures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..log.quaternions import of_matrix

Rows = NDArray[np.float64]

COLOUR = (0, 158, 115)
# About a sensor's z axis: seen around the flange of an arm [m].
_RADIUS, _THICKNESS = 0.07, 0.006
_AROUND, _ACROSS = 48, 12  # corners of the ring


class SensorRings:
    """A ring for each sensor, where it is."""

    def __init__(self, scene: Any, robot: _core.Robot, sensors: Sequence[_core.ForceTorqueSensor]) -> None:
        self._robot, self._sensors = robot, sensors
        vertices, triangles = _ring()
        self._rings = [
            scene.add_mesh_simple(f"/sensor {sensor.name}/ring", vertices, triangles, color=COLOUR)
            for sensor in sensors
        ]

    def move(self, q: Rows) -> Rows:
        """Takes them to where they are in a configuration: the origins `(n_sensors, 3)`, world frame [m]."""
        origins = np.zeros((len(self._sensors), 3))
        for k, (sensor, ring) in enumerate(zip(self._sensors, self._rings, strict=True)):
            pose = self._robot.link_pose(q, sensor.link) @ sensor.pose
            # viser has the scalar first.
            ring.wxyz, ring.position = np.roll(of_matrix(pose[:3, :3]), 1), pose[:3, 3]
            origins[k] = pose[:3, 3]
        return origins


def _ring() -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Vertices and triangles of a torus."""
    a, b = np.arange(_AROUND), np.arange(_ACROSS)
    around, across = np.meshgrid(2.0 * np.pi * a / _AROUND, 2.0 * np.pi * b / _ACROSS, indexing="ij")
    distance = _RADIUS + _THICKNESS * np.cos(across)
    height = _THICKNESS * np.sin(across)
    vertices = np.stack([distance * np.cos(around), distance * np.sin(around), height], axis=2).reshape(-1, 3)
    here, there = a[:, None] * _ACROSS, ((a + 1) % _AROUND)[:, None] * _ACROSS
    this, next_ = b[None, :], ((b + 1) % _ACROSS)[None, :]
    corners = [(here + this, there + this, there + next_), (here + this, there + next_, here + next_)]
    triangles = np.concatenate([np.stack(each, axis=2).reshape(-1, 3) for each in corners])
    return vertices.astype(np.float32), triangles.astype(np.uint32)
