"""`contactsense study NAME`: experiments that anyone can repeat."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from .. import InputError
from .._extras import MissingExtraError

app = typer.Typer(
    help="Repeat a study: experiments on published logs and on simulated robots.", no_args_is_help=True
)


def register(parent: typer.Typer) -> None:
    """Adds `study` to the command line."""
    parent.add_typer(app, name="study")


@app.callback()
def studies() -> None:
    """Makes every study a command of its own, also where there is but one."""


@app.command("franka_touch")
def franka_touch(
    data: Annotated[Path, typer.Option(help="Folder of the logs: a4.csv.gz and the like.")],
    touches: Annotated[bool, typer.Option("--touches", help="List every touch, too.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print all results as JSON.")] = False,
    png: Annotated[Path, typer.Option(help="Where to write the picture.")] = Path("franka_touch.png"),
    plot_log: Annotated[
        str | None, typer.Option(help="Log that the picture shows over time (default: first held out).")
    ] = None,
    tune: Annotated[
        bool, typer.Option("--tune", help="Choose the settings anew on the tuning files instead.")
    ] = False,
) -> None:
    """Touches of a real Franka arm: are they felt, how soon, and on which link."""
    from ..studies import franka_touch as study
    from ..studies.franka_touch import report

    try:
        from ..studies.franka_touch.plot import save_plot
    except ModuleNotFoundError as missing:
        raise MissingExtraError(missing.name or "matplotlib", "study") from missing
    result = study.run(data, tune=tune)
    if plot_log is not None and plot_log not in [log.name for log in result.logs]:
        raise InputError(
            f"plot_log: there is no log '{plot_log}'; there are {', '.join(log.name for log in result.logs)}"
        )
    try:
        save_plot(result, png, plot_log)
    except (OSError, ValueError) as cause:
        raise InputError(f"png: cannot write '{png}': {cause}") from cause
    if as_json:
        print(json.dumps(report.as_data(result), indent=2, allow_nan=False))
    else:
        report.print_study(result, Console(), touches=touches)
        print(f"Picture: {png}")


@app.command("single_contacts")
def single_contacts(
    robot: Annotated[str, typer.Option(help="A packaged robot, or a URDF file.")] = "atlas",
    package_dir: Annotated[
        list[Path] | None, typer.Option(help="Folder for `package://` names; may be repeated.")
    ] = None,
    floating_base: Annotated[bool, typer.Option("--floating-base", help="The URDF's base is free.")] = False,
    points: Annotated[int, typer.Option(help="Touches a link.")] = 100,
    seed: Annotated[int, typer.Option(help="Of poses, points and forces.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print all results as JSON.")] = False,
) -> None:
    """Single contacts with ideal measurements: which are located, how exactly, and why the others are not."""
    from .. import Robot
    from ..robot import DESCRIPTIONS
    from ..studies import single_contacts as study

    if robot in DESCRIPTIONS:
        subject = Robot.named(robot)
    else:
        subject = Robot.from_urdf(robot, package_dirs=package_dir or (), floating_base=floating_base)
    results = study.run(subject, points, seed)
    if as_json:
        print(json.dumps(study.as_data(results), indent=2, allow_nan=False))
    else:
        Console().print(study.table(results))
