"""What a fleet has felt as tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.table import Table
from rich.text import Text

from .._tables import number_text, plain_table
from ..fleet.summary import LinkSummary, RobotSummary


def robot_table(name: str, robots: Iterable[RobotSummary]) -> Table:
    """One row a robot."""
    header = ("robot", "logs", "time\n[h]", "contacts", "contacts\nan hour", "in contact\n[%]")
    rows = [
        (
            robot.robot,
            str(robot.logs),
            f"{robot.hours:.2f}",
            str(robot.contacts),
            f"{robot.contacts / robot.hours:.1f}",
            f"{100.0 * robot.in_contact:.1f}",
        )
        for robot in robots
    ]
    return _table(f"{name}: robots", header, rows, texts=1)


def link_table(links: Iterable[LinkSummary]) -> Table:
    """One row a robot and link."""
    header = ("robot", "link", "contacts", "contacts\nan hour", "located\n[%]", "median\npeak [N]")
    rows = [
        (
            link.robot,
            link.link,
            str(link.contacts),
            f"{link.an_hour:.1f}",
            f"{100.0 * link.located:.0f}",
            number_text(link.peak_force, 1),
        )
        for link in links
    ]
    return _table("Links", header, rows, texts=2)


def _table(title: str, header: Sequence[str], rows: Iterable[Sequence[str]], texts: int) -> Table:
    """The first columns are text, the others numbers."""
    table = plain_table(title)
    for k, name in enumerate(header):
        table.add_column(Text(name), justify="left" if k < texts else "right", no_wrap=True)
    for row in rows:
        table.add_row(*map(Text, row))
    return table
