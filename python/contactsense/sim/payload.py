"""What an arm carries though its description does not know."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._arrays import positive, vector


@dataclass(frozen=True)
class Payload:
    """A body fixed to a link."""

    link: str
    mass: float  # [kg]
    com: tuple[float, ...]  # (3,) centre of mass, link frame [m]
    # (3, 3) about the centre of mass, link axes [kg m^2]; None: a point mass.
    inertia: tuple[tuple[float, ...], ...] | None = None

    def __post_init__(self) -> None:
        positive("payload.mass", self.mass)
        object.__setattr__(self, "com", tuple(vector("payload.com", self.com, 3).tolist()))
        if self.inertia is not None:
            rows = vector("payload.inertia", np.ravel(self.inertia), 9).reshape(3, 3).tolist()
            object.__setattr__(self, "inertia", tuple(tuple(row) for row in rows))
