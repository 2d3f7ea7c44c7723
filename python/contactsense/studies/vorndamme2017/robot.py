"""The study's robot."""

from __future__ import annotations

from functools import lru_cache

from ... import Robot

ROBOT = "atlas"


@lru_cache(maxsize=1)
def shared_robot() -> Robot:
    """Loaded once a process."""
    return Robot.named(ROBOT)
