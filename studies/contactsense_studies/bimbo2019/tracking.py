"""A filter that follows a recorded run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from contactsense import ContactParticleFilter
from contactsense.sim import TorqueNoise

from .arm import Arm
from .experiments import Filter
from .options import Options
from .score import Outcome, judge, point_error


def make_filter(arm: Arm, kind: Filter, options: Options, seed: int) -> ContactParticleFilter:
    """The filter, with its defaults."""
    return ContactParticleFilter(
        arm.robot,
        particles=options.particles,
        motion=kind.motion,
        likelihood=kind.likelihood,
        schedule=kind.schedule,
        measurement=kind.measurement,
        seed=seed,
        threads=1,
    )


def track(
    arm: Arm,
    run: Any,
    kind: Filter,
    options: Options,
    seed: int,
    watch: Callable[[int, ContactParticleFilter, Any], None] = lambda row, particles, estimate: None,
) -> Outcome:
    """Feeds the run, a sample an update; `watch` is told each row, the filter and its estimate."""
    particles = make_filter(arm, kind, options, seed)
    noise = TorqueNoise(percent=kind.noise, seed=seed)
    errors = []
    for row, (q, torque) in enumerate(zip(run.q, run.external_torque, strict=True)):
        estimate = particles.update(q, noise.measure(torque))
        errors.append(point_error(estimate, run.point[row]))
        watch(row, particles, estimate)
    return judge(estimate, run.link[-1], run.point[-1], run.force[-1], tuple(np.round(errors, 6).tolist()))
