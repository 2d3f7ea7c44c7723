"""Particles as a user gives them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from ..errors import InputError
from .moment import Cloud
from .slot import MOST_PARTICLES


def cloud_of(given: _core.ContactParticleFilter | _core.Particles | ArrayLike) -> Cloud:
    """Points and weights, at most `MOST_PARTICLES`: of more, some at even distances.

    Raises:
        InputError: they are no points.
    """
    if isinstance(given, _core.ContactParticleFilter):
        given = given.particles
    if isinstance(given, _core.Particles):
        points, weights = given.point, given.weight
        shares = weights / max(float(np.max(weights, initial=0.0)), np.finfo(float).tiny)
    else:
        try:
            points = np.array(given, dtype=np.float64)  # the loop may change its own
        except (TypeError, ValueError) as cause:
            raise InputError("particles: must be a filter, its particles, or points (n, 3)") from cause
        if points.ndim != 2 or points.shape[1] != 3:
            raise InputError(
                f"particles: must be a filter, its particles, or points (n, 3), not {points.shape}"
            )
        if not np.isfinite(points).all():
            raise InputError("particles: must be finite")
        shares = np.ones(len(points))
    if len(points) > MOST_PARTICLES:
        chosen = np.linspace(0, len(points) - 1, MOST_PARTICLES).astype(np.intp)
        points, shares = points[chosen], shares[chosen]
    return Cloud(points, shares)
