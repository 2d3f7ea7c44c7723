"""The commands, one module each; every module adds its own by `register(app)`."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from .. import ContactSenseError, __version__
from ..demo import command as demo
from . import study

COMMANDS = (demo, study)

app = typer.Typer(
    name="contactsense",
    help="A robot's sense of touch over its whole body from what it already measures.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"contactsense {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version.", callback=_show_version, is_eager=True)
    ] = False,
) -> None:
    """Options of all commands; the text shown is the app's."""


for command in COMMANDS:
    command.register(app)


def run(arguments: list[str] | None = None) -> int:
    """Runs a command line, by default the process's; returns the exit code. An error is a line on stderr."""
    try:
        code = app(args=arguments, standalone_mode=True)
    except ContactSenseError as error:
        print(f"contactsense: {error}", file=sys.stderr)
        return 2
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    return code if isinstance(code, int) else 0
