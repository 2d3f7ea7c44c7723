"""A control loop or a log in the browser."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from .._extras import require
from ..errors import InputError
from ..offline import Replay

if TYPE_CHECKING:
    from .replay_view import ReplayView
    from .slot import Slot

# Between two instants that are shown [s]: a little less than a thirtieth, as some come late.
_BETWEEN = 1.0 / 32.0


class View:
    """The page of a control loop, in a process of its own; made by `view`.

    It costs a control tick about as much as reading the clock. In about 30 ticks a second it also hands the
    instant on to a thread, which writes it for the page while the loop waits for its next tick. It waits for
    nothing: what the page cannot show in time is not shown. It can be used as a context manager.

    Args:
        slot: memory that the page reads.
        process: of the page.
        address: of the page.
        nq: of the robot.

    Raises:
        TypeError: an argument is missing.

    Example:
        >>> import contactsense as cs
        >>> cs.View.__doc__.startswith("The page of a control loop")
        True
    """

    def __init__(self, slot: Slot, process: Any, address: str, nq: int) -> None:
        from .particles import cloud_of  # here: in the loop it would take milliseconds once

        self._slot, self._process, self._address, self._nq = slot, process, address, nq
        self._cloud_of = cloud_of
        self._due = 0.0
        # A queue of one, and a lock that is free while there is something in it.
        self._newest: tuple[Any, ...] = ()
        self._empty = threading.Lock()
        self._empty.acquire()
        self._failure: Exception | None = None
        threading.Thread(target=self._write, daemon=True).start()

    @property
    def address(self) -> str:
        """Where the page is, with the token where it has one."""
        return self._address

    def show(
        self,
        q: ArrayLike,
        report: _core.ContactReport,
        particles: _core.ContactParticleFilter | _core.Particles | ArrayLike | None = None,
    ) -> None:
        """Shows an instant, unless the one before is as good as new.

        Args:
            q: `(nq,)`, configuration.
            report: of the monitor for this instant.
            particles: a `ContactParticleFilter`, whose particles are read only where the instant is shown;
                its `particles`; or points `(n, 3)`, world frame [m]. Of more than 10,000, so many at even
                distances in their order are shown.

        Raises:
            InputError: an argument has the wrong shape, or the report of an earlier instant was of another
                robot.
        """
        now = time.monotonic()
        if now < self._due:
            return
        # As often as is due on average, also where ticks are late; after a pause it begins anew.
        self._due = max(self._due, now - _BETWEEN) + _BETWEEN
        if self._failure is not None:
            raise InputError("report: is not of the robot of the page") from self._failure
        position = np.array(q, dtype=np.float64)  # the loop may change its own
        if position.shape != (self._nq,):
            raise InputError(f"q: must be ({self._nq},), not {position.shape}")
        cloud = None if particles is None else self._cloud_of(particles)
        self._newest = position, report, cloud
        if self._empty.locked():
            self._empty.release()

    def _write(self) -> None:
        """Writes what is handed on until that is nothing.

        It gets the interpreter when the loop sleeps or reads the robot, after its tick. In the tick it would
        take tens of microseconds: what runs so rarely is in no cache.
        """
        while True:
            self._empty.acquire()
            newest = self._newest
            if not newest:
                return
            try:
                self._slot.write(*newest)
            except Exception as failure:
                self._failure = failure
                return

    def close(self) -> None:
        """Ends the page."""
        self._newest = ()
        if self._empty.locked():
            self._empty.release()
        if self._process.poll() is None:
            self._process.stdin.close()
            self._process.wait()
        self._process.stdout.close()

    def __enter__(self) -> View:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@overload
def view(
    source: _core.ContactMonitor, *, host: str = ..., port: int = ..., token: str | None = ...
) -> View: ...


@overload
def view(source: Replay, *, host: str = ..., port: int = ..., token: str | None = ...) -> ReplayView: ...


def view(
    source: _core.ContactMonitor | Replay,
    *,
    host: str = "127.0.0.1",
    port: int = 8080,
    token: str | None = None,
) -> View | ReplayView:
    """Opens a page in the browser that shows a control loop or a log.

    It shows the robot, its contacts with their forces, where the torques of the instant allow a single
    contact, and what force/torque sensors measure; of a log also a time line, the torques and a table of the
    contacts.

    Args:
        source: a `ContactMonitor`, whose reports `View.show` shows while the robot runs, or a `Replay`.
        host: address that the page is served at: one that only this machine reaches ("127.0.0.1", "::1",
            "localhost"), or one that others reach ("0.0.0.0" for all addresses of the machine), who then need
            the token. Nothing is encrypted.
        port: of the page; the next free one is taken where it is in use.
        token: what a browser has to know, at least 16 letters, digits, "-" or "_". None: nothing where only
            this machine reaches the page, and something random elsewhere. The address of the page has it.

    Returns:
        A `View`, whose `show` is called after `ContactMonitor.update`; of a `Replay` a
        `contactsense.viewer.replay_view.ReplayView`.

    Raises:
        InputError: an argument is wrong, or the page cannot be opened.
        MissingExtraError: viser is not installed.

    Example:
        >>> import contactsense as cs
        >>> monitor = cs.ContactMonitor(cs.Robot.named("iiwa14"), dt=0.001)
        >>> try:
        ...     page = cs.view(monitor, port=70000)
        ... except cs.InputError as error:
        ...     print(error)
        port: must be from 1 to 65535, not 70000
    """
    # These take milliseconds that programs without a page do not need.
    from .place import place_of

    if not isinstance(source, _core.ContactMonitor | Replay):
        raise InputError(
            f"source: must be a contactsense.ContactMonitor or Replay, not {type(source).__name__}"
        )
    place = place_of(host, port, token)
    require("view", "viser")
    if isinstance(source, Replay):
        from .replay_view import replay_view

        return replay_view(source.robot.name, source, place)
    from .live import start_page

    slot, process, told = start_page(source, place)
    page = View(slot, process, told, source.robot.nq)
    if not told.startswith("http://"):
        page.close()
        raise InputError(told)
    return page
