"""Which columns of a log say where a floating base is and how it moves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from .. import _core
from ..errors import InputError
from .base_frames import BaseFrames
from .blocks import Block, blocks, named_block, titles
from .components import Kind, phrases
from .joint_names import Tokens, words
from .recording import Recording, listing

# What `columns` may name.
BASE_POSE, BASE_TWIST = "base_pose", "base_twist"

_AXES = ("x", "y", "z")
_POSITION = "position, pos, p, translation, trans, t, -"
_ROTATION = "orientation, quaternion, quat, rotation, rot, q"
_LINEAR = "linear, linear velocity, lin vel, linear vel, velocity, vel, v"
_ANGULAR = "angular, angular velocity, ang vel, angular vel, omega, gyro, w"
_QUATERNION = {f"q{axis}": _ROTATION for axis in (*_AXES, "w")}
_TURN = {f"w{axis}": _ANGULAR for axis in _AXES}


def _kind(name: str, parts: Mapping[str, str]) -> Kind:
    return Kind(name, tuple(parts), phrases(**parts))


POSE = _kind("pose", {**{f"p{axis}": _POSITION for axis in _AXES}, **_QUATERNION})
ORIENTATION = _kind("rotation", _QUATERNION)
TWIST = _kind("twist", {**{f"v{axis}": _LINEAR for axis in _AXES}, **_TURN})
ANGULAR = _kind("angular velocity", _TURN)

# Words of topics and columns that are the base's.
_BASE_WORDS = frozenset({"base", "root", "floating", "odom", "odometry", "body"})
# Words that tell a pose from a twist, but not whose they are.
_FILLERS = frozenset({"pose", "twist", "imu", "state", "velocity", "vel", "data"})


@dataclass(frozen=True)
class BaseColumns:
    """Where the base is (`POSE`, or `ORIENTATION` of an IMU), and how it moves (`TWIST` or `ANGULAR`)."""

    pose: Block
    twist: Block | None


def base_columns(
    recording: Recording,
    robot: _core.Robot,
    frames: BaseFrames,
    columns: Mapping[str, str | Sequence[str]],
) -> BaseColumns:
    """What the log has of the base.

    Raises:
        InputError: nothing, or several that fit as well.
    """
    names = [words(name) for name in (*frames.own, robot.name)]
    if BASE_POSE in columns:
        pose = named_block(recording, [POSE, ORIENTATION], columns[BASE_POSE], f"columns: {BASE_POSE}")
    else:
        moving = [name for name in robot.all_link_names if name not in frames.links]
        pose = _pose(recording, names, frames.own, moving)
    if BASE_TWIST in columns:
        kind = ANGULAR if pose.kind is ORIENTATION else TWIST
        twist = named_block(recording, [kind], columns[BASE_TWIST], f"columns: {BASE_TWIST}")
        return BaseColumns(pose, twist)
    return BaseColumns(pose, _twist(recording, pose, names))


def _pose(recording: Recording, names: Sequence[Tokens], base: Sequence[str], moving: Sequence[str]) -> Block:
    poses = blocks(recording.tables, POSE)
    best = [block for block in poses if _is_base(block, names)]
    if not best:
        turns = [block for block in blocks(recording.tables, ORIENTATION) if not _is_within(block, poses)]
        best = [block for block in turns if _beside(block, ANGULAR)]
        best = [it for it in best if not _is_among(it.frame, moving) and not _is_unknown(it)]
    own = [block for block in best if _is_among(child_frame(block), base)]
    named = [block for block in best if _BASE_WORDS & set(block.words)]
    best = best if len(best) < 2 else own or named or best
    if len(best) == 1:
        return best[0]
    how = (
        f"name it with columns={{'{BASE_POSE}': ...}}: a topic, or seven columns, position and quaternion "
        "x y z w"
    )
    if best:
        raise InputError(f"columns: several fit as the pose of the base: {titles(best)}; {how}")
    raise InputError(
        "columns: nothing says where the base is: nav_msgs/Odometry, geometry_msgs/PoseStamped, "
        "sensor_msgs/Imu, or columns such as base_x and base_qw; "
        f"{how}; there are {f'other poses: {titles(poses)}' if poses else listing(recording)}"
    )


def _twist(recording: Recording, pose: Block, names: Sequence[Tokens]) -> Block | None:
    kind = ANGULAR if pose.kind is ORIENTATION else TWIST
    best = _beside(pose, kind)
    if not best and kind is TWIST:
        best = [block for block in blocks(recording.tables, kind) if _is_base(block, names)]
    if len(best) > 1:
        raise InputError(
            f"columns: several fit as the velocity of the base: {titles(best)}; name one with "
            f"columns={{'{BASE_TWIST}': ...}}"
        )
    return best[0] if best else None


def _beside(block: Block, kind: Kind) -> list[Block]:
    """Those of the same table with the same words, or the only one there."""
    there = blocks([block.table], kind)
    same = [other for other in there if _telling(other.stem) == _telling(block.stem)]
    return same or (there if len(there) == 1 else [])


def _telling(stem: Tokens) -> Tokens:
    return tuple(word for word in stem if word not in _FILLERS)


def _is_within(block: Block, others: Sequence[Block]) -> bool:
    return any(set(block.columns) <= set(other.columns) for other in others if other.table is block.table)


def _is_base(block: Block, names: Sequence[Tokens]) -> bool:
    """Whether its names say so; numbers of a file that have no other name are the base's as well."""
    all_words = block.words
    if block.table.kind == "nav_msgs/msg/Odometry" or _BASE_WORDS & set(all_words):
        return True
    if not block.table.kind and not _telling(block.stem):
        return True
    return any(
        all_words[at : at + len(name)] == name for name in names if name for at in range(len(all_words))
    )


def _is_unknown(block: Block) -> bool:
    """Whether an IMU says that it does not know how it is turned."""
    told = block.table.columns.get("orientation_covariance[0]")
    return told is not None and bool(np.all(told == -1.0))


def child_frame(block: Block) -> str:
    """The frame whose pose it is."""
    return block.frame if block.kind is ORIENTATION else block.frame_in("child_frame_id")


def _is_among(frame: str, links: Sequence[str]) -> bool:
    return frame in links or frame.rpartition("/")[2] in links
