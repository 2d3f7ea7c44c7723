"""The one style of tables on the terminal."""

from __future__ import annotations

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.table import Table


def plain_table(title: str | None) -> Table:
    """A table without rows and columns: a bold title and header, and a line below the header."""
    return Table(
        title=title,
        title_justify="left",
        title_style="bold",
        box=SIMPLE_HEAD,
        header_style="bold",
        pad_edge=False,
        padding=(0, 1, 0, 0),
    )


def number_text(value: float, digits: int) -> str:
    """A number with so many decimals; a dash where it is not known."""
    return f"{value:.{digits}f}" if np.isfinite(value) else "-"
