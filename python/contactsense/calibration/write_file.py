"""A calibration as the text of a file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any

import yaml

from ..errors import InputError
from .file_layout import (
    FORMAT,
    JOINT_FIELDS,
    NOISE_FIELDS,
    REVERSALS,
    ROBOT_FIELDS,
    Field,
    nameless,
)

# Of written numbers: more than any of them is known to, and what is read differs by less than 1e-9 of them.
DIGITS = 10
# Names that need no quotes; what YAML takes for another type does.
_PLAIN = re.compile(r"[A-Za-z_][\w./-]*", re.ASCII)

_HEADER = """\
# What contact-free motion taught of one robot, by contactsense. May be edited by hand.
# Units stand behind each entry, in parentheses those of sliding joints. "std" is one standard deviation.
"""


def written(content: dict[str, Any], version: str, source: str, date: str) -> str:
    """The text of a file.

    Args:
        content: the core's.
        version: of contactsense.
        source: where the calibration is from.
        date: of today.
    """
    lines = [
        f"format: {FORMAT}",
        f"contactsense: {text(version)}",
        f"source: {text(source)}",
        f"date: {text(date)}",
        *_robot(content),
        f"torque_is_external: {str(content['torque_is_external']).lower()}  # whether a vendor estimates it",
        *(_entry("", field, content[field.path[0]]) for field in ROBOT_FIELDS),
        *_joints(content),
        *_noise(content),
        *_links(content),
        *_payload(content["payload"]),
        *_rest(content),
    ]
    return _HEADER + "\n".join(lines) + "\n"


def _robot(content: dict[str, Any]) -> Iterator[str]:
    yield "robot:  # the only one that this file fits"
    yield f"  name: {text(content['robot'])}"
    yield f"  fingerprint: {text(content['fingerprint'])}  # of its joints and inertias"
    yield "  joints:  # in the order of the velocity"
    yield from (f"    - {text(joint)}" for joint in content["joints"])


def _joints(content: dict[str, Any]) -> Iterator[str]:
    yield "joints:"
    for index, joint in enumerate(content["joints"]):
        yield f"  {text(joint)}:"
        for field in JOINT_FIELDS:
            yield _entry("    ", field, _at(content, field)[index])
            if field.name == "viscous_std":
                ((kind, width),) = content["friction"]["reversal"][index].items()
                yield f"    reversal: {{{kind}: {number(width)}}}  # {REVERSALS[kind]}, of coulomb"


def _noise(content: dict[str, Any]) -> Iterator[str]:
    yield "noise:  # of the external torque, one standard deviation: a number, or one a joint"
    for field in NOISE_FIELDS:
        values = _at(content, field)
        if len(values) == 1:
            yield _entry("  ", field, values[0])
            continue
        yield f"  {field.name}:  # {field.unit}"
        pairs = zip(content["joints"], values, strict=True)
        yield from (f"    {text(joint)}: {number(value)}" for joint, value in pairs)


def _links(content: dict[str, Any]) -> Iterator[str]:
    yield "links:  # inertias of all that moves with a joint, in the frame of the link that it moves"
    for joint, body in zip(content["joints"], content["bodies"], strict=True):
        yield f"  {text(body['link'] or nameless(joint))}:"
        yield f"    joint: {text(joint)}"
        yield f"    mass: {number(body['mass'])}  # kg"
        yield f"    com: {numbers(body['com'])}  # m"
        yield f"    inertia: {numbers(body['inertia'])}  # kg m^2, about com: xx, xy, yy, xz, yz, zz"


def _payload(payload: dict[str, Any] | None) -> Iterator[str]:
    if payload is None:
        yield "payload: null  # what the description lacks on a link"
        return
    yield "payload:  # what the description lacks on a link"
    yield f"  link: {text(payload['link'])}"
    yield f"  mass: {number(payload['mass'])}  # kg"
    yield f"  mass_std: {number(payload['mass_std'])}  # kg"
    yield f"  com: {numbers(payload['com'])}  # m, in the link's frame"
    yield f"  com_std: {numbers(payload['com_std'])}  # m"
    yield f"  moment: {number(payload['moment'])}  # kg m^2, about com, the same about all axes"


def _rest(content: dict[str, Any]) -> Iterator[str]:
    offsets = content["sensor_offsets"]
    yield f"sensor_offsets:{'' if offsets else ' {}'}  # N and Nm, what a sensor reads without load"
    yield from (f"  {text(name)}: {numbers(offset)}" for name, offset in offsets)
    tails = content["tails"]
    yield f"tails:{'' if tails else ' []'}  # of detection's statistic: gain (1/s), level, scale"
    yield from (f"  - {numbers([tail['gain'], tail['level'], tail['scale']])}" for tail in tails)
    contacts = content["contacts"]
    yield f"contacts:{'' if contacts else ' []'}  # s, from when to when contacts were left out of the log"
    yield from (f"  - {numbers(contact)}" for contact in contacts)
    notes = content["notes"]
    yield f"notes:{'' if notes else ' []'}  # what the motion could not tell"
    yield from (f"  - {text(note)}" for note in notes)


def _entry(margin: str, field: Field, value: float | None) -> str:
    return f"{margin}{field.name}: {number(value)}  # {field.unit}"


def _at(content: dict[str, Any], field: Field) -> Any:
    found: Any = content
    for key in field.path:
        found = found[key]
    return found


def number(value: float | None) -> str:
    """A number, as YAML reads it; none is what JSON makes of one that is not finite."""
    if value is None:
        raise InputError("calibration: holds a number that is not finite, which no file can keep")
    short = f"{value:.{DIGITS}g}"
    mantissa, e, exponent = short.partition("e")
    if "." not in mantissa:
        mantissa += ".0"  # without it, YAML 1.1 takes 1e-05 for a text
    return mantissa + e + exponent


def numbers(values: Iterable[float | None]) -> str:
    """A list of numbers."""
    return f"[{', '.join(map(number, values))}]"


def text(value: str) -> str:
    """A text, in quotes where YAML needs them."""
    if _PLAIN.fullmatch(value) and yaml.safe_load(value) == value:
        return value
    quoted = yaml.safe_dump(value, default_style='"', allow_unicode=True, width=float("inf"))
    return str(quoted).rstrip("\n")
