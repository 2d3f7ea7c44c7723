"""Bags of a humanoid that tests of logs share."""

from __future__ import annotations

from pathlib import Path

from bag_files import write_mcap
from humanoid_logs import JOINTS, NAMES, swaying
from ros_messages import Message, Writer


def joint_messages(encoding: str = "cdr") -> list[Message]:
    return Writer(encoding).joints(swaying(), NAMES, JOINTS)


def bag(folder: Path, given: list[Message]) -> Path:
    return write_mcap(folder / "base.mcap", [*joint_messages(), *given])
