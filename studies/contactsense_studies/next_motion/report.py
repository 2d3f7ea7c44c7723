"""The study as a table."""

from __future__ import annotations

import math

from rich.console import Console
from rich.table import Table

from ..harness import print_tables, scaled, sheet
from .score import score
from .study import Study, wanted
from .touched import NOISE
from .trial import CLOSE, WAYS

NOTES = (
    "An arm leans on a sphere and moves a little, until the point is known.",
    f"motions: median until the point is within {CLOSE * 100:g} cm; never: not within the most motions.",
    "map: the last pose alone; filter: forgets; sampler: remembers.",
    "chosen: by `next_motion`, from what the method knows; random: the true contact and force are kept.",
    "lost: trials in which the contact ended, or another link touched. N: the greatest force.",
)


def print_study(study: Study, console: Console) -> None:
    """A row a link and method, and how to read them."""
    print_tables(console, [_table(study)], NOTES)


def _table(study: Study) -> Table:
    options, (percent, newton_metres) = study.options, NOISE
    noise = f"noise of {percent:g} % and {newton_metres:g} Nm"
    title = f"{options.robot}, motions of {options.max_step:g} degrees, {noise}"
    shown = sheet(title, ("link", "method", "motion"), ("n", "motions", "never", "lost", "N"))
    for link in study.links:
        for method in wanted(options):
            for way in WAYS:
                of = score(study.outcomes(link, method.name, way))
                if not of.trials:
                    continue
                motions = shown_motions(of.motions, options.motions)
                shares = (scaled(of.never, 100), scaled(of.lost, 100))
                row = (str(of.trials), motions, *shares, scaled(of.greatest_force, 1.0))
                shown.add_row(link, method.name, way, *row)
    return shown


def shown_motions(motions: float, most: int) -> str:
    """A median number of motions."""
    return f"{motions:g}" if math.isfinite(motions) else f"> {most}"
