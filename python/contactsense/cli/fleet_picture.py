"""Picture of the places on one robot of a fleet that were touched."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from .._pictures import save_picture
from .._places import Places, draw_places, link_colours, link_legend
from ..fleet.summary import places_of
from ..robot import Robot

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SIZE = (10.0, 5.0)  # [inch]


def save_fleet_picture(path: Path, folder: Path, name: str, robot: Robot) -> Path:
    """The robot from two sides, with every contact whose place is known."""
    places = Places(*places_of(folder, name))
    colours = link_colours(sorted(set(places.links)))

    def draw(figure: Figure) -> None:
        views = figure.subplots(1, 2)
        draw_places(views, robot, robot.neutral(), places, colours)
        views[0].set_title(f"{name}: {len(places.links)} contacts with a point")
        link_legend(views[1], colours)

    return save_picture("png", path, _SIZE, draw)
