"""A calibration from the text of a file."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..errors import InputError
from .entries import Entries
from .file_layout import FORMAT, JOINT_FIELDS, NOISE_FIELDS, REVERSALS, ROBOT_FIELDS, nameless
from .yaml_text import parsed

# A moment of inertia below zero by this share of the largest is rounding.
ROUNDING = 1e-6


def content_of(file: str, text: str) -> dict[str, Any]:
    """The core's content.

    Args:
        file: its name, for messages.
        text: what it holds.

    Raises:
        InputError: names the file, the joint or link, and the entry.
    """
    entries = Entries(file, parsed(file, text))
    found = entries.take("format", str(FORMAT))
    if found is True or found != FORMAT:
        raise InputError(
            f"{file}: format: this version of contactsense reads format {FORMAT}, not {found!r}; "
            "calibrate anew, or use the version that wrote the file"
        )
    for name in ("contactsense", "source", "date"):
        entries.take(name, "a text")  # for people
    robot = entries.inner("robot")
    joints = robot.texts("joints", "names of joints, in the order of the velocity")
    content: dict[str, Any] = {
        "robot": robot.text("name"),
        "fingerprint": robot.text("fingerprint"),
        "joints": joints,
        "torque_is_external": entries.flag("torque_is_external"),
        **{field.name: entries.field(field) for field in ROBOT_FIELDS},
    }
    robot.done()
    if len(set(joints)) < len(joints):
        raise InputError(f"{file}: robot: joints: a name stands there twice")
    _read_joints(entries.inner("joints"), joints, content)
    content["noise"] = _noise(entries.inner("noise"), joints)
    content["bodies"] = _bodies(entries.inner("links"), joints)
    content["payload"] = _payload(entries)
    content["sensor_offsets"] = _offsets(entries.inner("sensor_offsets"))
    content["tails"] = [
        dict(zip(("gain", "level", "scale"), entries.listed(where, item, 3, "1/s, 1, 1"), strict=True))
        for where, item in entries.items("tails", "triples of gain [1/s], level and scale")
    ]
    content["contacts"] = [
        entries.listed(where, item, 2, "s")
        for where, item in entries.items("contacts", "pairs of times [s], from when to when")
    ]
    content["notes"] = entries.texts("notes", "texts")
    entries.done()
    return content


def _read_joints(entries: Entries, joints: list[str], content: dict[str, Any]) -> None:
    friction: dict[str, Any] = {"reversal": []}
    content["friction"] = friction
    for field in JOINT_FIELDS:
        (friction if field.path[0] == "friction" else content)[field.path[-1]] = []
    for joint in joints:
        entry = entries.inner(joint)
        for field in JOINT_FIELDS:
            holder = friction if field.path[0] == "friction" else content
            holder[field.path[-1]].append(entry.field(field))
        friction["reversal"].append(_reversal(entry))
        entry.done()
    entries.done()


def _reversal(entry: Entries) -> dict[str, float]:
    reversal = entry.inner("reversal")
    kinds = reversal.names()
    if len(kinds) != 1 or kinds[0] not in REVERSALS:
        raise reversal.wrong("must be {velocity: number} or {displacement: number}", kinds)
    return {kinds[0]: reversal.number(kinds[0], REVERSALS[kinds[0]], "positive")}


def _noise(entries: Entries, joints: list[str]) -> dict[str, list[float]]:
    noise = {}
    for field in NOISE_FIELDS:
        if entries.is_mapping(field.name):
            inner = entries.inner(field.name)
            noise[field.name] = [inner.number(joint, field.unit, field.rule) for joint in joints]
            inner.done()
        else:
            noise[field.name] = [entries.field(field)]
    entries.done()
    return noise


def _bodies(entries: Entries, joints: list[str]) -> list[dict[str, Any]]:
    found: dict[str, dict[str, Any]] = {}
    for link in entries.names():
        entry = entries.inner(link)
        joint = entry.text("joint")
        if joint not in joints or joint in found:
            raise entry.wrong(f"joint must be another one of {', '.join(joints)}", joint)
        inertia = entry.numbers("inertia", 6, "kg m^2")
        found[joint] = {
            "link": "" if link == nameless(joint) else link,
            "mass": entry.number("mass", "kg", "not negative"),
            "com": entry.numbers("com", 3, "m"),
            "inertia": inertia,
        }
        entry.done()
        xx, xy, yy, xz, yz, zz = inertia
        moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if moments[0] < -ROUNDING * abs(moments[-1]):
            problem = "inertia: its principal moments must not be negative [kg m^2]"
            raise entry.wrong(problem, moments.round(9).tolist())
    for joint in joints:
        if joint not in found:
            raise entries.missing(f"the link that joint {joint!r} moves")
    return [found[joint] for joint in joints]


def _payload(entries: Entries) -> dict[str, Any] | None:
    if entries.take_null("payload"):
        return None
    payload = entries.inner("payload")
    content = {
        "link": payload.text("link"),
        "mass": payload.number("mass", "kg", "not negative"),
        "mass_std": payload.number("mass_std", "kg", "not negative"),
        "com": payload.numbers("com", 3, "m"),
        "com_std": payload.numbers("com_std", 3, "m", "not negative"),
        "moment": payload.number("moment", "kg m^2", "not negative"),
    }
    payload.done()
    return content


def _offsets(entries: Entries) -> list[Any]:
    return [[name, entries.numbers(name, 6, "N, Nm")] for name in entries.names()]
