"""A configuration from a YAML file, or from a parameter file of ROS 2."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, TypeVar

from ..errors import InputError
from ..robot import DESCRIPTIONS
from .configuration import Configuration, PerJoint, SensorTopic
from .entries import Entries, Rule
from .yaml_text import parsed

T = TypeVar("T")
Choice = TypeVar("Choice", bound=str)

PARAMETERS = "ros__parameters"
# A name in the graph of ROS 2, and one of a topic.
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_TOPIC = re.compile(r"/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")
_LARGEST_DOMAIN = 232  # of ROS 2


def read_configuration(path: str | os.PathLike[str]) -> Configuration:
    """Reads a file strictly; paths in it are relative to its folder.

    Raises:
        InputError: the file cannot be read, or an entry is missing, unknown or wrong; names it.
    """
    file = Path(path)
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise InputError(f"config: cannot read {file}: {error}") from error
    return configuration_of(str(file), text, file.resolve().parent)


def configuration_of(file: str, text: str, folder: Path) -> Configuration:
    """The configuration of a text."""
    entries = _parameters(Entries(file, parsed(file, text)), file)
    given: dict[str, Any] = {}

    def optional(name: str, read: Callable[[str], Any]) -> None:
        if name in entries.names():
            given[name] = read(name)

    def path(name: str) -> Path:
        return folder / entries.text(name)

    robot = entries.text("robot")
    given["robot"] = robot if robot in DESCRIPTIONS else str(folder / robot)
    optional("package_dirs", lambda name: tuple(folder / it for it in entries.texts(name, "folders")))
    optional("geometry", lambda name: _one_of(entries, name, ("collision", "visual", "collision_or_visual")))
    optional("locked_joints", lambda name: _positions(entries.inner(name)))
    optional("calibration", path)
    optional("torque_threshold", lambda name: _per_joint(entries, name, "positive"))
    optional("wrench_threshold", lambda name: entries.number(name, "N, Nm", "positive"))
    optional("observer_gain", lambda name: entries.number(name, "1/s", "positive"))
    optional("bias_time", lambda name: entries.number(name, "s", "positive"))
    optional("effort", lambda name: _one_of(entries, name, ("motor", "external")))
    optional("torque_constants", lambda name: _per_joint(entries, name, "not zero"))
    optional("rate", lambda name: entries.number(name, "Hz", "positive"))
    optional("sensors", lambda name: _sensors(entries.inner(name)))
    optional("wrench_timeout", lambda name: entries.number(name, "s", "positive"))
    for name in ("joint_states", "prefix", "diagnostics"):
        optional(name, lambda name: _topic(entries, name))
    optional("frame", entries.text)
    optional("marker_rate", lambda name: entries.number(name, "Hz", "positive"))
    optional("node", lambda name: _node(entries, name))
    optional("domain", lambda name: _domain(entries, name))
    optional("type_hash", entries.flag)
    entries.done()
    return Configuration(**given)


def _parameters(entries: Entries, file: str) -> Entries:
    """The parameters, out of the layout of ROS 2 where they are in it."""
    names = entries.names()
    if len(names) != 1 or names[0] == "robot":
        return entries
    node = entries.inner(names[0])
    found = node.inner(PARAMETERS)
    node.done()
    return found


def _one_of(entries: Entries, name: str, known: tuple[Choice, ...]) -> Choice:
    text = entries.text(name)
    for choice in known:
        if choice == text:
            return choice
    raise entries.wrong(f"{name} must be {' or '.join(known)}", text)


def _positions(joints: Entries) -> dict[str, float]:
    return {name: joints.number(name, "rad, m") for name in joints.names()}


def _per_joint(entries: Entries, name: str, rule: Rule) -> PerJoint:
    value = entries.take(name, "a number, or a list of one a joint [Nm, N]")
    if isinstance(value, list) and value:
        return entries.listed(name, value, len(value), "Nm, N", rule)
    return entries.listed(name, [value], 1, "Nm, N", rule)[0]


def _sensors(sensors: Entries) -> dict[str, SensorTopic]:
    found = {name: _sensor(sensors.inner(name)) for name in sensors.names()}
    topics = [sensor.topic for sensor in found.values()]
    if len(set(topics)) < len(topics):
        raise sensors.wrong("each must have a topic of its own", topics)
    return found


def _sensor(sensor: Entries) -> SensorTopic:
    convention: Literal["load", "support"] = "load"
    wanted = False
    if "convention" in sensor.names():
        convention = _one_of(sensor, "convention", ("load", "support"))
    if "wanted" in sensor.names():
        wanted = sensor.flag("wanted")
    found = SensorTopic(sensor.text("link"), _topic(sensor, "topic"), convention, wanted)
    sensor.done()
    return found


def _topic(entries: Entries, name: str) -> str:
    text = entries.text(name)
    if not _TOPIC.fullmatch(text):
        raise entries.wrong(f"{name} must be a topic such as /joint_states", text)
    return f"/{text.removeprefix('/')}"


def _node(entries: Entries, name: str) -> str:
    text = entries.text(name)
    if not _NAME.fullmatch(text):
        raise entries.wrong(f"{name} must be letters, digits and underscores", text)
    return text


def _domain(entries: Entries, name: str) -> int:
    number = entries.number(name, "1", "not negative")
    if number != int(number) or number > _LARGEST_DOMAIN:
        raise entries.wrong(f"{name} must be a whole number from 0 to {_LARGEST_DOMAIN}", number)
    return int(number)
