"""From tables of numbers to the rows of one robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..errors import InputError
from .base_pose import base_rows, left_out_by_base, write_base
from .choice import Group, choose
from .held import LARGEST
from .joint_columns import JointColumns
from .log import Log
from .quantities import CURRENT, EXTERNAL, POSITION, QUANTITIES, TORQUE, VELOCITY
from .reading import Reading
from .recording import Recording, Table
from .resample import at_rate, differences
from .sensors import WantedSensor
from .time_axis import TimeAxis, held, time_of
from .units import scale, unit_of, velocity_unit
from .wrenches import WRENCHES, wrench_rows

Rows = NDArray[np.float64]


# What is looked for where the external torque alone is wanted.
_OF_EXTERNAL = (POSITION, VELOCITY, EXTERNAL)


@dataclass(frozen=True)
class Wishes:
    """What the user says of a file; see `read_log`."""

    columns: Mapping[str, str | Sequence[str]]
    units: Mapping[str, str]
    torque_constants: NDArray[np.float64] | None
    external: bool
    rate: float | None
    sensors: tuple[WantedSensor, ...]

    @property
    def time(self) -> str | None:
        """The column of the time."""
        named = self.columns.get("time")
        return named if isinstance(named, str) or named is None else next(iter(named), None)


def robot_log(path: str, recording: Recording, robot: _core.Robot, wishes: Wishes) -> Log:
    """The log of what a recording has of a robot; see `read_log`."""
    joints = JointColumns(robot)
    groups = choose(recording, joints.names, wishes.columns, _OF_EXTERNAL if wishes.external else QUANTITIES)
    left_out = [*recording.left_out, *left_out_by_base(recording, groups, robot.floating_base)]
    if TORQUE in groups:
        groups.pop(CURRENT, None)
    for group in groups.values():
        _check_complete(group, joints.names)
    axis = time_of(recording, groups[POSITION].table, wishes.time)
    values, known = _values(recording, groups, axis, joints.names, wishes.time)
    extra = wrench_rows(recording, robot, wishes.sensors, axis, wishes.time)
    if robot.floating_base:
        extra.add(base_rows(recording, robot, wishes.columns, axis, wishes.time))
    values, known = values | extra.values, known & extra.known
    if np.count_nonzero(known) < 2:
        raise InputError(
            f"path: {np.count_nonzero(known)} rows of {path} are complete; at least 2 are wanted"
        )
    time = axis.time
    if not np.all(known):  # else they need not be copied
        time, values = time[known], {quantity: rows[known] for quantity, rows in values.items()}
    mended = [*axis.mended, *_faults(known, {name: values[name] for name in groups}), *extra.mended]
    chosen = [axis.chosen, *_to_units(time, values, groups, joints, wishes), *extra.chosen]
    if VELOCITY not in values:
        values[VELOCITY] = differences(time, values[POSITION])
        chosen.append("velocity: central differences of positions")
    if wishes.rate is not None:
        time, values = at_rate(time, values, wishes.rate)
        chosen.append(f"interpolated to {wishes.rate:g} rows a second")
    unknown = list(dict.fromkeys(name for group in groups.values() for name in group.others))
    others = [f"columns of joints that the robot does not have: {', '.join(unknown)}"] if unknown else []
    left_out += [*extra.left_out, *others]
    # Each is given up for its copy: long logs take much memory.
    q, v = joints.configuration(values.pop(POSITION)), joints.velocity(values.pop(VELOCITY))
    torques = {name: joints.velocity(values.pop(name)) for name in (TORQUE, EXTERNAL) if name in values}
    if robot.floating_base:
        write_base(q, v, values)
        torques[TORQUE] = torques[TORQUE][:, 6:]
    return Log(
        time,
        q,
        v,
        torques.get(TORQUE),
        wrenches=values[WRENCHES].reshape(len(q), -1, 6) if WRENCHES in values else None,
        external_torque=torques.get(EXTERNAL),
        reading=Reading(path, tuple(chosen), tuple(mended), tuple(left_out), recording.damage),
    )


def _check_complete(group: Group, joints: Sequence[str]) -> None:
    lacking = [joint for joint in joints if joint not in group.columns]
    if lacking:
        others = f"; it has others: {', '.join(group.others)}" if group.others else ""
        raise InputError(
            f"robot: the log has no {group.quantity} of {', '.join(lacking)} ({group.title}){others}; "
            "lock these joints (locked_joints of Robot.from_urdf), or name the columns"
        )


def _values(
    recording: Recording,
    groups: Mapping[str, Group],
    axis: TimeAxis,
    joints: Sequence[str],
    time_column: str | None,
) -> tuple[dict[str, Rows], NDArray[np.bool_]]:
    """The quantities at the times of the positions, and which rows have all of them."""
    base = groups[POSITION].table
    rows_of: dict[int, tuple[NDArray[np.intp], NDArray[np.bool_]]] = {
        id(base): (axis.rows, np.ones(len(axis.rows), dtype=bool))
    }
    known = np.ones(len(axis.rows), dtype=bool)
    values: dict[str, Rows] = {}
    for quantity, group in groups.items():
        if id(group.table) not in rows_of:
            rows_of[id(group.table)] = _last_rows(recording, group.table, axis, time_column)
        rows, present = rows_of[id(group.table)]
        values[quantity] = np.column_stack([group.values(joint)[rows] for joint in joints])
        # A NaN is not less than anything.
        known &= present & np.all(np.abs(values[quantity]) < LARGEST, axis=1)
    return values, known


def _last_rows(
    recording: Recording, table: Table, axis: TimeAxis, time_column: str | None
) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Rows of another table that were its last ones at the times of an axis, and where there were any."""
    own = time_of(recording, table, time_column if time_column in table.columns else None)
    last = held(axis.time + (axis.start - own.start), own.time)
    return own.rows[np.maximum(last, 0)], last >= 0


def _faults(known: NDArray[np.bool_], values: Mapping[str, Rows]) -> list[str]:
    faults = []
    if not np.all(known):
        faults.append(f"{np.count_nonzero(~known)} rows with values that are missing left out")
    repeats = np.all([np.all(rows[1:] == rows[:-1], axis=1) for rows in values.values()], axis=0)
    if np.any(repeats):
        faults.append(f"{np.count_nonzero(repeats)} rows repeat the values of the row before; they are kept")
    return faults


def _to_units(
    time: Rows,
    values: dict[str, Rows],
    groups: Mapping[str, Group],
    joints: JointColumns,
    wishes: Wishes,
) -> list[str]:
    """Makes the values those of the library's units; says which units they had."""
    chosen = []
    for quantity, group in groups.items():
        unit = unit_of(group, values[quantity], joints.turns, wishes.units)
        if quantity == VELOCITY and quantity not in wishes.units:
            unit = velocity_unit(unit, values[quantity], values[POSITION], time, joints.turns)
        factor = np.where(joints.turns if "deg" in unit else np.True_, scale(group, unit), 1.0)
        if np.any(factor != 1.0):
            values[quantity] = values[quantity] * factor
        chosen.append(f"{group.title} [{unit}]")
    if CURRENT in values:
        if wishes.torque_constants is None:
            raise InputError(
                f"torque_constants: {groups[CURRENT].title} are no torques; give the torque for each ampere"
            )
        values[TORQUE] = values.pop(CURRENT)
    wanted = EXTERNAL if wishes.external else TORQUE
    if wishes.torque_constants is not None and wanted in values:
        values[wanted] = values[wanted] * wishes.torque_constants
        chosen.append(f"{wanted}: what was recorded, times torque_constants")
    return chosen
