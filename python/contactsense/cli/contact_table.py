"""The contacts of a log as a table."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from rich.table import Table
from rich.text import Text

from .._tables import number_text, plain_table
from ..offline import Replay, ReplayedContact

# Header, and whether the column is aligned to the right.
_COLUMNS = (
    ("id", True),
    ("from, to\n[s]", False),
    ("link", False),
    ("prob.\n[%]", True),
    ("point, link's\nframe [m]", False),
    ("90 %\n[cm]", True),
    ("located", False),
    ("peak\n[N]", True),
)
_NOTE = (
    "prob.: probability of the link. 90 %: radius about the point that holds 90 % of the posterior. "
    "peak: greatest force."
)
_CLASS_COLUMNS = (
    ("id", True),
    ("from, to\n[s]", False),
    ("kind", False),
    ("clamped\n[%]", True),
    ("transient\n[%]", True),
    ("sustained\n[%]", True),
    ("intended\n[%]", True),
)
_CLASS_NOTE = (
    "kind: the likeliest of clamped, transient and sustained, whose probabilities sum to 100 %. "
    "intended: probability that a person touches the robot on purpose."
)


def contact_table(name: str, result: Replay) -> Table:
    """One row a contact."""
    time = result.ticks["time"]
    seconds = float(time[-1] - time[0]) if len(time) else 0.0
    until = ", until it was interrupted" if result.interrupted else ""
    count = len(result.contacts)
    title = f"{name}: {count} contact{'' if count == 1 else 's'} in {seconds:.1f} s{until}"
    table = plain_table(title)
    table.caption, table.caption_justify = _NOTE, "left"
    _fill(table, _COLUMNS, map(_cells, result.contacts))
    return table


def class_table(result: Replay) -> Table:
    """What kind each contact is, with probabilities."""
    table = plain_table("Classes")
    table.caption, table.caption_justify = _CLASS_NOTE, "left"
    _fill(table, _CLASS_COLUMNS, map(_class_cells, result.contacts))
    return table


def _fill(table: Table, columns: Iterable[tuple[str, bool]], rows: Iterable[Sequence[str]]) -> None:
    for header, right in columns:
        table.add_column(Text(header), justify="right" if right else "left", no_wrap=True)
    for row in rows:
        table.add_row(*map(Text, row))


def _cells(contact: ReplayedContact) -> list[str]:
    point = contact.point_local
    place = " ".join(f"{value:.3f}" for value in point) if np.all(np.isfinite(point)) else "not determined"
    return [
        str(contact.id),
        _times(contact),
        contact.link,
        number_text(100.0 * contact.link_probability, 0),
        place,
        number_text(100.0 * contact.region_radius, 1),
        "yes" if contact.located else "no",
        number_text(contact.peak_force, 1),
    ]


def _class_cells(contact: ReplayedContact) -> list[str]:
    probabilities = (contact.clamped, contact.transient, contact.sustained, contact.intended)
    percent = [number_text(100.0 * each, 0) for each in probabilities]
    return [str(contact.id), _times(contact), contact.kind, *percent]


def _times(contact: ReplayedContact) -> str:
    return f"{contact.start:.2f} {contact.end:.2f}"
