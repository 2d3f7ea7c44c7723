"""Contacts as things to be drawn, and which of those before are to be removed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from .. import _core
from ..offline.ros_messages import NANOSECONDS, Colour, Marker
from .values import Drawing, Drawings, Row

# Size of what is drawn: a hundred newtons are a metre, a point is a ball of two centimetres [m].
METRES_PER_NEWTON = 0.01
_BALL = (0.02, 0.02, 0.02)
_ARROW = (0.01, 0.02, 0.0)
_TEXT = (0.0, 0.0, 0.05)
# A text stands so far above what it is about [m].
_ABOVE = np.array([0.0, 0.0, 0.08])
# What is not drawn anew disappears: of a bridge that has died, nothing stays [ns].
_LIFETIME = NANOSECONDS
# Links with less probability are not named.
_LIKELY = 0.05
_LOCATED: Colour = (0.9, 0.2, 0.1, 1.0)
_OPEN: Colour = (0.9, 0.7, 0.1, 1.0)
_NUMBERS = 1 << 31  # numbers of markers have 31 bits

Pose = Callable[[str], Row]


class Drawn:
    """Draws contacts at a limited rate, and at each beginning and end.

    Args:
        frame: of the markers: the world of the robot.
        rate: most times a second while contacts last.
    """

    def __init__(self, frame: str, rate: float) -> None:
        self._frame = frame
        self._between = 1.0 / rate
        self._last = -np.inf
        self._contacts: tuple[int | None, ...] = ()
        self._shown: frozenset[tuple[str, int]] = frozenset()

    def update(
        self, stamp: int, now: float, contacts: Sequence[_core.Contact], pose: Pose
    ) -> Drawings | None:
        """What is to be drawn, if anything is.

        Args:
            stamp: of the joint state.
            now: [s], of a clock that is never set.
            contacts: of the tick.
            pose: of a link, `(4, 4)`.
        """
        if not contacts and not self._contacts:
            return None
        numbers = tuple([contact.id for contact in contacts])
        if numbers == self._contacts and now - self._last < self._between:
            return None
        self._contacts, self._last = numbers, now
        new = [drawing for contact in contacts for drawing in drawings_of(contact, pose)]
        shown = frozenset((drawing.namespace, drawing.number) for drawing in new)
        gone = [Drawing(namespace, number, Marker.SPHERE) for namespace, number in self._shown - shown]
        self._shown = shown
        return Drawings(stamp, self._frame, _LIFETIME, (*gone, *new))


def drawings_of(contact: _core.Contact, pose: Pose) -> Iterator[Drawing]:
    """Of one contact: point, force and text; where it is not located, only the text, at the link."""
    number = (contact.id or 0) % _NUMBERS
    if not contact.located:
        place = pose(contact.link)[:3, 3] + _ABOVE
        yield Drawing("text", number, Marker.TEXT, [place], _TEXT, _OPEN, text_of(contact))
        return
    point, force = contact.point, contact.force
    yield Drawing("point", number, Marker.SPHERE, [point], _BALL, _LOCATED)
    if np.isfinite(force).all():
        ends = [point - METRES_PER_NEWTON * force, point]
        yield Drawing("force", number, Marker.ARROW, ends, _ARROW, _LOCATED)
    yield Drawing("text", number, Marker.TEXT, [point + _ABOVE], _TEXT, _LOCATED, text_of(contact))


def text_of(contact: _core.Contact) -> str:
    """What is known of a contact in a few words."""
    likely = sorted(contact.link_probabilities.items(), key=lambda item: -item[1])
    links = ", ".join(f"{link} {share:.0%}" for link, share in likely if share >= _LIKELY) or contact.link
    size = float(np.linalg.norm(contact.force))
    force = f", {size:.0f} N" if np.isfinite(size) else ""
    radius = contact.region_radius
    if contact.located:
        within = f", 90 % within {100.0 * radius:.0f} cm" if np.isfinite(radius) else ""
        return f"{contact.link}{force}{within}"
    spread = f", 90 % within {100.0 * radius:.0f} cm" if np.isfinite(radius) else ""
    return f"not located: {links}{force}{spread}"
