"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A file beside `path` to write to, which takes its name at the end; it is removed where that fails."""
    wanted = Path(path)
    wanted.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=f".{wanted.name}.", dir=wanted.parent)
    os.close(handle)
    written = Path(name)
    try:
        yield written
        # As a file that is opened for writing; `mkstemp` lets only its owner read it.
        mask = os.umask(0)
        os.umask(mask)
        written.chmod(0o666 & ~mask)
        written.replace(wanted)
    except BaseException:
        with suppress(OSError):
            written.unlink()
        raise
