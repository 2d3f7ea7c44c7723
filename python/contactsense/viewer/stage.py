"""The robot and what is felt, as objects of a viser scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._pictures import BODY, ESTIMATE, NAMED, UNSURE
from ..log.quaternions import of_matrix
from .moment import Cloud, Moment, Touch
from .sensor_rings import COLOUR, SensorRings

Rows = NDArray[np.float64]

_METRES_PER_NEWTON = 0.006
_LONGEST = 0.8  # arrow [m]: that of 133 N and more
_LEAST_FORCE = 1.0  # of which an arrow is drawn [N]: less is noise of most sensors
_SHAFT, _HEAD, _HEAD_LENGTH = 0.009, 0.022, 0.045  # [m]
_POINT, _DOT, _PARTICLE = 0.012, 0.009, 0.009  # [m]
_GROUND = 4.0  # width, as a multiple of the robot's size
_OPACITY, _SMOOTH = 0.12, 4  # of a region, and how often the triangles of its ball are divided
# Places that are less likely than this share of the likeliest one are not drawn.
_LEAST = 0.01
# From unlikely to likely: pale yellow to dark red; of particles pale pink to purple.
HEAT = np.array([[255.0, 237.0, 160.0], [189.0, 0.0, 38.0]])
PURPLE = np.array([[205.0, 110.0, 195.0], [110.0, 20.0, 120.0]])


class Stage:
    """A robot in a scene; `show` moves it and draws an instant."""

    def __init__(
        self,
        scene: Any,
        robot: _core.Robot,
        sensors: Sequence[_core.ForceTorqueSensor] = (),
    ) -> None:
        self._scene, self._robot = scene, robot
        scene.set_up_direction("+z")
        self._links: dict[str, Any] = {}
        for link in robot.link_names:
            surface = robot.surface(link)
            if not len(surface.triangles):
                continue
            self._links[link] = scene.add_mesh_simple(
                f"/robot/{link}", surface.vertices.astype(np.float32), surface.triangles.astype(np.uint32),
                color=_rgb(BODY), side="double",
            )  # fmt: skip
        self._rings = SensorRings(scene, robot, sensors)
        self._drawn: dict[str, Any] = {}
        self._kept: set[str] = set()
        self._coloured: set[str] = set()

    def settle(self, q: Rows) -> tuple[Rows, float]:
        """Lays the ground below the robot: middle `(3,)` and radius of a ball about the robot [m]."""
        corners = []
        for link in self._links:
            pose = self._robot.link_pose(q, link)
            points = self._robot.surface(link).vertices @ pose[:3, :3].T + pose[:3, 3]
            corners += [points.min(axis=0), points.max(axis=0)]
        low, high = np.min(corners, axis=0), np.max(corners, axis=0)
        middle, radius = (low + high) / 2.0, float(np.linalg.norm(high - low)) / 2.0
        width = _GROUND * np.ceil(radius)
        # Lines of the grid are at whole metres, also where a robot walks far from the origin.
        position = (*np.round(middle[:2]), low[2] if self._robot.floating_base else min(0.0, low[2]))
        self._scene.add_grid("/ground", width=width, height=width, cell_size=0.1, position=position)
        return middle, radius

    def show(self, moment: Moment) -> None:
        """Draws an instant in place of the one before."""
        self._move(moment.q)
        self._colour({touch.link for touch in moment.touches})
        self._kept = set()
        for number, touch in enumerate(moment.touches):
            if np.all(np.isfinite(touch.point)):
                self._draw(number, touch)
        for number, (origin, wrench) in enumerate(
            zip(self._rings.move(moment.q), moment.wrenches, strict=False)
        ):
            self._arrow(f"/sensor force {number}", origin, wrench[:3], COLOUR)
        self._cloud("/posterior", moment.posterior, HEAT, _DOT)
        self._cloud("/particles", moment.particles, PURPLE, _PARTICLE)
        for name in self._drawn.keys() - self._kept:
            self._drawn.pop(name).remove()

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
        add, name = self._scene.add_icosphere, f"/contact {number}"
        self._put(f"{name}/point", add, radius=_POINT, color=colour, position=touch.point)
        if np.isfinite(touch.region_radius) and touch.region_radius > 0.0:
            self._put(
                f"{name}/region", add, radius=touch.region_radius, color=colour, opacity=_OPACITY,
                position=touch.point, cast_shadow=False, subdivisions=_SMOOTH,
            )  # fmt: skip
        self._arrow(f"{name}/force", touch.point, touch.force, colour)

    def _arrow(self, name: str, point: Rows, force: Rows, colour: tuple[int, int, int]) -> None:
        """A force that ends where it acts."""
        size = float(np.linalg.norm(force))
        if not size >= _LEAST_FORCE:  # nor where it is not known
            return
        along = force / size * min(_METRES_PER_NEWTON * size, _LONGEST)
        self._put(
            name, self._scene.add_arrows, points=np.array([[point - along, point]], dtype=np.float32),
            colors=_linear(colour), shaft_radius=_SHAFT, head_radius=_HEAD,
            head_length=_HEAD_LENGTH,
        )  # fmt: skip

    def _cloud(self, name: str, cloud: Cloud, colours: Rows, size: float) -> None:
        likely = cloud.shares > _LEAST
        if not likely.any():
            return
        share = cloud.shares[likely, None]
        points = cloud.points[likely].astype(np.float32)
        if name in self._drawn and len(self._drawn[name].points) != len(points):
            # Points and colours arrive one after the other, and must be as many.
            self._drawn.pop(name).remove()
        self._put(
            name, self._scene.add_point_cloud, points=points,
            colors=(colours[0] + share * (colours[1] - colours[0])).astype(np.uint8),
            point_size=size, point_shape="circle", point_shading="flat", precision="float32",
        )  # fmt: skip

    def _put(self, name: str, add: Callable[..., Any], **properties: Any) -> None:
        """Adds an object, or changes the one that is there since the instant before."""
        self._kept.add(name)
        handle = self._drawn.get(name)
        if handle is None:
            self._drawn[name] = add(name, **properties)
            return
        for key, value in properties.items():
            setattr(handle, key, value)


def _linear(colour: tuple[int, int, int]) -> NDArray[np.uint8]:
    """A colour for arrows, which viser takes as shares of light; all others are as on a screen (sRGB)."""
    light = ((np.array(colour) / 255.0 + 0.055) / 1.055) ** 2.4
    return np.round(255.0 * light).astype(np.uint8)


def _rgb(colour: str) -> tuple[int, int, int]:
    """Of `#RRGGBB`."""
    red, green, blue = bytes.fromhex(colour[1:])
    return red, green, blue
