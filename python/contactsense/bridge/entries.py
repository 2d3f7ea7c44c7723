"""The entries of a YAML mapping; what is missing, wrong or left over is refused by name."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any, Literal

from ..errors import InputError

Rule = Literal["any", "not negative", "positive", "not zero"]

# Which YAML 1.1 takes for a text, as it has no point.
_EXPONENT = re.compile(r"[-+]?\d+[eE][-+]?\d+")
_WANTED = {
    "any": "a finite number",
    "not negative": "a finite number that is not negative",
    "positive": "a positive number",
    "not zero": "a finite number other than zero",
}


class Entries:
    """A mapping of a file.

    Args:
        where: the file and the entries that lead to the mapping, for messages.
        value: what the file has there.
    """

    def __init__(self, where: str, value: Any) -> None:
        self._where = where
        if not isinstance(value, dict):
            raise self.wrong("must be a mapping of names to values", value)
        for key in value:
            if not isinstance(key, str):
                raise InputError(f"{where}: the name {key!r} must be a text; put it in quotes")
        self._left = dict(value)
        self._known: list[str] = []

    def names(self) -> list[str]:
        """What is left."""
        return list(self._left)

    def missing(self, what: str) -> InputError:
        """The error for something that is not there."""
        return InputError(f"{self._where}: {what} is missing")

    def wrong(self, problem: str, value: Any) -> InputError:
        """The error for a value of this mapping."""
        shown = repr(value)
        return InputError(f"{self._where}: {problem}, not {shown if len(shown) < 60 else shown[:60] + '...'}")

    def take(self, name: str, wanted: str) -> Any:
        """The value of an entry."""
        self._known.append(name)
        if name not in self._left:
            raise self.missing(f"{name} ({wanted})")
        return self._left.pop(name)

    def inner(self, name: str) -> Entries:
        """An entry that is a mapping."""
        return Entries(f"{self._where}: {name}", self.take(name, "a mapping of names to values"))

    def text(self, name: str) -> str:
        """An entry that is a text."""
        value = self.take(name, "a text")
        if not isinstance(value, str):
            raise self._of(name).wrong("must be a text, in quotes if need be", value)
        return value

    def flag(self, name: str) -> bool:
        """An entry that is true or false."""
        value = self.take(name, "true or false")
        if not isinstance(value, bool):
            raise self._of(name).wrong("must be true or false", value)
        return value

    def number(self, name: str, unit: str, rule: Rule = "any") -> float:
        """An entry that is a number."""
        wanted = f"{_WANTED[rule]} [{unit}]"
        return self._number(name, self.take(name, wanted), wanted, rule)

    def listed(self, name: str, value: Any, count: int, unit: str, rule: Rule = "any") -> list[float]:
        """A value that is a list of so many numbers."""
        if not isinstance(value, list) or len(value) != count:
            raise self._of(name).wrong(f"must be a list of {count} numbers [{unit}]", value)
        return [self._number(name, item, f"{_WANTED[rule]} [{unit}]", rule) for item in value]

    def items(self, name: str, wanted: str) -> Iterator[tuple[str, Any]]:
        """The items of an entry that is a list, each with a name for messages."""
        value = self.take(name, f"a list of {wanted}, or []")
        if not isinstance(value, list):
            raise self._of(name).wrong(f"must be a list of {wanted}", value)
        return ((f"{name}[{index}]", item) for index, item in enumerate(value))

    def texts(self, name: str, wanted: str) -> list[str]:
        """An entry that is a list of texts."""
        found = []
        for where, item in self.items(name, wanted):
            if not isinstance(item, str):
                raise self._of(where).wrong("must be a text, in quotes if need be", item)
            found.append(item)
        return found

    def done(self) -> None:
        """Refuses what nobody took."""
        if self._left:
            known = ", ".join(self._known)
            raise InputError(
                f"{self._where}: there is no entry {next(iter(self._left))!r}; there are {known}"
            )

    def _of(self, name: str) -> Entries:
        return Entries(f"{self._where}: {name}", {})

    def _number(self, name: str, value: Any, wanted: str, rule: Rule) -> float:
        if isinstance(value, str) and _EXPONENT.fullmatch(value):
            value = float(value)
        if isinstance(value, bool) or not isinstance(value, int | float) or not _usable(value, rule):
            raise self._of(name).wrong(f"must be {wanted}", value)
        return float(value)


def _usable(value: float, rule: Rule) -> bool:
    try:
        number = float(value)
    except OverflowError:
        return False
    allowed = {
        "any": True,
        "not negative": number >= 0.0,
        "positive": number > 0.0,
        "not zero": number != 0.0,
    }
    return math.isfinite(number) and allowed[rule]
