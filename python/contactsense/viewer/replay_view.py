"""The page of a log: the robot, a time line, the torques and the contacts."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np

from .. import _core
from .._tables import number_text
from ..errors import InputError
from ..offline import Replay, ReplayedContact
from ..offline.whole import whole_file
from .legend import legend
from .page import FRAMES, Page
from .place import Place
from .replay_moments import ReplayMoments
from .torque_plot import TorquePlot

# Points of a plot, which are more than its pixels.
_POINTS = 1500


class ReplayView:
    """The page of a log, until it is closed; made by `contactsense.view`.

    It can be used as a context manager.

    Args:
        title: of the page.
        result: what is shown.
        moments: of it.
        place: where the page is served.

    Raises:
        InputError: the log has no rows, or the page cannot be opened.
    """

    def __init__(self, title: str, result: Replay, moments: ReplayMoments, place: Place) -> None:
        if not len(moments):
            raise InputError("log: has no rows to show")
        self._moments, self._sensors = moments, result.sensors
        self._time = result.ticks["time"] - result.ticks["time"][0]
        self._page = Page(title, result.robot, result.log.q[0], place, result.sensors)
        self._lock = threading.RLock()
        self._playing = threading.Event()
        self._closed = threading.Event()
        self._build(title, result)
        self._draw(0.0)
        threading.Thread(target=self._play, daemon=True).start()

    @property
    def address(self) -> str:
        """Where the page is, with the token where it has one."""
        return self._page.address

    def show(self, seconds: float) -> None:
        """Shows the row at a time from the log's start."""
        self._slider.value = min(max(seconds, 0.0), float(self._time[-1]))

    def to_html(self, path: str | os.PathLike[str], start: float = 0.0, end: float = np.inf) -> None:
        """Writes a part of the log, in seconds from its start, as a page that needs no program or network.

        Raises:
            InputError: the log has no such part.
        """
        times = np.arange(max(start, 0.0), min(end, float(self._time[-1])), 1.0 / FRAMES)
        if not len(times):
            raise InputError(
                f"start: must be before end, and before the end of the log, {self._time[-1]:g} s"
            )
        with self._lock:
            serializer = self._page.server.get_scene_serializer()
            for seconds in times:
                self._draw(float(seconds))
                serializer.insert_sleep(1.0 / FRAMES)
            text = serializer.as_html()
            self._draw(float(self._slider.value))
        with whole_file(path) as file:
            file.write_text(text, encoding="utf-8")

    def _draw(self, seconds: float) -> None:
        row = min(int(np.searchsorted(self._time, seconds)), len(self._time) - 1)
        with self._lock, self._page.server.atomic():
            moment = self._moments.at(row)
            self._page.stage.show(moment)
            self._now.content = moment.told(self._sensors)

    def _follow(self, _: object) -> None:
        with self._lock:  # first: what waits longest would draw last, and what is no longer wanted
            self._draw(float(self._slider.value))

    def close(self) -> None:
        """Ends the page."""
        self._closed.set()
        self._page.close()

    def __enter__(self) -> ReplayView:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _build(self, title: str, result: Replay) -> None:
        gui: Any = self._page.server.gui
        gui.add_markdown(f"**{title}**: {len(result.contacts)} contacts in {self._time[-1]:.1f} s")
        length = round(float(self._time[-1]), 3) or 1.0  # [s]: a label of the slider
        self._slider = gui.add_slider("time [s]", 0.0, length, min(length, 0.001), 0.0)
        self._slider.on_update(self._follow)
        button = gui.add_button("Play / pause")
        button.on_click(lambda _: self._playing.clear() if self._playing.is_set() else self._playing.set())
        self._now = gui.add_markdown("")
        every = max(1, len(self._time) // _POINTS)
        columns = [self._time, result.ticks["external_torque"], result.ticks["collision"]]
        TorquePlot(gui, result.robot, "t [s]").show(*(column[::every] for column in columns))
        gui.add_html(_table(result.contacts, float(result.ticks["time"][0])))
        gui.add_html(legend(has_sensors=bool(result.sensors), has_particles=False))

    def _play(self) -> None:
        """Moves the time line on, as fast as the log went."""
        while not self._closed.wait(1.0 / FRAMES):
            if self._playing.is_set():
                start, begun = float(self._slider.value), time.monotonic()
                while self._playing.is_set() and not self._closed.wait(1.0 / FRAMES):
                    now = start + time.monotonic() - begun
                    self._slider.value = min(now, float(self._time[-1]))
                    if now >= self._time[-1]:
                        self._playing.clear()


def replay_view(title: str, result: Replay, place: Place) -> ReplayView:
    """The page of a log; a single contact of an arm has its posterior.

    Raises:
        InputError: the log has no rows, or the page cannot be opened.
    """
    contact_map = None if result.robot.floating_base else _core.ContactMap(result.robot)
    return ReplayView(title, result, ReplayMoments(result, contact_map), place)


def _table(contacts: Sequence[ReplayedContact], start: float) -> str:
    """The contacts as a table of HTML."""
    rows = [("time [s]", "link", "prob. [%]", "90 % [cm]", "located", "peak [N]")]
    rows += [
        (
            f"{contact.start - start:.2f} to {contact.end - start:.2f}",
            contact.link,
            number_text(100.0 * contact.link_probability, 0),
            number_text(100.0 * contact.region_radius, 1),
            "yes" if contact.located else "no",
            number_text(contact.peak_force, 1),
        )
        for contact in contacts
    ]
    cells = (
        "".join(f'<td style="padding:1px 4px;white-space:nowrap">{escape(cell)}</td>' for cell in row)
        for row in rows
    )
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    return f'<table style="font-size:12px">{body}</table>'
