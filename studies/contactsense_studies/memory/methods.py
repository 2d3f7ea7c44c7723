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

Update = Callable[[Any, Any], Any]


@dataclass(frozen=True)
class Method:
    """A way to locate a contact, and each how many samples of a run it is fed."""

    name: str
    make: Callable[[Robot, Options, Calibration | None], Update]
    every: int = 1


@dataclass(frozen=True)
class Found:
    """The end of one run."""

    outcome: Outcome
    near: bool  # a probable place is near the true one


def _filter(robot: Robot, options: Options, calibration: Calibration | None) -> Update:
    return ContactParticleFilter(robot, **_of_particles(options), calibration=calibration).update


def _sampler(robot: Robot, options: Options, calibration: Calibration | None) -> Update:
    return StaticObstacleSampler(robot, **_of_particles(options), calibration=calibration).update


def _of_particles(options: Options) -> dict[str, Any]:
    common = {"particles": options.particles, "seed": options.seed}
    rubbing = {"measurement": "friction_cone", "friction": options.friction}
    return {**common, **rubbing} if options.friction > 0.0 else common


def _map(robot: Robot, options: Options, calibration: Calibration | None) -> Update:
    rubbing: dict[str, Any] = {"friction": options.friction} if options.friction > 0.0 else {}
    return ContactMap(robot, **rubbing, calibration=calibration).evaluate


METHODS = (Method("map", _map, every=5), Method("filter", _filter), Method("sampler", _sampler, every=4))


def locate(
    robot: Robot,
    run: ContactRun,
    method: Method,
    noise: float,
    options: Options,
    calibration: Calibration | None = None,
) -> Found:
    """Feeds the run to the end, with noise of so many per cent; the seed of `options` is the trial's."""
    update = method.make(robot, options, calibration)
    torques = TorqueNoise(percent=noise, seed=options.seed)
    for row, (q, torque) in enumerate(zip(run.q, run.external_torque, strict=True)):
        measured = torques.measure(torque)
        if row % method.every == 0:
            estimate, last = update(q, measured), row
    point = run.point[last]
    places = [mode.point for mode in estimate.modes if mode.probability >= PROBABLE]
    near = any(float(((place - point) ** 2).sum()) <= NEAR**2 for place in places)
    return Found(judge(estimate, run.link[last], point, run.force[last]), near)
