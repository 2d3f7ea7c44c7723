"""Starts the process of a control loop's page."""

from __future__ import annotations

import pickle
import select
import subprocess
import sys

from .. import _core
from .place import Place
from .slot import Slot, slot_file

# The page is there after so long [s], or it is not to be had.
_PATIENCE = 60.0


def start_page(monitor: _core.ContactMonitor, place: Place) -> tuple[Slot, subprocess.Popen[bytes], str]:
    """Where instants go, the process that shows them, and what it says: the page's address, or why not."""
    file = slot_file()
    try:
        slot = Slot(file, monitor.robot, len(monitor.sensors), creates=True)
        process = subprocess.Popen(
            [sys.executable, "-m", "contactsense.viewer.live_page"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(pickle.dumps((monitor.robot, monitor.sensors, str(file), place)))
        process.stdin.flush()
        ready, _, _ = select.select([process.stdout], [], [], _PATIENCE)
        told = process.stdout.readline().decode().strip() if ready else ""
    finally:
        file.unlink()  # it lives on for those that have it open
    return slot, process, told or "port: the page could not be opened"
