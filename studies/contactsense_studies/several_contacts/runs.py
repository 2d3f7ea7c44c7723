"""Runs of a robot that touches several obstacles at once, so slowly that only the contacts count."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from contactsense import InputError, Robot
from contactsense.sim import PenaltyContact, TouchScene, touch_scene
from contactsense.sim._arrays import FloatArray
from contactsense.sim.penalty import joint_torque

# Seconds between poses, largest change of a joint [rad], and forces that contacts keep meanwhile [N].
PAUSE, AMPLITUDE, FORCES = 0.1, np.deg2rad(2.0), (3.0, 70.0)
# Each contact by itself turns the joints at least so much [Nm].
LEAST_TORQUE = 1.0
# Draws of links and obstacles; draws of a pose, each nearer to the first than those before.
_SCENES, _POSES = 40, 30


@dataclass(frozen=True, eq=False)
class SeveralRun:
    """Poses with all contacts in the same order; world frame."""

    q: FloatArray  # (T, nq)
    external_torque: FloatArray  # (T, nv) without noise
    links: tuple[str, ...]  # C, from the first contact to the last
    points: FloatArray  # (T, C, 3)
    forces: FloatArray  # (T, C, 3) on the robot


def record_several(
    robot: Robot,
    links: tuple[str, ...],
    contacts: int,
    poses: int,
    *,
    q: FloatArray | None = None,
    friction: float = 0.0,
    seed: int = 0,
) -> SeveralRun:
    """A robot that leans on `contacts` spheres with different ones of `links`, and moves at random.

    Args:
        robot: a floating base stays where it is.
        links: that can touch.
        contacts: how many touch at once.
        poses: how many are recorded.
        q: (nq,) pose that it moves about; random where there is none.
        friction: coefficient of friction of all contacts.
        seed: same seed, same run.

    Raises:
        InputError: no such contacts were found.
    """
    rng = np.random.default_rng([seed, contacts])
    for _ in range(_SCENES):
        touched = tuple(rng.choice(links, contacts, replace=False).tolist())
        try:
            scenes = _scenes(robot, touched, q, rng)
            return _follow(robot, scenes, poses, friction, rng)
        except InputError:
            continue
    raise InputError(f"contacts: no pose was found in which {contacts} of {', '.join(links)} touch")


def _scenes(
    robot: Robot, links: tuple[str, ...], q: FloatArray | None, rng: np.random.Generator
) -> list[TouchScene]:
    scenes: list[TouchScene] = []
    for link in links:
        seed = int(rng.integers(2**31))
        scenes.append(touch_scene(robot, link, q=q, least_torque=LEAST_TORQUE, seed=seed))
        q = scenes[0].q
    return scenes


def _follow(
    robot: Robot, scenes: list[TouchScene], poses: int, friction: float, rng: np.random.Generator
) -> SeveralRun:
    springs = [
        PenaltyContact(
            robot, scene.obstacle, stiffness=scene.stiffness, friction=friction, links=(scene.link,)
        )
        for scene in scenes
    ]
    start = scenes[0].q
    base = 6 if robot.floating_base else 0
    rows, torques, points, forces = [start], [], [], []
    for k in range(poses):
        for attempt in range(_POSES):
            step = np.zeros(robot.nv)
            if k > 0:
                step[base:] = AMPLITUDE * 0.9**attempt * rng.uniform(-1.0, 1.0, robot.nv - base)
            pose = pin.integrate(robot.model, start, step)
            speed = pin.difference(robot.model, rows[-1], pose) / PAUSE
            found = [spring.forces(pose, speed) for spring in springs]
            sizes = [float(np.linalg.norm(each[0].force)) if each else 0.0 for each in found]
            if all(FORCES[0] <= size <= FORCES[1] for size in sizes):
                break
        else:
            raise InputError("poses: the contacts cannot be kept")
        rows.append(pose)
        first = [each[0] for each in found]
        torques.append(joint_torque(robot, pose, first))
        points.append([contact.point for contact in first])
        forces.append([contact.force for contact in first])
    links = tuple(scene.link for scene in scenes)
    return SeveralRun(np.array(rows[1:]), np.array(torques), links, np.array(points), np.array(forces))
