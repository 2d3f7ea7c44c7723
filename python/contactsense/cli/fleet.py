"""`contactsense replay --engine ...`: many logs in parallel, into one data set."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

from ..fleet import FleetReplay, replay_fleet
from ..fleet.dataset import LOGS
from ..fleet.replay_fleet import Engine
from ..fleet.summary import links_of, robots_of
from ..robot import Robot
from .exit_codes import DAMAGED, FAILED, INTERRUPTED
from .progress import progress_bar


def replay_in_parallel(
    logs: Sequence[Path],
    robot: Robot,
    folder: Path,
    *,
    name: str | None,
    reading: Mapping[str, Any],
    monitor: Mapping[str, Any],
    classifier: Mapping[str, Any] | None,
    ticks: bool,
    engine: Engine,
    workers: int | None,
    address: str | None,
    png: Path | None,
    as_json: bool,
) -> int:
    """Replays all logs, prints what was found so far in the whole data set, and gives the exit code."""
    # Ray writes about tasks that were killed to stdout, which is for results.
    with progress_bar("logs", as_json) as show, redirect_stdout(sys.stderr):
        result = replay_fleet(
            logs,
            robot,
            folder,
            name=name,
            reading=reading,
            monitor=monitor,
            classifier=classifier,
            ticks=ticks,
            engine=engine,
            workers=workers,
            address=address,
            on_progress=show,
        )
    _print_faults(result)
    if (result.folder / LOGS).is_dir():
        _print_summary(result.folder, as_json)
        if png is not None:
            from .fleet_picture import save_fleet_picture

            save_fleet_picture(png, result.folder, name or robot.name, robot)
    if result.interrupted:
        return INTERRUPTED
    if result.failed:
        return FAILED
    return DAMAGED if result.damaged else 0


def _print_faults(result: FleetReplay) -> None:
    for kind, faults in (("damaged", result.damaged), ("failed", result.failed)):
        for log, fault in faults.items():
            print(f"{kind}: {log}: {fault}", file=sys.stderr)
    interrupted = "; interrupted" if result.interrupted else ""
    counts = (
        f"{len(result.replayed)} replayed, {len(result.unchanged)} unchanged, {len(result.failed)} failed"
    )
    print(f"logs: {counts}{interrupted}", file=sys.stderr)


def _print_summary(folder: Path, as_json: bool) -> None:
    robots, links = robots_of(folder), links_of(folder)
    if as_json:
        rows = {"robots": [row.to_dict() for row in robots], "links": [row.to_dict() for row in links]}
        print(json.dumps(rows, allow_nan=False))
        return
    from rich.console import Console

    from .fleet_tables import link_table, robot_table

    console = Console()
    console.print(robot_table(folder.name, robots))
    if links:
        console.print(link_table(links))
