"""`contactsense study NAME`: experiments that anyone can repeat."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import TaskID

from .. import InputError
from .._extras import MissingExtraError, require
from .._pictures import picture_file, picture_folder

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
    picture = picture_file("png", png)
    result = study.run(data, tune=tune)
    if plot_log is not None and plot_log not in [log.name for log in result.logs]:
        raise InputError(
            f"plot_log: there is no log '{plot_log}'; there are {', '.join(log.name for log in result.logs)}"
        )
    try:
        save_plot(result, picture, plot_log)
    except (OSError, ValueError) as cause:
        raise InputError(f"png: cannot write '{png}': {cause}") from cause
    if as_json:
        print(json.dumps(report.as_data(result), indent=2, allow_nan=False))
    else:
        report.print_study(result, Console(), touches=touches)
        print(f"Picture: {picture}")


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


@app.command("vorndamme2017")
def vorndamme2017(
    singles: Annotated[int, typer.Option(help="Scenes with one contact.")] = 3000,
    pairs: Annotated[
        int, typer.Option(help="Scenes with two contacts (twice: by links, and by area).")
    ] = 5000,
    fives: Annotated[int, typer.Option(help="Scenes with five contacts.")] = 5000,
    hits: Annotated[int, typer.Option(help="Hits over time, of the scenes with one contact.")] = 100,
    seed: Annotated[int, typer.Option(help="Of points, forces, poses and noise.")] = 0,
    noise: Annotated[float, typer.Option(help="Relative noise of the runs with noise.")] = 0.01,
    cone: Annotated[
        float, typer.Option(help="Greatest angle between force and inward normal, degrees.")
    ] = 30.0,
    random_poses: Annotated[bool, typer.Option("--random-poses", help="Not standing: any pose.")] = False,
    processes: Annotated[
        int | None, typer.Option(min=1, help="How many; the answer is the same (default: one a core).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print all results as JSON.")] = False,
    png: Annotated[Path | None, typer.Option(help="Folder to write pictures to.")] = None,
) -> None:
    """One, two and five contacts at once on Atlas, with joint torques and with force/torque sensors."""
    require("study", "mujoco")
    from ..studies.vorndamme2017 import data, report, study

    options = study.Options(singles, pairs, fives, hits, seed, noise, math.radians(cone), random_poses)
    save = _picture_writer("vorndamme2017", png)
    with _progress() as show:
        result = study.run(options, processes=processes, progress=show)
    if as_json:
        print(json.dumps(data.as_data(result), indent=2, allow_nan=False))
    else:
        report.print_study(result, Console())
    if result.complete:
        _save_pictures(save, result, png, as_json)
    else:
        raise KeyboardInterrupt


@app.command("bimbo2019")
def bimbo2019(
    robot: Annotated[str, typer.Option(help="A packaged arm, or a URDF file.")] = "iiwa14",
    package_dir: Annotated[
        list[Path] | None, typer.Option(help="Folder for `package://` names; may be repeated.")
    ] = None,
    link: Annotated[
        list[str] | None, typer.Option(help="Link to touch; may be repeated (default: all that move).")
    ] = None,
    experiment: Annotated[
        list[str] | None,
        typer.Option(help="random, deliberate, cube, 'smooth pole', pole; may be repeated (default: all)."),
    ] = None,
    trials: Annotated[int, typer.Option(help="A link, in every experiment.")] = 5,
    particles: Annotated[int, typer.Option(help="Of every filter.")] = 10_000,
    seed: Annotated[int, typer.Option(help="Of poses, points, motions, noise and filters.")] = 0,
    processes: Annotated[
        int | None, typer.Option(min=1, help="How many; the answer is the same (default: one a core).")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print all results as JSON.")] = False,
    png: Annotated[Path | None, typer.Option(help="Folder to write pictures to.")] = None,
) -> None:
    """Where an arm is touched, found by a particle filter while it moves a little: three motion models."""
    require("study", "mujoco")
    from ..studies.bimbo2019 import data, report, study
    from ..studies.bimbo2019.options import Options

    folders = tuple(str(folder) for folder in package_dir or ())
    options = Options(robot, folders, trials, particles, seed, tuple(link or ()), tuple(experiment or ()))
    save = _picture_writer("bimbo2019", png)
    with _progress() as show:
        result = study.run(options, processes=processes, progress=show)
    if as_json:
        print(json.dumps(data.as_data(result), indent=2, allow_nan=False))
    else:
        report.print_study(result, Console())
    if result.complete:
        _save_pictures(save, result, png, as_json)
    else:
        raise KeyboardInterrupt


@contextmanager
def _progress() -> Iterator[Callable[[str, int, int], None]]:
    """A bar for every stage, on standard error."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        stages: dict[str, TaskID] = {}

        def show(stage: str, done: int, total: int) -> None:
            if stage not in stages:
                stages[stage] = bar.add_task(stage, total=total)
            bar.update(stages[stage], completed=done)

        yield show


def _save_pictures(
    save: Callable[[Any, Path], list[Path]] | None, result: Any, folder: Path | None, quiet: bool
) -> None:
    if save is not None and folder is not None:
        for path in save(result, folder):
            if not quiet:
                print(f"Picture: {path}")


def _picture_writer(study: str, folder: Path | None) -> Callable[[Any, Path], list[Path]] | None:
    """Found before the study begins, so that a missing package or a bad folder is reported at once."""
    if folder is None:
        return None
    try:
        plots = import_module(f"contactsense.studies.{study}.plots")
    except ModuleNotFoundError as missing:
        raise MissingExtraError(missing.name or "matplotlib", "study") from missing
    picture_folder("png", folder)
    save: Callable[[Any, Path], list[Path]] = plots.save_plots
    return save
