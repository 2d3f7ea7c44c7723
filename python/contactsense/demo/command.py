"""`contactsense demo`."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from .._extras import require
from .._pictures import picture_file
from . import as_data, run, save_picture


def register(parent: typer.Typer) -> None:
    """Adds `demo` to the command line."""
    parent.command("demo")(command)


def command(
    robot: Annotated[
        str, typer.Option(help="Robot to simulate: iiwa14, an arm in motion, or atlas, a standing humanoid.")
    ] = "iiwa14",
    seed: Annotated[int, typer.Option(help="Seed of the motion, the contacts and the noise.")] = 0,
    noise: Annotated[
        tuple[float, float],
        typer.Option(help="Standard deviation of the measured torques: percent of the torque, and Nm."),
    ] = (0.0, 0.0),
    sensor_noise: Annotated[
        tuple[float, float],
        typer.Option(help="Standard deviation of the force/torque sensors of atlas: N, and Nm."),
    ] = (0.0, 0.0),
    gain: Annotated[
        float | None, typer.Option(help="Observer gain in 1/s (default: 500, or 250 with noise).")
    ] = None,
    imperfect: Annotated[
        bool, typer.Option(help="Repeat the run of iiwa14 with the errors of a real arm, calibrated.")
    ] = True,
    out: Annotated[Path, typer.Option(help="File to write the picture to.")] = Path("contactsense_demo.png"),
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Simulate contacts on a robot and compare what is estimated with the truth."""
    require("demo", "mujoco", "matplotlib", "rich")
    target = picture_file("out", out)
    from rich.console import Console

    from .table import live_table, print_result

    console = Console()
    wanted = partial(
        run,
        robot=robot,
        seed=seed,
        noise=noise,
        sensor_noise=sensor_noise,
        gain=gain,
        imperfect=imperfect,
    )
    if as_json or not console.is_terminal:
        result = wanted()
    else:
        with live_table(console) as show:
            result = wanted(on_progress=show)
    picture = save_picture(result, target)
    if as_json:
        print(json.dumps({**as_data(result), "picture": str(picture)}, indent=2, allow_nan=False))
    else:
        print_result(console, result, str(picture))
