"""What a robot measured over time, and the files that hold it."""

from .log import Log
from .read import read_log
from .reading import Reading

__all__ = ["Log", "Reading", "read_log"]
