"""`contactsense study NAME`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from contactsense._extras import require
from contactsense._pictures import picture_file

from .bimbo2019.options import Options as BimboOptions
from .contact_classes.options import Options as ContactClassesOptions
from .example_robots import robot_of
from .harness import AsJson, add_study, print_json
from .identifiability.options import Options as IdentifiabilityOptions
from .memory.options import Options as MemoryOptions
from .next_motion.options import Options as NextMotionOptions
from .real_arm.options import Options as RealArmOptions
from .recovery.options import Options as RecoveryOptions
from .several_contacts.options import Options as SeveralContactsOptions
from .vorndamme2017.options import Options as VorndammeOptions

app = typer.Typer(
    help="Repeat a study: experiments on published logs and on simulated robots.", no_args_is_help=True
)


def register(parent: typer.Typer) -> None:
    """Adds `study` to the command line."""
    parent.add_typer(app, name="study")


@app.command("franka_touch")
def franka_touch(
    data: Annotated[Path, typer.Option(help="Folder of the logs: a4.csv.gz and the like.")],
    touches: Annotated[bool, typer.Option("--touches", help="List every contact as well.")] = False,
    as_json: AsJson = False,
    png: Annotated[Path, typer.Option(help="File to write the picture to.")] = Path("franka_touch.png"),
    plot_log: Annotated[
        str | None, typer.Option(help="Log that the picture shows over time (default: first held out).")
    ] = None,
    tune: Annotated[
        bool, typer.Option("--tune", help="Choose the settings anew on the tuning files instead.")
    ] = False,
    calibrations: Annotated[
        Path | None,
        typer.Option(help="Folder to write the calibration of each log to, for contactsense replay."),
    ] = None,
) -> None:
    """Contacts of a real Franka arm: whether, how soon and on which link they are detected."""
    require("plot", "matplotlib")
    from .franka_touch import calibrated, plot, report, study

    picture = picture_file("png", png)
    result = study.run(data, tune=tune, plot_log=plot_log)
    plot.save_plot(result, picture, plot_log)
    if calibrations is not None:
        calibrated.save_calibrations(result.logs, result.calibrations, calibrations)
    if as_json:
        print_json(report.as_data(result))
    else:
        report.print_study(result, Console(), touches=touches)
        print(f"Picture: {picture}")


@app.command("single_contacts")
def single_contacts(
    robot: Annotated[str, typer.Option(help="A packaged robot, or a URDF file.")] = "atlas",
    package_dir: Annotated[
        list[Path] | None, typer.Option(help="Folder for `package://` names; may be repeated.")
    ] = None,
    floating_base: Annotated[
        bool, typer.Option("--floating-base", help="The base of the URDF file moves freely.")
    ] = False,
    points: Annotated[int, typer.Option(help="Number of contacts per link.")] = 100,
    seed: Annotated[int, typer.Option(help="Seed of poses, points and forces.")] = 0,
    as_json: AsJson = False,
) -> None:
    """Single contacts with ideal measurements: which are located, how accurately, and why others are not."""
    from . import single_contacts as study

    subject = robot_of(robot, package_dir or (), floating_base=floating_base)
    results = study.run(subject, points, seed)
    if as_json:
        print_json(study.as_data(results))
    else:
        Console().print(study.table(results))


add_study(
    app,
    "vorndamme2017",
    "One, two and five simultaneous contacts on Atlas, with joint torques and with force/torque sensors.",
    VorndammeOptions,
)
add_study(
    app,
    "bimbo2019",
    "Contacts on a moving arm, located by a particle filter with three motion models.",
    BimboOptions,
)
add_study(
    app,
    "real_arm",
    "Contacts on arms with the errors of real ones: detection and location before and after calibration.",
    RealArmOptions,
)
add_study(
    app,
    "identifiability",
    "How exactly the point of a contact is known from joint torques, over the surfaces of robots.",
    IdentifiabilityOptions,
)
add_study(
    app,
    "contact_classes",
    "Contacts of simulated arms told apart: clamped, transient or sustained; intended or accidental.",
    ContactClassesOptions,
)
add_study(
    app,
    "recovery",
    "What calibration recovers of the known errors and payloads of simulated arms, and how certain it is.",
    RecoveryOptions,
)
add_study(
    app,
    "memory",
    "Contacts on a moving arm, located by a sampler that remembers, by a particle filter and by a map.",
    MemoryOptions,
)
add_study(
    app,
    "next_motion",
    "Motions in contact that are chosen for what they tell, beside random ones.",
    NextMotionOptions,
)
add_study(
    app,
    "several_contacts",
    "Contacts at the same time on an arm or a humanoid, located together by a sampler.",
    SeveralContactsOptions,
)
