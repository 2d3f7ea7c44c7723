"""Pictures of the tutorials."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

PICTURES: dict[str, Callable[[Path], None]] = {}
