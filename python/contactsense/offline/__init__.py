"""A log through a monitor, and files of what it found."""

from .contact import ReplayedContact
from .replay import replay
from .result import Replay

__all__ = ["Replay", "ReplayedContact", "replay"]
