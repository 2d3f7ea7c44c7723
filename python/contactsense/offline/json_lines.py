"""Contacts as JSON, a line each."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from typing import Any

from .whole import whole_file


def write_json_lines(contacts: Iterable[Mapping[str, Any]], path: str | os.PathLike[str]) -> None:
    """One JSON object a contact; the file appears whole or not at all."""
    with whole_file(path) as file:
        lines = [json.dumps(contact, allow_nan=False) + "\n" for contact in contacts]
        file.write_text("".join(lines), encoding="utf-8")
