"""The page of a control loop, in a process of its own: `python -m contactsense.viewer.live_page`.

The process gets its settings as a pickle on stdin, tells the address on stdout, and ends when stdin does.
"""

from __future__ import annotations

import os
import pickle
import sys
import threading
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np

from .. import _core
from .moment import Moment, Touch, likelihood_of
from .page import FRAMES, address_of, close_page, open_page
from .slot import Slot
from .stage import Stage

_NOWHERE = np.zeros((0, 3)), np.zeros(0)


def main() -> None:
    """Shows what is in the slot until stdin ends."""
    robot, path, port = pickle.load(sys.stdin.buffer)
    slot = Slot(Path(path), robot)  # before the address is told: its file is then removed
    ended = threading.Event()
    threading.Thread(target=_end_with_stdin, args=(ended,), daemon=True).start()
    server, stage = open_page("live", robot, robot.neutral(), port)
    text = server.gui.add_markdown("")
    print(address_of(server), flush=True)
    contact_map = None if robot.floating_base else _core.ContactMap(robot)
    with redirect_stdout(sys.stderr):  # nobody reads on
        _show(server, stage, text, slot, contact_map, ended)
    close_page(server)


def _end_with_stdin(ended: threading.Event) -> None:
    # Not by `sys.stdin`, whose lock would be held when Python ends otherwise.
    while os.read(0, 1):
        pass
    ended.set()


def _show(
    server: Any,
    stage: Stage,
    text: Any,
    slot: Slot,
    contact_map: _core.ContactMap | None,
    ended: threading.Event,
) -> None:
    shown = 0
    while not ended.wait(1.0 / FRAMES):
        newest = slot.read()
        if newest is None or newest[0] == shown:
            continue
        shown, q, torque, touches = newest
        places = _NOWHERE
        if contact_map is not None and len(touches) == 1:
            found = contact_map.evaluate(q, torque)
            places = found.points, likelihood_of(found)
        with server.atomic():
            stage.show(Moment(q, touches, *places))
            text.content = _told(touches)


def _told(touches: tuple[Touch, ...]) -> str:
    lines = [
        f"- {touch.link} ({100.0 * touch.probability:.0f} %), {np.linalg.norm(touch.force):.1f} N, "
        f"{'located' if touch.located else 'not located'}"
        for touch in touches
    ]
    return "\n".join(lines) or "no contact"


if __name__ == "__main__":
    main()
