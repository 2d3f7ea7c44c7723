"""The robot and what is felt, as objects of a viser scene."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._pictures import BODY, ESTIMATE, NAMED, UNSURE
from ..log.quaternions import of_matrix
from .moment import Moment, Touch

Rows = NDArray[np.float64]

_METRES_PER_NEWTON = 0.006
_SHAFT, _HEAD, _HEAD_LENGTH = 0.006, 0.015, 0.03  # [m]
_DOT = 0.012  # [m]
# Places that are less likely than this share of the likeliest one are not drawn.
_LEAST = 0.01
# From unlikely to likely: pale yellow to dark red.
_COLD, _HOT = np.array([255.0, 237.0, 160.0]), np.array([189.0, 0.0, 38.0])


class Stage:
    """A robot in a scene; `show` moves it and draws an instant.

    `reach` is how far the robot reaches from the origin at the beginning [m].
    """

    def __init__(self, scene: Any, robot: _core.Robot, q: Rows) -> None:
        self._scene, self._robot = scene, robot
        scene.set_up_direction("+z")
        reach, lowest = 0.0, 0.0
        self._links: dict[str, Any] = {}
        for link in robot.link_names:
            surface = robot.surface(link)
            if not len(surface.triangles):
                continue
            self._links[link] = scene.add_mesh_simple(
                f"/robot/{link}", surface.vertices.astype(np.float32), surface.triangles.astype(np.uint32),
                color=_rgb(BODY), side="double",
            )  # fmt: skip
            pose = robot.link_pose(q, link)
            points = surface.vertices @ pose[:3, :3].T + pose[:3, 3]
            lowest = min(lowest, float(points[:, 2].min()))
            reach = max(reach, float(np.linalg.norm(points, axis=1).max()))
        self.reach = reach
        size = 2.0 * np.ceil(reach)
        scene.add_grid("/ground", width=size, height=size, cell_size=0.1, position=(0.0, 0.0, lowest))
        self._drawn: list[Any] = []
        self._coloured: set[str] = set()

    def show(self, moment: Moment) -> None:
        """Draws an instant in place of the one before."""
        self._move(moment.q)
        self._colour({touch.link for touch in moment.touches})
        for handle in self._drawn:
            handle.remove()
        self._drawn = []
        for number, touch in enumerate(moment.touches):
            if np.all(np.isfinite(touch.point)):
                self._draw(number, touch)
        likely = moment.likelihood > _LEAST
        if likely.any():
            share = moment.likelihood[likely, None]
            colours = (_COLD + share * (_HOT - _COLD)).astype(np.uint8)
            self._drawn.append(
                self._scene.add_point_cloud(
                    "/posterior", moment.places[likely].astype(np.float32), colours,
                    point_size=_DOT, point_shape="circle", point_shading="flat",
                )
            )  # fmt: skip

    def _move(self, q: Rows) -> None:
        for link, handle in self._links.items():
            pose = self._robot.link_pose(q, link)
            # viser has the scalar first.
            handle.wxyz, handle.position = np.roll(of_matrix(pose[:3, :3]), 1), pose[:3, 3]

    def _colour(self, touched: set[str]) -> None:
        for link in touched ^ self._coloured:
            if link in self._links:
                self._links[link].color = _rgb(NAMED if link in touched else BODY)
        self._coloured = touched

    def _draw(self, number: int, touch: Touch) -> None:
        colour = _rgb(ESTIMATE if touch.located else UNSURE)
        scene, name = self._scene, f"/contact {number}"
        self._drawn.append(scene.add_icosphere(f"{name}/point", _DOT, colour, position=touch.point))
        if np.isfinite(touch.region_radius) and touch.region_radius > 0.0:
            self._drawn.append(
                scene.add_icosphere(
                    f"{name}/region", touch.region_radius, colour, opacity=0.15, position=touch.point,
                    cast_shadow=False,
                )
            )  # fmt: skip
        if np.all(np.isfinite(touch.force)):
            # It ends where it acts.
            ends = np.array([[touch.point - _METRES_PER_NEWTON * touch.force, touch.point]])
            self._drawn.append(
                scene.add_arrows(
                    f"{name}/force", ends.astype(np.float32), colour,
                    shaft_radius=_SHAFT, head_radius=_HEAD, head_length=_HEAD_LENGTH,
                )
            )  # fmt: skip


def _rgb(colour: str) -> tuple[int, int, int]:
    """Of `#RRGGBB`."""
    red, green, blue = bytes.fromhex(colour[1:])
    return red, green, blue
