"""Some seconds of arms: external torque before and after calibration, and when contacts are reported."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from contactsense._pictures import GREY, JOINTS, TEXT, TRUTH

from .arms import ARMS
from .monitors import MONITORS
from .plot_rates import COLOURS
from .stretch import SHOWN, Stretch
from .study import Trial

_PANELS = (("thresholds", "before calibration"), ("calibrated", "after calibration, same scale"))
_STRIPS = {
    "default": "uncalibrated,\ndefault thresholds",
    "thresholds": "uncalibrated,\nthresholds of this arm",
    "calibrated": "calibrated",
}
# The axes end at so many times the largest torque without contact before calibration.
_ROOM = 2.2


def draw_stretches(figure: Any, trials: Sequence[Trial]) -> None:
    """A column of three panels for each trial, on one axis of time."""
    columns = figure.subplots(
        3,
        len(trials),
        sharex=True,
        squeeze=False,
        height_ratios=(2.0, 2.0, 1.25),
        gridspec_kw={"hspace": 0.04},
    )
    for column, trial in enumerate(trials):
        if trial.stretch is not None:
            _draw(columns[:, column], trial.arm, trial.stretch, labels=column == 0)
    joints = max((len(trial.thresholds) for trial in trials), default=0)
    handles = [
        columns[0, 0].plot([], [], color=JOINTS[joint % len(JOINTS)], lw=2.5)[0] for joint in range(joints)
    ]
    figure.legend(
        handles,
        [f"joint {joint + 1}" for joint in range(joints)],
        loc="outside upper center",
        ncols=max(joints, 1),
        frameon=False,
        title=f"External torque during {SHOWN:.0f} s; grey: a person pushes the named link",
        title_fontproperties={"weight": "bold", "size": 12},
    )


def _draw(panels: Any, arm: str, stretch: Stretch, *, labels: bool) -> None:
    before, after, strips = panels
    quiet = np.abs(stretch.torque["thresholds"][~stretch.contact])
    limit = _ROOM * float(quiet.max())
    for axes, (name, title) in zip((before, after), _PANELS, strict=True):
        for start, end, _, _ in stretch.contacts:
            axes.axvspan(start, end, color="0.88", lw=0, zorder=0)
        for joint, torque in enumerate(stretch.torque[name].T):
            axes.plot(stretch.time, torque, color=JOINTS[joint % len(JOINTS)], lw=0.9)
        axes.axhline(0.0, color=GREY, lw=0.6)
        axes.set_title(f"{ARMS[arm].about}: {title}", fontsize=10, pad=4)
        axes.set_ylim(-limit, limit)
        if labels:
            axes.set_ylabel("external torque [Nm]")
    for number, (start, end, link, force) in enumerate(stretch.contacts):
        if end > SHOWN:
            continue
        # Names of contacts in quick succession stand at two heights.
        before.text(
            0.5 * (start + end),
            (0.98 if number % 2 == 0 else 0.7) * limit,
            f"{_short(link)}\n{force:.0f} N",
            ha="center",
            va="top",
            fontsize=8,
            color=TEXT,
            bbox={"facecolor": "white", "alpha": 0.7, "lw": 0, "pad": 0.5},
        )
    _strips(strips, stretch, labels=labels)
    strips.set_xlim(0.0, SHOWN)
    strips.set_xlabel("time [s]")


def _strips(axes: Any, stretch: Stretch, *, labels: bool) -> None:
    rows = len(MONITORS)
    for start, end, _, _ in stretch.contacts:
        axes.fill_between([start, end], rows + 0.1, rows + 0.9, color=TRUTH, alpha=0.5, lw=0)
        axes.axvspan(start, end, color="0.88", lw=0, zorder=0)
    for number, name in enumerate(MONITORS):
        low, reported = rows - 1 - number, stretch.collision[name]
        # A line keeps reports in sight that are shorter than a dot of the picture.
        axes.fill_between(stretch.time, low + 0.1, low + 0.9, where=reported, color=COLOURS[name], lw=0.8)
    names = [_STRIPS[name] for name in reversed(MONITORS)]
    axes.set_yticks(np.arange(rows + 1) + 0.5, [*names, "true contact"], fontsize=9)
    axes.set_title("When a contact is reported", fontsize=10, pad=4)
    axes.set_ylim(0.0, rows + 1.0)
    axes.tick_params(axis="y", length=0, labelleft=labels)
    axes.spines["left"].set_visible(False)


def _short(link: str) -> str:
    """Without what the links of an arm have in common."""
    words = link.replace("_", " ")
    for common in ("iiwa ", "panda ", "j2s6s200 link ", "j2s6s200 "):
        words = words.removeprefix(common)
    return words.removesuffix(" link") if words != "link" else words
