"""What all studies share: options on the command line, progress, results as data, tables and pictures."""

from __future__ import annotations

import inspect
import json
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from types import GenericAlias
from typing import Annotated, Any, TypeAlias, get_args, get_type_hints

import numpy as np
import typer
from rich import box
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table

from contactsense import InputError
from contactsense._extras import MissingExtraError, require
from contactsense._pictures import picture_folder, save_picture
from contactsense._plain import plain

# Stage, how much of it is done, and all of it.
Report: TypeAlias = Callable[[str, int, int], None]
# By file name: size [inch], and what fills the figure from the study's result.
Pictures: TypeAlias = Mapping[str, tuple[tuple[float, float], Callable[[Any, Any], object]]]

AsJson = Annotated[bool, typer.Option("--json", help="Print all results as JSON.")]


def silent(stage: str, done: int, total: int) -> None:
    """A `Report` that shows nothing."""


def check_counts(seed: int, **counts: int) -> None:
    """Counts must be positive, and the seed not negative.

    Raises:
        InputError: one is not; names it.
    """
    for name, count in counts.items():
        if count < 1:
            raise InputError(f"{name}: must be at least 1, not {count}")
    if seed < 0:
        raise InputError(f"seed: must not be negative, not {seed}")


def add_study(app: typer.Typer, name: str, text: str, options: Any) -> None:
    """Adds a study that runs trials on several processes as the command `name` with the help `text`.

    The fields of the dataclass `options` are the command's options. The study's package has the modules
    `study` (`run`), `data` (`as_data`), `report` (`print_study`) and `plots` (`PICTURES`).
    """

    def command(processes: int | None, as_json: bool, pictures: Path | None, **values: Any) -> None:
        require("sim", "mujoco")
        given = {key: value for key, value in values.items() if value is not None}
        wanted = options(**{key: tuple(v) if isinstance(v, list) else v for key, v in given.items()})
        drawn = None if pictures is None else _pictures(name, pictures)
        module = {part: import_module(f"{__package__}.{name}.{part}") for part in ("study", "data", "report")}
        with progress_bars() as show:
            result = module["study"].run(wanted, processes=processes, progress=show)
        if as_json:
            print_json(module["data"].as_data(result))
        else:
            module["report"].print_study(result, Console())
        if not result.complete:
            raise KeyboardInterrupt
        for path in () if pictures is None or drawn is None else save_pictures(drawn, result, pictures):
            if not as_json:
                print(f"Picture: {path}")

    shared = {
        "processes": (
            Annotated[
                int | None,
                typer.Option(
                    min=1,
                    help="Number of worker processes (default: all cores). Results do not depend on it.",
                ),
            ],
            None,
        ),
        "as_json": (AsJson, False),
        "pictures": (
            Annotated[Path | None, typer.Option("--png", help="Folder to write pictures to.")],
            None,
        ),
    }
    own = {}
    for field in fields(options):
        kind, option = get_args(get_type_hints(options, include_extras=True)[field.name])
        own[field.name] = (Annotated[kind, option], field.default)
        if get_args(kind)[1:] == (...,):  # Typer knows no tuple of any length
            several: Any = GenericAlias(list, get_args(kind)[:1])
            own[field.name] = (Annotated[several | None, option], None)
    command.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [
            inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=kind)
            for key, (kind, default) in {**own, **shared}.items()
        ]
    )
    command.__annotations__ = {key: kind for key, (kind, _) in {**own, **shared}.items()}
    app.command(name, help=text)(command)


def _pictures(study: str, folder: Path) -> Pictures:
    """Found before the study begins, so that a missing package or a bad folder is reported at once."""
    try:
        pictures: Pictures = import_module(f"{__package__}.{study}.plots").PICTURES
    except ModuleNotFoundError as missing:
        raise MissingExtraError(missing.name or "matplotlib", "plot") from missing
    picture_folder("png", folder)
    return pictures


def save_pictures(pictures: Pictures, study: Any, folder: Path) -> list[Path]:
    """Writes all pictures of a study into `folder`; returns their paths.

    Raises:
        InputError: a file cannot be written.
    """
    picture_folder("png", folder)
    return [
        save_picture("png", folder / name, size, lambda figure, draw=draw: draw(figure, study))  # type: ignore[misc]
        for name, (size, draw) in pictures.items()
    ]


@contextmanager
def progress_bars() -> Iterator[Report]:
    """A bar for every stage, on standard error."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        stages: dict[str, TaskID] = {}

        def show(stage: str, done: int, total: int) -> None:
            if stage not in stages:
                stages[stage] = bar.add_task(stage, total=total)
            bar.update(stages[stage], completed=done)

        yield show


def print_json(data: Any) -> None:
    """Results as JSON; null where a figure is undefined or infinite."""
    print(json.dumps(plain(data), indent=2, allow_nan=False))


def sheet(title: str, labels: tuple[str, ...], figures: tuple[str, ...], caption: str | None = None) -> Table:
    """A table: columns of labels to the left, columns of figures to the right."""
    table = Table(
        title=title,
        title_justify="left",
        caption=caption,
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        show_edge=False,
        padding=(0, 1, 0, 0),
        pad_edge=False,
    )
    for name in labels:
        table.add_column(name, no_wrap=True)
    for name in figures:
        table.add_column(name, justify="right", no_wrap=True)
    return table


def print_tables(console: Console, tables: Any, notes: tuple[str, ...]) -> None:
    """All tables, and how to read them."""
    for table in tables:
        console.print(table)
        console.print()
    console.print("\n".join(notes), style="dim", highlight=False, soft_wrap=True)


def scaled(value: float, factor: float, digits: int = 0) -> str:
    """`value` times `factor` with so many digits; "-" where it is undefined or infinite."""
    return f"{factor * value:.{digits}f}" if math.isfinite(value) else "-"


def mean(values: Any) -> float:
    """Of numbers; NaN of none."""
    return float(np.mean(values)) if len(values) else math.nan


def median(values: Any) -> float:
    """Of numbers; NaN of none."""
    return float(np.median(values)) if len(values) else math.nan
