"""Contacts by a person at random times and places."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from contactsense import Robot
from contactsense.errors import InputError

from ._arrays import FloatArray, not_negative, whole
from .joint_motion import JointMotion
from .person_contact import PersonContact
from .push import random_push
from .random_moves import ordered

# Shortest time between contacts [s]: a person draws back and reaches out again.
_PAUSE = 0.5
# Rise and fall as a share of the contact, and at most this long [s].
_RISE, _LONGEST_RISE = (0.2, 0.5), 0.15
# Room in front of a point that a finger or hand needs [m]; places tried for one that has it, and on one link.
_ROOM, _TRIES, _TRIES_ON_LINK = 0.03, 400, 20


def random_contacts(
    robot: Robot,
    motion: JointMotion,
    contacts: int,
    *,
    contact_free: float = 0.0,
    force: tuple[float, float] = (3.0, 60.0),
    duration: tuple[float, float] = (0.1, 1.0),
    friction: float = 0.5,
    links: Iterable[str] | None = None,
    seed: int = 0,
) -> tuple[PersonContact, ...]:
    """`contacts` pushes, one at a time, at points uniform on the surface of moving links, each link as often.

    Points that another link covers when the contact starts are left out, and so are links that are covered
    as a whole. The force is inward, within the friction cone, and goes along with the link.

    Args:
        robot: with surfaces.
        motion: that it is pushed during.
        contacts: how many.
        contact_free: time without contact at the start [s].
        force: the largest of a contact [N]; uniform in its logarithm, as weak contacts are the more common.
        duration: [s]; uniform.
        friction: coefficient; directions are uniform in its cone.
        links: that are pushed; all moving ones with a surface by default.
        seed: same seed, same contacts.

    Raises:
        InputError: names the argument; `contacts` if so many do not fit into the motion; `links`
            if others cover them.
    """
    ordered("force", force, np.inf)
    ordered("duration", duration, np.inf)
    not_negative("contact_free", contact_free)
    not_negative("friction", friction)
    whole("contacts", contacts)
    whole("seed", seed)
    names = _links(robot, links) if contacts else ()
    rng = np.random.default_rng([seed, 3])
    start, lasting = _times(rng, motion, contacts, contact_free, duration)
    found = []
    for begin, length in zip(start, lasting, strict=True):
        strength = float(np.exp(rng.uniform(*np.log(force))))
        q = motion.q[int(np.searchsorted(motion.time, begin))]
        for attempt in range(_TRIES):
            if attempt % _TRIES_ON_LINK == 0:
                link = names[int(rng.integers(len(names)))]
            push = random_push(
                link,
                robot.surface(link),
                peak_force=strength,
                start=begin,
                duration=length,
                cone_angle=float(np.arctan(friction)),
                seed=int(rng.integers(2**31)),
            )
            if _within_reach(robot, q, link, push.point_local, -push.direction):
                break
        else:
            raise InputError(f"links: no point of {', '.join(names)} is within reach at {begin:.3f} s")
        rise = min(float(rng.uniform(*_RISE)) * length, _LONGEST_RISE)
        found.append(PersonContact(link, push.point_local, strength * push.direction, begin, length, rise))
    return tuple(found)


def _links(robot: Robot, links: Iterable[str] | None) -> tuple[str, ...]:
    model = robot.model
    moving = tuple(name for name in robot.link_names if model.frames[model.getBodyId(name)].parentJoint > 0)
    if not moving:
        raise InputError("robot: has no moving link with a surface")
    if links is None:
        return moving
    names = tuple(links)
    for name in names:
        if name not in moving:
            raise InputError(
                f"links: '{name}' is no moving link with a surface; there are {', '.join(moving)}"
            )
    if not names:
        raise InputError("links: must name at least one link")
    return names


def _times(
    rng: np.random.Generator, motion: JointMotion, count: int, free: float, duration: tuple[float, float]
) -> tuple[list[float], list[float]]:
    """Starts and lengths [s], in order, with pauses; what time is left is shared out at random."""
    lasting = rng.uniform(*duration, count)
    begin = float(motion.time[0]) + free
    left = float(motion.time[-1]) - begin - float(lasting.sum()) - _PAUSE * count
    if left < 0.0:
        raise InputError(f"contacts: {count} do not fit into the motion after contact_free, {free} s")
    waiting = np.sort(rng.uniform(0.0, left, count))
    start = begin + waiting + np.cumsum(lasting) - lasting + _PAUSE * np.arange(count)
    return start.tolist(), lasting.tolist()


def _within_reach(robot: Robot, q: FloatArray, link: str, point: FloatArray, outward: FloatArray) -> bool:
    """Whether no other link covers a point, looking the way the push comes from."""
    pose = robot.link_pose(q, link)
    origin, direction = pose[:3, :3] @ point + pose[:3, 3], pose[:3, :3] @ outward
    for other in robot.link_names:
        if other == link:
            continue
        there = robot.link_pose(q, other)
        turn = there[:3, :3].T
        surface = robot.surface(other)
        hits = surface.cast_rays(turn @ (origin - there[:3, 3]), turn @ direction).distance
        if (hits < _ROOM).any() or (surface.watertight and len(hits) % 2 == 1):
            return False
    return True
