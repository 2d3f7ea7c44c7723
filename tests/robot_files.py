"""Published robots to load: the example-robot-data package and, where present, `../shared/robots`."""

from pathlib import Path

import pytest
from robots import EXAMPLE_SHARE
from robots import SHARED as BESIDE

SHARED = BESIDE / "robots"
SHARE = EXAMPLE_SHARE if (EXAMPLE_SHARE / "example-robot-data").is_dir() else None
_ROBOTS = SHARE / "example-robot-data" / "robots" if SHARE else None

# Descriptions without a link: what xacro leaves of a macro file.
EMPTY = {"ur3.urdf"}


def _params() -> list:
    params = []
    for folder, reason in ((_ROBOTS, "example-robot-data is not installed"), (SHARED, "../shared is absent")):
        files = sorted(folder.rglob("*.urdf")) if folder and folder.is_dir() else []
        if not files:
            params.append(pytest.param(None, id=reason.split()[0], marks=pytest.mark.skip(reason=reason)))
        params += [
            pytest.param(file, id=str(file.relative_to(folder))) for file in files if file.name not in EMPTY
        ]
    return params


ROBOTS = _params()
PACKAGE_DIRS = [SHARE] if SHARE else []


def example(relative: str) -> Path:
    """A file of example-robot-data; skips the test where it is not installed."""
    if _ROBOTS is None:
        pytest.skip("example-robot-data is not installed")
    return _ROBOTS / relative
