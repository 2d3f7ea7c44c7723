"""What one entry is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

# A program's JSON output, by the label of its settings, one a seed.
Raw = Mapping[str, Sequence[Any]]


@dataclass(frozen=True)
class Figure:
    """One table of figures and how it comes about."""

    name: str
    about: str  # one sentence
    command: tuple[str, ...]  # `{seed}` and `{data}` are filled in
    aggregation: str  # how the runs become the table
    page: str  # where the table stands
    reduce: Callable[[Raw], Any]  # what is kept of the output
    table: Callable[[Any], str]  # of what is kept, in Markdown
    # Further arguments by label; every label is run with each of its seeds.
    settings: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: {"": ()})
    seeds: Mapping[str, range] = field(default_factory=dict)
    # Takes more than five minutes on a core, or an idle machine: not run unless named.
    long: bool = False

    def commands(self, data: str = "DIR") -> dict[str, list[list[str]]]:
        """The command lines of every label, one a seed."""
        return {
            label: [
                [part.format(seed=seed, data=data) for part in (*self.command, *more)]
                for seed in self.seeds.get(label, range(1))
            ]
            for label, more in self.settings.items()
        }

    def described_commands(self) -> list[str]:
        """For people to read: one line a label, with the range of seeds."""
        lines = []
        for label, more in self.settings.items():
            seeds = self.seeds.get(label)
            shown = "" if seeds is None else str(seeds[0]) if len(seeds) == 1 else f"{seeds[0]}..{seeds[-1]}"
            lines.append(" ".join(part.format(seed=shown, data="DIR") for part in (*self.command, *more)))
        return lines
