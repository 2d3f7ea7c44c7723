"""`ContactParticleFilter.update` beside the same step with Pinocchio, NumPy and SciPy's k-d trees."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

import contactsense as cs

from . import pressed_sphere, robots
from .machine import all_cores
from .reference_particle_filter import ReferenceParticleFilter
from .timing import Comparison, Contestant, Pace, interleave

PARTICLES, MANY, FEW = 10_000, 100_000, 300
STEPS = 20
# Where all contestants find the contact.
LINK = "iiwa_link_5"
PANDA_LINK = "panda_link6"
NEAR = 0.03  # [m]
# A step takes longer while the particles are scattered: always a whole run, from the spread on.
RUN = "reset()\nfor step in scene: update(step.q, step.tau_ext)"
ROUNDS = 10  # of the others for one here: a run of the peers takes seconds
MAX_US, MAX_US_TWO_THREADS = 5000.0, 3000.0
# Poses that the sampler is fed, of which forty are in its window, and the noise of their torques.
SAMPLED, RELATIVE = 60, 0.03
MAX_US_SAMPLER = 100_000.0  # on average
MIN_RATIO = 20.0
MIN_STEPS_PER_SECOND = 2200.0
MAX_GROWTH = 11.0  # for ten times the particles


def compare(pace: Pace) -> list[Comparison]:
    """An arm that sways against a sphere; every step has a new pose and new torques."""
    pace = replace(pace, rounds=max(1, pace.rounds // ROUNDS))
    iiwa = robots.iiwa14_meshes()
    scene = pressed_sphere.path(iiwa[1], LINK, STEPS)
    return [
        # The limit is held against the first: points 2 mm apart are 1 mm off on average.
        _beside_reference(*iiwa, LINK, (2, 1, 4), pace),
        # The search on its rounder links takes the peer far longer.
        _beside_reference(*robots.panda(), PANDA_LINK, (2,), pace),
        _two_threads(iiwa[0], iiwa[1], scene, pace),
        _growth(iiwa[0], iiwa[1], scene, pace),
        _few(*iiwa, scene, pace),
        _sampler(iiwa[0], iiwa[1], pace),
    ]


def _beside_reference(
    name: str, robot: cs.Robot, model: Any, link: str, spacings: tuple[int, ...], pace: Pace
) -> Comparison:
    """`spacings` of the peer's points [mm]."""
    scene = pressed_sphere.path(robot, link, STEPS)
    contestants = {"contactsense": cs.ContactParticleFilter(robot, particles=PARTICLES)}
    for spacing in spacings:
        contestants[f"numpy, cKDTree, a point each {spacing} mm"] = ReferenceParticleFilter(
            model, robot, particles=PARTICLES, spacing=1e-3 * spacing
        )
    for each in contestants.values():
        _check(each, scene, link)
    timings = interleave([_contestant(*each, scene) for each in contestants.items()], pace)
    task = f"particle filter, {name}, {PARTICLES:,}"
    return Comparison(task, timings, max_us=MAX_US, min_ratio=MIN_RATIO)


def _two_threads(name: str, robot: cs.Robot, scene: list[pressed_sphere.Pressed], pace: Pace) -> Comparison:
    return _beside_one_thread(
        f"particle filter, {name}, {PARTICLES:,}, two threads, wall",
        lambda threads: cs.ContactParticleFilter(robot, particles=PARTICLES, threads=threads),
        scene,
        pace,
        MAX_US_TWO_THREADS,
    )


def _beside_one_thread(
    task: str,
    make: Callable[[int], Any],
    scene: list[pressed_sphere.Pressed],
    pace: Pace,
    max_us: float,
) -> Comparison:
    """On the wall: a process's time counts both threads."""
    with all_cores():
        two, one = make(2), make(1)
        for each in (two, one):
            _check(each, scene, LINK)
        contestants = [
            _contestant("contactsense", two, scene),
            _contestant("contactsense, one thread", one, scene),
        ]
        timings = interleave(contestants, replace(pace, clock=time.perf_counter))
    return Comparison(task, timings, max_us=max_us)


def _growth(name: str, robot: cs.Robot, scene: list[pressed_sphere.Pressed], pace: Pace) -> Comparison:
    """Without a peer: a step of so many takes it half a second. Times are for 10,000 of the particles."""
    many, usual = (cs.ContactParticleFilter(robot, particles=n) for n in (MANY, PARTICLES))
    for each in (many, usual):
        _check(each, scene, LINK)
    share = MANY // PARTICLES
    contestants = [
        _contestant("contactsense", many, scene, share),
        _contestant(f"contactsense, {PARTICLES:,} in all", usual, scene),
    ]
    task = f"particle filter, {name}, {MANY:,}, a tenth of them"
    return Comparison(task, interleave(contestants, pace), min_ratio=share / MAX_GROWTH)


def _few(
    name: str, robot: cs.Robot, model: Any, scene: list[pressed_sphere.Pressed], pace: Pace
) -> Comparison:
    """So few may settle on a wrong link: their answers are not compared."""
    ours = cs.ContactParticleFilter(robot, particles=FEW)
    reference = ReferenceParticleFilter(model, robot, particles=FEW)
    contestants = [
        _contestant("contactsense", ours, scene),
        _contestant("numpy, cKDTree", reference, scene),
    ]
    task = f"particle filter, {name}, {FEW}"
    return Comparison(task, interleave(contestants, pace), max_us=1e6 / MIN_STEPS_PER_SECOND)


def _sampler(name: str, robot: cs.Robot, pace: Pace) -> Comparison:
    """Noisy torques, until the window has been full for a while; without a peer."""
    rng = np.random.default_rng(1)
    scene = [
        step._replace(tau_ext=step.tau_ext * (1.0 + RELATIVE * rng.normal(size=robot.nv)))
        for step in pressed_sphere.path(robot, LINK, SAMPLED)
    ]
    return _beside_one_thread(
        f"sampler, {name}, {PARTICLES:,}, two threads, wall",
        lambda threads: cs.StaticObstacleSampler(robot, particles=PARTICLES, threads=threads),
        scene,
        pace,
        MAX_US_SAMPLER,
    )


def _contestant(name: str, particles: Any, scene: list[pressed_sphere.Pressed], share: int = 1) -> Contestant:
    names = {"update": particles.update, "reset": particles.reset, "scene": scene}
    return Contestant(name, RUN, names, share * len(scene))


def _check(particles: Any, scene: list[pressed_sphere.Pressed], link: str) -> None:
    """It finds the contact."""
    particles.reset()
    for step in scene:
        estimate = particles.update(step.q, step.tau_ext)
    off = np.linalg.norm(estimate.point - scene[-1].point)
    assert estimate.link == link, f"the contact is on {link}, found on {estimate.link}"
    assert off < NEAR, f"the point found is {100 * off:.1f} cm off"
