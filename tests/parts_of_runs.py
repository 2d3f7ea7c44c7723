"""What one of several contacts of a recorded run does."""

from __future__ import annotations

from typing import Any

import numpy as np

import contactsense as cs


def torque_of(robot: cs.Robot, run: Any, contact: int) -> np.ndarray:
    """The external torques of one of the contacts alone, `(T, nv)`; `run` is a `SeveralRun`."""
    rows = [
        robot.jacobian(q, run.links[contact], run.points[k, contact])[:3].T @ run.forces[k, contact]
        for k, q in enumerate(run.q)
    ]
    return np.array(rows)
