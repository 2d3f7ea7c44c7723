"""What is run."""

from __future__ import annotations

from dataclasses import dataclass

from ... import InputError
from .experiments import BY_NAME, Experiment


@dataclass(frozen=True)
class Options:
    """Counts, seeds, and the robot."""

    robot: str = "iiwa14"  # described in the package, or a URDF file
    package_dirs: tuple[str, ...] = ()
    trials: int = 5  # a link
    particles: int = 10_000
    seed: int = 0
    links: tuple[str, ...] = ()  # default: all that move and have a surface
    experiments: tuple[str, ...] = ()  # by name; default: all

    def __post_init__(self) -> None:
        for name in ("trials", "particles"):
            if getattr(self, name) < 1:
                raise InputError(f"{name}: must be at least 1, not {getattr(self, name)}")
        for name in self.experiments:
            if name not in BY_NAME:
                raise InputError(f"experiments: there is no '{name}'; there are {', '.join(BY_NAME)}")
        if self.seed < 0:
            raise InputError(f"seed: must not be negative, not {self.seed}")

    def chosen(self) -> tuple[Experiment, ...]:
        """The experiments that are run, in the order of the table."""
        return tuple(
            each for name, each in BY_NAME.items() if name in self.experiments or not self.experiments
        )
