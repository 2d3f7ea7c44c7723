"""What is run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from typer import Option

from contactsense import InputError

from ..harness import check_counts


@dataclass(frozen=True)
class Options:
    """Counts, seed, and how contacts are drawn."""

    singles: Annotated[int, Option(help="Number of scenes with one contact.")] = 3000
    pairs: Annotated[
        int, Option(help="Number of scenes with two contacts, drawn by links and again by area.")
    ] = 5000
    fives: Annotated[int, Option(help="Number of scenes with five contacts.")] = 5000
    hits: Annotated[int, Option(help="Number of scenes with one contact that are also run over time.")] = 100
    seed: Annotated[int, Option(help="Seed of points, forces, poses and noise.")] = 0
    noise: Annotated[float, Option(help="Relative noise of the runs with noise.")] = 0.01
    cone: Annotated[
        float, Option(help="Greatest angle between the force and the inward normal, in degrees.")
    ] = 30.0
    random_poses: Annotated[
        bool, Option("--random-poses", help="Draw random poses instead of the standing one.")
    ] = False

    def __post_init__(self) -> None:
        check_counts(self.seed, singles=self.singles, pairs=self.pairs, fives=self.fives, hits=self.hits)
        if not 0.0 < self.noise < 1.0:
            raise InputError(f"noise: must be between 0 and 1 (relative), not {self.noise}")
        if not 0.0 < self.cone < 90.0:
            raise InputError(f"cone: must be between 0 and 90 degrees, not {self.cone:g}")
