"""Logs of a fleet through monitors, in parallel."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from numbers import Integral
from pathlib import Path
from typing import Any, Literal, get_args

from .. import _core
from .._extras import require
from ..errors import InputError
from .result import FleetReplay

Engine = Literal["local", "ray"]
ENGINES: tuple[Engine, ...] = get_args(Engine)


def replay_fleet(
    logs: Sequence[str | os.PathLike[str]],
    robot: _core.Robot,
    folder: str | os.PathLike[str],
    *,
    name: str | None = None,
    reading: Mapping[str, Any] | None = None,
    monitor: Mapping[str, Any] | None = None,
    classifier: Mapping[str, Any] | None = None,
    ticks: bool = False,
    engine: Engine = "local",
    workers: int | None = None,
    address: str | None = None,
    on_progress: Callable[[int, int], None] | None = None,
) -> FleetReplay:
    """Replays logs of one robot in parallel, and adds what was found to a data set of a fleet.

    The data set is of Parquet tables, partitioned by robot (`contacts/robot=NAME/...`): `logs` (one row a
    log), `contacts` and `contact_ticks` as those of `Replay.to_parquet`, each with the log's path in the
    column `log`. Robots of other models or calibrations are added by further calls. Logs that the data set
    has already, with the same settings, are passed over, so that a run that was ended goes on when it is
    called again; the data set is then the same, byte for byte. Logs that fail are tried once more after all
    others. Programs that call this with the engine "local" need `if __name__ == "__main__":`.

    Args:
        logs: files or folders of bags; on a cluster, paths that all of its machines can read.
        robot: their robot.
        folder: of the data set; on a cluster, one that all of its machines can write to. One run a robot at a
            time may write to it.
        name: of the robot in the data set; by default the name of its model.
        reading: arguments of `read_log`, by name.
        monitor: arguments of `ContactMonitor`, by name, without `dt`, which is that of each log.
        classifier: arguments of `ContactClassifier`, by name, without `dt`; empty for its defaults.
            None: contacts have no classes.
        ticks: whether there is also a table `ticks`, with a row for each row of each log.
        engine: "local", a process a log; or "ray", one task of Ray a log.
        workers: tasks at a time on this machine; by default one for each core.
        address: of a Ray cluster, such as "auto" or "ray://head:10001"; by default Ray is started here.
        on_progress: called after each log with the number of logs done and of all logs.

    Returns:
        A `FleetReplay`: what became of each log.

    Raises:
        InputError: an argument is wrong; names it.
        MissingExtraError: pyarrow, or Ray where it is asked for, is not installed.
        OSError: the data set cannot be written to.

    Example:
        >>> import contactsense as cs, tempfile
        >>> robot = cs.Robot.named("iiwa14")
        >>> cs.replay_fleet([], robot, tempfile.mkdtemp(), monitor={"torque_threshold": 1.0})
        FleetReplay(0 replayed, 0 unchanged, 0 failed)
    """
    # Processes take milliseconds to import that few programs need.
    from .run import Run
    from .settings import Settings

    _check_types(name, reading=reading, monitor=monitor, classifier=classifier)
    _check(robot, engine, workers, address, monitor, classifier)
    every = _paths(logs)
    wanted = _path("folder", folder)
    require("log", "pyarrow")
    settings = Settings(
        wanted,
        name or robot.name,
        robot,
        reading=reading or {},
        monitor=monitor or {},
        classifier=classifier,
        ticks=ticks,
    )
    run = Run(settings, every, on_progress)
    interrupted = False
    try:
        run.all(engine, workers, address)
    except KeyboardInterrupt:
        interrupted = True
    return run.result(interrupted)


def _path(argument: str, path: Any) -> Path:
    from .._paths import path_of  # few programs need it

    return Path(os.path.abspath(path_of(path, argument)))


def _paths(logs: object) -> list[Path]:
    """Each log once."""
    if isinstance(logs, str | os.PathLike) or not isinstance(logs, Iterable):
        raise InputError(f"logs: expected a sequence of paths, got {logs!r}")
    return list(dict.fromkeys(_path("logs", log) for log in logs))


def _check_types(name: object, **by_name: object) -> None:
    if name is not None and not isinstance(name, str):
        raise InputError(f"name: expected a string, got {name!r}")
    for argument, given in by_name.items():
        if given is not None and not isinstance(given, Mapping):
            raise InputError(f"{argument}: expected a mapping, got {type(given).__name__}")


def _check(
    robot: _core.Robot,
    engine: str,
    workers: int | None,
    address: str | None,
    monitor: Mapping[str, Any] | None,
    classifier: Mapping[str, Any] | None,
) -> None:
    if not isinstance(robot, _core.Robot):
        raise InputError(f"robot: expected a contactsense.Robot, got {type(robot).__name__}")
    if engine not in ENGINES:
        raise InputError(f"engine: must be {' or '.join(ENGINES)}, not {engine!r}")
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, Integral)):
        raise InputError(f"workers: expected a whole number, got {workers!r}")
    if workers is not None and workers < 1:
        raise InputError(f"workers: must be at least 1, not {workers}")
    if address is not None and engine != "ray":
        raise InputError(f"address: is that of a Ray cluster; the engine is {engine!r}")
    from ..offline.monitor_of import classifier_of  # a module that few programs need

    # What is wrong for one log is wrong for all.
    classifier_of(_core.ContactMonitor(robot, dt=0.001, **(monitor or {})), classifier)
