"""docs/figures.json: what was run, when, on which machine, and the text that it gave."""

from __future__ import annotations

import json
from typing import Any

from .catalogue import BY_NAME, FIGURES, Figure
from .pages import ROOT, pages, places

RECORD = ROOT / "docs" / "figures.json"
Entry = dict[str, Any]


def read() -> dict[str, Entry]:
    """All entries by name."""
    entries: dict[str, Entry] = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    return entries


def write(entries: dict[str, Entry]) -> None:
    """Writes all entries, in the order of the catalogue."""
    ordered = {figure.name: entries[figure.name] for figure in FIGURES if figure.name in entries}
    RECORD.write_text(json.dumps(ordered, indent=1) + "\n", encoding="utf-8")


def entry(figure: Figure, text: str, recorded: Entry, runs: list[Entry]) -> Entry:
    """One entry."""
    return {
        "page": figure.page,
        "commands": [f"python {command}" for command in figure.commands],
        "seeds": list(figure.seeds),
        "aggregation": figure.aggregation,
        "recorded": recorded,
        "text": text,
        "runs": runs,
    }


def faults() -> list[str]:
    """What does not agree between catalogue, record and pages."""
    entries = read()
    found = []
    in_pages = {
        (str(page.relative_to(ROOT)), name): text for page in pages() for name, text in places(page).items()
    }
    for page, name in in_pages:
        if name not in BY_NAME or BY_NAME[name].page != page:
            found.append(f"{page}: the figure '{name}' is not in tools/figures/catalogue.py")
    for figure in FIGURES:
        text = in_pages.get((figure.page, figure.name))
        if text is None:
            found.append(f"{figure.page}: there is no place for the figure '{figure.name}'")
        elif figure.name not in entries:
            found.append(f"docs/figures.json: no entry '{figure.name}'")
        else:
            recorded = entries[figure.name]
            expected = entry(figure, text, recorded["recorded"], recorded["runs"])
            found += [
                f"{figure.page}, figure '{figure.name}': {key} differs from docs/figures.json"
                for key, value in expected.items()
                if recorded.get(key) != value
            ]
            if figure.text is not None and recorded["runs"] and figure.text(recorded["runs"]) != text:
                found.append(
                    f"{figure.page}, figure '{figure.name}': the text does not follow from the recorded runs"
                )
    return found
