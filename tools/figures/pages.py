"""Marked places in pages: `<!-- figure: NAME -->`, the text, `<!-- end -->`."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
PLACE = re.compile(r"(<!-- figure: (\w+) -->\n)(.*?)(<!-- end -->)", re.DOTALL)


def pages() -> list[Path]:
    """All pages that may hold figures."""
    return [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


def places(page: Path) -> dict[str, str]:
    """The text of every marked place of a page by its name."""
    return {name: text.strip() for _, name, text, _ in PLACE.findall(page.read_text(encoding="utf-8"))}


def write(page: Path, name: str, text: str) -> None:
    """Replaces the text of a marked place."""

    def replaced(match: re.Match[str]) -> str:
        return f"{match[1]}{text}\n{match[4]}" if match[2] == name else match[0]

    page.write_text(PLACE.sub(replaced, page.read_text(encoding="utf-8")), encoding="utf-8")
