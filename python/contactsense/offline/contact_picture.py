"""Picture of the contacts of one log: where on the robot, and when."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .._contact_view import ShownContact, draw_contact
from .._core import Robot
from .._pictures import DETECTED, ESTIMATE, GREY, TEXT, save_picture
from .._places import Places, draw_places, link_colours, link_legend
from .._robot_view import FloatArray, body, eye, share_scale
from ..log import Log
from .summary import ReplayedContact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIZE = (10.0, 7.5)  # [inch]
# So many contacts have a drawing of the robot each; more share one.
_FEW = 4
_LEGEND = (
    "Blue: likeliest link. Arrow: force, which ends at the point; orange: located, yellow: not located.\n"
    "Circle: holds 90 % of the posterior."
)
# More points than this are not told apart on a picture.
_POINTS = 4000


class _Replayed(Protocol):
    """What the picture shows of a replay."""

    @property
    def robot(self) -> Robot: ...
    @property
    def log(self) -> Log: ...
    @property
    def ticks(self) -> Mapping[str, NDArray[Any]]: ...
    @property
    def contact_ticks(self) -> Mapping[str, NDArray[Any]]: ...
    @property
    def contacts(self) -> Sequence[ReplayedContact]: ...


def save_contact_picture(argument: str, path: Path, title: str, result: _Replayed) -> Path:
    """Above, where on the robot the contacts are; below, torque and contacts over time."""

    def draw(figure: Figure) -> None:
        above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=[3, 2])[:, 0]
        count = len(result.contacts)
        above.suptitle(f"{title}: {count} contact{'' if count == 1 else 's'}", x=0.02, ha="left", fontsize=14)
        axes = below.subplots()
        (_draw_force if result.robot.floating_base else _draw_torque)(axes, result)
        if count > _FEW:
            colours = link_colours([contact.link for contact in result.contacts])
            _draw_many(above, result, colours)
            link_legend(axes, colours)
        else:
            colours = {contact.link: DETECTED for contact in result.contacts}
            _draw_few(above, result)
            _name_spans(axes, result)
        _draw_spans(axes, result, colours)

    return save_picture(argument, path, _SIZE, draw)


def _draw_few(figure: Figure, result: _Replayed) -> None:
    """A drawing of the robot for each contact, at the time of its greatest force."""
    if not result.contacts:
        axes = figure.subplots()
        axes.add_collection(body(result.robot, result.log.q[0], eye(50.0, 25.0)))
        axes.autoscale_view()
        axes.set_axis_off()
        axes.set_aspect("equal")
        return
    shown = [_shown(result, contact) for contact in result.contacts]
    greatest = max([0.0, *(contact.peak_force for contact in result.contacts if contact.peak_force > 0.0)])
    views = figure.subplots(1, len(shown), squeeze=False)[0]
    for axes, contact, each in zip(views, result.contacts, shown, strict=True):
        draw_contact(axes, result.robot, each, greatest)
        axes.set_title(_caption(contact), fontsize=12, loc="center")
    share_scale(views)
    figure.supxlabel(_LEGEND, fontsize=10, color=TEXT)


def _shown(result: _Replayed, contact: ReplayedContact) -> ShownContact:
    """A contact at its greatest force, with the place that was known at its end."""
    ticks = result.contact_ticks
    own = np.flatnonzero(ticks["id"] == contact.id)
    forces = np.nan_to_num(np.linalg.norm(ticks["force"][own], axis=1), nan=-1.0)
    q = result.log.q[int(ticks["row"][own[int(np.argmax(forces))]])]
    pose = result.robot.link_pose(q, contact.link)
    point = pose[:3, :3] @ contact.point_local + pose[:3, 3]
    return ShownContact(q, contact.link, point, contact.force, contact.region_radius, contact.located)


def _caption(contact: ReplayedContact) -> str:
    force = f", {contact.peak_force:.0f} N" if np.isfinite(contact.peak_force) else ""
    known = "located" if contact.located else "not located"
    if np.isfinite(contact.region_radius):
        known += f", 90 % within {100.0 * contact.region_radius:.1f} cm"
    return f"{contact.start:.2f} s: {contact.link}{force}\n{known}"


def _draw_many(figure: Figure, result: _Replayed, colours: Mapping[str, str]) -> None:
    """The robot at its first contact with the places of all."""
    placed = [contact for contact in result.contacts if np.all(np.isfinite(contact.point_local))]
    places = Places(
        [contact.link for contact in placed],
        np.array([contact.point_local for contact in placed]).reshape(-1, 3),
        np.array([contact.peak_force for contact in placed]),
    )
    views: Sequence[Axes] = figure.subplots(1, 2)
    draw_places(views, result.robot, _pose(result), places, colours)
    views[0].set_title(f"{len(placed)} of the contacts have a point")


def _pose(result: _Replayed) -> FloatArray:
    """That of the first contact."""
    rows = result.contact_ticks["row"]
    q: FloatArray = result.log.q[int(rows[0]) if len(rows) else 0]
    return q


def _start(result: _Replayed) -> float:
    time = result.ticks["time"]
    return float(time[0]) if len(time) else 0.0


def _draw_torque(axes: Axes, result: _Replayed) -> None:
    time = result.ticks["time"]
    every = max(1, len(time) // _POINTS)
    torque = result.ticks["external_torque"][::every]
    axes.plot(time[::every] - _start(result), torque, color=GREY, linewidth=0.6)
    axes.set_title("External torque of all joints; contacts are shaded")
    axes.set_ylabel("external torque [Nm]")
    _finish(axes)


def _draw_force(axes: Axes, result: _Replayed) -> None:
    """In place of the torque, most of which is the ground's where the base is free."""
    ticks = result.contact_ticks
    for contact in result.contacts:
        own = ticks["id"] == contact.id
        force = np.linalg.norm(ticks["force"][own], axis=1)
        axes.plot(ticks["time"][own] - _start(result), force, color=ESTIMATE, linewidth=1.5)
    time = result.ticks["time"]
    axes.set_xlim(0.0, float(time[-1]) - _start(result) if len(time) > 1 else 1.0)
    axes.set_title("Estimated force of each contact; contacts are shaded")
    axes.set_ylabel("force [N]")
    _finish(axes)


def _finish(axes: Axes) -> None:
    axes.set_xlabel("time from the log's start [s]")
    axes.margins(x=0.0, y=0.15)


def _draw_spans(axes: Axes, result: _Replayed, colours: Mapping[str, str]) -> None:
    for contact in result.contacts:
        ends = contact.start - _start(result), contact.end - _start(result)
        axes.axvspan(*ends, color=colours[contact.link], alpha=0.3, linewidth=0.0)


def _name_spans(axes: Axes, result: _Replayed) -> None:
    for contact in result.contacts:
        middle = 0.5 * (contact.start + contact.end) - _start(result)
        place = axes.get_xaxis_transform()
        axes.text(middle, 0.98, contact.link, ha="center", va="top", fontsize=11, color=TEXT, transform=place)
