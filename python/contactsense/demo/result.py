"""What a demo run gives: every hit's truth against the estimate, and the signals over time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .settings import FloatArray, Settings

if TYPE_CHECKING:
    from ..robot import Robot
    from ..sim import TorqueNoise, WrenchNoise


@dataclass(frozen=True)
class HitResult:
    """One hit and what the monitor said of it at its strongest moment.

    That moment is the tick of the detected contact with the largest torque of collisions in thresholds; it is
    chosen without the truth. Errors are None where there is no estimate.
    """

    number: int  # from 1
    start: float  # [s]
    duration: float  # [s]
    link: str  # truly hit
    force: float  # true peak [N]
    delay: float | None  # from the start of the force to detection [s]; None: missed
    named: str | None  # the link that the monitor names
    located: bool  # whether it gives a point
    time: float | None  # strongest moment [s]
    point_error: float | None  # to the true point at that moment [m]
    point_std: float | None  # the monitor's own standard deviation of the point [m]
    force_error: float | None  # |estimate - true peak| / |true peak|, of the vectors
    q: FloatArray  # at the strongest moment, or at the hit's middle if missed
    true_point: FloatArray  # (3,) then [m]
    true_force: FloatArray  # (3,) at its peak, direction as then [N]
    point: FloatArray | None  # (3,) estimated [m]
    estimated_force: FloatArray | None  # (3,) [N]
    elsewhere: dict[str, int]  # other links that were named meanwhile, and on how many ticks

    @property
    def link_right(self) -> bool:
        """Whether the estimated link is the contact link."""
        return self.named == self.link


@dataclass(frozen=True)
class Signals:
    """One row a tick."""

    time: FloatArray  # (n,) [s]
    true_torque: FloatArray  # (n, nv) external torque of the hits [Nm]
    torque: FloatArray  # (n, nv) estimate of all external torque [Nm]
    true_force: FloatArray  # (n,) magnitude [N]
    force: FloatArray  # (n,) of the (strongest) located contact, NaN where there is none [N]
    collision: NDArray[np.bool_]  # (n,)


@dataclass(frozen=True)
class Standing:
    """How a humanoid stood while it was pushed."""

    feet: tuple[str, ...]  # sensors whose contacts are wanted
    ground: FloatArray  # (n, feet) measured force of the ground, a row a tick [N]
    moved: float  # largest way of the base [m]
    turned: float  # largest angle of the base [rad]

    @property
    def kept(self) -> bool:
        """Whether it stood throughout."""
        return self.moved < 0.1 and self.turned < 0.2


@dataclass(frozen=True)
class Timing:
    """Of a call to `ContactMonitor.update` from Python."""

    calls: int
    mean: float  # [s]
    median: float  # [s]
    max: float  # [s]


@dataclass(frozen=True)
class Scored:
    """Hits of a run, and what the monitor said of them."""

    hits: tuple[HitResult, ...]
    false_alarms: int
    signals: Signals

    @property
    def detected(self) -> int:
        """How many contacts were detected."""
        return sum(hit.delay is not None for hit in self.hits)

    @property
    def links_right(self) -> int:
        """Of how many contacts the link is correct."""
        return sum(hit.link_right for hit in self.hits)

    @property
    def located(self) -> tuple[HitResult, ...]:
        """The contacts with a located point."""
        return tuple(hit for hit in self.hits if hit.located)


@dataclass(frozen=True)
class ImperfectResult(Scored):
    """The same motion and contacts on an arm with the errors of a real one, calibrated."""

    calibration_seconds: float  # of motion without contact [s]
    torque_threshold: FloatArray  # (nv,) that follow from the calibration [Nm]


@dataclass(frozen=True)
class DemoResult(Scored):
    """A run."""

    robot_name: str
    robot: Robot
    seed: int
    noise: TorqueNoise
    sensor_noise: WrenchNoise
    settings: Settings
    planned_speed: float  # fastest joint of the planned motion; zero where it stands [rad/s]
    timing: Timing
    standing: Standing | None  # of a humanoid
    imperfect: ImperfectResult | None = None  # of an arm


@dataclass(frozen=True)
class Progress:
    """Where a run is."""

    time: float  # [s]
    end: float  # [s]
    hits: tuple[HitResult, ...]  # scored so far
    planned: int
    settings: Settings
    sensed: str  # what the monitor says now, a link's name or empty
    imperfect: bool = False  # whether the imperfect arm has its turn


def as_data(result: DemoResult) -> dict[str, Any]:
    """Plain numbers and texts, for JSON; None where there is no estimate."""
    data: dict[str, Any] = {
        "robot": result.robot_name,
        "seed": result.seed,
        "noise": {"percent": result.noise.percent, "newton_metres": result.noise.newton_metres},
        "planned_peak_speed": result.planned_speed,
        "observer_gain": result.settings.observer_gain,
        "torque_threshold": result.settings.torque_threshold.tolist(),
        **_scored_data(result),
        "monitor": {
            "calls": result.timing.calls,
            "mean_us": 1e6 * result.timing.mean,
            "median_us": 1e6 * result.timing.median,
            "max_us": 1e6 * result.timing.max,
        },
    }
    if result.standing is not None:
        data["standing"] = _standing_data(result, result.standing)
    if result.imperfect is not None:
        data["imperfect"] = {
            "calibration_s": result.imperfect.calibration_seconds,
            "torque_threshold": result.imperfect.torque_threshold.tolist(),
            **_scored_data(result.imperfect),
        }
    return data


def _scored_data(result: Scored) -> dict[str, Any]:
    return {
        "hits": [_hit_data(hit) for hit in result.hits],
        "summary": {
            "hits": len(result.hits),
            "detected": result.detected,
            "links_named_right": result.links_right,
            "located": len(result.located),
            "located_on_wrong_link": sum(not hit.link_right for hit in result.located),
            "median_point_error_mm": _median([hit.point_error for hit in result.located], 1e3),
            "worst_point_error_mm": _worst([hit.point_error for hit in result.located], 1e3),
            "median_force_error_percent": _median([hit.force_error for hit in result.located], 100.0),
            "median_delay_ms": _median([hit.delay for hit in result.hits], 1e3),
            "false_alarms": result.false_alarms,
        },
    }


def _standing_data(result: DemoResult, standing: Standing) -> dict[str, Any]:
    noise = result.sensor_noise
    return {
        "kept": standing.kept,
        "base_moved_mm": 1e3 * standing.moved,
        "base_turned_deg": float(np.degrees(standing.turned)),
        "wanted_contacts": list(standing.feet),
        "sensor_noise": {"newtons": noise.newtons, "newton_metres": noise.newton_metres},
        "wrench_threshold": result.settings.wrench_threshold.tolist(),
    }


def _hit_data(hit: HitResult) -> dict[str, Any]:
    return {
        "number": hit.number,
        "start_s": hit.start,
        "duration_ms": 1e3 * hit.duration,
        "link": hit.link,
        "peak_force_n": hit.force,
        "delay_ms": _scaled(hit.delay, 1e3),
        "named": hit.named,
        "link_right": hit.link_right,
        "located": hit.located,
        "point_error_mm": _scaled(hit.point_error, 1e3),
        "point_std_mm": _scaled(hit.point_std, 1e3),
        "force_error_percent": _scaled(hit.force_error, 100.0),
        "ticks_named_elsewhere": hit.elsewhere,
    }


def _scaled(value: float | None, factor: float) -> float | None:
    return None if value is None else factor * value


def _median(values: list[float | None], factor: float) -> float | None:
    known = [value for value in values if value is not None]
    return factor * float(np.median(known)) if known else None


def _worst(values: list[float | None], factor: float) -> float | None:
    known = [value for value in values if value is not None]
    return factor * max(known) if known else None
