"""Every command line of README and pages names commands and options that exist."""

from __future__ import annotations

import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("typer")
import typer

from contactsense.cli.app import app

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
# A command line in an indented or fenced block, with lines that go on after a backslash.
LINE = re.compile(r"^(?: {4})?(?:\$ )?contactsense ((?:[^\\\n]|\\\n)*)$", re.MULTILINE)
BLOCK = re.compile(r"^```sh\n(.*?)^```$|((?:^ {4}.*\n|^\n)+)", re.MULTILINE | re.DOTALL)


def commands() -> Iterator[tuple[str, str]]:
    """Page and arguments of each command line."""
    for page in PAGES:
        for block in BLOCK.finditer(page.read_text(encoding="utf-8")):
            for line in LINE.finditer(block[0]):
                yield page.name, line[1].replace("\\\n", " ")


@pytest.mark.parametrize(("page", "line"), list(commands()), ids=lambda value: value[:60])
def test_the_command_line_is_understood(page: str, line: str) -> None:
    arguments = shlex.split(line, comments=True)
    command: Any = typer.main.get_command(app)
    context = command.make_context("contactsense", [], resilient_parsing=True)
    # Versions of Typer differ in whose classes these are.
    while hasattr(command, "get_command"):
        name = arguments.pop(0)
        command = command.get_command(context, name)
        assert command is not None, f"{page}: no command {name}"
        context = command.make_context(name, [], parent=context, resilient_parsing=True)
    context.resilient_parsing = False  # raises where an option does not exist, or has no value
    command.make_parser(context).parse_args(arguments)


def test_many_command_lines_are_found() -> None:
    assert len(list(commands())) > 30
