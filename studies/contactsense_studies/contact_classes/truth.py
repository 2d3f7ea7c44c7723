"""What a contact was, from what happened in the simulation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .episode import DT, TOUCH, Episode, Scene

# A pause of the force that is shorter than this is part of one contact: a robot bounces, and comes back [s].
BRIDGED = 0.15
# A contact with something that gives way and ends within this is transient [s].
SHORT = 0.4
INTENDED = ("push", "lean", "lead", "tap")


@dataclass(frozen=True)
class Truth:
    """Of one contact."""

    scene: str
    kind: str  # clamped, transient, sustained
    intended: bool
    start: float  # [s]
    end: float  # [s]
    peak: float  # [N]


def truth_of(scene: Scene, episode: Episode) -> Truth | None:
    """None where nothing touched."""
    rows = np.flatnonzero(episode.force > TOUCH)
    if not len(rows):
        return None
    breaks = np.flatnonzero(np.diff(rows) > BRIDGED / DT)
    first, last = int(rows[0]), int(rows[breaks[0]] if len(breaks) else rows[-1])
    lasted = DT * (last - first)
    held = scene.kind in ("fixed", "held", "soft")
    if scene.kind == "tap":
        kind = "transient"
    elif scene.kind in INTENDED:
        kind = "sustained"
    elif lasted < SHORT and not (held and episode.retracts[first : last + 1].any()):
        kind = "transient"
    else:
        kind = "clamped" if held else "sustained"
    return Truth(
        scene.kind,
        kind,
        scene.kind in INTENDED,
        float(episode.time[first]),
        float(episode.time[last]),
        float(episode.force[first : last + 1].max()),
    )
