"""The study as tables."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from ..harness import print_tables, scaled, sheet
from .score import ALL, NEAR, links
from .study import Study

NOTES = (
    "std: standard deviation of the point of a contact on the link: median, and 90th percentile, over the",
    f"link's surface and all poses. in {100 * NEAR:g} cm: share of the surface with at most that.",
    "rank: unknowns of the five (three of the force, two of the point) that torques without noise determine;",
    "the most frequent. detected: share where the torque of the normal force is greater than the noise",
    "without contact is in 99 % of cases. Links that no joint moves are not listed.",
    "all: of all samples, of which small links have more than their share in the surface.",
)


def print_study(study: Study, console: Console) -> None:
    """All tables, and how to read them."""
    options = study.options
    about = (
        f"Contacts of {options.force:g} N; noise of {options.torque_noise:g} Nm and "
        f"{100 * options.relative_noise:g} % of the contact's torque; friction {options.friction:g}."
    )
    print_tables(console, [_table(study, name) for name in study.robots], (about, *NOTES))


def _table(study: Study, name: str) -> Table:
    count = len(study.of(name))
    table = sheet(
        f"{study.robot(name).name}, {'one pose' if count == 1 else f'{count} poses'}",
        ("link",),
        ("samples", "std\ncm", "90 %\ncm", f"in {100 * NEAR:g} cm\n%", "\nrank", "detected\n%"),
    )
    for score in links(study.of(name)):
        if score.link == ALL:
            table.add_section()
        table.add_row(
            score.link,
            str(score.samples),
            scaled(score.point_std, 100, 1),
            scaled(score.point_std_90, 100, 1),
            scaled(score.near, 100),
            str(score.rank),
            scaled(score.detectable, 100),
        )
    return table
