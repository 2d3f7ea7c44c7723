"""One core, one thread a library, and a note of what was measured on."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from importlib import metadata
from pathlib import Path

THREAD_VARIABLES = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "IGL_PARALLEL_FOR_NUM_THREADS",
    "TBB_NUM_THREADS",
)
PACKAGES = ("contactsense", "numpy", "pin", "trimesh", "embreex", "libigl", "fcpw", "scipy")
_allowed: set[int] = set()  # before the process was pinned


def use_one_core(core: int | None = None) -> str:
    """Pins this process; to be called before NumPy and the peers are imported. Says what it did."""
    for variable in THREAD_VARIABLES:
        os.environ[variable] = "1"
    if not hasattr(os, "sched_setaffinity"):
        return "one thread a library; this system cannot pin a process to a core"
    _allowed.update(os.sched_getaffinity(0))
    core = max(_allowed) if core is None else core
    os.sched_setaffinity(0, {core})
    return f"pinned to core {core}"


def all_cores() -> AbstractContextManager[None]:
    """Frees this thread, and those that it starts, from the one core meanwhile."""
    return _on_cores(lambda pinned: _allowed)


def other_cores() -> AbstractContextManager[None]:
    """Processes that are started meanwhile run on the other cores, if there are any."""
    return _on_cores(lambda pinned: _allowed - pinned or _allowed)


@contextmanager
def _on_cores(chosen: Callable[[set[int]], set[int]]) -> Iterator[None]:
    """On cores that are chosen by those of before; where nothing is pinned, it stays so."""
    if not _allowed:
        yield
        return
    pinned = os.sched_getaffinity(0)
    os.sched_setaffinity(0, chosen(pinned))
    try:
        yield
    finally:
        os.sched_setaffinity(0, pinned)


def describe() -> dict[str, str]:
    """The class of machine and the versions in use."""
    about = {
        "cpu": _cpu_name(),
        "cores": str(os.cpu_count()),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    }
    for package in PACKAGES:
        try:
            about[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            about[package] = "absent"
    return about


def _cpu_name() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or "unknown"
