"""What a bridge counts, and what it says of its health."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from .values import Health

OK, WARNING, ERROR = 0, 1, 2
# The rate of the messages may differ from the one in the configuration by so much.
_RATE_FACTOR = 1.5
_MICROSECONDS = 1e6  # of a second


@dataclass
class Counts:
    """Since the start.

    Args:
        received: messages on the topic of the joint states.
        taken: of these, those that the monitor took in.
        refused: those that it did not, with a reason.
        other_joints: messages without any joint of the robot, as of a gripper; no fault.
        late: messages that were not newer than the one before.
        lost: messages that the sender numbered, and that did not arrive.
        contacts: how often a contact began.
        tick_time: of all ticks [s].
    """

    received: int = 0
    taken: int = 0
    refused: int = 0
    other_joints: int = 0
    late: int = 0
    lost: int = 0
    contacts: int = 0
    tick_time: float = 0.0

    def since(self, before: Counts) -> Counts:
        """What was counted since."""
        return Counts(**{name: value - getattr(before, name) for name, value in vars(self).items()})


class HealthReport:
    """Makes a report from time to time.

    Args:
        robot: its name.
        rate: of the messages, as configured [Hz].
    """

    def __init__(self, robot: str, rate: float) -> None:
        self._robot, self._rate = robot, rate
        self._before, self._time = Counts(), 0.0
        self.longest_tick = 0.0  # since the last report [s]
        self.reason = ""  # of the last message that was refused
        self.missing: list[str] = []  # joints, in the last message that lacked some

    def start(self, now: float) -> None:
        """The first period begins [s]."""
        self._time = now

    def report(
        self, stamp: int, now: float, counts: Counts, state: Mapping[str, str], troubled: str
    ) -> Health:
        """What to say of the time since the last report.

        Args:
            stamp: [ns].
            now: [s].
            counts: until now.
            state: further values.
            troubled: what else is wrong; nothing if nothing is.
        """
        lately, seconds = counts.since(self._before), max(now - self._time, 1e-9)
        rate = lately.taken / seconds
        level, message = self._judge(lately, rate, troubled)
        mean = lately.tick_time / max(1, lately.taken)
        values = {
            "messages": str(counts.received),
            "taken in": str(counts.taken),
            "refused": str(counts.refused),
            "last refused": self.reason,
            "missing joints": ", ".join(self.missing),
            "of other joints": str(counts.other_joints),
            "late": str(counts.late),
            "lost": str(counts.lost),
            "rate [Hz]": f"{rate:.1f}",
            "tick, mean [us]": f"{_MICROSECONDS * mean:.0f}",
            "tick, longest [us]": f"{_MICROSECONDS * self.longest_tick:.0f}",
            "contacts": str(counts.contacts),
            **state,
        }
        if not lately.taken:
            values |= {"collision": "unknown", "links": ""}
        self._before, self._time, self.longest_tick = replace(counts), now, 0.0
        return Health(stamp, level, self._robot, message, values)

    def _judge(self, lately: Counts, rate: float, troubled: str) -> tuple[int, str]:
        if not lately.taken:
            if lately.refused:
                return ERROR, f"no joint state can be used: {self.reason}"
            return ERROR, "no joint states"
        if lately.refused:
            return WARNING, f"{lately.refused} joint states refused: {self.reason}"
        if lately.lost:
            return WARNING, f"{lately.lost} joint states lost"
        if troubled:
            return WARNING, troubled
        if not self._rate / _RATE_FACTOR <= rate <= self._rate * _RATE_FACTOR:
            return WARNING, f"{rate:.0f} joint states a second, not {self._rate:.0f} as configured"
        return OK, "running"
