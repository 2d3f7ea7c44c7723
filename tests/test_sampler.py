"""The sampler of static obstacles: what it finds on runs in closed form, and which model it chooses."""

from __future__ import annotations

import signal
import threading

import numpy as np
import pytest
from particle_runs import arm, explored

import contactsense as cs

ROWS = slice(None, None, 3)


def sampled(run: cs.sim.ContactRun, noise: float = 0.0, **options: object) -> cs.StaticObstacleSampler:
    generator = np.random.default_rng(3)
    sampler = cs.StaticObstacleSampler(arm(), **{"particles": 3000, **options})
    for q, torque in zip(run.q[ROWS], run.external_torque[ROWS], strict=True):
        sampler.update(q, torque * (1.0 + noise * generator.standard_normal(torque.size)))
    return sampler


def last(run: cs.sim.ContactRun) -> int:
    return range(len(run))[ROWS][-1]


@pytest.mark.parametrize("noise", [0.0, 0.1])
@pytest.mark.parametrize("link", [4, 5, 6, 7])
def test_a_ball_is_found(link: int, noise: float) -> None:
    for seed in (41, 42):
        run = explored(link, seed)
        estimate = sampled(run, noise, relative_noise=0.1 if noise else 0.03).estimate
        off = float(np.linalg.norm(estimate.point - run.point[last(run)]))
        assert estimate.link == run.link[-1]
        assert off < 0.01, (seed, off)
        assert estimate.explained
        assert estimate.event == "continued"


@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_three_torques_give_the_link_and_about_the_point(noise: float) -> None:
    # Medians of 4 and 22 mm, at most 9 and 64 mm with standard deviations of 23 and 42 mm.
    off = []
    for seed in (41, 42, 43, 1041, 1042):
        run = explored(3, seed)
        estimate = sampled(run, noise, relative_noise=0.1 if noise else 0.03).estimate
        off.append(float(np.linalg.norm(estimate.point - run.point[last(run)])))
        assert estimate.link == run.link[-1]
        assert off[-1] < 3.0 * np.sqrt(np.trace(estimate.covariance))
    assert np.median(off) < (0.03 if noise else 0.01), off


def test_greater_noise_than_stated_is_learnt() -> None:
    run = explored(5, 41)
    sure, stated = (sampled(run, 0.1, relative_noise=noise).estimate for noise in (0.01, 0.1))
    assert sure.residual > 3.0 * stated.residual
    for estimate in (sure, stated):
        assert np.linalg.norm(estimate.point - run.point[last(run)]) < 0.015


def pushed(link: str, forces: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """External torques of forces along the inward normal at a point that stays on the link."""
    robot = arm()
    surface = robot.surface(link)
    place = surface.sample(64, seed=2)
    point, normal = place.points[40], place.normals[40]
    rows = []
    for q, force in zip(poses, forces, strict=True):
        pose = robot.link_pose(q, link)
        world = pose[:3, :3] @ point + pose[:3, 3]
        jacobian = robot.jacobian(q, link, world)[:3]
        rows.append(-jacobian.T @ (pose[:3, :3] @ normal) * force)
    return np.array(rows)


def test_a_person_is_told_from_an_obstacle() -> None:
    models = ("obstacle", "person", "both")
    generator = np.random.default_rng(1)
    run = explored(5, 41)
    sampler = sampled(run, 0.02, models=models)
    probabilities = sampler.model_probabilities
    assert list(probabilities) == list(models)
    assert probabilities["obstacle"] > 0.9
    forces = generator.uniform(10.0, 40.0, len(run))
    torques = pushed("iiwa_link_5", forces, run.q)
    sampler.reset()
    for q, torque in zip(run.q[ROWS], torques[ROWS], strict=True):
        sampler.update(q, torque * (1.0 + 0.02 * generator.standard_normal(7)))
    assert sampler.model_probabilities["person"] > 0.9
    assert sampler.estimate.link == "iiwa_link_5"
    # A single model is judged by its evidence.
    alone = [
        cs.StaticObstacleSampler(arm(), particles=3000, models=model) for model in ("obstacle", "person")
    ]
    for each in alone:
        for q, torque in zip(run.q[ROWS], torques[ROWS], strict=True):
            each.update(q, torque)
    assert alone[1].log_evidence > alone[0].log_evidence + 10.0


def test_what_holds_the_link_is_told_from_others() -> None:
    robot, link, stiffness = arm(), "iiwa_link_6", 800.0
    poses = explored(5, 41).q[ROWS]
    place = robot.surface(link).sample(64, seed=2)
    point, normal = place.points[30], place.normals[30]

    def at(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        pose = robot.link_pose(q, link)
        return pose[:3, :3] @ point + pose[:3, 3], -pose[:3, :3] @ normal

    anchor, inward = at(poses[0])
    sampler = cs.StaticObstacleSampler(robot, particles=3000, models=("obstacle", "person", "both"))
    for q in poses:
        here, _ = at(q)
        force = 20.0 * inward + stiffness * (anchor - here)
        estimate = sampler.update(q, robot.jacobian(q, link, here)[:3].T @ force)
    assert sampler.model_probabilities["both"] > 0.9
    assert estimate.link == link
    assert np.linalg.norm(estimate.point - here) < 0.01
    assert np.linalg.norm(estimate.force - force) < 0.1 * np.linalg.norm(force)


def test_bad_input_names_the_argument_and_changes_nothing() -> None:
    robot = arm()
    for name, value in (
        ("models", "wall"),
        ("models", ()),
        ("models", ("person", "person")),
        ("window", 1),
        ("moves", 0),
        ("forgetting_time", -1.0),
        ("forgetting_time", np.nan),
        ("particles", 0),
    ):
        with pytest.raises(cs.InputError, match=name):
            cs.StaticObstacleSampler(robot, **{name: value})
    sampler = cs.StaticObstacleSampler(robot, particles=500, forgetting_time=2.0)
    q, torque = np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]
    with pytest.raises(cs.InputError, match=r"time: must be given"):
        sampler.update(q, torque)
    assert not sampler.estimate.contact
    sampler.update(q, torque, time=1.0)
    before = sampler.particles.point
    with pytest.raises(cs.InputError, match=r"time: must not be less"):
        sampler.update(q, torque, time=0.5)
    with pytest.raises(cs.InputError, match="tau_ext"):
        sampler.update(q, torque[1:], time=2.0)
    assert np.array_equal(sampler.particles.point, before)
    assert sampler.estimate.time == 1.0


def test_an_obstacle_that_creeps_is_followed() -> None:
    """A ball that goes sideways by 0.5 mm a pose, its force the same."""
    robot = arm()
    run = explored(5, 41)
    errors = {}
    for forgetting in (None, 1.0):
        sampler = cs.StaticObstacleSampler(robot, particles=3000, forgetting_time=forgetting)
        generator = np.random.default_rng(7)
        surface, link = robot.surface("iiwa_link_5"), "iiwa_link_5"
        pose = robot.link_pose(run.q[0], link)
        place = surface.sample(64, seed=2)
        normal = pose[:3, :3] @ place.normals[20]
        centre = pose[:3, :3] @ place.points[20] + pose[:3, 3] + 0.05 * normal
        across = np.cross(normal, [1.0, 0.3, -0.2])
        across /= np.linalg.norm(across)
        off = []
        for k, q in enumerate(run.q[ROWS]):
            here = centre + 0.5e-3 * k * across
            pose = robot.link_pose(q, link)
            near = surface.closest_points(((here - pose[:3, 3]) @ pose[:3, :3])[None])
            point = pose[:3, :3] @ near.points[0] + pose[:3, 3]
            away = (here - point) / np.linalg.norm(here - point)
            torque = -robot.jacobian(q, link, point)[:3].T @ away * 25.0
            torque *= 1.0 + 0.02 * generator.standard_normal(7)
            estimate = sampler.update(q, torque, time=0.2 * k)
            off.append(np.linalg.norm(estimate.point - point))
        errors[forgetting] = float(np.median(off[20:]))
    assert errors[1.0] < 0.005, errors
    assert errors[1.0] < 0.8 * errors[None], errors


def test_the_same_seed_gives_the_same_bits_on_any_number_of_threads() -> None:
    run = explored(4, 42)
    one, two = (sampled(run, 0.05, threads=threads, seed=5).particles for threads in (1, 2))
    assert np.array_equal(one.point, two.point)
    assert np.array_equal(one.weight, two.weight)
    again = sampled(run, 0.05, seed=6).particles
    assert not np.array_equal(one.point, again.point)


def test_options_make_an_equal_sampler() -> None:
    sampler = cs.StaticObstacleSampler(
        arm(), particles=200, models=("person", "both"), window=7, forgetting_time=3.0, friction=0.2
    )
    again = cs.StaticObstacleSampler(arm(), **sampler.options)
    assert again.options == sampler.options
    assert sampler.options["models"] == ("person", "both")
    assert "200" in repr(sampler)


def test_ctrl_c_ends_an_update_with_what_it_has() -> None:
    run = explored(5, 41)
    sampler = cs.StaticObstacleSampler(arm(), particles=60_000, moves=1000)
    # Not the handler of the test runner: this one is the interpreter's own.
    former = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT))

    def work() -> None:
        for q, torque in zip(run.q[ROWS], run.external_torque[ROWS], strict=True):
            sampler.update(q, torque)

    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, former)
    assert sampler.estimate.contact
    assert abs(sampler.particles.weight.sum() - 1.0) < 1e-9
    assert sampler.update(run.q[-1], run.external_torque[-1]).event == "continued"
