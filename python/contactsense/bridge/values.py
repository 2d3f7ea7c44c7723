"""What a bridge takes in and gives out, as plain values. Stamps are in nanoseconds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..offline.ros_messages import DIAGNOSTICS, JOINT_STATE, MARKERS, WRENCH, Colour

Row = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class JointReading:
    """A joint state as it came.

    Args:
        stamp: of the measurement; zero where the sender has no clock.
        names: of the joints, in the order of the numbers.
        position: [rad, m].
        velocity: [rad/s, m/s].
        effort: [Nm, N].
    """

    stamp: int
    names: tuple[str, ...]
    position: Row
    velocity: Row
    effort: Row


@dataclass(frozen=True, eq=False)
class ExternalTorque:
    """The external torque of the joints `(n,)` [Nm, N]."""

    stamp: int
    names: tuple[str, ...]
    torque: Row


@dataclass(frozen=True, eq=False)
class LinkWrench:
    """Force and moment of a contact on a link, at its origin and in its axes, `(6,)` [N, Nm]."""

    stamp: int
    link: str
    wrench: Row


@dataclass(frozen=True, eq=False)
class Drawing:
    """Something to be drawn, or to be removed.

    Args:
        namespace: with the number, what tells it apart.
        number: of the contact.
        shape: one of `Marker`; of what is removed, any.
        points: each `(3,)` in the world [m]; none where it is removed.
        scale: size, of the kind that the shape has [m].
        colour: red, green, blue and opacity.
        text: of a text.
    """

    namespace: str
    number: int
    shape: int
    points: Sequence[Row] = ()
    scale: tuple[float, float, float] = (0.0, 0.0, 0.0)
    colour: Colour = (0.0, 0.0, 0.0, 0.0)
    text: str = ""


@dataclass(frozen=True, eq=False)
class Drawings:
    """What is drawn anew in a frame; it disappears by itself after `lifetime` [ns]."""

    stamp: int
    frame: str
    lifetime: int
    drawings: tuple[Drawing, ...]


@dataclass(frozen=True, eq=False)
class Health:
    """How the bridge is: level 0 well, 1 a warning, 2 an error."""

    stamp: int
    level: int
    robot: str
    message: str
    values: Mapping[str, str] = field(default_factory=dict)


Output = ExternalTorque | LinkWrench | Drawings | Health
# A topic with what is published there.
Published = tuple[str, Output]
# The type of message that each becomes.
KINDS: Mapping[type[Output], str] = {
    ExternalTorque: JOINT_STATE,
    LinkWrench: WRENCH,
    Drawings: MARKERS,
    Health: DIAGNOSTICS,
}
