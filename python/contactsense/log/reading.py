"""How a file became a log: what was chosen, what was mended, what is missing."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Reading:
    """How `read_log` read a file.

    Args:
        path: the file or folder.
        chosen: one line for each thing that was chosen: topics, columns, joints, units, time.
        mended: one line for each kind of fault in the rows that was mended, with how often: rows out of
            order, repeated rows, jumps of the clock, gaps, values that are missing.
        left_out: what the file has beside that.
        damage: where the file is broken, with what could be read nevertheless; empty for a whole file.

    Raises:
        TypeError: an argument is missing.

    Example:
        >>> import contactsense as cs
        >>> print(cs.Reading("a.csv", ("time from 't' [s]: 3 rows",), (), (), ()))
        a.csv
          read: time from 't' [s]: 3 rows
    """

    path: str
    chosen: tuple[str, ...]
    mended: tuple[str, ...]
    left_out: tuple[str, ...]
    damage: tuple[str, ...]

    def __str__(self) -> str:
        parts = [("read", self.chosen), ("mended", self.mended), ("left out", self.left_out)]
        parts.append(("damaged", self.damage))
        lines = [f"{title}: {line}" for title, them in parts for line in them]
        return "\n".join([self.path, *(f"  {line}" for line in lines)])
