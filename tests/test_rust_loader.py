"""The core's own URDF reader gives the robot that the package's reader gives, and refuses what it refuses."""

from __future__ import annotations

import math
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from robot_files import PACKAGE_DIRS, ROBOTS
from test_urdf_checks import BAD_MODELS
from urdf_text import ARM, SOLID, joint, link, robot, shape, write

import contactsense as cs
from contactsense import _core
from contactsense.robot import description_file

TOLERANCE = 1e-12
STATES = 3


def load_both(path: Path, locked=None, **options):
    """The robot of either reader, or what it raised."""
    positions = dict(locked) if isinstance(locked, dict) else dict.fromkeys(locked or ())

    def attempt(load, **more):
        try:
            return load(path, **options, **more)
        except cs.ContactSenseError as error:
            return error

    ours = attempt(_core._robot_from_urdf, locked=positions)
    return ours, attempt(cs.Robot.from_urdf, locked_joints=locked)


def assert_close(ours, theirs, what):
    ours, theirs = np.asarray(ours), np.asarray(theirs)
    assert ours.shape == theirs.shape, what
    if ours.size:
        error = np.max(np.abs(ours - theirs)) / max(1.0, np.max(np.abs(theirs)))
        assert error < TOLERANCE, f"{what}: relative error {error:.1e}"


def configuration(robot, rng):
    """Any base pose, any angle."""
    q = robot.neutral()
    # (cos, sin) pairs and the quaternion are where neutral has ones.
    free = 7 if robot.floating_base else 0
    if free:
        q[:3] = rng.uniform(-2, 2, 3)
        q[3:7] = rng.standard_normal(4)
        q[3:7] /= np.linalg.norm(q[3:7])
    index = free
    while index < robot.nq:
        angle = rng.uniform(-2, 2)
        if q[index] == 1.0:
            q[index : index + 2] = math.cos(angle), math.sin(angle)
            index += 2
        else:
            q[index] = angle
            index += 1
    return q


def assert_same_surface(ours, theirs, name):
    assert ours.vertices.shape == theirs.vertices.shape, name
    assert_close(ours.vertices, theirs.vertices, f"{name}: vertices")
    np.testing.assert_array_equal(ours.triangles, theirs.triangles)
    assert ours.area == pytest.approx(theirs.area, rel=TOLERANCE)
    assert ours.watertight == theirs.watertight


def assert_same(ours, theirs, frames=()):
    """The same robot, or the same refusal."""
    if isinstance(theirs, cs.ContactSenseError):
        assert type(ours) is type(theirs), ours
        assert str(ours) == str(theirs)
        return
    assert isinstance(ours, _core.Robot), ours
    for field in ("name", "nq", "nv", "floating_base", "joint_names", "link_names", "warnings"):
        assert getattr(ours, field) == getattr(theirs, field), field
    np.testing.assert_array_equal(ours.neutral(), theirs.neutral())
    rng = np.random.default_rng(1)
    for _ in range(STATES):
        q = configuration(theirs, rng)
        v, a = rng.uniform(-2, 2, (2, theirs.nv))
        assert_close(ours.mass_matrix(q), theirs.mass_matrix(q), "mass matrix")
        assert_close(ours.inverse_dynamics(q, v, a), theirs.inverse_dynamics(q, v, a), "inverse dynamics")
        for name in (*theirs.link_names, *frames):
            assert_close(ours.link_pose(q, name), theirs.link_pose(q, name), name)
            assert_close(ours.jacobian(q, name), theirs.jacobian(q, name), name)
    for name in theirs.link_names:
        assert_same_surface(ours.surface(name), theirs.surface(name), name)


def frames_of(path):
    return [link.get("name") for link in ElementTree.parse(path).getroot().findall("link")]


@pytest.mark.parametrize("floating_base", [False, True])
@pytest.mark.parametrize("path", ROBOTS)
def test_published_robots(path, floating_base):
    ours, theirs = load_both(path, package_dirs=PACKAGE_DIRS, floating_base=floating_base)
    assert_same(ours, theirs, frames_of(path))


@pytest.mark.parametrize("path", ROBOTS)
def test_visual_geometry(path):
    ours, theirs = load_both(path, package_dirs=PACKAGE_DIRS, geometry="visual")
    assert_same(ours, theirs)


@pytest.mark.parametrize("path", ROBOTS)
def test_locked_joints(path):
    free = load_both(path, package_dirs=PACKAGE_DIRS, floating_base=True)[1]
    if isinstance(free, cs.ContactSenseError):
        pytest.skip("not loaded")
    rng = np.random.default_rng(2)
    names = free.joint_names[1:]
    locked = {name: rng.uniform(-3, 3) for name in names if rng.uniform() < 0.5}
    for choice in (locked, list(names)):
        for floating_base in (False, True):
            ours, theirs = load_both(
                path, locked=choice, package_dirs=PACKAGE_DIRS, floating_base=floating_base
            )
            assert_same(ours, theirs, frames_of(path))


@pytest.mark.parametrize("name", ["iiwa14", "atlas"])
def test_packaged_robots(name):
    assert_same(*load_both(Path(str(description_file(name))), floating_base=name == "atlas"))
