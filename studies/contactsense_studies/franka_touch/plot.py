"""The study as a picture: one log over time, all logs in short."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from contactsense._pictures import save_picture

from .logs import JOINTS
from .study import Evaluation, Study
from .summary import summarise

OWN, OTHER, FALSE = "#1b6ca8", "#e08e2b", "#c0392b"


def save_plot(study: Study, path: Path, log_name: str | None = None) -> None:
    """Writes the picture; `log_name` chooses the log over time, by default the first held out.

    Raises:
        InputError: the file cannot be written.
    """
    names = [log.name for log in study.logs]
    held_out = [log.name for log in study.measured.logs if not log.tuning]
    index = names.index(log_name or (held_out or names)[0])

    def draw(figure: Figure) -> None:
        upper, lower = figure.subfigures(2, 1, squeeze=False, height_ratios=(1.75, 1))[:, 0]
        _draw_log(upper, study, index)
        _draw_summary(lower, study)

    save_picture("png", path, (13, 9.5), draw)


def _draw_log(figure: Any, study: Study, index: int) -> None:
    log, ticks, judged = study.logs[index], study.measured.replays[index].ticks, study.measured.logs[index]
    threshold = study.measured.settings.detection_threshold
    # Base joints feel newtonmetres where the wrist feels tenths.
    base, wrist = figure.subplots(2, 1, sharex=True)
    colors = mpl.colormaps["viridis"](np.linspace(0.0, 0.92, JOINTS))
    time = log.time - log.time[0]
    for axes, joints in ((base, range(4)), (wrist, range(4, JOINTS))):
        for touch in judged.touches:
            axes.axvspan(touch.start - log.time[0], touch.end - log.time[0], color="0.88", lw=0, zorder=0)
        for joint in joints:
            label = f"joint {joint + 1} (threshold {threshold[joint]:.2g})"
            axes.plot(time, ticks["external_torque"][:, joint], color=colors[joint], lw=1.1, label=label)
        for onset in log.time[ticks["onset"]]:
            false = onset in judged.false_onsets
            axes.axvline(onset - log.time[0], color=FALSE if false else "k", lw=1, ls="--", zorder=1)
        axes.set_ylabel("external torque [Nm]")
        axes.margins(x=0.01)
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=9, frameon=False)
    base.set_title(
        f"{log.name}: contacts on link {log.link}. Shaded: label; dashed: onset (false: red); "
        "above: estimated link",
        pad=16,
    )
    for touch in judged.touches:
        right = touch.link == log.link
        base.annotate(
            "-" if touch.link is None else str(touch.link),
            ((touch.start + touch.end) / 2 - log.time[0], 1.01),
            xycoords=("data", "axes fraction"),
            ha="center",
            va="bottom",
            fontsize=9,
            color=OWN if right else FALSE,
            weight="bold",
        )
    wrist.set_xlabel("time [s]")


def _draw_summary(figure: Any, study: Study) -> None:
    delays, links = figure.subplots(1, 2)
    names = [log.name + ("*" if log.tuning else "") for log in study.measured.logs]
    ticks = [f"{name}\nlink {log.link}" for name, log in zip(names, study.measured.logs, strict=True)]
    for offset, evaluation, color, label in (
        (-0.2, study.measured, OWN, "momentum observer"),
        (0.2, study.vendor, OTHER, "vendor's torque"),
    ):
        _draw_delays(delays, evaluation, offset, color, label)
        _draw_links(links, evaluation, offset, color, label)
    for axes in (delays, links):
        axes.set_xticks(range(len(ticks)), ticks, fontsize=9)
    delays.axhline(0.0, color="0.6", lw=0.8)
    delays.set_ylabel("onset after the start of the label [ms]")
    delays.set_title("onset of every detected contact (* settings chosen with this file)")
    delays.legend(fontsize=9, frameon=False)
    links.set_ylim(0.0, 1.05)
    links.set_ylabel("share of contacts")
    links.set_title("correct link (light: it or a neighbour)")


def _draw_delays(axes: Any, evaluation: Evaluation, offset: float, color: str, label: str) -> None:
    for position, log in enumerate(evaluation.logs):
        felt = np.array([1e3 * touch.delay for touch in log.touches if touch.delay is not None])
        spread = np.linspace(-0.13, 0.13, len(felt)) if len(felt) else felt
        name = None if position else label
        axes.plot(position + offset + spread, felt, "o", ms=3, color=color, label=name, alpha=0.8)
        missed = len(log.touches) - len(felt)
        if missed:
            axes.annotate(f"{missed} missed", (position + offset, 0), color=FALSE, ha="center", fontsize=8)


def _draw_links(axes: Any, evaluation: Evaluation, offset: float, color: str, label: str) -> None:
    figures = [summarise([log]) for log in evaluation.logs]
    at = np.arange(len(figures)) + offset
    axes.bar(at, [figure.within_one for figure in figures], 0.36, color=color, alpha=0.3)
    axes.bar(at, [figure.exact for figure in figures], 0.36, color=color, label=label)
