"""Contacts as JSON, a line each."""

from __future__ import annotations

import json
import os

from .result import Replay
from .whole import whole_file


def write_json_lines(replay: Replay, path: str | os.PathLike[str]) -> None:
    """See `Replay.to_json_lines`."""
    with whole_file(path) as file:
        lines = [json.dumps(contact.to_dict(), allow_nan=False) + "\n" for contact in replay.contacts]
        file.write_text("".join(lines), encoding="utf-8")
