"""Scenes drawn at random: what the robot meets, where, how fast, and how it reacts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactsense import Robot
from contactsense.sim import JointMotion, random_moves

from .episode import DT, Scene
from .partner import Hand, Lead, Thing
from .reaction import PathClock

# Kinds of scenes with their shares.
KINDS = {
    "free": 0.16,  # something that is thrown off or gives way
    "arm": 0.12,  # a person's arm that gives way, and is drawn back
    "fixed": 0.12,  # something that does not move
    "held": 0.16,  # a limb between the robot and a wall
    "soft": 0.08,  # something soft before a wall, met slowly
    "body": 0.08,  # a person who stands and yields slowly
    "push": 0.10,
    "lean": 0.05,
    "lead": 0.06,
    "tap": 0.07,
}
MOTION_SECONDS = 60.0
# Before the contact, so that the observers have settled; and after its begin [s].
BEFORE, AFTER = 0.6, 2.0
# Least speed of a point that runs into something [m/s].
LEAST_SPEED = 0.05
# Room that is left before a joint's limit is not looked at: arms in simulation have none.
TRIES = 200


@dataclass(frozen=True)
class Way:
    """Where the robot moves, and how its surface does."""

    robot: Robot
    motion: JointMotion
    samples: dict[str, tuple[np.ndarray, np.ndarray]]  # by link: points and normals, link frame


def way_of(robot: Robot, seed: int, seconds: float = MOTION_SECONDS) -> Way:
    """Moves from pose to pose, at speeds of people's surroundings."""
    motion = random_moves(robot, seconds, dt=DT, speed=(0.08, 0.5), rest=(0.2, 2.5), seed=seed)
    links = [link for link in robot.link_names if _joint(robot, link) > 2]
    samples = {}
    for link in links:
        found = robot.surface(link).sample(60, seed=seed)
        samples[link] = (np.array(found.points), np.array(found.normals))
    return Way(robot, motion, samples)


def _joint(robot: Robot, link: str) -> int:
    return int(robot.model.frames[robot.model.getBodyId(link)].parentJoint)


def draw(way: Way, rng: np.random.Generator, kind: str | None = None) -> Scene:
    """A scene of a kind; of any, by their shares, if none is given."""
    if kind is None:
        kind = str(rng.choice(list(KINDS), p=np.array(list(KINDS.values())) / sum(KINDS.values())))
    if kind in ("push", "lean", "lead", "tap"):
        return _by_person(way, rng, kind)
    for _ in range(TRIES):
        scene = _run_into(way, rng, kind)
        if scene is not None:
            return scene
    raise ValueError("the robot moves too slowly to run into anything")


def _run_into(way: Way, rng: np.random.Generator, kind: str) -> Scene | None:
    row = _row(way, rng)
    link, point, normal, velocity = _place(way, rng, row)
    speed = float(np.linalg.norm(velocity))
    slow = kind in ("soft", "body")
    if not LEAST_SPEED < speed < (0.35 if slow else 1.5) or velocity @ normal < 0.5 * speed:
        return None
    # Not head on: the surface of the thing turns the force, as far as friction holds.
    line = velocity / speed + 0.5 * normal + 0.25 * rng.standard_normal(3)
    line /= np.linalg.norm(line)
    if line @ velocity < 0.6 * speed:
        return None
    pose = way.robot.link_pose(way.motion.q[row], link)
    local = pose[:3, :3].T @ (point - pose[:3, 3])
    return _scene(way, rng, kind, row, (link, local, line), thing=_thing(rng, kind))


def _by_person(way: Way, rng: np.random.Generator, kind: str) -> Scene:
    # Half of the time the robot is at rest.
    at_rest = rng.random() < (1.0 if kind == "lead" else 0.5)
    against = rng.random() < 0.3
    for _ in range(TRIES):
        row = _row(way, rng)
        link, point, normal, velocity = _place(way, rng, row)
        speed = float(np.linalg.norm(velocity))
        if at_rest != (speed < 0.02):
            continue
        inward = -normal + 0.3 * rng.standard_normal(3)
        inward /= np.linalg.norm(inward)
        if at_rest or (inward @ velocity < -0.3 * speed) == against:
            break
    pose = way.robot.link_pose(way.motion.q[row], link)
    local = pose[:3, :3].T @ (point - pose[:3, 3])
    line = pose[:3, :3].T @ inward
    lead = hand = None
    if kind == "lead":
        far = rng.uniform(0.05, 0.25) * inward
        lead = Lead(
            tuple(far),
            rng.uniform(0.5, 1.2),
            rng.uniform(0.0, 1.0),
            _log(rng, 200.0, 1200.0),
            rng.uniform(5.0, 30.0),
            rng.uniform(20.0, 60.0),
        )
    elif kind == "tap":
        half = rng.uniform(0.05, 0.14)
        hand = Hand(_log(rng, 8.0, 35.0), half, 0.0, half)
    else:
        lean = kind == "lean"
        hand = Hand(
            _log(rng, 10.0, 60.0),
            rng.uniform(0.3, 0.8) if lean else rng.uniform(0.12, 0.5),
            rng.uniform(1.0, 2.0) if lean else rng.uniform(0.2, 1.2),
            rng.uniform(0.1, 0.4),
            rng.uniform(0.0, 0.25),
            rng.uniform(0.5, 3.0),
            rng.uniform(0.0, 6.28),
        )
    return _scene(way, rng, kind, row, (link, local, line), hand=hand, lead=lead)


def _thing(rng: np.random.Generator, kind: str) -> Thing:
    if kind == "free":
        return Thing(
            _log(rng, 0.5, 20.0), _log(rng, 3e3, 6e4), rng.uniform(0.1, 1.0), damper=_log(rng, 0.1, 5.0)
        )
    if kind == "arm":
        return Thing(
            rng.uniform(1.0, 5.0),
            _log(rng, 3e3, 4e4),
            rng.uniform(0.2, 1.0),
            spring=_log(rng, 5.0, 150.0),
            damper=rng.uniform(2.0, 15.0),
            leaves=rng.uniform(0.1, 0.25),
            pull=rng.uniform(30.0, 100.0),
        )
    if kind == "fixed":
        return Thing(np.inf, _log(rng, 4e3, 1e5), rng.uniform(0.1, 0.8))
    if kind == "held":
        return Thing(
            rng.uniform(0.5, 5.0),
            _log(rng, 4e3, 5e4),
            rng.uniform(0.2, 1.0),
            damper=rng.uniform(2.0, 20.0),
            gap=rng.uniform(0.0, 0.015),
            wall=_log(rng, 1e4, 1e5),
        )
    if kind == "soft":
        return Thing(np.inf, _log(rng, 4e2, 4e3), rng.uniform(0.5, 2.0))
    return Thing(
        rng.uniform(30.0, 80.0),
        _log(rng, 2e3, 2e4),
        1.0,
        spring=_log(rng, 50.0, 800.0),
        damper=rng.uniform(80.0, 300.0),
    )


def _scene(
    way: Way,
    rng: np.random.Generator,
    kind: str,
    row: int,
    place: tuple[str, np.ndarray, np.ndarray],
    **partner: object,
) -> Scene:
    first = row - round(BEFORE / DT)
    last = min(len(way.motion), row + round(AFTER / DT) + 2)
    rows = slice(first, last)
    motion = JointMotion(
        DT * np.arange(last - first), way.motion.q[rows], way.motion.v[rows], way.motion.a[rows]
    )
    led = kind == "lead"
    react = str(rng.choice(["none", "stop", "retract", "soft"], p=[0.3, 0.4, 0.15, 0.15]))
    clock = PathClock(
        "soft" if led and rng.random() < 0.6 else react,  # type: ignore[arg-type]
        0.0 if led else rng.uniform(0.01, 0.15),
        rng.uniform(0.05, 0.2),
        rng.uniform(0.0, 0.8),
        rng.uniform(0.3, 1.0),
        rng.uniform(0.2, 0.6),
    )
    return Scene(
        kind,
        *place,
        start=BEFORE,
        seconds=BEFORE + AFTER,
        motion=motion,
        stiffness=_log(rng, 1.0, 3.0) if led else _log(rng, 2.0, 20.0),
        clock=clock,
        most=rng.uniform(60.0, 200.0),
        sliding=rng.uniform(0.0, 0.5),
        **partner,  # type: ignore[arg-type]
    )


def _row(way: Way, rng: np.random.Generator) -> int:
    return int(rng.integers(round(BEFORE / DT) + 1, len(way.motion) - round(AFTER / DT) - 2))


def _place(way: Way, rng: np.random.Generator, row: int) -> tuple[str, np.ndarray, np.ndarray, np.ndarray]:
    """A link, and its point [m], outward normal and velocity [m/s], world frame."""
    link = str(rng.choice(list(way.samples)))
    points, normals = way.samples[link]
    which = int(rng.integers(len(points)))
    q, v = way.motion.q[row], way.motion.v[row]
    pose = way.robot.link_pose(q, link)
    point = pose[:3, :3] @ points[which] + pose[:3, 3]
    velocity = way.robot.jacobian(q, link, point)[:3] @ v
    return link, point, pose[:3, :3] @ normals[which], velocity


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))
