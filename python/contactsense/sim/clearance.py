"""Whether an arm touches itself or the floor."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin

from contactsense import Robot

from ._arrays import FloatArray

# Poses that tell which pairs of shapes are drawn into each other, and the share of them that does.
_POSES, _ALWAYS = 30, 0.8


class Clearance:
    """Checks poses with the convex hulls of the links, so that it rather refuses too many.

    Links that a joint connects may touch, and so may those that touch nearly always: their shapes are drawn
    into each other.

    Args:
        robot: with a fixed base.
        floor: height of the ground, which the first moving link may touch [m]; None: there is none.
    """

    def __init__(self, robot: Robot, floor: float | None) -> None:
        self._model, self._data = robot.model, robot.model.createData()
        self._shapes = pin.GeometryModel()
        for shape in robot.geometry_model.geometryObjects:
            self._add(shape.name, int(shape.parentJoint), shape.placement, _hull(shape.geometry))
        joints = [int(shape.parentJoint) for shape in self._shapes.geometryObjects]
        parents = [int(joint) for joint in robot.model.parents]
        pairs = [
            (i, j)
            for j in range(len(joints))
            for i in range(j)
            if joints[i] != joints[j] and parents[joints[i]] != joints[j] and parents[joints[j]] != joints[i]
        ]
        if floor is not None:
            ground = coal.Halfspace(np.array([0.0, 0.0, 1.0]), floor)
            self._add("floor", 0, pin.SE3.Identity(), ground)
            pairs += [(i, len(joints)) for i, joint in enumerate(joints) if joint > 0 and parents[joint] > 0]
        for i, j in pairs:
            self._shapes.addCollisionPair(pin.CollisionPair(i, j))
        self._contacts = self._shapes.createData()
        self._leave_out_overlaps(robot, links=len(joints))

    def free(self, poses: FloatArray) -> bool:
        """Whether nothing touches in any of `poses` (n, nq)."""
        # From the end to the middle: a bad target is found at once.
        return not any(
            pin.computeCollisions(self._model, self._data, self._shapes, self._contacts, pose, True)
            for pose in poses[::-1]
        )

    def _add(self, name: str, joint: int, placement: pin.SE3, geometry: coal.CollisionGeometry) -> None:
        self._shapes.addGeometryObject(pin.GeometryObject(name, joint, placement, geometry))

    def _leave_out_overlaps(self, robot: Robot, links: int) -> None:
        pairs = [(int(pair.first), int(pair.second)) for pair in self._shapes.collisionPairs]
        count = np.zeros(len(pairs))
        for seed in range(_POSES):
            pose = robot.random_configuration(seed)
            pin.computeCollisions(self._model, self._data, self._shapes, self._contacts, pose, False)
            count += [result.isCollision() for result in self._contacts.collisionResults]
        for (i, j), times in zip(pairs, count, strict=True):
            if times >= _ALWAYS * _POSES and j < links:
                self._shapes.removeCollisionPair(pin.CollisionPair(i, j))
        self._contacts = self._shapes.createData()


def _hull(geometry: coal.CollisionGeometry) -> coal.CollisionGeometry:
    if not isinstance(geometry, coal.BVHModelBase):
        return geometry
    own = geometry.clone()
    own.buildConvexHull(True, "Qt")
    return own.convex
