"""A control loop in the browser."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from .._extras import require
from ..errors import InputError

if TYPE_CHECKING:
    from .slot import Slot

# What is shown each second at most.
_FRAMES = 30.0
# The page is there after so long [s], or it is not to be had.
_PATIENCE = 60.0


class View:
    """The page of a control loop, in a process of its own; made by `view`.

    It costs a control tick about as much as reading the clock, and some microseconds in 30 ticks a second. It
    waits for nothing: what the page cannot show in time is not shown. It can be used as a context manager.

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
        self._slot, self._process, self._address, self._nq = slot, process, address, nq
        self._due = 0.0

    @property
    def address(self) -> str:
        """Where the page is: on this machine only."""
        return self._address

    def show(self, q: ArrayLike, report: _core.ContactReport) -> None:
        """Shows an instant, unless the one before is as good as new.

        Args:
            q: `(nq,)`, configuration.
            report: what the monitor says of it.

        Raises:
            InputError: `q` has the wrong shape.
        """
        now = time.monotonic()
        if now < self._due:
            return
        self._due = now + 1.0 / _FRAMES
        position = np.asarray(q, dtype=np.float64)
        if position.shape != (self._nq,):
            raise InputError(f"q: must be ({self._nq},), not {position.shape}")
        self._slot.write(position, report)

    def close(self) -> None:
        """Ends the page."""
        if self._process.poll() is None:
            self._process.stdin.close()
            self._process.wait()
        self._process.stdout.close()

    def __enter__(self) -> View:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def view(monitor: _core.ContactMonitor, *, port: int = 8080) -> View:
    """Opens a page in the browser that shows what a monitor says while a robot runs.

    The page is served to this machine only. It shows the robot, its contacts with their forces, and where the
    torques of the instant allow a single contact.

    Args:
        monitor: its robot is shown.
        port: of the page; the next free one is taken where it is in use.

    Returns:
        A `View`, whose `show` is called after `ContactMonitor.update`.

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
    if not isinstance(monitor, _core.ContactMonitor):
        raise InputError(f"monitor: expected a contactsense.ContactMonitor, got {type(monitor).__name__}")
    if not 1 <= port <= 65535:
        raise InputError(f"port: must be from 1 to 65535, not {port}")
    require("view", "viser")
    # These take milliseconds that programs without a page do not need.
    import pickle
    import select
    import subprocess
    import sys

    from .slot import Slot, slot_file

    file = slot_file()
    try:
        slot = Slot(file, monitor.robot, creates=True)
        process = subprocess.Popen(
            [sys.executable, "-m", "contactsense.viewer.live_page"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(pickle.dumps((monitor.robot, str(file), port)))
        process.stdin.flush()
        ready, _, _ = select.select([process.stdout], [], [], _PATIENCE)
        address = process.stdout.readline().decode().strip() if ready else ""
    finally:
        file.unlink()  # it lives on for those that have it open
    page = View(slot, process, address, monitor.robot.nq)
    if not address:
        page.close()
        raise InputError("port: the page could not be opened")
    return page
