"""The robot's nine force/torque sensors, and what torques and sensors show of a scene (VI-A)."""

from __future__ import annotations

from functools import lru_cache
from typing import Literal, TypeAlias, get_args

import numpy as np

from contactsense import Robot
from contactsense.sim import joint_torque
from contactsense.sim._arrays import FloatArray
from contactsense.sim.atlas import SENSOR_LINKS

from .noise import NONE, Noise
from .scenes import Scene

DISTAL_LINKS = SENSOR_LINKS[:4]  # hands and feet

# What is measured: joint torques and the base's motion; these and the sensors of hands and feet; these and
# all sensors; all sensors alone.
Method: TypeAlias = Literal["torques", "distal", "both", "sensors"]
METHODS: tuple[Method, ...] = get_args(Method)


def external_torque(robot: Robot, scene: Scene) -> FloatArray:
    """What the pushes do to the joints: sum of `J^T f` `(nv,)`."""
    return joint_torque(robot, scene.q, scene.touches)


def sensor_links(method: Method) -> tuple[str, ...]:
    """Where the sensors are that a method uses."""
    return {"torques": (), "distal": DISTAL_LINKS}.get(method, SENSOR_LINKS)


def external_wrenches(robot: Robot, scene: Scene, sensors: tuple[str, ...] = SENSOR_LINKS) -> FloatArray:
    """What the pushes do to the sensors `(n, 6)`: world axes, at the sensors' origins."""
    wrenches = np.zeros((len(sensors), 6))
    for row, sensor in enumerate(sensors):
        origin = robot.link_pose(scene.q, sensor)[:3, 3]
        for touch in scene.touches:
            if carries(robot, sensor, touch.link):
                wrenches[row] += [*touch.force, *np.cross(touch.point - origin, touch.force)]
    return wrenches


@lru_cache(maxsize=4096)
def carries(robot: Robot, sensor: str, link: str) -> bool:
    """Whether the sensor feels a push on the link: `link` is `sensor`'s or behind it."""
    return moved_by(robot, sensor) <= moved_by(robot, link)


@lru_cache(maxsize=4096)
def moved_by(robot: Robot, link: str) -> frozenset[int]:
    """Coordinates that turn or shift a link."""
    # A revolute joint shows in the angular rows in every pose.
    return frozenset(np.flatnonzero(np.any(robot.jacobian(robot.neutral(), link) != 0.0, axis=0)).tolist())


def observed(
    robot: Robot, scene: Scene, method: Method, noise: Noise = NONE, seed: list[int] | None = None
) -> tuple[FloatArray, FloatArray | None]:
    """External torque and wrenches as measured."""
    rng = np.random.default_rng(seed)
    tau = external_torque(robot, scene)
    tau = tau + noise.on_torques(tau) * rng.standard_normal(robot.nv)
    if method == "torques":
        return tau, None
    wrenches = external_wrenches(robot, scene, sensor_links(method))
    wrenches = wrenches + noise.on_wrenches(wrenches) * rng.standard_normal(wrenches.shape)
    return (np.zeros(robot.nv) if method == "sensors" else tau), wrenches
