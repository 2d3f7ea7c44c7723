"""What is run."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from typer import Option

from contactsense import InputError

from ..harness import check_counts


@dataclass(frozen=True)
class Options:
    """Robots, poses, contacts, noise and seed."""

    robots: Annotated[
        tuple[str, ...],
        Option("--robot", help="A packaged robot, or a URDF file; may be repeated (default: iiwa14, atlas)."),
    ] = ()
    package_dirs: Annotated[
        tuple[str, ...],
        Option("--package-dir", help="Folder for `package://` names of URDF files; may be repeated."),
    ] = ()
    floating_base: Annotated[
        bool, Option("--floating-base", help="The bases of the URDF files move freely.")
    ] = False
    poses: Annotated[int, Option(help="Number of random poses of each robot.")] = 20
    q: Annotated[
        str | None,
        Option("--q", help="One pose in place of random ones: numbers with commas between; for one robot."),
    ] = None
    force: Annotated[float, Option(help="Normal force of the contacts, in N.")] = 10.0
    torque_noise: Annotated[
        float, Option(help="Standard deviation of each torque without contact, in Nm (N of a base's force).")
    ] = 0.1
    relative_noise: Annotated[
        float, Option(help="Standard deviation of each torque as a share of the contact's own.")
    ] = 0.03
    friction: Annotated[float, Option(help="Coefficient of friction.")] = 0.5
    samples: Annotated[int, Option(help="Number of points on the surface of each robot.")] = 5000
    seed: Annotated[int, Option(help="Seed of the poses.")] = 0

    def __post_init__(self) -> None:
        check_counts(self.seed, poses=self.poses, samples=self.samples)
        for name, least in (
            ("force", "positive"),
            ("torque_noise", "positive"),
            ("relative_noise", "zero or more"),
        ):
            value = getattr(self, name)
            if not math.isfinite(value) or value < 0.0 or (value == 0.0 and least == "positive"):
                raise InputError(f"{name}: must be {least} and finite, not {value}")
        if self.q is not None:
            if len(self.robots) != 1:
                raise InputError("q: is for one robot; name it with --robot")
            try:
                self.configuration()
            except ValueError as cause:
                raise InputError(f"q: must be numbers with commas between, not '{self.q}'") from cause

    def configuration(self) -> tuple[float, ...] | None:
        """The pose given, if one is."""
        return None if self.q is None else tuple(float(number) for number in self.q.split(","))
