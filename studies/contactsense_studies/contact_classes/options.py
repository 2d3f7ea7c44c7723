"""What is run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from typer import Option

from contactsense import InputError

from ..harness import check_counts
from .arms import ARMS


@dataclass(frozen=True)
class Options:
    """Arms, counts and seed."""

    arms: Annotated[
        tuple[str, ...],
        Option(
            "--arm",
            help=f"One of {', '.join(ARMS)}; may be repeated (default: those without weights of their own).",
        ),
    ] = ()
    scenes: Annotated[int, Option(help="Number of scenes per arm.")] = 130
    seed: Annotated[int, Option(help="Seed of errors, noise, motions and contacts.")] = 0

    def __post_init__(self) -> None:
        check_counts(self.seed, scenes=self.scenes)
        for name in self.arms:
            if name not in ARMS:
                raise InputError(f"arms: there is no '{name}'; there are {', '.join(ARMS)}")
