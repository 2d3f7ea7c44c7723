"""The command line: `contactsense COMMAND`."""

from __future__ import annotations

import sys

from .._extras import MissingExtraError

# What the command line itself needs; studies and demos ask for theirs.
NEEDED = ("typer", "rich")


def main() -> None:
    """Runs a command and ends the process.

    Exit codes: 0 done, 1 failed, 2 wrong input or something not installed, 130 interrupted.
    """
    try:
        from .app import run
    except ModuleNotFoundError as missing:
        if missing.name is None or missing.name.partition(".")[0] not in NEEDED:
            raise
        print(f"contactsense: {MissingExtraError(missing.name, 'cli')}", file=sys.stderr)
        sys.exit(2)
    sys.exit(run())
