"""Which inertias a body can have, and which masses make the mass matrix singular."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from .. import _core
from ..errors import ModelError
from .description import FloatArray, JointTuple, LinkTuple, name_list

# A principal moment is clearly negative when below both: published models have rounding errors below the
# first, and inertias moved to the wrong point (up to a fifth of the largest moment) below the second.
_NEGATIVE_MOMENT = 1e-6  # [kg m^2]
_NEGATIVE_SHARE = 0.5
# Published moments carry two or three digits.
_TRIANGLE_SLACK = 1e-2
_NO_MOMENT = 1e-12  # [kg m^2]
_RANK = 1e-12
_INDEFINITE_SHARE = 1e-6
_INDEFINITE = "the mass matrix has a negative eigenvalue; check the masses and inertias"


def check_inertias(what: str, bodies: Iterable[tuple[str, float, FloatArray]]) -> list[str]:
    """Warnings on (name, mass, inertia (3, 3) about the centre of mass) of links or joints, as `what` says.

    Warned of are negative principal moments and those that break the triangle inequality I1 + I2 >= I3: no
    distribution of positive mass has them. `ModelError`: a negative mass.
    """
    odd = []
    for name, mass, inertia in bodies:
        if mass < 0.0:
            raise ModelError(f"{what} '{name}': mass must not be negative, not {mass:g} kg")
        smallest, middle, largest = np.linalg.eigvalsh(inertia)
        if smallest < -_NO_MOMENT or largest > (1.0 + _TRIANGLE_SLACK) * (smallest + middle) + _NO_MOMENT:
            odd.append(name)
    return (
        [f"Inertias that no rigid body has (used as given), of the {what}s {name_list(odd)}"] if odd else []
    )


def check_bodies(joints: Iterable[JointTuple], links: Iterable[LinkTuple]) -> None:
    """`ModelError` where a moving body's mass or a principal moment of it is clearly negative.

    A body is all that is fixed to one joint; a link of the base may be odd without harm.
    """
    joints, links = list(joints), list(links)
    for index, joint in enumerate(joints, start=1):
        owner = (
            f"joint '{joint.name}' (links {name_list([link.name for link in links if link.joint == index])})"
        )
        if joint.mass < 0.0:
            raise ModelError(f"{owner}: mass must not be negative, not {joint.mass:g} kg")
        moments = np.linalg.eigvalsh(joint.inertia)
        if moments[0] < -max(_NEGATIVE_MOMENT, _NEGATIVE_SHARE * moments[2]):
            raise ModelError(f"{owner}: inertia has the negative principal moment {moments[0]:g} kg m^2")


def check_mass_matrix(joints: list[JointTuple]) -> list[str]:
    """A warning that names the joints along which the mass matrix is singular whatever the configuration.

    Kinematics, isolation and inverse dynamics stay valid for such a robot; forward dynamics does not.
    `ModelError` where the mass matrix has a negative eigenvalue.
    """
    if not joints:
        return []
    # The core's: `pinocchio.Data` takes memory with the cube of the joints, 4 GB for 400.
    robot = _core.Robot("", joints, [], np.zeros(3), [])
    generator = np.random.default_rng(0)
    idle = np.ones(robot.nv, dtype=bool)
    for step in (0.0, 1.0, 1.0):
        matrix = robot.mass_matrix(_configuration(joints, step * generator.uniform(-1.0, 1.0, robot.nv)))
        if not np.isfinite(matrix).all():
            raise ModelError(
                "the mass matrix is not finite; check the magnitudes of placements, masses and inertias"
            )
        idle &= _null_coordinates(matrix)
    names, start = [], 0
    for joint in joints:
        end = start + _velocities(joint)
        if idle[start:end].any():
            names.append(joint.name)
        start = end
    if not names:
        return []
    return [
        "No mass or inertia moves with these joints, so the mass matrix is singular "
        f"and the acceleration of forward dynamics is not to be relied on: {name_list(names)}"
    ]


def _velocities(joint: JointTuple) -> int:
    return 6 if joint.kind == "free_flyer" else 1


def _configuration(joints: list[JointTuple], positions: FloatArray) -> list[float]:
    """Joint positions as `q`; the base stays where it is, as its pose does not change the mass matrix."""
    q: list[float] = []
    start = 0
    for joint in joints:
        position = float(positions[start])
        start += _velocities(joint)
        if joint.kind == "free_flyer":
            q += [0.0] * 6 + [1.0]
        elif joint.kind == "continuous":
            q += [math.cos(position), math.sin(position)]
        else:
            q.append(position)
    return q


def _null_coordinates(matrix: FloatArray) -> np.ndarray:
    """Coordinates that take part in a motion without kinetic energy."""
    diagonal = np.diag(matrix)
    if diagonal.min() < -_NO_MOMENT:
        raise ModelError(_INDEFINITE)
    massless = diagonal <= _NO_MOMENT
    scale = 1.0 / np.sqrt(np.where(massless, 1.0, diagonal))
    scaled = matrix * np.outer(scale, scale)
    scaled[massless, :] = scaled[:, massless] = 0.0
    values, vectors = np.linalg.eigh(scaled)
    if values[0] < -_INDEFINITE_SHARE:
        raise ModelError(_INDEFINITE)
    in_null_space = (np.abs(vectors[:, values < _RANK]) > 1e-3).any(axis=1)
    return np.asarray(massless | in_null_space)
