"""The table of contacts, truth against estimate, live while the demo runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from .._tables import plain_table
from .arm import FLOOR
from .result import DemoResult, HitResult, ImperfectResult, Progress, Standing
from .settings import DEVIATIONS, Settings

# Header, and whether the column is aligned to the right.
_COLUMNS = (
    ("no.", True),
    ("true link", False),
    ("force\n[N]", True),
    ("estimated\nlink", False),
    ("located", False),
    ("off by\n[mm]", True),
    ("± std\n[mm]", True),
    ("force\noff [%]", True),
    ("delay\n[ms]", True),
)
_IMPERFECT_TITLE = (
    "The same contacts on an arm with the errors of a real one (torque noise and bias, friction, hysteresis, "
    "wrong masses, encoder steps, filtered velocities), calibrated with {:.0f} s of other motion"
)
_NOTES = (
    "The estimate is that of the tick with the largest torques. Off by: the distance to the true point at "
    "that tick. ± std: the standard deviation of the point that the monitor reports. Force off: the error of "
    "the force vector relative to the true peak, including the delay of the observer. Delay: from the start "
    "of the force to its detection. Not located: fewer than six joints lie before the link, or the torques "
    "are too small compared with their errors, so that point and force cannot be determined."
)


@contextmanager
def live_table(console: Console) -> Iterator[Callable[[Progress], None]]:
    """Shows a table of the progress that it is told; it is gone at the end; on a terminal only."""
    with Live(console=console, transient=True, refresh_per_second=12) as live:

        def show(progress: Progress) -> None:
            state = Text("free")
            if progress.imperfect:
                state = Text("the same contacts on an imperfect arm, which is calibrated first")
            if progress.sensed:
                state = Text(f"contact on {progress.sensed}", style="bold yellow")
            status = Text(f"{progress.time:4.1f} of {progress.end:.0f} s   ").append_text(state)
            live.update(Group(hit_table(progress.hits, progress.planned), status))

        yield show


def hit_table(hits: Sequence[HitResult], rows: int = 0, title: str | None = None) -> Table:
    """One row a contact, empty rows for those to come."""
    table = plain_table(title)
    for header, right in _COLUMNS:
        table.add_column(escape(header), justify="right" if right else "left", no_wrap=True)
    for hit in hits:
        table.add_row(*_cells(hit))
    for number in range(len(hits) + 1, rows + 1):
        table.add_row(f"[dim]{number}[/dim]", *[""] * (len(_COLUMNS) - 1))
    return table


def _cells(hit: HitResult) -> list[RenderableType]:
    named: RenderableType
    if hit.named is None:
        named = Text("not detected" if hit.delay is None else "none", style="red")
    else:
        named = Text(hit.named, style="green" if hit.link_right else "red")
    return [
        str(hit.number),
        hit.link,
        f"{hit.force:.0f}",
        named,
        Text("yes", style="green") if hit.located else Text("no", style="yellow"),
        _number(hit.point_error, 1e3),
        _number(hit.point_std, 1e3),
        _number(hit.force_error, 100.0),
        _number(hit.delay, 1e3),
    ]


def _number(value: float | None, factor: float) -> str:
    return "-" if value is None else f"{factor * value:.1f}"


def settings_text(result: DemoResult) -> str:
    """How the monitor is set."""
    settings, standing = result.settings, result.standing
    if standing is not None:
        return _standing_settings_text(settings, standing)
    thresholds = " ".join(f"{threshold:.2f}" for threshold in settings.torque_threshold)
    return (
        f"Observer gain {settings.observer_gain:.0f}/s; torque thresholds {thresholds} Nm: the larger of "
        f"{FLOOR:g} Nm and {DEVIATIONS:g} standard deviations of the observed torque at the stated noise"
    )


def _standing_settings_text(settings: Settings, standing: Standing) -> str:
    torque, wrench = settings.torque_threshold, settings.wrench_threshold
    return (
        f"Observer gain {settings.observer_gain:.0f}/s; thresholds: base {torque[:3].max():.1f} N and "
        f"{torque[3:6].max():.1f} Nm, joints {torque[6:].min():.1f} to {torque[6:].max():.1f} Nm, "
        f"sensors {wrench[:, :3].max():.1f} N and {wrench[:, 3:].max():.1f} Nm: the larger of a floor "
        f"and {DEVIATIONS:g} standard deviations at the stated noise. Wanted contacts: "
        f"{', '.join(standing.feet)}"
    )


def _headline(result: DemoResult) -> str:
    noise, standing = result.noise, result.standing
    text = f"seed {result.seed}, torque noise {noise.percent:g} % and {noise.newton_metres:g} Nm"
    if standing is None:
        return f"{result.robot_name} at up to {result.planned_speed:.1f} rad/s, {text}"
    sensors = result.sensor_noise
    own = f"sensor noise {sensors.newtons:g} N and {sensors.newton_metres:g} Nm"
    return f"{result.robot_name} stands, {text}, {own}"


def print_result(console: Console, result: DemoResult, picture: str) -> None:
    """The whole answer, for people."""
    other = result.imperfect
    console.print(_headline(result), highlight=False)
    console.print(settings_text(result), highlight=False)
    console.print(hit_table(result.hits, title=None if other is None else _first_title(result)))
    if other is not None:
        console.print(hit_table(other.hits, title=_IMPERFECT_TITLE.format(other.calibration_seconds)))
    console.print(_NOTES, style="dim", highlight=False)
    if other is not None:
        console.print(_compared(result, other))
    console.print(summary_text(result), highlight=False, style="bold")
    console.print(f"Picture: {picture}", highlight=False, soft_wrap=True)


def _first_title(result: DemoResult) -> str:
    return "Ideal torques" if result.noise.none else "Torques with noise and no other error"


def _compared(result: DemoResult, other: ImperfectResult) -> Table:
    """Both runs side by side."""
    ideal = "ideal torques" if result.noise.none else "noisy torques"
    table = plain_table(None)
    table.add_column("")
    for header in (ideal, "imperfect arm,\ncalibrated"):
        table.add_column(header, justify="right")
    runs = (result, other)
    count = len(result.hits)
    table.add_row("detected", *(f"{run.detected} of {count}" for run in runs))
    table.add_row("link correct", *(f"{run.links_right} of {count}" for run in runs))
    table.add_row("located", *(f"{len(run.located)} of {count}" for run in runs))
    table.add_row("median point error \\[mm]", *(_middle(run.located, "point_error", 1e3) for run in runs))
    table.add_row("median force error \\[%]", *(_middle(run.located, "force_error", 100.0) for run in runs))
    table.add_row("median delay \\[ms]", *(_middle(run.hits, "delay", 1e3) for run in runs))
    table.add_row("false alarms", *(str(run.false_alarms) for run in runs))
    return table


def _middle(hits: Sequence[HitResult], name: str, factor: float) -> str:
    known = [value for hit in hits if (value := getattr(hit, name)) is not None]
    return _number(float(np.median(known)) if known else None, factor)


def summary_text(result: DemoResult) -> str:
    """One line or two."""
    located = result.located
    of = "" if result.imperfect is None else f"{_first_title(result)}: "
    text = (
        f"{of}{result.detected} of {len(result.hits)} contacts detected, {result.links_right} links correct, "
        f"{len(located)} points located"
    )
    errors = sorted(1e3 * hit.point_error for hit in located if hit.point_error is not None)
    if errors:
        text += f" (point error {errors[len(errors) // 2]:.1f} mm median, {errors[-1]:.1f} mm worst)"
    timing = result.timing
    alarms = f"{result.false_alarms} false alarm{'' if result.false_alarms == 1 else 's'}"
    standing = ""
    if result.standing is not None:
        kept = "It kept standing" if result.standing.kept else "It FELL"
        standing = f"{kept}: its pelvis moved by {1e3 * result.standing.moved:.1f} mm at most.\n"
    return (
        f"{text}; {alarms}.\n{standing}Monitor call from Python: {1e6 * timing.mean:.1f} us mean, "
        f"{1e6 * timing.median:.1f} us median, {1e6 * timing.max:.0f} us max over {timing.calls} ticks."
    )
