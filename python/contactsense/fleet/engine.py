"""What runs the tasks of a fleet."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from pathlib import Path

from .one_log import Outcome
from .settings import Settings

Work = Callable[[Settings, Path], Outcome]
# As they come, in any order.
Outcomes = Generator[tuple[Path, Outcome], None, None]
Engine = Callable[[Sequence[Path]], Outcomes]
