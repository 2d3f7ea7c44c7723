"""The page of a control loop, in a process of its own: `python -m contactsense.viewer.live_page`.

The process gets its settings as a pickle on stdin, tells the address on stdout, and ends when stdin does.
"""

from __future__ import annotations

import os
import pickle
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import replace
from pathlib import Path

from .. import _core
from ..errors import InputError
from .legend import legend
from .moment import posterior_of
from .page import Page
from .slot import Slot
from .torque_plot import RecentTorques

# Between two looks at the slot [s]: short beside the time between two instants, so that none is missed.
_LOOK = 0.004


def main() -> None:
    """Shows what is in the slot until stdin ends."""
    robot, sensors, path, place = pickle.load(sys.stdin.buffer)
    slot = Slot(Path(path), robot, len(sensors))  # before the address is told: its file is then removed
    ended = threading.Event()
    threading.Thread(target=_end_with_stdin, args=(ended,), daemon=True).start()
    try:
        page = Page("live", robot, robot.neutral(), place, sensors)
    except InputError as error:
        print(error, flush=True)
        return
    print(page.address, flush=True)
    contact_map = None if robot.floating_base else _core.ContactMap(robot)
    with redirect_stdout(sys.stderr):  # nobody reads on
        _show(page, slot, robot, sensors, contact_map, ended)
    page.close()


def _end_with_stdin(ended: threading.Event) -> None:
    # Not by `sys.stdin`, whose lock would be held when Python ends otherwise.
    while os.read(0, 1):
        pass
    ended.set()


def _show(
    page: Page,
    slot: Slot,
    robot: _core.Robot,
    sensors: Sequence[_core.ForceTorqueSensor],
    contact_map: _core.ContactMap | None,
    ended: threading.Event,
) -> None:
    text = page.server.gui.add_markdown("")
    torques = RecentTorques(page.server.gui, robot)
    page.server.gui.add_html(legend(has_sensors=bool(sensors), has_particles=True))
    shown = 0
    while not ended.wait(_LOOK):
        if slot.count == shown:
            continue
        newest = slot.read()
        if newest is None:
            continue
        if not shown:
            page.look(newest[2].q)
        shown, torque, moment = newest
        # Particles take the place of the posterior, which would hide them.
        is_sought = len(moment.touches) == 1 and not len(moment.particles.points)
        if contact_map is not None and is_sought:
            moment = replace(moment, posterior=posterior_of(contact_map.evaluate(moment.q, torque)))
        with page.server.atomic():
            page.stage.show(moment)
            text.content = moment.told(sensors)
            torques.add(time.monotonic(), torque, bool(moment.touches))


if __name__ == "__main__":
    main()
