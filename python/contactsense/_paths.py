"""Checks of paths that are arguments."""

from __future__ import annotations

import os
from pathlib import Path

from .errors import InputError


def path_of(path: str | os.PathLike[str]) -> Path:
    """The argument `path`; no number, which `open` takes for a file that the process has open already.

    Raises:
        InputError: it is no path.
    """
    try:
        return Path(path)
    except TypeError:
        raise InputError(f"path: expected a path, got {path!r}") from None
