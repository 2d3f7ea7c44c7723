"""Choosing settings on the tuning files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from contactsense import InputError, Robot

from .logs import TouchLog
from .replay import replay, with_noise_of
from .settings import TUNING_FILES, UNUSED_GAIN, Settings, Source
from .summary import Summary, summarise
from .touches import judge

GAINS = (20.0, 30.0, 50.0, 100.0)
DETECTION_FACTORS = (5.0, 6.0, 8.0, 10.0, 12.0, 15.0, 20.0, 30.0, 40.0, 60.0)
HOLD_TIMES = (0.02, 0.05)
BIAS_TIME_CONSTANTS = (0.5, 1.0)
ISOLATION_FACTORS = (1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0)
# False alarms are counted with thresholds lowered to this share, so that other days have some room.
MARGIN = 0.8


def choose_settings(robot: Robot, logs: Sequence[TouchLog], source: Source) -> Settings:
    """The best settings of a grid on the tuning files.

    Detection: fewest touches missed, then fewest false alarms (with lowered thresholds too), fewest onsets
    before a label, shortest delay at both ends. Isolation: smallest mean error of the link's number.

    Raises:
        InputError: a tuning file is missing.
    """
    used = [log for log in logs if log.name in TUNING_FILES]
    if len(used) < len(TUNING_FILES):
        raise InputError(f"data: settings are chosen on {' and '.join(TUNING_FILES)}; not all are there")

    def figures(settings: Settings) -> Summary:
        return summarise([judge(robot, log, replay(robot, log, settings), settings, True) for log in used])

    def detection_cost(settings: Settings) -> tuple[float, ...]:
        figure = figures(settings)
        lowered = figures(replace(settings, detection_factor=MARGIN * settings.detection_factor))
        false_alarms = figure.false_alarms + lowered.false_alarms
        late = figure.delay_median + figure.overrun
        return figure.touches - figure.detected, false_alarms, figure.early, late

    def isolation_cost(settings: Settings) -> float:
        return figures(settings).link_error

    detecting = min(_detection_grid(robot, used, source), key=detection_cost)
    return min((replace(detecting, isolation_factor=x) for x in ISOLATION_FACTORS), key=isolation_cost)


def _detection_grid(robot: Robot, logs: list[TouchLog], source: Source) -> Iterator[Settings]:
    for gain in GAINS if source == "measured" else (UNUSED_GAIN,):
        base = Settings(source, (0.0,) * robot.nv, gain, 1.0, 1.0, HOLD_TIMES[0], BIAS_TIME_CONSTANTS[0])
        base = with_noise_of(robot, logs, base)
        for factor in DETECTION_FACTORS:
            for hold in HOLD_TIMES:
                for constant in BIAS_TIME_CONSTANTS:
                    yield replace(base, detection_factor=factor, hold_time=hold, bias_time_constant=constant)
