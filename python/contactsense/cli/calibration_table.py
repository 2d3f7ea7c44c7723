"""A calibration as a table."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.text import Text

from .._tables import plain_table
from ..calibration import Calibration

_COLUMNS = ("joint", "bias", "Coulomb\nfriction", "viscous\nfriction", "rotor\ninertia", "before", "after")
_UNITS = ("", "[Nm]", "[Nm]", "[Nm s/rad]", "[kg m²]", "[Nm]", "[Nm]")


def print_calibration(
    console: Console,
    calibration: Calibration,
    before: NDArray[np.float64],
    after: NDArray[np.float64],
    file: str,
) -> None:
    """Prints what was learnt, one row a joint, and what the motion could not tell."""
    table = plain_table(f"Calibration of {calibration.robot_name}")
    for header, unit in zip(_COLUMNS, _UNITS, strict=True):
        table.add_column(
            Text(f"{header}\n{unit}".strip()), justify="left" if header == "joint" else "right", no_wrap=True
        )
    friction = calibration.friction
    columns = (
        calibration.torque_bias,
        friction.coulomb,
        friction.viscous,
        calibration.armature,
        before,
        after,
    )
    for joint, name in enumerate(calibration.joint_names):
        table.add_row(Text(name), *[f"{values[joint]:.3g}" for values in columns])
    console.print(table)
    console.print(
        "Before, after: root mean square of the external torque of this log, low-passed, without and with "
        "the calibration. The noise in the file is from parts of the log that were held out.",
        highlight=False,
    )
    if calibration.payload is not None:
        payload = calibration.payload
        console.print(f"Payload: {payload.mass:.3f} kg", highlight=False)
    for note in calibration.notes:
        console.print(Text(f"Note: {note}"))
    console.print(Text(f"Written to {file}"))
