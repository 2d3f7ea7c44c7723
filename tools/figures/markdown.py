"""Tables and numbers as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table with a header."""
    head, *body = ("|" + "".join(f" {cell} |" if cell else " |" for cell in line) for line in (header, *rows))
    return "\n".join([head, "|" + "---|" * len(header), *body])


def number(value: float, digits: int = 2) -> str:
    """Rounded to so many significant digits, without an exponent."""
    rounded = float(f"{value:.{digits}g}")
    return f"{rounded:.{max(0, digits - 1 - _exponent(rounded))}f}" if rounded else "0"


def _exponent(value: float) -> int:
    return int(f"{value:e}".split("e")[1])


def percent(share: float) -> str:
    """A share in whole percent."""
    return f"{100 * share:.0f} %"
