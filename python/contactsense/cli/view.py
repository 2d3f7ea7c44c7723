"""`contactsense view`."""

from __future__ import annotations

import sys
import time
import webbrowser
from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from .._extras import require
from ..errors import InputError
from ..offline import replay
from ..offline.monitor_of import monitor_of
from .log_options import LogOptions
from .monitor_options import MonitorOptions
from .progress import progress_bar
from .shared_options import with_shared_options

_MINUTE = 60.0  # [s] of a log in a page that is written: about ten megabytes


def register(parent: typer.Typer) -> None:
    """Adds `view` to the command line."""
    parent.command("view")(with_shared_options(command))


def command(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="File or folder of a bag.")],
    options: LogOptions,
    monitor: MonitorOptions,
    html: Annotated[
        Path | None,
        typer.Option(help="Write a page that needs no program and no network to this file, and end."),
    ] = None,
    start: Annotated[
        float, typer.Option(help="With --html: from so many seconds after the log's start.")
    ] = 0.0,
    end: Annotated[
        float | None, typer.Option(help="With --html: to so many seconds (default: a minute of the log).")
    ] = None,
    host: Annotated[
        str,
        typer.Option(help="What serves the page: this machine only, or 0.0.0.0 for all who know the token."),
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port of the page.")] = 8080,
    token: Annotated[
        str | None,
        typer.Option(
            envvar="CONTACTSENSE_TOKEN",
            help="What a browser has to know; random where others than this machine reach the page.",
        ),
    ] = None,
    open_page: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
) -> None:
    """Show a log in the browser: the robot, its contacts, where they can be, and the torques."""
    require("view", "viser")
    from ..viewer.place import place_of
    from ..viewer.replay_view import replay_view

    place = place_of(host, port, token)
    if html is not None and not html.resolve().parent.is_dir():
        raise InputError(f"html: cannot write '{html}': there is no folder '{html.resolve().parent}'")
    loaded = options.load_robot()
    measured = options.load_log(log, loaded, monitor.sensors())
    with progress_bar(log.name, False) as show:
        result = replay(measured, monitor_of(measured, loaded, **monitor.arguments()), on_progress=show)
    page = replay_view(log.name, result, place)
    try:
        if html is not None:
            page.to_html(html, start, start + _MINUTE if end is None else end)
            return
        print(f"{page.address} shows the log; Ctrl-C ends it", file=sys.stderr)
        if open_page:
            webbrowser.open(page.address)
        with suppress(KeyboardInterrupt):
            while True:
                time.sleep(1.0)
    finally:
        page.close()
