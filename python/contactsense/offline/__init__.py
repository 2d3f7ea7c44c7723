"""A log through a monitor, and files of what it found."""

from .replay import replay
from .result import Replay
from .summary import ReplayedContact

__all__ = ["Replay", "ReplayedContact", "replay"]
