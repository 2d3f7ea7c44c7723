"""From the joints of a message to the vectors of a robot."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..errors import InputError
from ..log.joint_columns import JointColumns
from ..log.joint_names import match
from .values import JointReading, Row

Places = NDArray[np.intp]

# As many orders of names are remembered; a topic has one a sender.
_MOST = 16
# No robot has as many joints: names of joints are compared in pairs, and what is longer is no joint state.
_MOST_NAMES = 256


class OtherJointsError(InputError):
    """A message has none of the robot's joints: it is of another device on the same topic."""


class MissingJointsError(InputError):
    """A message has some of the robot's joints, but not all."""

    def __init__(self, missing: list[str]) -> None:
        self.missing = missing
        super().__init__(f"name: joints are missing: {', '.join(missing)}")


class JointOrder:
    """Orders the numbers of messages, by the names in them.

    Attributes:
        names: of the robot's joints, in its own order.
    """

    def __init__(self, robot: _core.Robot) -> None:
        self._columns = JointColumns(robot)
        self.names: tuple[str, ...] = tuple(self._columns.names)
        self._known: dict[tuple[str, ...], Places | InputError] = {}
        self._senders: set[str] = set()  # names of joints in messages that had all

    def vectors(self, message: JointReading) -> tuple[Row, Row, Row]:
        """Configuration, velocity and effort.

        Raises:
            InputError: joints are missing, a field is empty, or has another size than the names.
        """
        places = self._known.get(message.names)
        if places is None:
            places = self._learn(message.names)
        if isinstance(places, InputError):
            raise places
        q = self._ordered("position", message.position, message, places)
        v = self._ordered("velocity", message.velocity, message, places)
        effort = self._ordered("effort", message.effort, message, places)
        columns = self._columns
        return columns.configuration(q)[0], columns.velocity(v)[0], columns.velocity(effort)[0]

    def one_each(self, name: str, values: float | list[float]) -> Row:
        """Numbers `(nv,)` of a parameter with one number, or one a joint in the order of `names`.

        Raises:
            InputError: there are more or fewer numbers than joints.
        """
        if isinstance(values, list) and len(values) != len(self.names):
            raise InputError(f"{name}: has {len(values)} numbers for {len(self.names)} joints")
        row: Row = self._columns.velocity(np.broadcast_to(values, (1, len(self.names))))[0]
        return row

    def torques(self, v: Row) -> Row:
        """One number a joint, in the order of `names`."""
        row: Row = self._columns.velocities(v[None])[0]
        return row

    def _ordered(self, field: str, values: Row, message: JointReading, places: Places) -> Row:
        if len(values) != len(message.names):
            if not len(values):
                raise InputError(f"{field}: is empty")
            raise InputError(f"{field}: has {len(values)} numbers for {len(message.names)} joints")
        return np.take(values, places)[None]

    def _learn(self, names: tuple[str, ...]) -> Places | InputError:
        """Remembers also what is wrong with names: it is the same with each message."""
        found = self._places(names)
        if len(self._known) >= _MOST:
            self._known.clear()
        self._known[names] = found
        return found

    def _places(self, names: tuple[str, ...]) -> Places | InputError:
        if len(names) > _MOST_NAMES:
            return InputError(f"name: there are {len(names)} joints; at most {_MOST_NAMES} are read")
        if len(set(names)) < len(names):
            return InputError("name: a joint stands there twice")
        found = match(self.names, names)
        if not found:
            return OtherJointsError("name: none of the robot's joints is there")
        missing = [name for name in self.names if name not in found]
        if missing:
            # Fingers may be called nearly as joints of the arm; those of the arm are known by now.
            is_other = self._senders and self._senders.isdisjoint(names)
            return OtherJointsError("name: is of other joints") if is_other else MissingJointsError(missing)
        if not self._senders:
            self._known.clear()
        elif len(self._senders) > _MOST_NAMES:
            self._senders.clear()
        self._senders.update(found.values())
        return np.array([names.index(found[name]) for name in self.names], dtype=np.intp)
