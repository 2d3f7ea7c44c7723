"""The robot: kinematics, dynamics and surfaces, frozen."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from importlib import resources
from typing import Any

from numpy.typing import ArrayLike

from . import _core
from .errors import InputError
from .loading.describe_pinocchio import describe_pinocchio
from .loading.describe_urdf import describe_urdf
from .loading.description import RobotDescription

DESCRIPTIONS = ("atlas", "iiwa14")


class Robot(_core.Robot):
    """A robot: immutable, shareable between threads.

    `q`, `v` and `tau` are ordered as in the Pinocchio model of the same URDF. A floating base has
    `q = [position, quaternion xyzw, joints]` and `v = [base linear, base angular, joints]`, both base
    velocities in the base frame.
    """

    @classmethod
    def from_urdf(
        cls,
        path: str | os.PathLike[str],
        *,
        package_dirs: str | os.PathLike[str] | Iterable[str | os.PathLike[str]] = (),
        floating_base: bool = False,
        locked_joints: Mapping[str, float] | Iterable[str] | None = None,
        geometry: str = "collision",
        gravity: ArrayLike = (0.0, 0.0, -9.81),
    ) -> Robot:
        """A robot from a URDF file.

        Args:
            path: the URDF.
            package_dirs: where `package://` names and mesh files may come from, besides the URDF's own.
            floating_base: whether the root link moves freely.
            locked_joints: `{name: position}` [rad, m], or names, held at neutral.
            geometry: "collision" or "visual".
            gravity: `(3,)`, world frame [m/s^2].

        Raises:
            ModelError: the description cannot be used; names the link or joint.
            GeometryError: a mesh or primitive cannot be used; names it.
            InputError: an argument cannot be used; names it.
        """
        return cls._of(
            describe_urdf(
                path,
                package_dirs=package_dirs,
                floating_base=floating_base,
                locked_joints=locked_joints,
                geometry=geometry,
                gravity=gravity,
            )
        )

    @classmethod
    def from_pinocchio(cls, model: Any, geometry_model: Any) -> Robot:
        """A robot from a `pinocchio.Model` and a `pinocchio.GeometryModel`.

        Raises:
            ModelError, GeometryError: names the joint or geometry object that cannot be used.
            InputError: an argument has another type.
        """
        return cls._of(describe_pinocchio(model, geometry_model))

    @classmethod
    def named(cls, name: str) -> Robot:
        """A robot that the package describes: "iiwa14" (fixed base) or "atlas" (floating base).

        Raises:
            InputError: there is no such description.
        """
        with resources.as_file(description_file(name)) as path:
            return cls.from_urdf(path, floating_base=name == "atlas")

    @classmethod
    def _of(cls, description: RobotDescription) -> Robot:
        return cls(
            description.name,
            description.joints,
            description.links,
            description.gravity,
            list(description.warnings),
        )


def description_file(name: str) -> Any:
    """The packaged URDF of a named robot, as a `Traversable`."""
    if name not in DESCRIPTIONS:
        raise InputError(f"name: there is no robot {name!r}; there are {', '.join(DESCRIPTIONS)}")
    return resources.files("contactsense") / "descriptions" / f"{name}.urdf"
