"""What is run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from typer import Option

from contactsense import InputError

from ..arm_options import ArmOptions
from ..harness import check_counts
from .experiments import BY_NAME, Experiment


@dataclass(frozen=True)
class Options(ArmOptions):
    """Counts, seed, and the robot."""

    experiments: Annotated[
        tuple[str, ...],
        Option("--experiment", help=f"One of {', '.join(BY_NAME)}; may be repeated (default: all)."),
    ] = ()
    trials: Annotated[int, Option(help="Number of trials per link and experiment.")] = 5
    particles: Annotated[int, Option(help="Number of particles per filter.")] = 10_000
    seed: Annotated[int, Option(help="Seed of poses, points, motions, noise and filters.")] = 0

    def __post_init__(self) -> None:
        check_counts(self.seed, trials=self.trials, particles=self.particles)
        for name in self.experiments:
            if name not in BY_NAME:
                raise InputError(f"experiments: there is no '{name}'; there are {', '.join(BY_NAME)}")

    def chosen(self) -> tuple[Experiment, ...]:
        """The experiments that are run, in the order of the table."""
        return tuple(
            each for name, each in BY_NAME.items() if name in self.experiments or not self.experiments
        )
