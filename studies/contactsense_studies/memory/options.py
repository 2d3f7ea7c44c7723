"""What is run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from typer import Option

from contactsense import InputError

from ..arm_options import ArmOptions
from ..harness import check_counts


@dataclass(frozen=True)
class Options(ArmOptions):
    """Counts, seed, and the robot."""

    trials: Annotated[int, Option(help="Number of trials per link.")] = 20
    particles: Annotated[int, Option(help="Number of particles of filter and sampler.")] = 10_000
    friction: Annotated[float, Option(help="Coefficient of friction, which all are told.")] = 0.0
    imperfect: Annotated[
        bool, Option("--imperfect", help="With the errors of a real arm, which is calibrated before.")
    ] = False
    seed: Annotated[int, Option(help="Seed of poses, points, motions, noise and particles.")] = 0

    def __post_init__(self) -> None:
        check_counts(self.seed, trials=self.trials, particles=self.particles)
        if not self.friction >= 0.0:
            raise InputError(f"friction must be zero or positive, got {self.friction}")

    def noises(self) -> tuple[float, ...]:
        """Noise of each external torque, of which nothing is said [%]: three are granted by default."""
        return (0.0,) if self.imperfect else (0.0, 5.0, 10.0)

    def title(self, noise: float) -> str:
        """What the torques err by, in words."""
        return "Errors of a real arm, calibrated" if self.imperfect else f"Noise of {noise:g} %"
