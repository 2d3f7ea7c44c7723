"""The command line."""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

from . import marks, page, record
from .entries import BY_NAME, FIGURES
from .entry import Figure

PAGE = record.ROOT / "docs" / "figures.md"


def pages() -> list[Path]:
    """All pages that may state figures."""
    return [record.ROOT / "README.md", *sorted((record.ROOT / "docs").glob("*.md"))]


def run(figures: list[Figure], data: str | None) -> None:
    """Measures, one after the other; each result is saved at once. No command is run twice."""
    printed: dict[tuple[str, ...], Any] = {}
    for figure in figures:
        if any("{data}" in part for part in figure.command) and data is None:
            print(f"{figure.name}: left out; needs --data", file=sys.stderr)
            continue
        about = record.measured()
        raw: dict[str, list[Any]] = {}
        for label, commands in figure.commands(str(Path(data or "").resolve())).items():
            with tempfile.TemporaryDirectory() as folder:
                raw[label] = []
                for command in commands:
                    if tuple(command) not in printed:
                        print(" ".join(command), file=sys.stderr)
                        printed[tuple(command)] = record.run(command, Path(folder))
                    raw[label].append(printed[tuple(command)])
        result = figure.reduce(raw)
        records = record.load()
        records[figure.name] = {
            "commands": figure.described_commands(),
            "measured": about,
            "result": result,
            "table": figure.table(result),
        }
        record.save(records)
        write()


def adopt(figures: list[Figure]) -> None:
    """Records the tables that stand in the text, with the commits that put their rows there.

    A table whose words alone have changed keeps the commits of its numbers.
    """
    records = record.load()
    for figure in figures:
        text = (record.ROOT / figure.page).read_text(encoding="utf-8")
        table = marks.tables(text)[figure.name]
        before = records.get(figure.name, {})
        if "result" in before:
            raise SystemExit(
                f"{figure.name}: was measured; its table comes from the result, by `run` or `write`"
            )
        if "recorded" in before and marks.numbers(before["table"]) == marks.numbers(table):
            recorded = before["recorded"]
        else:
            recorded = _introduced(table, figure.page)
        records[figure.name] = {
            "commands": figure.described_commands(),
            "recorded": recorded,
            "table": table,
        }
    record.save(records)
    write()


def _introduced(table: str, page: str) -> dict[str, Any]:
    rows = [record.introduced(row, page) for row in table.splitlines()[2:]]
    oldest, newest = (choose(rows, key=lambda row: row["date"]) for choose in (min, max))
    return newest if oldest == newest else {**newest, "oldest_row": oldest}


def write() -> None:
    """Brings all pages up to date with the records, and their tables with the results."""
    records = record.load()
    for name, one in records.items():
        if "result" in one:
            one["table"] = BY_NAME[name].table(one["result"])
    record.save(records)
    for path in pages():
        text = path.read_text(encoding="utf-8")
        new = text
        for name in marks.tables(text):
            if name in records:
                new = marks.replaced(new, name, records[name]["table"])
        if new != text:
            path.write_text(new, encoding="utf-8")
    PAGE.write_text(page.render(records), encoding="utf-8")


def differences() -> list[str]:
    """What of the text is not what is recorded."""
    records = record.load()
    found = [f"{name}: recorded, but no such entry" for name in records if name not in BY_NAME]
    for figure in FIGURES:
        if figure.name not in records:
            found.append(f"{figure.name}: not recorded")
            continue
        one = records[figure.name]
        if one["commands"] != figure.described_commands():
            found.append(f"{figure.name}: recorded of another command")
        if "result" in one and figure.table(one["result"]) != one["table"]:
            found.append(f"{figure.name}: the table is not that of the recorded result")
        text = (record.ROOT / figure.page).read_text(encoding="utf-8")
        if figure.name not in marks.tables(text):
            found.append(f"{figure.page}: has no marks for {figure.name}")
    for path in pages():
        for name, table in marks.tables(path.read_text(encoding="utf-8")).items():
            if table != records.get(name, {}).get("table"):
                found.append(f"{path.relative_to(record.ROOT)}: the table {name} is not what is recorded")
    if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != page.render(records):
        found.append("docs/figures.md: not what is recorded; write it with `python -m tools.figures write`")
    return found


def without_entry() -> dict[str, list[str]]:
    """By page: figures of the prose that no record has."""
    known = [one["table"] for one in record.load().values()]
    listed = {str(path.relative_to(record.ROOT)): marks.unrecorded(path, known) for path in pages()}
    return {name: figures for name, figures in listed.items() if figures}


def check() -> int:
    """Prints what differs, and what has no entry; the exit code tells of the former only."""
    found = differences()
    for line in found:
        print(line)
    for name, figures in without_entry().items():
        print(f"{name}: in the text, in no table: {', '.join(figures)}")
    return 1 if found else 0


def main(arguments: list[str] | None = None) -> int:
    """Runs the command line; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tools.figures", description="Measured figures.")
    parser.add_argument("action", nargs="?", choices=("list", "run", "adopt", "write"), default="list")
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--check", action="store_true", help="compare the text with docs/figures.json")
    parser.add_argument(
        "--data", default=os.environ.get("CONTACTSENSE_FRANKA_TOUCH"), help="logs of the Franka arm"
    )
    given: Any = parser.parse_args(arguments)
    if unknown := sorted(set(given.names) - set(BY_NAME)):
        parser.error(f"there is no figure {unknown[0]!r}; there are {', '.join(BY_NAME)}")
    if given.check:
        return check()
    chosen = [BY_NAME[name] for name in given.names] or [figure for figure in FIGURES if not figure.long]
    if given.action == "run":
        run(chosen, given.data)
    elif given.action == "adopt":
        adopt([BY_NAME[name] for name in given.names])
    elif given.action == "write":
        write()
    else:
        for figure in FIGURES:
            print(f"{figure.name} ({figure.page}{', long' if figure.long else ''}): {figure.about}")
            print("\n".join(f"  {line}" for line in figure.described_commands()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
