"""Steps of time between messages, by their stamps."""

from __future__ import annotations

from ..errors import InputError

# A stamp that is older than the last one by so much is that of a clock that was set anew [s].
_RESTART = 1.0
_SECONDS = 1e-9  # of a nanosecond


class LateError(InputError):
    """A message is as old as the one before, or older."""


class Stamps:
    """The stamps of the messages that were accepted.

    Args:
        longest: step from which on messages are missing in between [s].

    Attributes:
        gaps: how many steps were longer.
        longest_gap: [s].
        restarts: how often the clock was set back.
    """

    def __init__(self, longest: float) -> None:
        self._longest = longest
        self._last: int | None = None
        self.gaps = 0
        self.longest_gap = 0.0
        self.restarts = 0

    def is_restart(self, stamp: int) -> bool:
        """Whether the sender's clock was set back, as where a recording starts anew.

        Then no stamp is known any more.
        """
        if not stamp or self._last is None or (self._last - stamp) * _SECONDS < _RESTART:
            return False
        self._last = None
        self.restarts += 1
        return True

    def step(self, stamp: int) -> float | None:
        """Time since the last message [s]; None where it is not known.

        Raises:
            LateError: the message is not newer.
        """
        if not stamp or self._last is None:
            return None
        if stamp <= self._last:
            raise LateError(
                "stamp: is that of the message before"
                if stamp == self._last
                else f"stamp: is {(self._last - stamp) * _SECONDS:.6f} s older than the message before"
            )
        return (stamp - self._last) * _SECONDS

    def accept(self, stamp: int, step: float | None) -> None:
        """A message was taken in."""
        if stamp:
            self._last = stamp
        if step is not None and step > self._longest:
            self.gaps += 1
            self.longest_gap = max(self.longest_gap, step)
