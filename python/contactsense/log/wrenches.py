"""Readings of force/torque sensors in a log: which columns are whose."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from .. import _core
from ..errors import InputError
from .blocks import Block, blocks, named_block, titles
from .components import WRENCH
from .held import Extra, series_of
from .joint_names import Tokens, words
from .recording import Recording
from .sensors import WantedSensor
from .time_axis import TimeAxis

WRENCHES = "wrenches"
# What a controller works out is no reading of a sensor, unless its name says so.
_ESTIMATED = frozenset({"ext", "external", "estimate", "estimated", "hat"})
# Words that names of sensors and topics have or lack at will.
_FILLERS = frozenset({"ft", "fts", "sensor", "force", "torque", "wrench", "link", "frame", "joint", "data"})


def wrench_rows(
    recording: Recording,
    robot: _core.Robot,
    wanted: Sequence[WantedSensor],
    axis: TimeAxis,
    time_column: str | None,
) -> Extra:
    """Readings of all sensors `(n, 6 sensors)` at the times of the joints: the last ones by then.

    Raises:
        InputError: a sensor has no readings, or it is ambiguous which are its own.
    """
    there = blocks(recording.tables, WRENCH)
    chosen = _assigned(recording, wanted, there)
    extra = Extra.none(axis)
    columns = []
    for sensor, block in zip(wanted, chosen, strict=True):
        block.check_frames("sensors")
        note = sensor.frame_note(block.frame, robot)
        series = series_of(recording, block, time_column)
        columns.append(extra.hold(series, axis, f"reading of '{sensor.name}'", "sensors"))
        extra.chosen.append(f"wrench of '{sensor.name}' from {block.title} [N, Nm]{note}")
    if columns:
        extra.values[WRENCHES] = np.column_stack(columns)
    taken = {(id(block.table), block.columns) for block in chosen}
    extra.left_out += [
        f"wrench {block.title}: no sensor was given for it"
        for block in there
        if (id(block.table), block.columns) not in taken
    ]
    return extra


def _assigned(recording: Recording, wanted: Sequence[WantedSensor], there: Sequence[Block]) -> list[Block]:
    chosen = []
    for sensor in wanted:
        if sensor.source is not None:
            chosen.append(named_block(recording, [WRENCH], sensor.source, f"sensors: '{sensor.name}'"))
        else:
            chosen.append(_found(sensor, there, is_alone=len(wanted) == 1))
    for k, block in enumerate(chosen):
        for other, earlier in zip(wanted, chosen[:k], strict=False):
            if earlier.table is block.table and earlier.columns == block.columns:
                names = f"'{other.name}' and '{wanted[k].name}'"
                raise InputError(
                    f"sensors: {names} both fit {block.title}; there are {_listing(there)}; {_NAME_IT}"
                )
    return chosen


_NAME_IT = "name the topic or the columns, as in sensors={'wrist': '/ft/wrench'}"


def _found(sensor: WantedSensor, there: Sequence[Block], is_alone: bool) -> Block:
    """The block whose names are the sensor's, or the only one of the only sensor."""
    fitting, told = list(there), False
    for fits in _fits(sensor):
        some = [block for block in fitting if fits(block)]
        if some:
            fitting, told = some, True
    if len(fitting) == 1 and (told or (is_alone and not _ESTIMATED & set(fitting[0].words))):
        return fitting[0]
    at = f" at '{sensor.link}'" if sensor.link else ""
    if told:
        raise InputError(
            f"sensors: several wrenches fit '{sensor.name}'{at}: {_listing(fitting)}; {_NAME_IT}"
        )
    raise InputError(
        f"sensors: no wrench is named as '{sensor.name}'{at}; there are {_listing(there)}; {_NAME_IT}"
    )


def _fits(sensor: WantedSensor) -> list[Callable[[Block], bool]]:
    """From the surest sign on: frame, whole names in the topic or column, words of names."""
    names = [name for name in (sensor.name, sensor.link) if name]
    return [
        lambda block: block.frame in names or block.frame.rpartition("/")[2] in names,
        lambda block: _has(block.words, words(sensor.name)),
        lambda block: bool(sensor.link) and _has(block.words, words(sensor.link)),
        lambda block: _has(block.words, _telling(sensor.name)),
        lambda block: bool(sensor.link) and _has(block.words, _telling(sensor.link)),
    ]


def _telling(name: str) -> Tokens:
    return tuple(word for word in words(name) if word not in _FILLERS)


def _has(words_of_block: Tokens, some: Tokens) -> bool:
    places = range(len(words_of_block) - len(some) + 1)
    return bool(some) and any(words_of_block[at : at + len(some)] == some for at in places)


def _listing(there: Sequence[Block]) -> str:
    return titles(there) or "no columns of six components"
