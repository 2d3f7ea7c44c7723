"""What a robot measured over time."""

from .log import Log

__all__ = ["Log"]
