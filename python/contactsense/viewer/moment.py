"""What a page shows of one instant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .. import _core

Rows = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Touch:
    """One contact.

    Args:
        link: the likeliest one.
        probability: of that link.
        located: whether 90 % of the posterior are near the point.
        point: `(3,)`, world frame [m]; NaN where it is not known.
        force: `(3,)`, world frame [N]; NaN where it is not known.
        region_radius: of the ball about the point that holds 90 % of the posterior [m].
    """

    link: str
    probability: float
    located: bool
    point: Rows
    force: Rows
    region_radius: float


@dataclass(frozen=True, eq=False)
class Cloud:
    """Points on the robot.

    Args:
        points: `(n, 3)`, world frame [m].
        shares: `(n,)`, the likelihood or weight of each, as a share of the greatest.
    """

    points: NDArray[np.floating]
    shares: NDArray[np.floating]


NOWHERE = Cloud(np.zeros((0, 3)), np.zeros(0))
NO_WRENCHES = np.zeros((0, 6))


@dataclass(frozen=True, eq=False)
class Moment:
    """One instant.

    Args:
        q: `(nq,)`, configuration.
        touches: the contacts.
        posterior: where a single contact can be.
        particles: of a particle filter.
        wrenches: `(n_sensors, 6)`, the external wrench that each sensor sees, at its origin, world axes
            [N, Nm]; NaN where it has no reading.
    """

    q: Rows
    touches: tuple[Touch, ...]
    posterior: Cloud = NOWHERE
    particles: Cloud = NOWHERE
    wrenches: Rows = field(default_factory=lambda: NO_WRENCHES)

    def told(self, sensors: Sequence[_core.ForceTorqueSensor]) -> str:
        """Contacts and sensors as a list, in Markdown."""
        lines = []
        for touch in self.touches:
            size = float(np.linalg.norm(touch.force))
            force = f", {size:.1f} N" if np.isfinite(size) else ""
            share = f" ({100.0 * touch.probability:.0f} %)" if np.isfinite(touch.probability) else ""
            lines.append(f"- {touch.link}{share}{force}, {'located' if touch.located else 'not located'}")
        lines = lines or ["- no contact"]
        for sensor, wrench in zip(sensors, self.wrenches, strict=True):
            sizes = np.linalg.norm(wrench[:3]), np.linalg.norm(wrench[3:])
            known = f"{sizes[0]:.1f} N, {sizes[1]:.1f} Nm" if np.all(np.isfinite(sizes)) else "no reading"
            lines.append(f"- sensor {sensor.name}: {known}")
        return "\n".join(lines)


def posterior_of(found: _core.MapEstimate) -> Cloud:
    """The places of a map."""
    greatest = np.max(found.log_posterior, initial=-np.inf)
    return Cloud(found.points, np.exp(found.log_posterior - greatest))
