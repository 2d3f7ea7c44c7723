"""Contacts and ticks as Parquet, one schema each."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._extras import require
from .summary import PROBABILITIES
from .whole import whole_file

_CONTACT: dict[str, Any] = {
    "id": np.int64, "start": np.float64, "end": np.float64, "link": str, "link_probability": np.float64,
    "located": np.bool_, "point": 3, "point_local": 3, "region_radius": np.float64, "peak_force": np.float64,
    "force": 3,
}  # fmt: skip
# Of contacts that are classified.
_CLASS: dict[str, Any] = {"kind": str, **dict.fromkeys(PROBABILITIES, np.float64)}


def write_parquet(tables: Mapping[str, Mapping[str, NDArray[Any]]], folder: str | os.PathLike[str]) -> None:
    """One file a table, of columns by name; each appears whole or not at all."""
    require("log", "pyarrow")
    import pyarrow.parquet

    for name, columns in tables.items():
        with whole_file(Path(folder) / f"{name}.parquet") as file:
            pyarrow.parquet.write_table(as_table(columns), file)


def replay_tables(
    contacts: Sequence[Any], contact_ticks: Mapping[str, NDArray[Any]], ticks: Mapping[str, NDArray[Any]]
) -> dict[str, Mapping[str, NDArray[Any]]]:
    """The columns of each table of a `Replay` by its name."""
    schema = _CONTACT | _CLASS if "clamped" in contact_ticks else _CONTACT
    return {"contacts": _contact_columns(contacts, schema), "contact_ticks": contact_ticks, "ticks": ticks}


def _contact_columns(contacts: Sequence[Any], schema: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    """Columns with one value a contact."""
    columns: dict[str, NDArray[Any]] = {}
    for name, kind in schema.items():
        values = [getattr(contact, name) for contact in contacts]
        if isinstance(kind, int):
            columns[name] = np.array(values, dtype=np.float64).reshape(-1, kind)
        else:
            columns[name] = np.array(values, dtype=object if kind is str else kind)
    return columns


def as_table(columns: Mapping[str, NDArray[Any]]) -> Any:
    """A `pyarrow.Table`; vectors are lists of fixed length, text is text also where there are no rows."""
    import pyarrow as pa

    def column(values: NDArray[Any]) -> Any:
        if values.dtype == object:
            return pa.array(values.tolist(), type=pa.string())
        if values.ndim == 2:
            return pa.FixedSizeListArray.from_arrays(pa.array(values.ravel()), values.shape[1])
        return pa.array(np.ascontiguousarray(values))

    return pa.table({name: column(values) for name, values in columns.items()})
