"""Picture of a log without contact: the torque that the model does not explain."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._pictures import ESTIMATE, GREY, legend_above, save_picture
from ..log import Log
from ..offline.residuals import settled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def save_diagnosis_picture(path: Path, log: Log, robot: _core.Robot, residual: NDArray[np.float64]) -> Path:
    """One row a joint: the measured torque, and the external torque that should be none."""
    assert log.tau is not None  # a diagnosis needs it
    tau = log.tau

    def draw(figure: Figure) -> None:
        axes = figure.subplots(len(robot.joint_names), 1, squeeze=False, sharex=True)[:, 0]
        rows = settled(log)
        for joint, (own, name) in enumerate(zip(axes, robot.joint_names, strict=True)):
            own.plot(log.time[rows], tau[rows, joint], color=GREY, linewidth=0.8, label="measured torque")
            own.plot(
                log.time[rows], residual[rows, joint], color=ESTIMATE, linewidth=0.8, label="external torque"
            )
            own.axhline(0.0, color=GREY, linewidth=0.5)
            own.set_ylabel(name, fontsize=8)
        axes[0].set_title("Torque, and what of it the model does not explain [Nm]")
        legend_above(axes[0])
        axes[-1].set_xlabel("time [s]")

    return save_picture("png", path, (10.0, 1.5 * len(robot.joint_names) + 1.0), draw)
