"""Pictures of the pages in the browser: of a log, of a control loop, and the exported file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

PICTURES: dict[str, Callable[[Path], None]] = {}
