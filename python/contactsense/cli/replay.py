"""`contactsense replay`."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from .. import ContactMonitor
from .._extras import require
from ..calibration import Calibration
from ..errors import InputError
from ..log import Log
from ..offline import Replay, replay
from ..robot import Robot
from .exit_codes import DAMAGED, INTERRUPTED
from .log_options import LogOptions, numbers, with_log_options

# A robot that is touched for more of the time than this is rather one whose model is wrong.
_OFTEN = 0.5


def register(parent: typer.Typer) -> None:
    """Adds `replay` to the command line."""
    parent.command("replay")(with_log_options(command))


def command(
    logs: Annotated[
        list[Path], typer.Argument(metavar="LOG...", help="Files or folders of bags; one log each.")
    ],
    options: LogOptions,
    calibration: Annotated[
        Path | None, typer.Option(help="File of `contactsense calibrate`: noise, friction, masses, levels.")
    ] = None,
    threshold: Annotated[
        str | None,
        typer.Option(
            help="Torque that is a contact in Nm, one or one a joint: 2,2,1 "
            "(default: 0.5, or the calibration's)."
        ),
    ] = None,
    gain: Annotated[float, typer.Option(help="Observer gain in 1/s.")] = 50.0,
    bias_time: Annotated[
        float | None,
        typer.Option(help="Time constant in s of the bias that is learnt without contact (default: none)."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="Folder for contacts.jsonl, Parquet tables and replay.mcap (one folder a log)."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object a contact, a line each.")
    ] = False,
) -> None:
    """Find the contacts in logs: when, where and how hard."""
    require("cli", "rich")
    if out is not None:
        require("log", "pyarrow", "rosbags", "mcap")
    loaded = options.load_robot()
    known = None if calibration is None else Calibration.load(calibration)
    code = 0
    for path in logs:
        log = options.load_log(path, loaded)
        monitor = make_monitor(loaded, log, known, numbers("threshold", threshold), gain, bias_time)
        with progress_bar(path.name, as_json) as show:
            result = replay(log, monitor, on_progress=show)
        print_contacts(path, result, as_json)
        if out is not None:
            write(result, out / _stem(path) if len(logs) > 1 else out)
        if result.interrupted:
            raise typer.Exit(INTERRUPTED)
        if log.reading is not None and log.reading.damage:
            code = DAMAGED
    if code:
        raise typer.Exit(code)


def make_monitor(
    robot: Robot,
    log: Log,
    calibration: Calibration | None,
    threshold: list[float] | float | None,
    gain: float,
    bias_time: float | None,
) -> ContactMonitor:
    """A monitor for a log at the rate of its rows."""
    if len(log) < 2:
        raise InputError(f"log: has {len(log)} rows; at least 2 are wanted")
    given: dict[str, Any] = {} if threshold is None else {"torque_threshold": threshold}
    if bias_time is not None:
        given["bias_time_constant"] = bias_time
    return ContactMonitor(
        robot, dt=float(np.median(np.diff(log.time))), observer_gain=gain, calibration=calibration, **given
    )


@contextmanager
def progress_bar(title: str, quiet: bool) -> Iterator[Callable[[int, int], None] | None]:
    """A bar on stderr where that is a terminal."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield None
        return
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task(title, total=None)
        yield lambda done, rows: progress.update(task, completed=done, total=rows)


def print_contacts(path: Path, result: Replay, as_json: bool) -> None:
    """The contacts, as a table or as JSON lines."""
    if as_json:
        for contact in result.contacts:
            print(json.dumps({"log": str(path), **contact.to_dict()}, allow_nan=False))
    else:
        from rich.console import Console

        from .contact_table import contact_table

        Console().print(contact_table(path.name, result))
    share = float(np.mean(result.ticks["collision"])) if len(result.ticks["time"]) else 0.0
    if share > _OFTEN:
        print(
            f"contactsense: {path}: in contact for {share:.0%} of the time. If the robot was not, its model "
            "has errors: calibrate with motion without contact (contactsense calibrate), or ask what is "
            "wrong (contactsense diagnose)",
            file=sys.stderr,
        )


def write(result: Replay, folder: Path) -> None:
    """All files of a result."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        result.to_json_lines(folder / "contacts.jsonl")
        result.to_parquet(folder)
        result.to_mcap(folder / "replay.mcap")
    except OSError as cause:
        raise InputError(f"out: cannot write to '{folder}': {cause.strerror or cause}") from cause


def _stem(path: Path) -> str:
    return path.name.split(".")[0] or path.name
