"""`python -m tools.figures`: runs the commands behind the figures, or checks the text."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from datetime import datetime, timezone
from typing import Any

from . import record
from .catalogue import BY_NAME, FIGURES, Figure
from .pages import ROOT, places, write


def run(figure: Figure, data: str | None) -> list[dict[str, Any]]:
    """Runs all commands of a figure, for all seeds."""
    runs = []
    for command in figure.commands:
        for seed in figure.seeds or (None,):
            if "{data}" in command and data is None:
                sys.exit(f"figures: '{figure.name}' needs --data: see docs/franka_logs.md")
            arguments = [part.format(seed=seed, data=data) for part in command.split()]
            print(f"{figure.name}: python {' '.join(arguments)}", file=sys.stderr)
            done = subprocess.run(
                [sys.executable, *arguments], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True
            )
            shown = command.replace("{seed}", str(seed))
            runs.append({"command": f"python {shown}", "seed": seed, "result": json.loads(done.stdout)})
    return runs


def machine() -> dict[str, str]:
    """Date, processor and versions."""
    from benches.compare.machine import describe

    return {"date": datetime.now(timezone.utc).date().isoformat(), **describe()}


def main() -> int:
    """Runs the command line; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tools.figures", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(BY_NAME)}; default all")
    parser.add_argument("--check", action="store_true", help="compare the pages with docs/figures.json")
    parser.add_argument("--data", help="folder of the Franka logs (docs/franka_logs.md)")
    arguments = parser.parse_args()
    if arguments.check:
        found = record.faults()
        print("\n".join(found) or "The pages agree with docs/figures.json.")
        return bool(found)
    if unknown := [name for name in arguments.names if name not in BY_NAME]:
        parser.error(f"there is no figure '{unknown[0]}'; there are {', '.join(BY_NAME)}")
    for figure in FIGURES:
        if arguments.names and figure.name not in arguments.names:
            continue
        runs = run(figure, arguments.data)
        page = ROOT / figure.page
        if figure.text is not None:
            write(page, figure.name, figure.text(runs))
        else:
            print(
                f"{figure.name}: recorded; compare the text in {figure.page} by hand",
                file=sys.stderr,
            )
        entries = record.read()
        entries[figure.name] = record.entry(figure, places(page)[figure.name], machine(), runs)
        record.write(entries)
    return 0


if __name__ == "__main__":
    sys.exit(main())
