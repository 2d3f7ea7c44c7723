"""One contact of one arm in MuJoCo: what moves it, and what was true."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense import Robot
from contactsense.sim import ImpedanceController, JointMotion, SimulatedRobot

from .partner import Hand, Lead, Thing
from .reaction import PathClock

DT = 1e-3  # [s]
# A force that counts as contact [N].
TOUCH = 1.0


@dataclass(frozen=True)
class Scene:
    """One arm on its way, and what it meets.

    `link` and `point_local` (3,) [m] are touched; `line` (3,) is where the thing would give way to, world
    frame, or, of a hand, where the force points to in the link's frame. `start` is when [s].
    """

    kind: str
    link: str
    point_local: np.ndarray
    line: np.ndarray
    start: float
    seconds: float
    motion: JointMotion
    stiffness: float  # of a joint, as a multiple of its rated torque [1/rad]
    clock: PathClock
    most: float  # force of a protective stop [N]
    sliding: float  # coefficient of friction
    thing: Thing | None = None
    hand: Hand | None = None
    lead: Lead | None = None


@dataclass(frozen=True, eq=False)
class Episode:
    """`n` rows of what happened."""

    time: np.ndarray  # (n,) [s]
    q: np.ndarray  # (n, nv)
    v: np.ndarray  # (n, nv)
    tau: np.ndarray  # (n, nv) of the motors [Nm]
    external: np.ndarray  # (n, nv) [Nm]
    force: np.ndarray  # (n,) of the contact [N]
    speed: np.ndarray  # (n,) of the point into the thing, or against the hand's force [m/s]
    retracts: np.ndarray  # (n,) whether the robot moves back


def simulate(robot: Robot, true: Robot, rated: np.ndarray, scene: Scene) -> Episode | None:
    """The arm under impedance control on its path; None where the simulation becomes unstable."""
    arm = SimulatedRobot(true.model, dt=DT, integrator="implicitfast")
    control = ImpedanceController(robot.model, stiffness=scene.stiffness * rated)
    soft = ImpedanceController(robot.model, stiffness=0.3 * rated)
    path, clock = scene.motion, scene.clock
    arm.reset(path.q[0], path.v[0])
    rows: list[tuple[object, ...]] = []
    origin: np.ndarray | None = None
    before: np.ndarray | None = None
    for tick in range(round(scene.seconds / DT)):
        now = tick * DT
        q, v = arm.q, arm.v
        arm.clear_forces()
        pose = arm.link_pose(scene.link)
        point = pose[:3, :3] @ scene.point_local + pose[:3, 3]
        velocity = np.zeros(3) if before is None else (point - before) / DT
        before = point
        force = np.zeros(3)
        if now >= scene.start:
            origin = point if origin is None else origin
            force = _force(scene, now - scene.start, pose, point - origin, velocity)
        size = float(np.linalg.norm(force))
        if size > 0.0:
            arm.apply_force(scene.link, point, force)
        if size > TOUCH:
            clock.react(now)
        if size > scene.most:
            clock.stop(now)
        external = arm.external_torque() if size > 0.0 else np.zeros(robot.nv)
        clock.step(now, DT)
        row = min(clock.time / DT, len(path) - 1.001)
        low, part = int(row), row % 1.0
        goal = (1.0 - part) * path.q[low] + part * path.q[low + 1]
        rate = clock.rate * path.v[low]
        tau = soft.torque(q, v, q) if clock.soft(now) else control.torque(q, v, goal, rate)
        measured = arm.step(np.clip(tau, -3.0 * rated, 3.0 * rated))
        speed = -float(force @ velocity) / size if size > 0.0 else 0.0
        rows.append((now, q, v, measured.tau_mean, external, size, speed, clock.retracts))
    if any(int(warning.number) for warning in arm.mj_data.warning):
        return None
    return Episode(*(np.array(column) for column in zip(*rows, strict=True)))


def _force(
    scene: Scene, time: float, pose: np.ndarray, moved: np.ndarray, velocity: np.ndarray
) -> np.ndarray:
    """(3,) on the robot, world frame [N]."""
    if scene.lead is not None:
        return scene.lead.force(time, moved, velocity)
    if scene.hand is not None:
        return np.asarray(scene.hand.force(time) * (pose[:3, :3] @ scene.line))
    assert scene.thing is not None
    along = float(velocity @ scene.line)
    size = scene.thing.force(float(moved @ scene.line), along, DT)
    across = velocity - along * scene.line
    slip = float(np.linalg.norm(across))
    return np.asarray(-size * (scene.line + scene.sliding * across / max(slip, 0.02)))
