"""The robot: kinematics, dynamics and surfaces, frozen."""

from __future__ import annotations

import logging
import os
import threading
from collections.abc import Iterable, Mapping
from importlib import resources
from typing import Any, Literal, SupportsFloat

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from . import _core
from .errors import InputError
from .loading.coal import geometry_of
from .loading.describe_pinocchio import describe_pinocchio
from .loading.description import RobotDescription, Shape
from .loading.urdf import load_urdf

DESCRIPTIONS = ("atlas", "iiwa14")
_LOG = logging.getLogger("contactsense")
# Where a payload is: link, mass, centre of mass, inertia.
_Payload = tuple[str, float, "list[float]", "list[list[float]]"]


class Robot(_core.Robot):
    """A robot: immutable, shareable between threads and processes; make one with a class method below.

    `q`, `v` and `tau` are ordered as in the Pinocchio model of the same URDF. A floating base has
    `q = [position, quaternion xyzw, joints]` and `v = [base linear, base angular, joints]`, both base
    velocities in the base frame.

    Attributes:
        model: the `pinocchio.Model` it was built from; not to be changed.

    Example:
        >>> import contactsense as cs
        >>> robot = cs.Robot.named("iiwa14")
        >>> q = robot.configuration({"iiwa_joint_4": -1.2})
        >>> robot.jacobian(q, "iiwa_link_7").shape
        (6, 7)
    """

    model: Any
    _description: RobotDescription
    _objects: Any
    _shapes: dict[str, Shape]
    _payloads: tuple[_Payload, ...]
    _lock: threading.Lock

    @classmethod
    def from_urdf(
        cls,
        path: str | os.PathLike[str],
        *,
        package_dirs: str | os.PathLike[str] | Iterable[str | os.PathLike[str]] = (),
        floating_base: bool = False,
        locked_joints: Mapping[str, SupportsFloat] | Iterable[str] | None = None,
        geometry: Literal["collision", "visual", "collision_or_visual"] = "collision",
        gravity: ArrayLike = (0.0, 0.0, -9.81),
        armature: Mapping[str, SupportsFloat] | None = None,
        missing_meshes: Literal["error", "warn"] = "error",
    ) -> Robot:
        """A robot from a URDF file.

        A joint of type "floating" between the root link and its child is a floating base as well. Joints
        that mimic another stay independent joints, with a warning. Shapes of size zero and endless planes
        are left out, with a warning.

        Args:
            path: the URDF.
            package_dirs: where `package://` names and mesh files may come from, besides the URDF's own
                folder. No file elsewhere is read. A file named by an absolute path of another machine is
                looked for in these folders by the end of its path.
            floating_base: whether the root link moves freely.
            locked_joints: `{name: position}` [rad, m], or names, held at neutral.
            geometry: which shapes make the surface: "collision"; "visual"; or "collision_or_visual", which
                takes the visual shapes of links that have no collision shapes.
            gravity: `(3,)`, world frame [m/s^2].
            armature: `{joint: inertia}` of the rotor, reflected through the gear [kg m^2; kg for sliding
                joints]; zero for joints that are not named.
            missing_meshes: "error", or "warn" to leave out a shape whose mesh file is missing; a link
                without other shapes then has no surface.

        Raises:
            ModelError: the description cannot be used; names the link or joint.
            GeometryError: a mesh or primitive cannot be used; names it.
            InputError: an argument cannot be used; names it.
        """
        loaded = load_urdf(
            path,
            package_dirs=package_dirs,
            floating_base=floating_base,
            locked_joints=locked_joints,
            geometry=geometry,
            gravity=gravity,
            armature=armature,
            missing_meshes=missing_meshes,
        )
        return cls._of(loaded.description, loaded.model, loaded.geometry_model, loaded.shapes)

    @classmethod
    def from_pinocchio(cls, model: Any, geometry_model: Any) -> Robot:
        """A robot from a `pinocchio.Model` and a `pinocchio.GeometryModel`.

        Args:
            model: joints and inertias; its gravity is the robot's.
            geometry_model: the shapes of its links.

        Raises:
            ModelError, GeometryError: names the joint or geometry object that cannot be used.
            InputError: an argument has another type.
        """
        return cls._of(describe_pinocchio(model, geometry_model), model, geometry_model, {})

    @classmethod
    def named(cls, name: str) -> Robot:
        """A robot that the package describes.

        Args:
            name: "iiwa14" (fixed base) or "atlas" (floating base).

        Raises:
            InputError: there is no such description.
        """
        with resources.as_file(description_file(name)) as path:
            return cls.from_urdf(path, floating_base=name == "atlas")

    def with_payload(self, link: str, mass: float, com: ArrayLike, inertia: ArrayLike | None = None) -> Robot:
        """The robot with a payload fixed to a link; the payload has no surface.

        Args:
            link: the link that holds it.
            mass: [kg].
            com: `(3,)`, its centre of mass in the link's frame [m].
            inertia: `(3, 3)`, about its centre of mass in the link's axes [kg m^2]; a point mass by default.

        Raises:
            InputError: there is no such link, or a number cannot be used; names the argument.
        """
        about_com = np.zeros((3, 3)) if inertia is None else inertia
        loaded = Robot(self._with_payload(link, mass, com, about_com))
        place = next(entry for entry in self._description.links if entry.name == link)
        added = pin.Inertia(
            float(mass), np.array(com, dtype=np.float64), np.array(about_com, dtype=np.float64)
        )
        model = self.model.copy()
        if place.joint > 0:
            model.inertias[place.joint] += pin.SE3(place.placement).act(added)
        payload = (link, float(mass), added.lever.tolist(), added.inertia.tolist())
        loaded._keep(self._description, model, self._objects, self._shapes, (*self._payloads, payload))
        return loaded

    @property
    def geometry_model(self) -> Any:
        """The `pinocchio.GeometryModel` it was built from; not to be changed."""
        with self._lock:
            # Trees over meshes take time and memory that few need.
            for item in self._objects.geometryObjects:
                if item.name in self._shapes and item.name not in self._built:
                    item.geometry = geometry_of(self._shapes[item.name])
                    self._built.add(item.name)
        return self._objects

    @classmethod
    def _of(cls, description: RobotDescription, model: Any, objects: Any, shapes: dict[str, Shape]) -> Robot:
        robot = cls(tuple(description))
        robot._keep(description, model, objects, shapes, ())
        if robot.warnings:
            _LOG.warning(
                "%s: %d warnings:\n  %s", robot.name, len(robot.warnings), "\n  ".join(robot.warnings)
            )
        return robot

    def _keep(
        self,
        description: RobotDescription,
        model: Any,
        objects: Any,
        shapes: dict[str, Shape],
        payloads: tuple[_Payload, ...],
    ) -> None:
        self.model = model
        self._description = description
        self._objects = objects
        self._shapes = shapes
        self._payloads = payloads
        self._built: set[str] = set()
        self._lock = threading.Lock()

    def __reduce__(self) -> tuple[Any, ...]:
        # As it was built, not as it is in memory: the same numbers give the same robot.
        return _restore, (self._description, self.model, self._objects, self._shapes, self._payloads)

    def __copy__(self) -> Robot:
        return self

    def __deepcopy__(self, memo: Any) -> Robot:
        return self


def _restore(
    description: RobotDescription, model: Any, objects: Any, shapes: dict[str, Shape], payloads: Any
) -> Robot:
    core = _core.Robot(tuple(description))
    for payload in payloads:
        core = core._with_payload(*payload)
    robot = Robot(core)
    robot._keep(description, model, objects, shapes, payloads)
    return robot


def description_file(name: str) -> Any:
    """The packaged URDF of a named robot, as a `Traversable`."""
    if not isinstance(name, str) or name not in DESCRIPTIONS:
        raise InputError(f"name: there is no robot {name!r}; there are {', '.join(DESCRIPTIONS)}")
    return resources.files("contactsense") / "descriptions" / f"{name}.urdf"
