"""Files that others wrote, read whole."""

from __future__ import annotations

import os
import stat


def read_regular_file(path: str | os.PathLike[str], largest: int) -> bytes:
    """The bytes of a regular file; `OSError` for anything else, and for more than `largest` bytes.

    A device or a pipe can have no end, or no beginning, so neither is opened.
    """
    about = os.stat(path)
    if not stat.S_ISREG(about.st_mode):
        raise OSError("it is not a regular file")
    content = b""
    if about.st_size <= largest:
        with open(path, "rb") as file:
            # A file may grow, or not know its size, as those in /proc.
            content = file.read(largest + 1)
    size = max(about.st_size, len(content))
    if size > largest:
        raise OSError(f"it has {size} bytes or more; at most {largest} are read")
    return content
