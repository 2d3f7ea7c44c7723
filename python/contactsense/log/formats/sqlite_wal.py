"""Pages of an SQLite file that wait in its write-ahead log, as a recorder leaves them that was killed."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

_MAGIC = (b"\x37\x7f\x06\x82", b"\x37\x7f\x06\x83")
_HEAD, _FRAME = 32, 24  # bytes
MAX_LOG = 2**30  # bytes; SQLite begins anew after a few MB


@dataclass(frozen=True)
class WaitingPages:
    """The newest state of each page that was committed.

    Args:
        pages: by number.
        count: of all pages of the file after the last commit; 0 without one.
        is_cut: whether pages follow the last commit, or the log is not one.
    """

    pages: dict[int, bytes] = field(default_factory=dict)
    count: int = 0
    is_cut: bool = False


def waiting_pages(path: Path, page_size: int) -> WaitingPages:
    """Those of a log; none where there is no log, or one that is not of this file.

    Its checksums are not compared: what is broken shows in the pages.
    """
    try:
        with path.open("rb") as file:
            data = file.read(MAX_LOG)
    except OSError:
        return WaitingPages()
    if data[:4] not in _MAGIC or int.from_bytes(data[8:12], "big") != page_size:
        return WaitingPages(is_cut=len(data) > 0)
    salts = data[16:24]
    committed: dict[int, bytes] = {}
    uncommitted: dict[int, bytes] = {}
    count = 0
    for at in range(_HEAD, len(data), _FRAME + page_size):
        head, page = data[at : at + _FRAME], data[at + _FRAME : at + _FRAME + page_size]
        # Frames of an earlier round of the log are still behind the newest ones.
        if head[8:16] != salts or len(page) < page_size:
            break
        uncommitted[int.from_bytes(head[:4], "big")] = page
        after = int.from_bytes(head[4:8], "big")
        if after:
            committed |= uncommitted
            uncommitted, count = {}, after
    return WaitingPages(committed, count, bool(uncommitted))
