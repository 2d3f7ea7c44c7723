"""What locates the contact of a recorded run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from contactsense import Calibration, ContactMap, ContactParticleFilter, Robot, StaticObstacleSampler
from contactsense.sim import ContactRun, TorqueNoise

from ..bimbo2019.score import Outcome, judge
from .options import Options

# The most probable places that are weighed beside the best: so probable at least, and so near [m].
PROBABLE, NEAR = 0.1, 0.02


def _no_particles() -> None:
    """What has no particles."""


@dataclass(frozen=True)
class Locator:
    """What is fed with poses and torques."""

    update: Callable[[Any, Any], Any]
    particles: Callable[[], Any] = _no_particles  # after the last update


@dataclass(frozen=True)
class Setting:
    """What a locator is told."""

    particles: int
    seed: int
    friction: float = 0.0
    calibration: Calibration | None = None


@dataclass(frozen=True)
class Method:
    """A way to locate a contact, and each how many samples of a run it is fed."""

    name: str
    make: Callable[[Robot, Setting], Locator]
    every: int = 1


@dataclass(frozen=True)
class Found:
    """The end of one run."""

    outcome: Outcome
    near: bool  # a probable place is near the true one


def _of_particles(kind: Any) -> Callable[[Robot, Setting], Locator]:
    def make(robot: Robot, setting: Setting) -> Locator:
        rubbing = _rubbing(setting)
        if rubbing:
            rubbing["measurement"] = "friction_cone"
        common = {"particles": setting.particles, "seed": setting.seed, "calibration": setting.calibration}
        locator = kind(robot, **common, **rubbing)
        return Locator(locator.update, lambda: locator.particles)

    return make


def _map(robot: Robot, setting: Setting) -> Locator:
    return Locator(ContactMap(robot, calibration=setting.calibration, **_rubbing(setting)).evaluate)


def _rubbing(setting: Setting) -> dict[str, Any]:
    return {"friction": setting.friction} if setting.friction > 0.0 else {}


METHODS = (
    Method("map", _map, every=5),
    Method("filter", _of_particles(ContactParticleFilter)),
    Method("sampler", _of_particles(StaticObstacleSampler), every=4),
)


def locate(
    robot: Robot,
    run: ContactRun,
    method: Method,
    noise: float,
    options: Options,
    calibration: Calibration | None = None,
) -> Found:
    """Feeds the run to the end, with noise of so many per cent; the seed of `options` is the trial's."""
    setting = Setting(options.particles, options.seed, options.friction, calibration)
    locator = method.make(robot, setting)
    torques = TorqueNoise(percent=noise, seed=options.seed)
    for row, (q, torque) in enumerate(zip(run.q, run.external_torque, strict=True)):
        measured = torques.measure(torque)
        if row % method.every == 0:
            estimate, last = locator.update(q, measured), row
    point = run.point[last]
    places = [mode.point for mode in estimate.modes if mode.probability >= PROBABLE]
    near = any(float(((place - point) ** 2).sum()) <= NEAR**2 for place in places)
    return Found(judge(estimate, run.link[last], point, run.force[last]), near)
