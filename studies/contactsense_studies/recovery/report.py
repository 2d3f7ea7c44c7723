"""The study as tables."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from ..harness import print_tables, scaled, sheet
from .score import table
from .study import SECONDS, Study

NOTES = (
    "Each arm has errors of its own and an unknown payload,",
    f"and is calibrated once with {SECONDS:g} s of exciting motion.",
    "linear: masses, bias, friction and noise are off;",
    "typical: torque scales and hysteresis of the gears as well.",
    "Errors: median / 90th percentile of the size, found less true.",
    "Coulomb friction: as a share of the true one.",
    "%: share of the errors within 1.645 stated standard deviations,",
    "90 % where these are exact.",
)


def print_study(study: Study, console: Console) -> None:
    """All tables, and how to read them."""
    print_tables(console, [_of_joints(study), _of_payloads(study)], NOTES)
    for name, missing in study.skipped.items():
        console.print(f"{name} was skipped: {missing}", highlight=False, soft_wrap=True)


def _of_joints(study: Study) -> Table:
    shown = sheet("Joints", ("robot", "errors"), ("n", "bias mNm", "%", "Coulomb %", "%"))
    for (robot, kind), runs in study.found.items():
        of = table(runs)
        shown.add_row(robot, kind, str(len(runs)), *_both(of, "bias", 1e3), *_both(of, "coulomb", 100))
    return shown


def _of_payloads(study: Study) -> Table:
    shown = sheet("Payloads", ("robot", "errors"), ("n", "mass %", "%", "centre mm", "%"))
    for (robot, kind), runs in study.found.items():
        of = table(runs)
        shown.add_row(robot, kind, str(len(runs)), *_both(of, "mass", 100), *_both(of, "com", 1e3))
    return shown


def _both(of: dict[str, float], name: str, factor: float) -> tuple[str, str]:
    sizes = " / ".join(scaled(of[key], factor, 1) for key in (name, f"{name}_90"))
    return sizes, scaled(of[f"{name}_covered"], 100)
