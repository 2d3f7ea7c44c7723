"""What is run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from typer import Option

from contactsense import InputError

from ..harness import check_counts
from .experiments import BY_NAME, Experiment


@dataclass(frozen=True)
class Options:
    """Counts, seed, and the robot."""

    robot: Annotated[str, Option(help="A packaged arm, or a URDF file.")] = "iiwa14"
    package_dirs: Annotated[
        tuple[str, ...], Option("--package-dir", help="Folder for `package://` names; may be repeated.")
    ] = ()
    links: Annotated[
        tuple[str, ...], Option("--link", help="Link in contact; may be repeated (default: all that move).")
    ] = ()
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
