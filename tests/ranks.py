"""The rank deficit of contacts by NumPy alone, to hold against that of the isolator."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

import contactsense as cs

# Moments are counted as forces at this lever [m]; singular values below this share of the largest are nil.
LEVER, TOLERANCE = 0.3, 1e-7


def rank_deficit(robot: cs.Robot, q: np.ndarray, links: Sequence[str]) -> int:
    """Components of the wrenches on `links` that the joint torques leave undetermined."""
    balance = np.array([1.0] * 3 + [LEVER] * 3)
    wrenches = np.hstack([robot.jacobian(q, link).T * balance for link in links])
    values = np.linalg.svd(wrenches, compute_uv=False)
    return 6 * len(links) - int(np.sum(values > TOLERANCE * values[0]))
