"""Load compensation beside iDynTree's estimator of external wrenches."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest
from robots import BY_NAME, RobotFile, parameters
from sensor_models import joints_by_child, moving_and_fixed_links

import contactsense as cs

if importlib.util.find_spec("idyntree") is None:
    pytest.skip("idyntree is not installed (it has wheels for Linux only)", allow_module_level=True)

from benches.compare.idyntree_estimator import IdyntreeEstimator, on_submodels

NAMES = ("panda", "ur5", "xarm7", "talos", "g1", "icub", "anymal", "atlas_v5")
FILES = parameters(BY_NAME[name] for name in NAMES)


def parents_of(file: RobotFile, links: list[str]) -> list[int | None]:
    joints = joints_by_child(file.path)

    def above(link: str) -> int | None:
        while link in joints:
            link = joints[link].find("parent").get("link")
            if link in links:
                return links.index(link)
        return None

    return [above(link) for link in links]


def links_with_mass(path: Path) -> set[str]:
    """iDynTree takes massless links at the tips for mere frames."""
    found = ElementTree.parse(path).getroot().findall("link")
    return {
        link.get("name")
        for link in found
        if link.find("inertial/mass") is not None and float(link.find("inertial/mass").get("value")) > 0.0
    }


@pytest.mark.parametrize("kind", ["moving", "fixed"])
@pytest.mark.parametrize("file", FILES)
def test_wrenches_agree(file: RobotFile, kind: str) -> None:
    rng = np.random.default_rng(1)
    moving, fixed = moving_and_fixed_links(file.require())
    heavy = links_with_mass(file.path)
    links = [str(link) for link in rng.permutation(moving if kind == "moving" else fixed) if link in heavy][
        :6
    ]
    if kind == "moving":
        # It carries readings over at the joint's zero: only sensors at fixed joints may be nested.
        links = [link for link, parent in zip(links, parents_of(file, links), strict=True) if parent is None]
    if not links:
        pytest.skip("iDynTree keeps no such links")
    sensors = [cs.ForceTorqueSensor(f"sensor_of_{link}", link) for link in links]
    robot, model = file.robot(), file.model()
    names = [name for name in model.names[1:] if name != "root_joint"]
    peer = IdyntreeEstimator(file.path, sensors, names)
    compensator = cs.LoadCompensator(robot, sensors)
    parents = parents_of(file, links)
    free = 6 if file.floating_base else 0
    for _ in range(5):
        q = pin.integrate(model, pin.neutral(model), rng.uniform(-1, 1, model.nv))
        v, a = rng.uniform(-2, 2, (2, model.nv))
        readings = rng.uniform(-50, 50, (len(links), 6))
        angles = [
            np.arctan2(q[j.idx_q + 1], q[j.idx_q]) if j.nq == 2 else q[j.idx_q]
            for j in model.joints[1:]
            if j.nq < 7
        ]
        base = None
        if free:
            turn = pin.Quaternion(*q[[6, 3, 4, 5]]).normalized().toRotationMatrix()
            proper = a[:3] + np.cross(v[3:6], v[:3]) - turn.T @ [0, 0, -9.81]
            base = proper, v[3:6], a[3:6]
        peer.set(np.array(angles), v[free:], a[free:], readings)
        peer.estimate(base)
        external = compensator.update(q, v, a, readings)
        ours, theirs = on_submodels(robot, q, sensors, parents, external), peer.wrenches_on_submodels()
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-8 * max(1.0, np.abs(theirs).max()))
