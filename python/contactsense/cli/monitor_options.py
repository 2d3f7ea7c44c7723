"""Options of the commands that give a log to a monitor."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from .._core import ForceTorqueSensor
from ..calibration import Calibration
from .log_options import numbers
from .sensor_options import ConventionOption, SensorOption, WantedOption, sensors_of


@dataclass(frozen=True)
class MonitorOptions:
    """What the options say of the monitor."""

    calibration: Annotated[
        Path | None, typer.Option(help="File of `contactsense calibrate`: noise, friction, masses, levels.")
    ] = None
    threshold: Annotated[
        str | None,
        typer.Option(
            help="Torque that is a contact in Nm, one or one a joint: 2,2,1 "
            "(default: 0.5, or the calibration's)."
        ),
    ] = None
    gain: Annotated[float, typer.Option(help="Observer gain in 1/s.")] = 50.0
    bias_time: Annotated[
        float | None,
        typer.Option(help="Time constant in s of the bias that is learnt without contact (default: none)."),
    ] = None
    sensor: SensorOption = None
    sensor_convention: ConventionOption = "load"
    wanted: WantedOption = None
    wrench_threshold: Annotated[
        float, typer.Option(help="Wrench at a sensor that is a contact, in N and Nm.")
    ] = 2.0

    def sensors(self) -> dict[ForceTorqueSensor, str | None]:
        """The sensors, and where their readings are."""
        return sensors_of(self.sensor, self.sensor_convention)

    def arguments(self) -> dict[str, Any]:
        """Arguments of `ContactMonitor` by name, without `dt`."""
        arguments: dict[str, Any] = {
            "sensors": list(self.sensors()),
            "wanted_contacts": self.wanted or [],
            "wrench_threshold": self.wrench_threshold,
            "observer_gain": self.gain,
            "bias_time_constant": self.bias_time,
            "calibration": None if self.calibration is None else Calibration.load(self.calibration),
        }
        if self.threshold is not None:
            arguments["torque_threshold"] = numbers("threshold", self.threshold)
        return arguments
