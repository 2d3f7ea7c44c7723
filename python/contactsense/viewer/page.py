"""A page on this machine that shows a robot."""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._extras import require
from .stage import Stage

LOOPBACK = "127.0.0.1"
FRAMES = 30.0  # [1/s]


def open_page(title: str, robot: _core.Robot, q: NDArray[np.float64], port: int) -> tuple[Any, Stage]:
    """A server of viser, and the robot in its scene, all of which is seen."""
    require("view", "viser")
    import viser

    # What it says of itself goes to stdout, which is for results.
    with redirect_stdout(sys.stderr):
        server = viser.ViserServer(host=LOOPBACK, port=port, label=f"contactsense: {title}", verbose=False)
    stage = Stage(server.scene, robot, q)
    camera, reach = server.initial_camera, stage.reach
    camera.look_at = (0.0, 0.0, 0.4 * reach)
    camera.position = (1.5 * reach, 1.1 * reach, 1.2 * reach)
    return server, stage


def address_of(server: Any) -> str:
    """Where a page is."""
    return f"http://{LOOPBACK}:{server.get_port()}"


def close_page(server: Any) -> None:
    """Ends a page."""
    with redirect_stdout(sys.stderr):
        server.stop()
