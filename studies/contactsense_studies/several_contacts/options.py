"""What is run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from typer import Option

from contactsense import InputError

from ..harness import check_counts

METHODS = ("sampler", "filter")


@dataclass(frozen=True)
class Options:
    """Robot, numbers of contacts, noise and seed."""

    robot: Annotated[str, Option(help="A packaged arm, or atlas.")] = "iiwa14"
    method: Annotated[str, Option(help="sampler or filter.")] = "sampler"
    contacts: Annotated[
        tuple[int, ...], Option("--contacts", help="Contacts at the same time; may be repeated.")
    ] = (1, 2)
    links: Annotated[
        tuple[str, ...],
        Option("--link", help="Link that may be touched; may be repeated (default: all but legs)."),
    ] = ()
    trials: Annotated[int, Option(help="Number of trials for each number of contacts.")] = 20
    poses: Annotated[int, Option(help="Poses of a trial.")] = 40
    particles: Annotated[
        int,
        Option(help="Number of particles for each number of contacts (sampler) or each contact (filter)."),
    ] = 10_000
    max_contacts: Annotated[int, Option(help="Contacts that are looked for at most.")] = 3
    friction: Annotated[float, Option(help="Coefficient of friction, which is told.")] = 0.0
    percent: Annotated[float, Option(help="Noise of each torque in proportion to it [%].")] = 3.0
    newton_metres: Annotated[float, Option(help="Noise of each torque at rest [Nm].")] = 0.02
    seed: Annotated[int, Option(help="Seed of poses, contacts, motions, noise and particles.")] = 0

    def __post_init__(self) -> None:
        check_counts(self.seed, trials=self.trials, particles=self.particles, poses=self.poses)
        if self.method not in METHODS:
            raise InputError(f"method must be one of {', '.join(METHODS)}, got {self.method!r}")
        if not self.contacts or any(not 1 <= number <= self.max_contacts for number in self.contacts):
            raise InputError(f"contacts must be from 1 to max_contacts, which is {self.max_contacts}")
        for name, value in (
            ("friction", self.friction),
            ("percent", self.percent),
            ("newton_metres", self.newton_metres),
        ):
            if not value >= 0.0:
                raise InputError(f"{name} must be zero or positive, got {value}")
