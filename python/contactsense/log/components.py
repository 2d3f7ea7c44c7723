"""Names of columns that are the components of a force, a pose or a velocity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from .joint_names import Tokens, words

_AXES = "xyz"
# Digits of a number: one with more counts no components.
DIGITS = 9


@dataclass(frozen=True)
class Kind:
    """A quantity of several components.

    Args:
        name: for messages.
        order: the components.
        phrases: the component that words of a name mean.
        numbered: words after which numbers from 0 on are the components in order.
    """

    name: str
    order: tuple[str, ...]
    phrases: Mapping[Tokens, str]
    numbered: frozenset[str] = frozenset()

    @cached_property
    def _telling(self) -> frozenset[str]:
        """The first words of all phrases, of which a name has one: most columns of a log have none."""
        return self.numbered | {phrase[0] for phrase in self.phrases}

    def component(self, name: Tokens) -> tuple[str, Tokens, Tokens] | None:
        """The component that a name tells, and the words of the name before and after."""
        if self._telling.isdisjoint(name):
            return None
        if len(name) > 1 and name[-1].isdecimal() and len(name[-1]) <= DIGITS:
            number = int(name[-1])
            if name[-2] in self.numbered and number < len(self.order):
                return self.order[number], name[:-1], ()
            if number < len(_AXES):  # of an array of a vector
                axis = (*name[:-1], _AXES[number])
                for first in range(len(name) - 1):
                    if axis[first:] in self.phrases:
                        return self.phrases[axis[first:]], name[:first], ()
        for length in range(max(map(len, self.phrases)), 0, -1):
            for first in range(len(name) - length, -1, -1):
                found = self.phrases.get(name[first : first + length])
                if found is not None:
                    return found, name[:first], name[first + length :]
        return None


def phrases(**parts: str) -> dict[Tokens, str]:
    """Of `fx="f, force"`: which words mean the component `fx`, both as `force x` and as `fx`.

    The last letter of a component is its axis. A vector without a name, written as "-", is the axis alone.
    """
    found: dict[Tokens, str] = {}
    for part, vectors in parts.items():
        axis = part[-1]
        for vector in vectors.split(","):
            before = words(vector)
            found[(*before, axis)] = part
            if len(before) == 1 and len(before[0]) == 1:
                found[before[0] + axis,] = part
    return found


_FORCE, _MOMENT = "force, f, frc", "torque, moment, t, m, tau, trq"
WRENCH = Kind(
    "wrench",
    ("fx", "fy", "fz", "mx", "my", "mz"),
    phrases(fx=_FORCE, fy=_FORCE, fz=_FORCE, mx=_MOMENT, my=_MOMENT, mz=_MOMENT),
    frozenset({"wrench", "ft", "fts"}),
)
