"""What is run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from typer import Option

from contactsense import InputError

from ..arm_options import ArmOptions
from ..harness import check_counts

NAMES = ("map", "filter", "sampler")


@dataclass(frozen=True)
class Options(ArmOptions):
    """Counts, bounds, seed, and the robot."""

    methods: Annotated[
        tuple[str, ...], Option("--method", help="map, filter or sampler; may be repeated (default: all).")
    ] = NAMES
    trials: Annotated[int, Option(help="Number of trials per link.")] = 20
    motions: Annotated[int, Option(help="Motions of a trial at most.")] = 12
    particles: Annotated[int, Option(help="Number of particles of filter and sampler.")] = 10_000
    max_force: Annotated[float, Option(help="Greatest force of a motion [N].")] = 60.0
    max_step: Annotated[float, Option(help="How far each joint moves at most [degrees].")] = 1.0
    seed: Annotated[int, Option(help="Seed of poses, points, motions, noise and particles.")] = 0

    def __post_init__(self) -> None:
        check_counts(self.seed, trials=self.trials, particles=self.particles, motions=self.motions)
        for name in self.methods:
            if name not in NAMES:
                raise InputError(f"methods: '{name}' is none of {', '.join(NAMES)}")
        for name, value in (("max_force", self.max_force), ("max_step", self.max_step)):
            if not value > 0.0:
                raise InputError(f"{name} must be positive, got {value}")
