"""Names and numbers as the tables state them."""

from __future__ import annotations

import numpy as np

from .instruments import Method

NAMES: dict[Method, str] = {
    "torques": "torques",
    "distal": "+ 4",
    "both": "+ 9",
    "sensors": "9 alone",
}


def percent(share: float) -> str:
    """In %, rounded so that only all is 100 and only none is 0."""
    if np.isnan(share):
        return "-"
    if share in (0.0, 1.0):
        return f"{100 * share:.0f}"
    return f"{min(max(100 * share, 0.01), 99.99):.{1 if 0.001 <= share <= 0.999 else 2}f}"
