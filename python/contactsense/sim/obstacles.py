"""Things that stand still in the world and that a robot touches: sphere, cube, pole.

Each is a core (point, box, segment) swollen by a radius, so its signed distance is that of the core less the
radius, and smooth wherever the core itself is not reached.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from contactsense.errors import InputError

from ._arrays import FloatArray, positive, tangents, unit_vector, vector


class _Rounded:
    """What follows from a core: `project` onto it, and the radius it is swollen by."""

    @property
    def rounding(self) -> float:
        """Radius of the rounding: no penetration can be deeper and still have a direction [m]."""
        raise NotImplementedError

    def project(self, points: FloatArray) -> FloatArray:
        """(n, 3) nearest points of the core to `points` (n, 3) [m]."""
        raise NotImplementedError

    def signed_distance(self, points: ArrayLike) -> FloatArray:
        """(n,) distance of world points (n, 3) from the surface [m], negative inside.

        Inside the core it stays at minus the rounding.
        """
        array = _rows("points", points)
        distance: FloatArray = np.linalg.norm(array - self.project(array), axis=1) - self.rounding
        return distance

    def to_dict(self) -> dict[str, Any]:
        """Plain values for `obstacle_from_dict`."""
        kind = next(kind for kind, shape in _KINDS.items() if isinstance(self, shape))
        plain = {key: np.asarray(value).tolist() for key, value in vars(self).items()}
        return {"kind": kind} | plain


@dataclass(frozen=True, eq=False)
class SphereObstacle(_Rounded):
    """A sphere in the world: `center` (3,) [m] and `radius` [m]."""

    center: FloatArray
    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", vector("center", self.center, 3))
        object.__setattr__(self, "radius", positive("radius", self.radius))

    @property
    def rounding(self) -> float:
        """The radius [m]."""
        return self.radius

    def project(self, points: FloatArray) -> FloatArray:
        """(n, 3) the centre [m], whatever the `points` (n, 3) are."""
        return np.broadcast_to(self.center, points.shape)


@dataclass(frozen=True, eq=False)
class CubeObstacle(_Rounded):
    """A box in the world with slightly rounded edges.

    `center` (3,) [m]; `half_extents` (3,), or one number for a cube [m]; `rotation` (3, 3) from its axes to
    the world's; `edge_radius` of its edges and corners, inside the extents [m].
    """

    center: FloatArray
    half_extents: FloatArray
    rotation: FloatArray = field(default_factory=lambda: np.eye(3))
    edge_radius: float = 0.01

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", vector("center", self.center, 3))
        size = np.asarray(self.half_extents, dtype=np.float64)
        extents = vector("half_extents", np.full(3, size) if size.ndim == 0 else size, 3)
        if (extents <= 0).any():
            raise InputError("half_extents must be positive")
        object.__setattr__(self, "half_extents", extents)
        rotation = vector("rotation", np.asarray(self.rotation, dtype=np.float64).ravel(), 9).reshape(3, 3)
        if (
            not np.allclose(rotation @ rotation.T, np.eye(3), rtol=0, atol=1e-9)
            or np.linalg.det(rotation) < 0
        ):
            raise InputError("rotation must be a rotation matrix (3, 3)")
        object.__setattr__(self, "rotation", rotation)
        radius = positive("edge_radius", self.edge_radius)
        if radius > extents.min():
            raise InputError(f"edge_radius must not exceed the least half extent {extents.min():g}")
        object.__setattr__(self, "edge_radius", radius)

    @property
    def rounding(self) -> float:
        """The radius of edges and corners [m]."""
        return self.edge_radius

    @property
    def core(self) -> FloatArray:
        """(3,) half extents of the box within the rounding [m]."""
        inner: FloatArray = self.half_extents - self.edge_radius
        return inner

    def project(self, points: FloatArray) -> FloatArray:
        """(n, 3) points of the box within the rounding [m], nearest to `points` (n, 3)."""
        local = (points - self.center) @ self.rotation
        nearest: FloatArray = self.center + np.clip(local, -self.core, self.core) @ self.rotation.T
        return nearest


@dataclass(frozen=True, eq=False)
class CylinderObstacle(_Rounded):
    """A round pole in the world, closed by half-spheres.

    `center` (3,) [m], `axis` (3,) made a unit vector, `radius` [m], `half_length` of the straight part [m].
    """

    center: FloatArray
    axis: FloatArray
    radius: float
    half_length: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "center", vector("center", self.center, 3))
        object.__setattr__(self, "axis", unit_vector("axis", self.axis))
        object.__setattr__(self, "radius", positive("radius", self.radius))
        object.__setattr__(self, "half_length", positive("half_length", self.half_length))

    @property
    def rounding(self) -> float:
        """The radius [m]."""
        return self.radius

    @property
    def frame(self) -> FloatArray:
        """(3, 3) rotation to the world from axes of which the third is the pole's."""
        return np.stack([*tangents(self.axis), self.axis], axis=1)

    def project(self, points: FloatArray) -> FloatArray:
        """(n, 3) points of the pole's segment [m], nearest to `points` (n, 3)."""
        along = np.clip((points - self.center) @ self.axis, -self.half_length, self.half_length)
        nearest: FloatArray = self.center + along[:, None] * self.axis
        return nearest


Obstacle: TypeAlias = SphereObstacle | CubeObstacle | CylinderObstacle

_KINDS: dict[str, Any] = {"sphere": SphereObstacle, "cube": CubeObstacle, "cylinder": CylinderObstacle}


def obstacle_from_dict(values: Mapping[str, Any]) -> Obstacle:
    """The obstacle that `to_dict` wrote.

    Raises:
        InputError: no such kind, or a value is missing or wrong.
    """
    rest = dict(values)
    kind = rest.pop("kind", None)
    if kind not in _KINDS:
        raise InputError(f"kind must be one of {', '.join(_KINDS)}, not {kind!r}")
    try:
        obstacle: Obstacle = _KINDS[kind](**rest)
    except TypeError as error:
        raise InputError(f"obstacle: {error}") from error
    return obstacle


def _rows(name: str, points: ArrayLike) -> FloatArray:
    array = np.asarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3 or not np.isfinite(array).all():
        raise InputError(f"{name} must be finite numbers of shape (n, 3)")
    return array
