"""Tables between comment marks, and numbers outside them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

MARKED = re.compile(r"<!-- figures: (\w+) -->\n(.*?)\n?<!-- end -->", re.DOTALL)
CODE = re.compile(r"^```.*?^```$|^    .*$", re.MULTILINE | re.DOTALL)
SECTION = re.compile(r"^## Figures\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
# A result: a number with a unit, or a count out of another.
STATED = re.compile(
    r"(?<![\w.])(\d[\d,.]*)(?: ?(?:%|ms|us|mm|cm|nm)(?!\w)|(?= (?:of|/) \d)|(?=(?: points)? exact\b))"
)


def tables(text: str) -> dict[str, str]:
    """The marked tables of a page by name."""
    return {found[1]: found[2] for found in MARKED.finditer(text)}


def numbers(table: str) -> list[str]:
    """The numbers of a table, without its header and the labels of its rows."""
    cells = [cell for row in table.splitlines()[2:] for cell in row.split("|")[2:]]
    return [number for cell in cells for number in re.findall(r"\d[\d.,]*", cell)]


def replaced(text: str, name: str, table: str) -> str:
    """The page with another table between these marks."""

    def fill(found: re.Match[str]) -> str:
        return found[0] if found[1] != name else f"<!-- figures: {name} -->\n{table}\n<!-- end -->"

    return MARKED.sub(fill, text)


def stated(text: str) -> Iterator[str]:
    """Figures in the prose of sections named Figures, with what stands beside them."""
    for section in SECTION.findall(text):
        prose = CODE.sub("", MARKED.sub("", section))
        for found in STATED.finditer(prose):
            yield found[1].rstrip(".,")


def unrecorded(page: Path, known: Iterable[str]) -> list[str]:
    """Figures of a page's prose that are in none of the known texts."""
    everything = " ".join(known)
    text = page.read_text(encoding="utf-8")
    return [
        each for each in stated(text) if not re.search(rf"(?<![\d.]){re.escape(each)}(?![\d])", everything)
    ]
