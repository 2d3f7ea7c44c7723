"""Columns of a recording that are together one quantity of several components."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..errors import InputError
from .components import DIGITS, Kind
from .joint_names import Tokens, words
from .quantities import NOT_MEASURED
from .recording import Recording, Table, listing

# Units that the name of a component may end in.
_UNITS = frozenset({"n", "nm", "m", "rad", "s"})


@dataclass(frozen=True, eq=False)
class Block:
    """The columns of one table that are the components of one quantity.

    Args:
        kind: of quantity.
        table: the table.
        columns: in the order of the kind's components.
        stem: the words that the names have in common.
    """

    kind: Kind
    table: Table
    columns: tuple[str, ...]
    stem: Tokens

    @property
    def words(self) -> Tokens:
        """All words that tell whose it is: of the topic or table, and of the columns."""
        return (*words(self.table.name), *self.stem)

    @property
    def frame(self) -> str:
        """The frame of its messages; empty where it is not known."""
        return self.frame_in("header.frame_id")

    def frame_in(self, field: str) -> str:
        """The frame that a field names; empty where none is known."""
        frames = self.table.frames.get(field, ())
        return frames[0].strip("/") if len(frames) == 1 else ""

    def check_frames(self, argument: str) -> None:
        """Refuses messages of which some are in another frame.

        Raises:
            InputError: lists the frames.
        """
        for frames in self.table.frames.values():
            if len(frames) > 1:
                names = ", ".join(f"'{frame}'" for frame in frames)
                raise InputError(f"{argument}: messages of {self.table.name} are of several frames: {names}")

    @property
    def title(self) -> str:
        """For messages."""
        frame = f" (frame '{self.frame}')" if self.frame else ""
        return f"'{self.columns[0]}' to '{self.columns[-1]}' of {self.table.name}{frame}"


def titles(several: Sequence[Block]) -> str:
    """Of blocks to choose from, for messages; with all columns where the first and last are the same."""
    short = [block.title for block in several]
    if len(set(short)) < len(short):
        short = [f"{', '.join(block.columns)} of {block.table.name}" for block in several]
    return "; ".join(short)


def blocks(tables: Sequence[Table], kind: Kind) -> list[Block]:
    """All complete ones; what was asked for, and not measured, is none."""
    measured = [table for table in tables if not (table.kind and NOT_MEASURED & set(words(table.name)))]
    return [block for table in measured for block in _of_columns(table, kind, _measured(table.columns))]


def named_block(recording: Recording, kinds: Sequence[Kind], given: str | Sequence[str], what: str) -> Block:
    """The one that the user names: by its topic, by a pattern with `*` for the component, or by all columns.

    Of several kinds, the first that is there.

    Raises:
        InputError: there is none, or several.
    """
    for kind in kinds:
        found = [block for table in recording.tables for block in _named(table, kind, given)]
        if len(found) == 1:
            return found[0]
        if found:
            raise InputError(
                f"{what}: several fit {given!r}: {titles(found)}; name the columns of one of them"
            )
    raise InputError(
        f"{what}: nothing that {given!r} names has the {len(kinds[0].order)} components of a "
        f"{kinds[0].name}, {', '.join(kinds[0].order)}; there are {listing(recording)}"
    )


def _named(table: Table, kind: Kind, given: str | Sequence[str]) -> list[Block]:
    if not isinstance(given, str):
        whole = len(given) == len(kind.order) and set(given) <= set(table.columns)
        return [Block(kind, table, tuple(given), ())] if whole else []
    if given == table.name:
        return _of_columns(table, kind, list(table.columns))
    before, star, after = given.partition("*")
    pattern = given.replace("[", "[[]")
    matching = [name for name in table.columns if star and fnmatch.fnmatchcase(name, pattern)]
    numbers = {name[len(before) : len(name) - len(after)]: name for name in matching}
    in_order = sorted((it for it in numbers if it.isdecimal() and len(it) <= DIGITS), key=int)
    if len(in_order) == len(numbers) == len(kind.order):
        return [Block(kind, table, tuple(numbers[number] for number in in_order), ())]
    return _of_columns(table, kind, matching)


def _measured(columns: Iterable[str]) -> list[str]:
    return [column for column in columns if not NOT_MEASURED & set(words(column))]


def _of_columns(table: Table, kind: Kind, columns: Sequence[str]) -> list[Block]:
    found: dict[tuple[Tokens, Tokens], dict[str, list[str]]] = {}
    for column in columns:
        told = kind.component(words(column))
        if told is not None:
            part, before, after = told
            while after and after[-1] in _UNITS:
                after = after[:-1]
            found.setdefault((before, after), {}).setdefault(part, []).append(column)
    whole = {stem: parts for stem, parts in found.items() if len(parts) == len(kind.order)}
    return [
        Block(kind, table, chosen, (*before, *after))
        for (before, after), parts in whole.items()
        # Where a component is there twice, both are found, so that none is taken without a word.
        for chosen in dict.fromkeys(tuple(parts[part][end] for part in kind.order) for end in (0, -1))
    ]
