"""Many logs of robots, into one data set of what was found in them."""

from .replay_fleet import replay_fleet
from .result import FleetReplay

__all__ = ["FleetReplay", "replay_fleet"]
