"""What the measurements determine, from the true contacts: ranks, with NumPy alone (eqs. 28, 31)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ... import Robot
from ..sampling import FloatArray

LEVER = 0.3  # [m], sets moments against forces
RANK_TOLERANCE = 1e-7  # of the largest singular value


def stacked_jacobian(robot: Robot, q: FloatArray, links: Sequence[str]) -> FloatArray:
    """Jacobians of the links at their origins, one below the other `(6 n, nv)`; moments over the lever."""
    balance = np.array([[1.0]] * 3 + [[1.0 / LEVER]] * 3)
    return np.vstack([robot.jacobian(q, link) * balance for link in links])


def rank(matrix: FloatArray) -> int:
    """Number of singular values over a ten-millionth of the largest."""
    values = np.linalg.svd(matrix, compute_uv=False)
    return int(np.sum(values > RANK_TOLERANCE * values[0])) if values.size else 0


def rank_deficit(robot: Robot, q: FloatArray, links: Sequence[str]) -> int:
    """`6 n - rank` of the stacked Jacobians of the links touched (eq. 31): components left open."""
    return 6 * len(links) - rank(stacked_jacobian(robot, q, links))
