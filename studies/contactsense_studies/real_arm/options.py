"""What is run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from typer import Option

from contactsense import InputError

from ..harness import check_counts
from .arms import ARMS

# What `calibrate` needs, and what shows anything of a monitor [s].
_SHORTEST = {"calibration_seconds": 10, "free_seconds": 10}


@dataclass(frozen=True)
class Options:
    """Arms, counts, times and seed."""

    arms: Annotated[
        tuple[str, ...],
        Option("--arm", help=f"One of {', '.join(ARMS)}; may be repeated (default: all that are installed)."),
    ] = ()
    trials: Annotated[int, Option(help="Number of arms of each kind, each with errors of its own.")] = 3
    contacts: Annotated[int, Option(help="Number of contacts per trial.")] = 60
    calibration_seconds: Annotated[
        int, Option(help="Contact-free motion for the calibration, and as much for thresholds, in s.")
    ] = 60
    free_seconds: Annotated[int, Option(help="Contact-free motion per trial that is judged, in s.")] = 240
    seed: Annotated[int, Option(help="Seed of errors, noise, motions and contacts.")] = 0

    def __post_init__(self) -> None:
        check_counts(self.seed, trials=self.trials, contacts=self.contacts)
        for name, least in _SHORTEST.items():
            if getattr(self, name) < least:
                raise InputError(f"{name}: must be at least {least} s, not {getattr(self, name)}")
        for name in self.arms:
            if name not in ARMS:
                raise InputError(f"arms: there is no '{name}'; there are {', '.join(ARMS)}")
