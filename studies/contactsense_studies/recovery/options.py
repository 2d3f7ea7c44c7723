"""What is run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from typer import Option

from contactsense import InputError

from ..harness import check_counts
from .arms import ROBOTS, USUAL


@dataclass(frozen=True)
class Options:
    """Robots, counts and seed."""

    robots: Annotated[
        tuple[str, ...],
        Option(
            "--robots",
            help=f"One of {', '.join(ROBOTS)}; may be repeated (default: {', '.join(USUAL)}).",
        ),
    ] = ()
    runs: Annotated[
        int, Option(help="Number of arms of each robot and kind, each with errors of its own.")
    ] = 25
    seed: Annotated[int, Option(help="Seed of errors, payloads and noise.")] = 0

    def __post_init__(self) -> None:
        check_counts(self.seed, runs=self.runs)
        for name in self.robots:
            if name not in ROBOTS:
                raise InputError(f"robots: there is no '{name}'; there are {', '.join(ROBOTS)}")
