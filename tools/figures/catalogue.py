"""Every figure of README.md and docs/: command, seeds, aggregation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from . import render

# One command: its command line, its seed (None: it has no seed), and the JSON that it printed.
Run = dict[str, Any]


@dataclass(frozen=True)
class Figure:
    """A marked place in a page, and the commands behind it.

    A command is what follows the Python interpreter. `{seed}` stands for each seed, and `{data}` for the
    folder of the logs (docs/franka_logs.md). Without `text`, the results are recorded and the page is edited
    by hand.
    """

    name: str
    page: str
    commands: tuple[str, ...]
    aggregation: str
    seeds: tuple[int, ...] = ()
    text: Callable[[list[Run]], str] | None = None


CLI = "-m contactsense.cli"
NOISE = "--noise 2 0.1"

FIGURES = (
    Figure(
        "franka_touch",
        "README.md",
        (f"{CLI} study franka_touch --data {{data}} --json",),
        "contacts of the six logs that were not used to choose settings, pooled",
        text=render.franka_touch,
    ),
    Figure(
        "single_contacts",
        "README.md",
        (f"{CLI} study single_contacts --json", f"{CLI} study single_contacts --robot iiwa14 --json"),
        "sums over links; maximum of the point error; seed 0 is the default of the command",
        text=render.single_contacts,
    ),
    Figure(
        "demo_arm",
        "README.md",
        (f"{CLI} demo --seed {{seed}} --json", f"{CLI} demo {NOISE} --seed {{seed}} --json"),
        "all pushes of the seeds pooled; range of the delay, maximum of the errors of located points",
        seeds=(0, 1),
        text=render.demo,
    ),
    Figure(
        "demo_atlas",
        "README.md",
        (
            f"{CLI} demo --robot atlas --seed {{seed}} --json",
            f"{CLI} demo --robot atlas {NOISE} --sensor-noise 1 0.05 --seed {{seed}} --json",
        ),
        "all pushes of the seeds pooled; range of the delay, maximum of the errors of located points",
        seeds=tuple(range(201, 209)),
        text=render.demo,
    ),
    Figure(
        "vorndamme2017_summary",
        "README.md",
        (f"{CLI} study vorndamme2017 --json",),
        "counts over all scenes; seed 0 is the default of the command",
    ),
    Figure(
        "vorndamme2017",
        "docs/vorndamme2017.md",
        (f"{CLI} study vorndamme2017 --json",),
        "counts over all scenes; seed 0 is the default of the command",
    ),
    Figure(
        "bimbo2019_summary",
        "README.md",
        (f"{CLI} study bimbo2019 --seed {{seed}} --json",),
        "means and medians over the trials of a link",
        seeds=(1,),
    ),
    Figure(
        "bimbo2019",
        "docs/bimbo2019.md",
        (f"{CLI} study bimbo2019 --seed {{seed}} --json",),
        "means and medians over the trials of a link",
        seeds=(1,),
    ),
    Figure(
        "speed",
        "README.md",
        ("-m benches.compare --wall --json", "-m benches.compare noisy --json"),
        "median of the rounds of benches/compare; ratio of medians",
    ),
)
BY_NAME = {figure.name: figure for figure in FIGURES}
