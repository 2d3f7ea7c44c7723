"""The commands: the package's own, and those that other distributions add.

Each is added by a function `register(app)`; entry points of the group `contactsense.commands` name those of
other distributions.
"""

from __future__ import annotations

import contextlib
import os
import sys
from importlib.metadata import entry_points
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from .. import ContactSenseError, __version__
from .._extras import MissingExtraError
from ..demo import command as demo
from . import bridge, calibrate, diagnose, replay, view
from .exit_codes import INTERRUPTED

STUDIES = "contactsense-studies"  # the distribution that adds `study`


class _Commands(TyperGroup):
    """Ends on Ctrl-C with a line and a code of its own; Typer gives the code of an error."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            print("contactsense: interrupted", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None


app = typer.Typer(
    cls=_Commands,
    name="contactsense",
    help="Contacts anywhere on a robot, detected from joint positions, velocities and torques.",
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


def _study() -> None:
    """Repeat a study. Needs the package contactsense-studies."""
    raise MissingExtraError(STUDIES)


def _add_commands() -> None:
    for command in (demo, replay, calibrate, diagnose, view, bridge):
        command.register(app)
    added = {entry.name: entry for entry in entry_points(group="contactsense.commands")}
    for entry in added.values():
        entry.load()(app)
    if "study" not in added:
        anything = {"allow_extra_args": True, "ignore_unknown_options": True}
        app.command("study", context_settings=anything, add_help_option=False)(_study)


_add_commands()


def run(arguments: list[str] | None = None) -> int:
    """Runs a command line, by default the process's; returns the exit code. An error is a line on stderr."""
    try:
        code = _run(arguments)
        sys.stdout.flush()
    except OSError as error:
        # Only output is not checked before; a reader that left (`| head`) needs no message.
        if not isinstance(error, BrokenPipeError):
            print(f"contactsense: cannot write the output: {error.strerror or error}", file=sys.stderr)
        _discard_output()
        return 1
    return code


def _run(arguments: list[str] | None) -> int:
    try:
        code = app(args=arguments, standalone_mode=True)
    except ContactSenseError as error:
        print(f"contactsense: {error}", file=sys.stderr)
        return 2
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    return code if isinstance(code, int) else 0


def _discard_output() -> None:
    """What is left to be written cannot be, so that Python must not try again when it ends."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
