"""Picture of the contacts of one log: where on the robot, and when."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .._pictures import GREY, save_picture
from .._robot_view import FloatArray
from ..offline import Replay
from ..robot import Robot
from .places import Places, draw_places, link_colours, link_legend

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIZE = (10.0, 7.5)  # [inch]
# More points than this are not told apart on a picture.
_POINTS = 4000


def save_contact_picture(path: Path, title: str, robot: Robot, result: Replay) -> Path:
    """The robot at its first contact with the places of all; below, torque and contacts over time."""
    placed = [contact for contact in result.contacts if np.all(np.isfinite(contact.point_local))]
    places = Places(
        [contact.link for contact in placed],
        np.array([contact.point_local for contact in placed]).reshape(-1, 3),
        np.array([contact.peak_force for contact in placed]),
    )
    colours = link_colours([contact.link for contact in result.contacts])

    def draw(figure: Figure) -> None:
        grid = figure.add_gridspec(2, 2, height_ratios=[3, 2])
        views = [figure.add_subplot(grid[0, side]) for side in (0, 1)]
        draw_places(views, robot, _pose(result), places, colours)
        views[0].set_title(f"{title}: {len(result.contacts)} contacts, {len(placed)} with a point")
        _draw_torque(figure.add_subplot(grid[1, :]), result, colours)

    return save_picture("png", path, _SIZE, draw)


def _pose(result: Replay) -> FloatArray:
    """That of the first contact."""
    rows = result.contact_ticks["row"]
    q: FloatArray = result.log.q[int(rows[0]) if len(rows) else 0]
    return q


def _draw_torque(axes: Axes, result: Replay, colours: Mapping[str, str]) -> None:
    time = result.ticks["time"]
    start = float(time[0]) if len(time) else 0.0
    every = max(1, len(time) // _POINTS)
    axes.plot(time[::every] - start, result.ticks["external_torque"][::every], color=GREY, linewidth=0.6)
    for contact in result.contacts:
        colour = colours[contact.link]
        axes.axvspan(contact.start - start, contact.end - start, color=colour, alpha=0.35, linewidth=0.0)
    link_legend(axes, colours)
    axes.set_title("External torque of all joints [Nm]; contacts in the colour of their link")
    axes.set_xlabel("Time from the log's start [s]")
    axes.margins(x=0.0)
