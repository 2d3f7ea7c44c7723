"""Picture of a calibration: what is left of the torques before and after, and which motion it is from."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .._pictures import ESTIMATE, GREY, legend_above, save_picture
from ..calibration import Calibration
from ..log import Log
from ..offline.residuals import settled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Rows = NDArray[np.float64]

# Axes of a motion show so much at least: a joint that hardly moves should look like it [rad, m; a second].
_LEAST_RANGE, _LEAST_SPEED = 0.1, 0.1


def save_calibration_picture(
    path: Path, log: Log, calibration: Calibration, before: Rows, after: Rows
) -> Path:
    """One row a joint: external torque over time; beside it, the range of positions and velocities."""
    joints = calibration.joint_names

    def draw(figure: Figure) -> None:
        axes = figure.subplots(len(joints), 2, squeeze=False, gridspec_kw={"width_ratios": [3, 1]})
        rows = settled(log)
        for joint, name in enumerate(joints):
            left, right = axes[joint]
            _draw_torque(left, log.time[rows], before[rows, joint], after[rows, joint], name)
            velocity = log.v[rows, joint]
            _draw_motion(right, _position(log, joint)[rows], velocity)
            if joint == 0:
                legend_above(left)
                left.set_title("External torque without contact [Nm]")
                right.set_title("Motion: velocity over position")
        axes[-1][0].set_xlabel("time [s]")
        axes[-1][1].set_xlabel("position [rad, m]")

    return save_picture("png", path, (11.0, 1.5 * len(joints) + 1.0), draw)


def _draw_torque(axes: Axes, time: Rows, before: Rows, after: Rows, name: str) -> None:
    axes.plot(time, before, color=GREY, linewidth=0.8, label="description")
    axes.plot(time, after, color=ESTIMATE, linewidth=0.8, label="calibrated")
    axes.axhline(0.0, color=GREY, linewidth=0.5)
    axes.set_ylabel(name, fontsize=8)


def _draw_motion(axes: Axes, position: Rows, velocity: Rows) -> None:
    axes.plot(position, velocity, color=GREY, linewidth=0.6)
    axes.set_xlim(_at_least(_LEAST_RANGE, axes.get_xlim()))
    axes.set_ylim(_at_least(_LEAST_SPEED, axes.get_ylim()))
    axes.locator_params(nbins=4)
    axes.ticklabel_format(useOffset=False)


def _at_least(width: float, limits: tuple[float, float]) -> tuple[float, float]:
    low, high = limits
    missing = max(0.0, width - (high - low)) / 2.0
    return low - missing, high + missing


def _position(log: Log, joint: int) -> Rows:
    """Of a joint; that of one without limits is integrated, as configurations have its cosine and sine."""
    if log.q.shape[1] == log.v.shape[1]:
        return log.q[:, joint]
    steps = np.diff(log.time, prepend=log.time[:1])
    return np.cumsum(log.v[:, joint] * steps)
