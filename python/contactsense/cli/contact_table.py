"""The contacts of a log as a table."""

from __future__ import annotations

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


def contact_table(name: str, result: Replay) -> Table:
    """One row a contact."""
    time = result.ticks["time"]
    seconds = float(time[-1] - time[0]) if len(time) else 0.0
    until = ", until it was interrupted" if result.interrupted else ""
    count = len(result.contacts)
    title = f"{name}: {count} contact{'' if count == 1 else 's'} in {seconds:.1f} s{until}"
    table = plain_table(title)
    table.caption, table.caption_justify = _NOTE, "left"
    for header, right in _COLUMNS:
        table.add_column(Text(header), justify="right" if right else "left", no_wrap=True)
    for contact in result.contacts:
        table.add_row(*_cells(contact))
    return table


def _cells(contact: ReplayedContact) -> list[Text]:
    point = contact.point_local
    place = " ".join(f"{value:.3f}" for value in point) if np.all(np.isfinite(point)) else "not determined"
    cells = [
        str(contact.id),
        f"{contact.start:.2f} {contact.end:.2f}",
        contact.link,
        number_text(100.0 * contact.link_probability, 0),
        place,
        number_text(100.0 * contact.region_radius, 1),
        "yes" if contact.located else "no",
        number_text(contact.peak_force, 1),
    ]
    return [Text(cell) for cell in cells]
