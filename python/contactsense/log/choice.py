"""Which columns of a recording are a robot's positions, velocities and torques."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..errors import InputError
from .base_columns import BASE_POSE, BASE_TWIST
from .blocks import blocks
from .components import WRENCH
from .joint_names import match
from .quantities import CURRENT, EXTERNAL, POSITION, QUANTITIES, TORQUE, meaning
from .recording import Column, Recording, Table, listing

# What `columns` may name.
COLUMNS = ("time", *QUANTITIES, BASE_POSE, BASE_TWIST)


@dataclass(frozen=True)
class Group:
    """Columns of one table that hold the same quantity of several joints.

    Args:
        quantity: one of `QUANTITIES`.
        table: the table they are of.
        columns: the column of each of the robot's joints that has one.
        others: columns of joints that the robot does not have.
    """

    quantity: str
    table: Table
    columns: Mapping[str, str]
    others: tuple[str, ...]

    def values(self, joint: str) -> Column:
        """The column of a joint."""
        return self.table.columns[self.columns[joint]]

    @property
    def title(self) -> str:
        """For messages."""
        first, *rest = self.columns.values()
        names = f"'{first}'" if not rest else f"'{first}' to '{rest[-1]}'"
        return f"{self.quantity} from {names} of {self.table.name}"


def choose(
    recording: Recording,
    joints: Sequence[str],
    columns: Mapping[str, str | Sequence[str]],
    quantities: Sequence[str] = QUANTITIES,
) -> dict[str, Group]:
    """The groups that hold the most of the robot's joints, by quantity.

    Raises:
        InputError: no table has positions, or several groups fit as well.
    """
    found: dict[str, Group] = {}
    groups = [group for table in recording.tables for group in _groups(table, joints)]
    for quantity in quantities:
        if quantity in columns:
            found[quantity] = _named(recording, joints, quantity, columns[quantity])
            continue
        known = found.get(POSITION)
        own = [group for group in groups if group.quantity == quantity]
        best = _best(own, None if known is None else known.table)
        if len(best) > 1:
            titles = "; ".join(group.title for group in best)
            raise InputError(
                f"columns: several fit as {quantity}: {titles}; name one of them, or one of topics"
            )
        if best:
            found[quantity] = best[0]
    if POSITION not in found:
        raise InputError(_nothing("positions", joints, recording))
    if not {TORQUE, EXTERNAL, CURRENT} & set(found):
        what = "torques" if TORQUE in quantities else "external torques"
        raise InputError(_nothing(what, joints, recording))
    return found


def _nothing(what: str, joints: Sequence[str], recording: Recording) -> str:
    of_joints = f"the robot's {len(joints)} joints, {', '.join(joints)}"
    return f"columns: nothing holds {what} of {of_joints}; there are {listing(recording)}"


def _groups(table: Table, joints: Sequence[str]) -> list[Group]:
    by_source: dict[tuple[str, str], dict[str, str]] = {}
    # A wrench's torque is none of joints.
    forces = {column for block in blocks([table], WRENCH) for column in block.columns}
    for column in table.columns:
        told = None if column in forces else meaning(column)
        if told is not None:
            by_source.setdefault((told.quantity, told.source), {})[told.joint] = column
    groups = []
    for (quantity, _), named in by_source.items():
        matched = _matched(joints, list(named))
        if matched:
            others = tuple(named[name] for name in named if name not in matched.values())
            of_joints = {joint: named[name] for joint, name in matched.items()}
            groups.append(Group(quantity, table, of_joints, others))
    return groups


def _matched(joints: Sequence[str], names: Sequence[str]) -> dict[str, str]:
    """The name of each joint. Numbers tell joints only by their order, unless there are names beside them."""
    if all(map(_is_number, names)):
        return _numbered(joints, names)
    return match(joints, names)


def _is_number(name: str) -> bool:
    return re.fullmatch(r"[0-9]{1,9}", name) is not None


def _numbered(joints: Sequence[str], names: Sequence[str]) -> dict[str, str]:
    """Numbers without names, from 0 or 1 on, are the robot's joints in order if there are as many."""
    numbers = sorted((int(name), name) for name in names if _is_number(name))
    first = numbers[0][0] if numbers else -1
    consecutive = [number for number, _ in numbers] == list(range(first, first + len(joints)))
    if len(names) != len(joints) or first not in (0, 1) or not consecutive:
        return {}
    return {joint: name for joint, (_, name) in zip(joints, numbers, strict=True)}


def _best(groups: Sequence[Group], table: Table | None) -> list[Group]:
    """Those with most joints; of these, those of the table that has the positions, if any."""
    most = max((len(group.columns) for group in groups), default=0)
    best = [group for group in groups if len(group.columns) == most]
    beside = [group for group in best if group.table is table]
    return beside or best


def _named(recording: Recording, joints: Sequence[str], quantity: str, given: str | Sequence[str]) -> Group:
    """The columns that the user names: one a joint, or a pattern with `*` in place of the joint."""
    for table in recording.tables:
        if isinstance(given, str):
            pattern = given.replace("[", "[[]")
            matching = [name for name in table.columns if fnmatch.fnmatchcase(name, pattern)]
            before, _, after = given.partition("*")
            keys = {name[len(before) : len(name) - len(after)]: name for name in matching}
            matched = _matched(joints, list(keys))
            columns = {joint: keys[key] for joint, key in matched.items()}
            others = tuple(name for name in matching if name not in columns.values())
        else:
            if len(given) != len(joints):
                raise InputError(
                    f"columns: {quantity} must name {len(joints)} columns, one for each of "
                    f"{', '.join(joints)}"
                )
            columns = dict(zip(joints, given, strict=True)) if set(given) <= set(table.columns) else {}
            others = ()
        if columns:
            return Group(quantity, table, columns, others)
    raise InputError(f"columns: no table has {given!r} for {quantity}; there are {listing(recording)}")
