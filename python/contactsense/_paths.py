"""Checks of paths that are arguments."""

from __future__ import annotations

import os
from pathlib import Path

from .errors import InputError


def path_of(path: str | os.PathLike[str], argument: str = "path") -> Path:
    """A path that was given as an argument; no number, which `open` takes for a file that is open already.

    Raises:
        InputError: it is no path.
    """
    try:
        return Path(path)
    except TypeError:
        raise InputError(f"{argument}: expected a path, got {path!r}") from None
