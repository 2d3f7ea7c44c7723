"""`contactsense calibrate`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from .._extras import require
from .._pictures import optional_picture
from ..calibration import calibrate
from ..offline.residuals import residuals, settled
from .log_options import LogOptions
from .shared_options import with_shared_options

# What `calibrate` asks for [s].
_SHORTEST = 10.0


def register(parent: typer.Typer) -> None:
    """Adds `calibrate` to the command line."""
    parent.command("calibrate")(with_shared_options(command))


def command(
    log: Annotated[
        Path, typer.Argument(metavar="LOG", help="File or folder of a bag: motion without contact.")
    ],
    options: LogOptions,
    payload_link: Annotated[
        str | None, typer.Option(help="Link that holds a payload which the description lacks.")
    ] = None,
    false_alarms: Annotated[float, typer.Option(help="False alarms an hour that levels are set for.")] = 1.0,
    out: Annotated[Path, typer.Option(help="File to write the calibration to.")] = Path("calibration.yaml"),
    png: Annotated[
        Path | None, typer.Option(help="Picture of the residuals before and after, and of the motion.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Learn torque bias, friction, inertias and noise of an arm from its motion without contact."""
    require("cli", "rich")
    png = optional_picture("png", png)
    loaded = options.load_robot()
    measured = options.load_log(log, loaded)
    seconds = float(measured.time[-1] - measured.time[0])
    if seconds < _SHORTEST:
        print(
            f"contactsense: {log}: {seconds:.1f} s are short; record at least {_SHORTEST:g} s in which all "
            "joints move",
            file=sys.stderr,
        )
    learnt = calibrate(loaded, measured, false_alarms_per_hour=false_alarms, payload_link=payload_link)
    before, after = residuals(loaded, measured), residuals(loaded, measured, learnt)
    rows = settled(measured)
    learnt.save(out, source=log.name)
    if png is not None:
        from .calibration_picture import save_calibration_picture

        save_calibration_picture(png, measured, learnt, before, after)
    sizes = [np.sqrt(np.mean(values[rows] ** 2, axis=0)) for values in (before, after)]
    if as_json:
        told = {**learnt.to_dict(), "residual_before": sizes[0].tolist(), "residual_after": sizes[1].tolist()}
        print(json.dumps({**told, "file": str(out)}, indent=2))
        return
    from rich.console import Console

    from .calibration_table import print_calibration

    print_calibration(Console(), learnt, sizes[0], sizes[1], str(out))
