"""Robots that tests share: from PyPI's example-robot-data, and from a folder beside the project."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pinocchio as pin
import pytest

import contactsense as cs

SHARED = Path(__file__).resolve().parents[2] / "shared"
# example-robot-data installs beside Pinocchio.
EXAMPLE_SHARE = Path(pin.__file__).resolve().parents[4] / "share"


@dataclass(frozen=True)
class RobotFile:
    name: str
    path: Path
    package_dirs: tuple[Path, ...] = ()
    floating_base: bool = False

    def require(self) -> RobotFile:
        """Itself; skips the test where the file is absent."""
        if not self.path.exists():
            pytest.skip(f"{self.path} is absent (example-robot-data or the folder beside the project)")
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
    root = EXAMPLE_SHARE / "example-robot-data" / "robots"
    return RobotFile(name, root / subpath, (EXAMPLE_SHARE,), floating_base)


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
BY_NAME = {file.name: file for file in [*EXAMPLES, *ATLAS, IIWA14]}
