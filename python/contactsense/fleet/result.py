"""What became of each log of a fleet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, eq=False, repr=False)
class FleetReplay:
    """What became of each log that `replay_fleet` was given.

    Args:
        folder: of the data set.
        replayed: logs that were replayed now.
        unchanged: logs that the data set had already, with the same settings.
        failed: why a log could not be replayed, by log; the data set has nothing of these.
        damaged: where a log is broken, by log; the data set has what could be read of these.
        interrupted: whether Ctrl-C ended it; logs that are in none of the above are not in the data set.

    Raises:
        TypeError: an argument is missing.

    Example:
        >>> import contactsense as cs, pathlib
        >>> cs.FleetReplay(pathlib.Path("found"), (), (), {}, {}, False)
        FleetReplay(0 replayed, 0 unchanged, 0 failed)
    """

    folder: Path
    replayed: tuple[Path, ...]
    unchanged: tuple[Path, ...]
    failed: Mapping[Path, str]
    damaged: Mapping[Path, str]
    interrupted: bool

    def __repr__(self) -> str:
        counts = f"{len(self.replayed)} replayed, {len(self.unchanged)} unchanged, {len(self.failed)} failed"
        return f"FleetReplay({counts})"
