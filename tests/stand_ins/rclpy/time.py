"""Time stamps."""

from __future__ import annotations

from geometry_msgs.msg import Stamp


class Time:
    def __init__(self, nanoseconds: int) -> None:
        self.nanoseconds = nanoseconds

    @classmethod
    def from_msg(cls, stamp: Stamp) -> Time:
        return cls(1_000_000_000 * stamp.sec + stamp.nanosec)
