"""What locates the contact of a recorded run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

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


class Make(Protocol):
    """Makes a locator."""

    def __call__(
        self,
        robot: Robot,
        *,
        particles: int,
        seed: int,
        friction: float = 0.0,
        calibration: Calibration | None = None,
    ) -> Locator:
        """Of a contact with a coefficient of friction, by torques with the noise of a calibration."""


@dataclass(frozen=True)
class Method:
    """A way to locate a contact, and each how many samples of a run it is fed."""

    name: str
    make: Make
    every: int = 1


@dataclass(frozen=True)
class Found:
    """The end of one run."""

    outcome: Outcome
    near: bool  # a probable place is near the true one


def _of_particles(kind: Any) -> Make:
    def make(
        robot: Robot,
        *,
        particles: int,
        seed: int,
        friction: float = 0.0,
        calibration: Calibration | None = None,
    ) -> Locator:
        rubbing = {"measurement": "friction_cone", "friction": friction} if friction > 0.0 else {}
        locator = kind(robot, particles=particles, seed=seed, calibration=calibration, **rubbing)
        return Locator(locator.update, lambda: locator.particles)

    return make


def _map(
    robot: Robot,
    *,
    particles: int,
    seed: int,
    friction: float = 0.0,
    calibration: Calibration | None = None,
) -> Locator:
    rubbing: dict[str, Any] = {"friction": friction} if friction > 0.0 else {}
    return Locator(ContactMap(robot, **rubbing, calibration=calibration).evaluate)


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
    locator = method.make(
        robot,
        particles=options.particles,
        seed=options.seed,
        friction=options.friction,
        calibration=calibration,
    )
    torques = TorqueNoise(percent=noise, seed=options.seed)
    for row, (q, torque) in enumerate(zip(run.q, run.external_torque, strict=True)):
        measured = torques.measure(torque)
        if row % method.every == 0:
            estimate, last = locator.update(q, measured), row
    point = run.point[last]
    places = [mode.point for mode in estimate.modes if mode.probability >= PROBABLE]
    near = any(float(((place - point) ** 2).sum()) <= NEAR**2 for place in places)
    return Found(judge(estimate, run.link[last], point, run.force[last]), near)
