"""How a floating base moves: as the log says, or by differences of its pose."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .base_columns import ANGULAR, BaseColumns, child_frame
from .base_frames import told_axes
from .blocks import Block
from .held import Extra, Series, series_of
from .quaternions import inverse, product, rotated, rotation_vectors
from .recording import Recording
from .resample import differences, neighbours

Rows = NDArray[np.float64]


def twist_of(
    recording: Recording,
    found: BaseColumns,
    poses: Series,
    base: Sequence[str],
    time_column: str | None,
    extra: Extra,
) -> Series:
    """Linear and angular velocity in the axes of the frame that is measured; `base` are other names of it."""
    own = replace(poses, values=_differences(poses))
    block = found.twist
    if block is None:
        extra.chosen.append("velocity of the base: central differences of its pose")
        return own
    series = series_of(recording, block, time_column)
    at_rest = np.zeros((len(series.values), 6 - series.values.shape[1]))
    values = np.column_stack([at_rest, series.values])
    pose_rows, known = poses.at(series)
    expected, _ = own.at(series)
    values, quaternions, expected = values[known], pose_rows[known, 3:], expected[known]
    axes = {}
    for name, part in (("linear", slice(0, 3)), ("angular", slice(3, 6))):
        told = _named_axes(block, found.pose, base) or told_axes(
            values[:, part], expected[:, part], quaternions
        )
        if told == "world":
            values[:, part] = rotated(inverse(quaternions), values[:, part])
        axes[name] = told
    if not all(axes.values()) or not len(values):
        extra.chosen.append("velocity of the base: central differences of its pose")
        extra.left_out.append(f"velocity {block.title}: fits the differences of the pose in no axes")
        return own
    where = " and ".join(f"{name} in axes of the {told}" for name, told in axes.items())
    if len(set(axes.values())) == 1:
        where = f"in axes of the {axes['angular']}"
    extra.chosen.append(f"velocity of the base from {block.title} [m/s, rad/s], {where}")
    return replace(series, time=series.time[known], values=values)


def _named_axes(block: Block, pose: Block, base: Sequence[str]) -> str:
    """The axes of a twist where its messages name them."""
    if block.kind is ANGULAR and block.table is pose.table:
        return "base"
    if block.table.kind == "nav_msgs/msg/Odometry":
        return "base"
    frame = block.frame
    if not frame:
        return ""
    if frame in base or frame == child_frame(pose):
        return "base"
    return "world" if frame == pose.frame and pose.table.kind else ""


def _differences(poses: Series) -> Rows:
    """Twist in axes of the moving frame, by central differences of its pose."""
    quaternions = poses.values[:, 3:]
    before, after = neighbours(poses.time)
    turn = rotation_vectors(product(inverse(quaternions[before]), quaternions[after]))
    linear = rotated(inverse(quaternions), differences(poses.time, poses.values[:, :3]))
    return np.column_stack([linear, turn / (poses.time[after] - poses.time[before])[:, None]])
