"""Obstacles, and where links meet them deepest: against differences, dense samples and MuJoCo's distances."""

from __future__ import annotations

import json

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

import mujoco
from robots import convex_parts, meshes, packaged, rotation

from contactsense.errors import InputError
from contactsense.sim import (
    ContactQuery,
    CubeObstacle,
    CylinderObstacle,
    Obstacle,
    SphereObstacle,
    obstacle_from_dict,
)


def _obstacles(rng: np.random.Generator) -> list[Obstacle]:
    return [
        SphereObstacle(rng.normal(size=3), 0.3),
        CubeObstacle(rng.normal(size=3), [0.2, 0.3, 0.4], rotation(rng), 0.05),
        CubeObstacle(rng.normal(size=3), 0.3, edge_radius=0.3),
        CylinderObstacle(rng.normal(size=3), rng.normal(size=3), 0.1, 0.5),
    ]


def _normals(obstacle: Obstacle, points: np.ndarray) -> np.ndarray:
    """Outward unit normals (n, 3) at points outside the core: away from its nearest points."""
    arm = points - obstacle.project(points)
    return arm / np.linalg.norm(arm, axis=1, keepdims=True)


def test_distances_and_normals_agree() -> None:
    rng = np.random.default_rng(0)
    for obstacle in _obstacles(rng):
        points = obstacle.center + rng.normal(size=(200, 3))
        step = 1e-6
        numeric = np.stack(
            [
                (
                    obstacle.signed_distance(points + step * axis)
                    - obstacle.signed_distance(points - step * axis)
                )
                / (2 * step)
                for axis in np.eye(3)
            ],
            axis=1,
        )
        outside = np.linalg.norm(points - obstacle.project(points), axis=1) > 1e-3
        assert outside.sum() > 100
        normals = _normals(obstacle, points[outside])
        np.testing.assert_allclose(normals, numeric[outside], atol=1e-5)
        # The surface is as far as the distance says, along the gradient.
        on = points[outside] - obstacle.signed_distance(points[outside])[:, None] * normals
        np.testing.assert_allclose(obstacle.signed_distance(on), 0.0, atol=1e-12)
        assert (obstacle.signed_distance(points) >= -obstacle.rounding).all()


def test_known_distances() -> None:
    cube = CubeObstacle([1.0, 0.0, 0.0], 0.5, edge_radius=0.1)
    points = [[2.0, 0.0, 0.0], [1.0, 0.0, 0.45], [1.5, 0.5, 0.0]]
    corner = 0.1 * (np.sqrt(2.0) - 1.0)
    np.testing.assert_allclose(cube.signed_distance(points), [0.5, -0.05, corner], atol=1e-12)
    pole = CylinderObstacle([0.0, 0.0, 1.0], [0.0, 0.0, 2.0], 0.1, 0.5)
    np.testing.assert_allclose(
        pole.signed_distance([[0.3, 0.0, 1.2], [0.0, 0.0, 1.7], [0.05, 0.0, 1.0]]),
        [0.2, 0.1, -0.05],
        atol=1e-12,
    )
    ball = SphereObstacle([0.0, 0.0, 0.0], 0.2)
    np.testing.assert_allclose(ball.signed_distance([[0.0, 0.5, 0.0], [0.0, 0.0, 0.0]]), [0.3, -0.2])


def test_they_are_written_and_read_back() -> None:
    for obstacle in _obstacles(np.random.default_rng(1)):
        again = obstacle_from_dict(json.loads(json.dumps(obstacle.to_dict())))
        assert type(again) is type(obstacle)
        points = np.random.default_rng(2).normal(size=(20, 3))
        np.testing.assert_array_equal(again.signed_distance(points), obstacle.signed_distance(points))


def test_wrong_arguments_are_named() -> None:
    for make, name in [
        (lambda: SphereObstacle([0, 0], 1.0), "center"),
        (lambda: SphereObstacle([0, 0, 0], -1.0), "radius"),
        (lambda: CubeObstacle([0, 0, 0], [1, 1, 0]), "half_extents"),
        (lambda: CubeObstacle([0, 0, 0], 1.0, -np.eye(3)), "rotation"),
        (lambda: CubeObstacle([0, 0, 0], 0.1, np.eye(2)), "rotation"),
        (lambda: CubeObstacle([0, 0, 0], 0.1, edge_radius=0.2), "edge_radius"),
        (lambda: CylinderObstacle([0, 0, 0], [0, 0, 0], 1.0, 1.0), "axis"),
        (lambda: CylinderObstacle([0, 0, np.nan], [0, 0, 1], 1.0, 1.0), "center"),
        (lambda: CylinderObstacle([0, 0, 0], [0, 0, 1], 1.0, 0.0), "half_length"),
        (lambda: SphereObstacle([0, 0, 0], 1.0).signed_distance([0, 0, 0]), "points"),
        (lambda: obstacle_from_dict({"kind": "cone"}), "kind"),
        (lambda: obstacle_from_dict({"kind": "sphere", "center": [0, 0, 0]}), "radius"),
    ]:
        with pytest.raises(InputError, match=name):
            make()


def _near(robot, link, q, rng) -> list[Obstacle]:
    """Obstacles that press 2 mm into a random point of a link."""
    sample = robot.surface(link).sample(1, seed=int(rng.integers(2**31)))
    pose = robot.link_pose(q, link)
    point, normal = pose[:3, :3] @ sample.points[0] + pose[:3, 3], pose[:3, :3] @ sample.normals[0]
    across = np.cross(normal, rng.normal(size=3)) + 0.1 * normal
    turn = rotation(rng)
    box = CubeObstacle(np.zeros(3), 0.05, turn, 0.01)
    reach = np.abs(normal @ turn) @ box.core + 0.01
    return [
        SphereObstacle(point + 0.048 * normal, 0.05),
        CubeObstacle(point + (reach - 0.002) * normal, 0.05, turn, 0.01),
        CylinderObstacle(point + 0.028 * normal, across, 0.03, 0.3),
    ]


@pytest.mark.parametrize("which", [packaged, pytest.param(meshes, marks=pytest.mark.shared)])
def test_nothing_is_deeper(which) -> None:
    robot = which()
    rng = np.random.default_rng(3)
    q = np.array([0.3, 0.5, -0.2, -1.2, 0.4, 0.7, 0.1])
    judged = 0
    for link in robot.link_names[1:]:
        dense = robot.surface(link).sample(100_000, seed=1).points
        pose = robot.link_pose(q, link)
        world = dense @ pose[:3, :3].T + pose[:3, 3]
        for obstacle in _near(robot, link, q, rng):
            found = ContactQuery(robot, obstacle).at(q, link)
            distances = obstacle.signed_distance(world)
            if found.penetration > 0.9 * obstacle.rounding:
                continue  # a dent in the link: the core is reached
            judged += 1
            # Samples cannot be deeper than the deepest point, and come close to it.
            assert -1e-9 <= found.penetration + distances.min() < 1e-3
            assert abs(obstacle.signed_distance(found.point[None])[0] + found.penetration) < 1e-8
            np.testing.assert_allclose(found.normal, -_normals(obstacle, found.point[None])[0], atol=1e-6)
            local = (found.point - pose[:3, 3]) @ pose[:3, :3]
            assert robot.surface(link).closest_points(local[None]).distances[0] < 1e-8
    assert judged >= 15


@pytest.mark.shared
def test_distances_agree_with_mujoco_on_convex_parts() -> None:
    robot = meshes()
    rng = np.random.default_rng(4)
    q = np.array([0.3, 0.5, -0.2, -1.2, 0.4, 0.7, 0.1])
    judged = 0
    for link in robot.link_names[2::2]:
        parts = convex_parts(link)
        for obstacle in _near(robot, link, q, rng):
            shift = 0.02 * ContactQuery(robot, obstacle).at(q, link).normal
            moved = obstacle_from_dict(obstacle.to_dict() | {"center": list(obstacle.center + shift)})
            gap = -ContactQuery(robot, moved).at(q, link).penetration
            if gap < -0.9 * moved.rounding:
                continue  # a dent in the link: the core is reached
            judged += 1
            pieces = _mujoco_distance(robot.link_pose(q, link), parts, moved)
            # The pieces differ from the mesh by 3.2 mm at most.
            assert abs(gap - pieces) < 3.5e-3, (link, obstacle)
    assert judged >= 7


def _mujoco_distance(pose: np.ndarray, parts: list[np.ndarray], obstacle: Obstacle) -> float:
    spec = mujoco.MjSpec()
    for number, vertices in enumerate(parts):
        spec.add_mesh(name=f"m{number}", uservert=vertices.ravel())
        geom = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"m{number}")
        geom.pos, geom.quat = pose[:3, 3], _quaternion(pose[:3, :3])
    geom = spec.worldbody.add_geom(pos=obstacle.center)
    if isinstance(obstacle, SphereObstacle):
        geom.type, geom.size, swell = mujoco.mjtGeom.mjGEOM_SPHERE, [obstacle.radius, 0, 0], 0.0
    elif isinstance(obstacle, CubeObstacle):
        geom.type, geom.size, swell = mujoco.mjtGeom.mjGEOM_BOX, obstacle.core, obstacle.edge_radius
        geom.quat = _quaternion(obstacle.rotation)
    else:
        geom.type, swell = mujoco.mjtGeom.mjGEOM_CAPSULE, 0.0
        geom.size, geom.quat = [obstacle.radius, obstacle.half_length, 0], _quaternion(obstacle.frame)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    ends = np.zeros(6)
    return (
        min(mujoco.mj_geomDistance(model, data, k, len(parts), 1.0, ends) for k in range(len(parts))) - swell
    )


def _quaternion(turn: np.ndarray) -> np.ndarray:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(turn).ravel())
    return quaternion


def test_a_centre_inside_a_link_is_deeper_still() -> None:
    robot = packaged()
    q = robot.neutral()
    surface, pose = robot.surface("iiwa_link_5"), robot.link_pose(q, "iiwa_link_5")
    sample = surface.sample(1, seed=7)
    for depth in (-0.004, 0.004):
        center = pose[:3, :3] @ (sample.points[0] - depth * sample.normals[0]) + pose[:3, 3]
        found = ContactQuery(robot, SphereObstacle(center, 0.01)).at(q, "iiwa_link_5")
        assert found.penetration == pytest.approx(0.01 + depth, abs=1e-6)
        assert found.normal @ (pose[:3, :3] @ sample.normals[0]) > 0.99


def test_only_links_that_touch_are_found() -> None:
    robot = packaged()
    q = robot.neutral()
    pose = robot.link_pose(q, "iiwa_link_4")
    query = ContactQuery(robot, SphereObstacle(pose[:3, 3] + [0.0, 0.0, 2.0], 0.1))
    assert query.touching(q) == []
    assert "iiwa_link_0" not in query.links
    inside = ContactQuery(robot, SphereObstacle(pose[:3, 3] + [0.1, 0.0, 0.0], 0.12)).touching(q)
    assert {"iiwa_link_3", "iiwa_link_4"} <= {contact.link for contact in inside}
    assert [contact.penetration for contact in inside] == sorted(
        (contact.penetration for contact in inside), reverse=True
    )
    with pytest.raises(InputError, match=r"links: 'elbow'"):
        ContactQuery(robot, SphereObstacle([0, 0, 0], 1.0), links=("elbow",))
