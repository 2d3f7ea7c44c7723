"""Names of links, short."""

from __future__ import annotations

from collections.abc import Sequence


def short(link: str, links: Sequence[str]) -> str:
    """Without a first word that all names share."""
    shared = len({each.partition("_")[0] for each in links}) == 1
    return link.partition("_")[2] or link if shared else link
