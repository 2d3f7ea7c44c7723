"""Whether a picture can be written, before the work that it shows is done."""

from __future__ import annotations

import os
from pathlib import Path

from .errors import InputError


def picture_file(argument: str, path: str | os.PathLike[str]) -> Path:
    """The absolute path of a picture to be written; ".png" is added where there is no suffix.

    Raises:
        InputError: it cannot be written; names `argument`.
    """
    from matplotlib.backend_bases import FigureCanvasBase

    target = Path(path).resolve()
    if target.is_dir():
        raise InputError(
            f"{argument}: '{path}' is a folder; name a file in it, such as '{Path(path) / 'a.png'}'"
        )
    target = target if target.suffix else target.with_suffix(".png")
    kinds = FigureCanvasBase.get_supported_filetypes()
    if target.suffix[1:].lower() not in kinds:
        known = ", ".join(f".{kind}" for kind in kinds)
        raise InputError(f"{argument}: cannot write '{path}': it must end in one of {known}")
    if not target.parent.is_dir():
        raise InputError(f"{argument}: cannot write '{path}': there is no folder '{target.parent}'")
    if not os.access(target if target.exists() else target.parent, os.W_OK):
        raise InputError(f"{argument}: cannot write '{path}': permission denied")
    return target


def picture_folder(argument: str, path: str | os.PathLike[str]) -> Path:
    """A folder for pictures, made if need be.

    Raises:
        InputError: pictures cannot be written there; names `argument`.
    """
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as cause:
        raise InputError(f"{argument}: '{path}' cannot be a folder for pictures: {cause.strerror}") from cause
    if not os.access(folder, os.W_OK):
        raise InputError(f"{argument}: cannot write into '{path}': permission denied")
    return folder
