"""Pose and velocity of a floating base at the times of the joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..errors import InputError
from .base_columns import ORIENTATION, base_columns, child_frame
from .base_frames import base_frames, is_same, placed
from .base_twist import twist_of
from .blocks import Block
from .choice import Group
from .formats.messages import BASE_KINDS
from .held import Extra, Series, series_of
from .quantities import CURRENT, EXTERNAL, TORQUE
from .quaternions import continuous, inverse, of_matrix, product, rotated
from .recording import Recording
from .resample import QUATERNION
from .time_axis import TimeAxis

Rows = NDArray[np.float64]

POSITION, TWIST = "base position", "base twist"
# A quaternion shorter than this is none, but a message that was not filled.
_SHORTEST = 1e-3
_REST = "position and linear velocity of the base are zero: exact only while the base does not accelerate"


def base_rows(
    recording: Recording,
    robot: _core.Robot,
    columns: Mapping[str, str | Sequence[str]],
    axis: TimeAxis,
    time_column: str | None,
) -> Extra:
    """Position, quaternion and twist of the base at the times of the joints: the last ones by then.

    Raises:
        InputError: nothing says where the base is, or several do.
    """
    frames = base_frames(robot)
    found = base_columns(recording, robot, frames, columns)
    for block in (found.pose, found.twist):
        if block is not None:
            block.check_frames("columns")
    extra = Extra.none(axis)
    poses = _poses(series_of(recording, found.pose, time_column), found.pose, extra)
    place, note = _place(found.pose, frames.links, robot)
    origin = frames.origin.copy()
    extra.chosen.append(f"pose of the base from {found.pose.title}{note}")
    if found.pose.kind is ORIENTATION:
        extra.chosen.append(_REST)
        place[:3, 3], origin[:3, 3] = 0.0, 0.0
    base = frames.own if is_same(place) else []
    twist = twist_of(recording, found, poses, base, time_column, extra)
    pose_rows = extra.hold(poses, axis, "pose of the base", "columns")
    twist_rows, moving = twist.at(axis)
    if found.twist is not None and twist.time is not poses.time:
        twist_rows = extra.hold(twist, axis, "velocity of the base", "columns")
    extra.known &= moving
    pose_rows, twist_rows = _of_base(pose_rows, twist_rows, place)
    pose_rows = placed(np.asarray(np.linalg.inv(origin), np.float64), pose_rows)
    extra.values |= {POSITION: pose_rows[:, :3], QUATERNION: continuous(pose_rows[:, 3:]), TWIST: twist_rows}
    used = [found.pose.table, found.pose.table if found.twist is None else found.twist.table]
    others = [it for it in recording.tables if it.kind in BASE_KINDS and not any(it is one for one in used)]
    why = "the base is known without it"
    if found.pose.kind is ORIENTATION:
        why = "not named as that of the base (base_pose, base_twist)"
    extra.left_out += [f"{table.name} ({table.kind}): {why}" for table in others]
    return extra


def left_out_by_base(recording: Recording, groups: dict[str, Group], floats: bool) -> list[str]:
    """Lines on what a log of a robot with a base of this kind leaves out; takes it from the groups.

    Raises:
        InputError: nothing is left of the torques.
    """
    if not floats:
        others = [table for table in recording.tables if table.kind in BASE_KINDS]
        names = dict.fromkeys(f"{table.name} ({table.kind})" for table in others)
        return [f"{name}: no measurements of joints or forces" for name in names]
    if EXTERNAL not in groups:
        return []
    if len({TORQUE, EXTERNAL, CURRENT} & set(groups)) == 1:
        raise InputError(
            f"columns: {groups[EXTERNAL].title} has nothing of the floating base; torques of the motors are "
            "needed"
        )
    return [f"{groups.pop(EXTERNAL).title}: has nothing of the floating base"]


def write_base(q: Rows, v: Rows, values: Mapping[str, Rows]) -> None:
    """Writes the base's part of configurations `(n, nq)` and velocities `(n, nv)`."""
    q[:, :3], q[:, 3:7], v[:, :6] = values[POSITION], values[QUATERNION], values[TWIST]


def _poses(series: Series, block: Block, extra: Extra) -> Series:
    """Rows of position and quaternion; without those whose quaternion is of length zero."""
    whole = np.linalg.norm(series.values[:, -4:], axis=1) > _SHORTEST
    empty = int(np.count_nonzero(~whole))
    if empty:
        extra.mended.append(f"{empty} quaternions of the base of length zero left out")
    values = series.values[whole]
    if len(values) < 2:
        raise InputError(f"columns: {len(values)} poses of the base are complete ({block.title})")
    position = values[:, :3] if values.shape[1] == len(block.kind.order) == 7 else np.zeros((len(values), 3))
    return replace(
        series, time=series.time[whole], values=np.column_stack([position, continuous(values[:, -4:])])
    )


def _place(block: Block, links: Mapping[str, Rows], robot: _core.Robot) -> tuple[Rows, str]:
    """The pose, in the frame of the base, of the frame that is measured; and what is to be said of it."""
    frame = child_frame(block)
    known = next((it for it in (frame, frame.rpartition("/")[2]) if it in links), None)
    if known is not None:
        note = "" if is_same(links[known]) else f", which is that of '{known}', moved to the base"
        return links[known].copy(), note
    if {frame, frame.rpartition("/")[2]} & set(robot.all_link_names):
        raise InputError(f"columns: {block.title} is the pose of '{frame}', which moves against the base")
    return np.eye(4), f"; the robot has no frame '{frame}', which is taken as the base" if frame else ""


def _of_base(poses: Rows, twists: Rows, place: Rows) -> tuple[Rows, Rows]:
    """From the measured frame, which is at `place` in the base's, to the base."""
    if is_same(place):
        return poses, twists
    turn, offset = of_matrix(place[:3, :3]), place[:3, 3]
    quaternions = product(poses[:, 3:], inverse(turn))
    position = poses[:, :3] - rotated(quaternions, np.broadcast_to(offset, (len(poses), 3)))
    angular = rotated(turn, twists[:, 3:])
    linear = rotated(turn, twists[:, :3]) - np.cross(angular, offset)
    return np.column_stack([position, quaternions]), np.column_stack([linear, angular])
