"""`contactsense replay`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from .._extras import require
from .._pictures import optional_picture
from ..errors import InputError
from ..fleet.replay_fleet import Engine
from ..offline import Replay, replay
from ..offline.monitor_of import classifier_of, monitor_of
from .exit_codes import DAMAGED, INTERRUPTED
from .fleet import replay_in_parallel
from .log_options import LogOptions
from .monitor_options import MonitorOptions
from .progress import progress_bar
from .shared_options import with_shared_options

# A robot that is touched for more of the time than this is rather one whose model is wrong.
_OFTEN = 0.5


def register(parent: typer.Typer) -> None:
    """Adds `replay` to the command line."""
    parent.command("replay")(with_shared_options(command))


def command(
    logs: Annotated[
        list[Path], typer.Argument(metavar="LOG...", help="Files or folders of bags; one log each.")
    ],
    options: LogOptions,
    monitor: MonitorOptions,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for contacts.jsonl, Parquet tables and replay.mcap (one folder a log); with "
            "--engine, for the data set of all logs."
        ),
    ] = None,
    png: Annotated[
        Path | None,
        typer.Option(
            help="Picture of where and when the robot was touched; of one log, or with --engine of all."
        ),
    ] = None,
    classes: Annotated[
        bool,
        typer.Option(
            "--classes", help="Say whether contacts are clamped, transient or sustained, and intended."
        ),
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object a contact, a line each.")
    ] = False,
    engine: Annotated[
        Engine | None,
        typer.Option(help="Replay logs in parallel, each in a process (local) or a task of Ray (ray)."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="With --engine: tasks at a time here (default: one a core).")
    ] = None,
    address: Annotated[
        str | None, typer.Option(help="With --engine ray: address of the cluster (default: start Ray here).")
    ] = None,
    name: Annotated[
        str | None,
        typer.Option(help="With --engine: the robot's name in the data set (default: the model's)."),
    ] = None,
    ticks: Annotated[
        bool, typer.Option("--ticks", help="With --engine: the data set has a row for each row of each log.")
    ] = False,
) -> None:
    """Find the contacts in logs: when, where and how hard."""
    require("cli", "rich")
    if png is not None and len(logs) > 1 and engine is None:
        raise InputError(f"png: is a picture of one log, and there are {len(logs)}")
    png = optional_picture("png", png)
    sensors, arguments = monitor.sensors(), monitor.arguments()
    classifying: dict[str, Any] | None = {} if classes else None
    if engine is not None:
        if out is None:
            raise InputError("out: --engine needs the folder of the data set")
        code = replay_in_parallel(
            logs,
            options.load_robot(),
            out,
            name=name,
            reading=options.reading(sensors),
            monitor=arguments,
            classifier=classifying,
            ticks=ticks,
            engine=engine,
            workers=workers,
            address=address,
            png=png,
            as_json=as_json,
        )
        raise typer.Exit(code)
    if workers is not None or address is not None or name is not None or ticks:
        raise InputError("engine: --workers, --address, --name and --ticks need --engine")
    if out is not None:
        require("log", "pyarrow", "rosbags", "mcap")
    loaded = options.load_robot()
    if png is not None and not loaded.link_names:
        raise InputError(
            "png: the robot has no surface that could be drawn; see --package-dir and --geometry"
        )
    code = 0
    for path in logs:
        log = options.load_log(path, loaded, sensors)
        log_monitor = monitor_of(log, loaded, **arguments)
        classifier = classifier_of(log_monitor, classifying)
        with progress_bar(path.name, as_json) as show:
            result = replay(log, log_monitor, classifier=classifier, on_progress=show)
        print_contacts(path, result, as_json)
        if png is not None:
            from ..offline.contact_picture import save_contact_picture

            save_contact_picture("png", png, path.name, result)
        if out is not None:
            write(result, out / _stem(path) if len(logs) > 1 else out)
        if result.interrupted:
            raise typer.Exit(INTERRUPTED)
        if log.reading is not None and log.reading.damage:
            code = DAMAGED
    if code:
        raise typer.Exit(code)


def print_contacts(path: Path, result: Replay, as_json: bool) -> None:
    """The contacts, as a table or as JSON lines."""
    if as_json:
        for contact in result.contacts:
            print(json.dumps({"log": str(path), **contact.to_dict()}, allow_nan=False))
    else:
        from rich.console import Console

        from .contact_table import class_table, contact_table

        console = Console()
        console.print(contact_table(path.name, result))
        if any(contact.kind for contact in result.contacts):
            console.print(class_table(result))
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
