"""A page that shows a robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._extras import require
from .gate import Gate
from .place import Place
from .stage import Stage

LOOPBACK = "127.0.0.1"
FRAMES = 30.0  # [1/s]
# The camera: field of view [deg], and where it is, as multiples of the robot's size from its middle: a robot
# that stretches out stays in sight.
_FIELD = 45.0
_FROM = np.array([2.3, 1.5, 0.9])


class Page:
    """A server of viser with a robot in its scene, all of which is seen, until it is closed.

    viser knows no passwords: where the place has a token, a gate stands before it.

    Raises:
        InputError: the place cannot be listened at.
        MissingExtraError: viser is not installed.
    """

    def __init__(
        self,
        title: str,
        robot: _core.Robot,
        q: NDArray[np.float64],
        place: Place,
        sensors: Sequence[_core.ForceTorqueSensor] = (),
    ) -> None:
        require("view", "viser")
        import viser

        host, port = (place.host, place.port) if place.token is None else (LOOPBACK, 0)
        with _quiet():
            self.server: Any = viser.ViserServer(
                host=host, port=port, label=f"contactsense: {title}", verbose=False
            )
        inner = int(self.server.get_port())
        self._gate: Gate | None = None
        self.address = f"http://{place.shown_host}:{inner}"
        if place.token is not None:
            try:
                self._gate = Gate(place.host, place.port, inner, place.token)
            except BaseException:
                self.close()
                raise
            self.address = f"http://{place.shown_host}:{self._gate.port}/?token={place.token}"
        gui, theme = self.server.gui, {"control_width": "large"}
        if hasattr(gui, "main_panel"):
            gui.main_panel.dock_right()
        else:  # before viser 1.1
            theme["control_layout"] = "fixed"
        gui.configure_theme(**theme, show_logo=False, show_share_button=False)
        self.stage = Stage(self.server.scene, robot, sensors)
        self.look(q)

    def look(self, q: NDArray[np.float64]) -> None:
        """Where a browser that comes to the page looks from: all of the robot is seen."""
        middle, radius = self.stage.settle(q)
        camera = self.server.initial_camera
        camera.fov = np.radians(_FIELD)
        camera.look_at = tuple(middle)
        camera.position = tuple(middle + _FROM * radius)

    def close(self) -> None:
        """Ends the page."""
        if self._gate is not None:
            self._gate.close()
        with _quiet():
            self.server.stop()


@contextmanager
def _quiet() -> Iterator[None]:
    """Keeps viser from printing its address, which is not always that of the page, and that it ends."""
    import rich

    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
