"""`contactsense diagnose`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from .. import diagnose
from .._extras import require
from .._pictures import optional_picture
from .._plain import plain
from ..errors import InputError
from ..offline.residuals import residuals
from .log_options import LogOptions
from .shared_options import with_shared_options


def register(parent: typer.Typer) -> None:
    """Adds `diagnose` to the command line."""
    parent.command("diagnose")(with_shared_options(command))


def command(
    log: Annotated[
        Path, typer.Argument(metavar="LOG", help="File or folder of a bag: motion without contact.")
    ],
    options: LogOptions,
    png: Annotated[Path | None, typer.Option(help="Picture of the external torque of each joint.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Say what is wrong with a robot's model or measurements, from motion without contact."""
    require("cli", "rich")
    png = optional_picture("png", png)
    loaded = options.load_robot()
    measured = options.load_log(log, loaded)
    if measured.tau is None:
        raise InputError("log: has an external torque only; diagnose needs torques of the motors")
    findings = diagnose(loaded, measured.q, measured.v, measured.tau, time=measured.time)
    if png is not None:
        from .diagnosis_picture import save_diagnosis_picture

        save_diagnosis_picture(png, measured, loaded, residuals(loaded, measured))
    if as_json:
        print(json.dumps(plain([finding.to_dict() for finding in findings]), indent=2, allow_nan=False))
        return
    from rich.console import Console
    from rich.text import Text

    console = Console()
    if not findings:
        console.print("Nothing is wrong that this motion would show.")
    for number, finding in enumerate(findings, start=1):
        console.print(Text(f"{number}. {finding.severity}, {finding.code}: {finding.message}"))
        console.print(Text(f"   explains {finding.evidence:.0%} of what was unexplained until then"))
