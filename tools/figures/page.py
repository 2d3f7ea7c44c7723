"""docs/figures.md, of all entries."""

from __future__ import annotations

from typing import Any

from .entries import FIGURES
from .entry import Figure

HEAD = """# Figures

Each table of measured figures, the command that measures it, and what it was measured with.
`python -m tools.figures run NAME` measures one anew; this page and the tables are written from
`docs/figures.json`. DIR holds the logs that `python -m contactsense_studies.franka_touch.convert` makes."""

# The site of the pages does not have what is outside their folder.
SOURCE = "https://github.com/contactsense/contactsense/blob/main/"


def render(records: dict[str, Any]) -> str:
    """The page."""
    parts = [HEAD, *(_section(figure, records[figure.name]) for figure in FIGURES if figure.name in records)]
    return "\n\n".join(parts) + "\n"


def _section(figure: Figure, record: dict[str, Any]) -> str:
    commands = "\n".join(f"    {line}" for line in figure.described_commands())
    parts = [f"## {figure.name}", f"{figure.about} {figure.aggregation}", commands]
    if figure.page == "docs/figures.md":
        parts.append(f"<!-- figures: {figure.name} -->\n{record['table']}\n<!-- end -->")
    else:
        link = figure.page.removeprefix("docs/") if figure.page.startswith("docs/") else SOURCE + figure.page
        parts.append(f"The table is in [{figure.page}]({link}).")
    parts.append(_provenance(record))
    return "\n\n".join(parts)


def _provenance(record: dict[str, Any]) -> str:
    if "recorded" in record:
        recorded = record["recorded"]
        oldest = recorded.get("oldest_row")
        since = f"; its oldest row, in commit {oldest['commit']} of {oldest['date']}" if oldest else ""
        return f"As recorded in commit {recorded['commit']} of {recorded['date']}{since}."
    about = record["measured"]["about"]
    versions = ", ".join(
        f"{key} {value}" for key, value in about.items() if key not in ("cpu", "cores", "system")
    )
    return (
        f"Measured on {record['measured']['date']} at commit {record['measured']['commit']}, {about['cpu']}, "
        f"{about['cores']} cores, {about['system']};\n{versions}."
    )
