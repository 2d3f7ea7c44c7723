"""Random contacts: poses, and points that a straight line reaches."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from robots import robot_named

from contactsense.sim.sampling import CONE, FORCES, SLIDE, blocked, random_configuration, touches


@pytest.mark.parametrize("name", ["atlas", "panda"])
def test_random_poses_are_steps_from_neutral_as_pinocchio_takes_them(name: str) -> None:
    robot = robot_named(name)
    q = random_configuration(robot, np.random.default_rng(3))
    step = np.random.default_rng(3).uniform(-1.0, 1.0, robot.nv) * (np.pi / 2)
    for joint in robot.model.joints[1:]:
        if joint.nv == 1 and joint.shortname().startswith("JointModelP"):
            step[joint.idx_v] *= SLIDE
    np.testing.assert_allclose(q, pin.integrate(robot.model, pin.neutral(robot.model), step), atol=1e-12)


def test_contacts_are_on_the_surface_and_nothing_bars_them() -> None:
    robot = robot_named("iiwa14")
    found = list(touches(robot, "iiwa_link_5", 25, np.random.default_rng(0)))
    assert len(found) == 25
    for touch in found:
        pose = robot.link_pose(touch.q, touch.link)
        closest = robot.surface(touch.link).closest_points(((touch.point - pose[:3, 3]) @ pose[:3, :3])[None])
        assert closest.distances[0] == pytest.approx(0.0, abs=1e-9)
        size = np.linalg.norm(touch.force)
        assert FORCES[0] <= size <= FORCES[1]
        inward = -(pose[:3, :3] @ closest.normals[0])
        assert touch.force @ inward / size > np.cos(CONE) - 1e-6
        assert not blocked(robot, touch.q, touch.link, touch.point[None], touch.force[None] / size)[0]
