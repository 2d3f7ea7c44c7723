"""Robots that tests share: packaged, of PyPI's example-robot-data, and of a folder outside the project.

A test that needs that folder is marked `shared`; `PUBLISHED` and `parameters` bring the mark with them. All
others run on the same robots whatever lies beside the project.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import contactsense as cs

# The folder of shared data; the variable names another.
SHARED = Path(os.environ.get("CONTACTSENSE_SHARED", Path(__file__).resolve().parents[2] / "shared"))
# example-robot-data installs beside Pinocchio.
EXAMPLE_SHARE = Path(pin.__file__).resolve().parents[4] / "share"
_EXAMPLES = EXAMPLE_SHARE / "example-robot-data" / "robots"
PACKAGE_DIRS = [EXAMPLE_SHARE]


def shared_is_there() -> bool:
    """Whether the folder of shared data exists; one that is named must."""
    if "CONTACTSENSE_SHARED" in os.environ and not SHARED.is_dir():
        raise pytest.UsageError(f"CONTACTSENSE_SHARED: {SHARED} is not a folder")
    return SHARED.is_dir()


@dataclass(frozen=True)
class RobotFile:
    name: str
    path: Path
    package_dirs: tuple[Path, ...] = ()
    floating_base: bool = False

    @property
    def shared(self) -> bool:
        """Whether it is no part of the project, nor of a package."""
        return self.path.is_relative_to(SHARED)

    def require(self) -> RobotFile:
        """Itself; skips the test where example-robot-data is not installed."""
        if not self.path.exists():
            if self.shared:
                pytest.fail(f"{self.path} is absent: a test of '{self.name}' must be marked `shared`")
            pytest.skip(f"{self.path} is absent: example-robot-data is not installed")
        return self

    def robot(self, **options: object) -> cs.Robot:
        self.require()
        return cs.Robot.from_urdf(
            self.path, package_dirs=self.package_dirs, floating_base=self.floating_base, **options
        )

    def model(self) -> pin.Model:
        self.require()
        if self.floating_base:
            return pin.buildModelFromUrdf(str(self.path), pin.JointModelFreeFlyer())
        return pin.buildModelFromUrdf(str(self.path))


def _example(name: str, subpath: str, floating_base: bool = False) -> RobotFile:
    return RobotFile(name, _EXAMPLES / subpath, (EXAMPLE_SHARE,), floating_base)


EXAMPLES = [
    _example("panda", "panda_description/urdf/panda.urdf"),
    _example("ur5", "ur_description/urdf/ur5_robot.urdf"),
    _example("xarm7", "xarm_description/urdf/xarm7.urdf"),
    _example("kinova", "kinova_description/robots/kinova.urdf"),
    _example("talos", "talos_data/robots/talos_reduced.urdf", True),
    _example("g1", "g1_description/urdf/g1_29dof_rev_1_0.urdf", True),
    _example("icub", "icub_description/robots/icub_reduced.urdf", True),
    _example("romeo", "romeo_description/urdf/romeo.urdf", True),
    _example("anymal", "anymal_b_simple_description/robots/anymal.urdf", True),
]
ATLAS = [
    RobotFile("atlas_v3", SHARED / "robots/atlas/atlas_v3_simple_shapes.urdf", floating_base=True),
    RobotFile("atlas_v5", SHARED / "robots/atlas/atlas_v5_simple_shapes.urdf", floating_base=True),
    RobotFile("atlas_hull", SHARED / "robots/atlas/atlas_v5_convex_hull.urdf", floating_base=True),
]
IIWA14 = RobotFile("iiwa14_mesh", SHARED / "robots/iiwa14/iiwa14.urdf")
TALOS_ARM = _example("talos_left_arm", "talos_data/robots/talos_left_arm.urdf")
BY_NAME = {file.name: file for file in [*EXAMPLES, *ATLAS, IIWA14, TALOS_ARM]}


def parameters(robots: Iterable[RobotFile | str]) -> list:
    """Of a test over robots, by file or by name (which may be a packaged robot's); shared ones are marked."""
    params = []
    for robot in robots:
        file = BY_NAME.get(robot) if isinstance(robot, str) else robot
        marks = [pytest.mark.shared] if file is not None and file.shared else []
        params.append(pytest.param(robot, id=robot if isinstance(robot, str) else robot.name, marks=marks))
    return params


def robot_named(name: str) -> cs.Robot:
    """Of `BY_NAME`, or packaged."""
    return BY_NAME[name].robot() if name in BY_NAME else cs.Robot.named(name)


# Descriptions without a link: what xacro leaves of a macro file.
_EMPTY = {"ur3.urdf"}


def _published() -> list:
    """All URDF files of example-robot-data, and of the folder of shared robots."""
    params = []
    for folder, marks in ((_EXAMPLES, []), (SHARED / "robots", [pytest.mark.shared])):
        files = [file for file in sorted(folder.rglob("*.urdf")) if file.name not in _EMPTY]
        params += [pytest.param(file, id=str(file.relative_to(folder)), marks=marks) for file in files]
        if not files:
            reason = f"no robots in {folder}"
            params.append(pytest.param(None, id=reason, marks=[*marks, pytest.mark.skip(reason=reason)]))
    return params


PUBLISHED = _published()


def example(relative: str) -> Path:
    """A file of example-robot-data; skips the test where it is not installed."""
    if not _EXAMPLES.is_dir():
        pytest.skip("example-robot-data is not installed")
    return _EXAMPLES / relative


# Robots to touch in the simulation.


@cache
def packaged() -> cs.Robot:
    """The packaged iiwa14, of exact primitives."""
    return cs.Robot.named("iiwa14")


@cache
def meshes() -> cs.Robot:
    """The iiwa14 with meshes, which are not convex; shared."""
    return IIWA14.robot()


def panda() -> cs.Robot:
    """Franka's arm with convex links, fingers and all."""
    return example_arm("panda")


def example_arm(name: str) -> cs.Robot:
    """An arm of example-robot-data; skips the test where it is not installed."""
    return BY_NAME[name].robot()


def convex_parts(link: str) -> list[np.ndarray]:
    """Vertices of the convex pieces of a link of `meshes`, link frame."""
    folder = IIWA14.require().path.parent / "convex_parts"
    files = sorted(folder.glob(f"link_{link[-1]}_*.obj"))
    lines = [path.read_text(encoding="utf-8").splitlines() for path in files]
    return [np.array([line.split()[1:4] for line in text if line.startswith("v ")], float) for text in lines]


def rotation(rng: np.random.Generator) -> np.ndarray:
    """A random rotation (3, 3)."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn * np.sign(np.linalg.det(turn))
