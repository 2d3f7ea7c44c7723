"""What a column holds, by its name."""

from __future__ import annotations

import re
from dataclasses import dataclass

from .joint_names import Tokens, words

POSITION, VELOCITY, TORQUE, EXTERNAL, CURRENT = "position", "velocity", "torque", "external_torque", "current"
QUANTITIES = (POSITION, VELOCITY, TORQUE, EXTERNAL, CURRENT)

_PHRASES = {
    POSITION: """position, positions, pos, q, actual q, angle, angles, joint position, joint positions,
        jnt pos, joint pos, joint angle, measured position, actual position""",
    VELOCITY: """velocity, velocities, vel, dq, qd, qdot, q dot, actual qd, speed, joint velocity,
        joint velocities, jnt vel, joint vel, measured velocity, actual velocity""",
    TORQUE: """torque, torques, effort, efforts, tau, tau j, tau m, trq, joint torque, joint torques,
        measured torque, actual torque,
        joint effort, tau measured""",
    EXTERNAL: """tau ext, external torque, external torques, ext torque, tau ext hat filtered,
        torque external, joint torque external, external joint torque, external joint torques,
        o tau ext hat filtered""",
    CURRENT: "current, currents, actual current, motor current, joint current",
}
_BY_WORDS = {words(phrase): quantity for quantity, them in _PHRASES.items() for phrase in them.split(",")}
_LONGEST = max(map(len, _BY_WORDS))
# What was asked for is not what was measured.
NOT_MEASURED = frozenset(
    {"target", "desired", "des", "d", "cmd", "command", "commanded", "ref", "reference", "goal", "setpoint"}
    | {"error", "err", "limit", "max", "min", "std"}
)
# Units that a name may end in.
_UNITS = frozenset(["rad", "deg", "degrees", "radians", "nm", "s", "a", "ma"])
_INDEXED = re.compile(r"(?P<field>.*)\[(?P<key>.*)\]\s*", re.DOTALL)


@dataclass(frozen=True)
class Meaning:
    """A quantity of one joint.

    Args:
        quantity: one of `QUANTITIES`.
        joint: the joint's name, or its number.
        source: what columns of the same kind have in common: the words of the name but the joint's.
    """

    quantity: str
    joint: str
    source: str


def meaning(column: str) -> Meaning | None:
    """What a column holds; None where its name does not tell."""
    indexed = _INDEXED.fullmatch(column)
    if indexed is not None:
        return _of_field(indexed["field"], indexed["key"])
    all_words = words(column)
    if NOT_MEASURED & set(all_words):
        return None
    unit = all_words[-1] if all_words and all_words[-1] in _UNITS and len(all_words) > 2 else ""
    named = all_words[:-1] if unit else all_words
    for length in range(min(_LONGEST, len(named) - 1), 0, -1):
        for part, rest in ((named[:length], named[length:]), (named[-length:], named[:-length])):
            if part in _BY_WORDS:
                return Meaning(_BY_WORDS[part], " ".join(rest), " ".join((*part, unit)).strip())
    return None


def _of_field(field: str, key: str) -> Meaning | None:
    """Of an element of an array, by the last words of its path that tell a quantity."""
    path = [words(part) for part in field.split(".")]
    if any(NOT_MEASURED & set(part) for part in path):
        return None
    external = any(_BY_WORDS.get(part) == EXTERNAL for part in path)
    quantity = _BY_WORDS.get(path[-1]) or _ending(path[-1])
    if external and quantity in (TORQUE, None):
        quantity = EXTERNAL
    return None if quantity is None else Meaning(quantity, key, field)


def _ending(part: Tokens) -> str | None:
    return next((_BY_WORDS[part[-k:]] for k in range(len(part) - 1, 0, -1) if part[-k:] in _BY_WORDS), None)
