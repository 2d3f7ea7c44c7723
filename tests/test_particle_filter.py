"""The particle filter on runs in closed form: what it finds, and what it says of itself."""

from __future__ import annotations

import sys
import threading

import numpy as np
import pytest
from particle_runs import Which, arm, error, explored, follow
from robots import meshes, packaged

import contactsense as cs
from contactsense import sim

CHI2_90 = 6.25  # three degrees of freedom
# The packaged iiwa14 of simple solids, and the one with meshes.
ARMS = [packaged, pytest.param(meshes, marks=pytest.mark.shared)]


@pytest.mark.parametrize("which", ARMS)
@pytest.mark.parametrize("noise", [0.0, 0.1])
@pytest.mark.parametrize("link", [4, 5, 6, 7])
def test_a_ball_is_found_on_the_outer_links(link: int, noise: float, which: Which) -> None:
    # Over eight seeds at most 6 mm off, the force by 11 %.
    runs = [explored(link, seed, which=which) for seed in (41, 42, 43)]
    for run in runs:
        estimate = follow(run, noise, which())
        force = run.force[-1]
        assert estimate.link == run.link[-1]
        assert error(estimate, run) < 0.015
        assert np.linalg.norm(estimate.force - force) < (0.1 + noise) * np.linalg.norm(force)
        assert estimate.contact
        assert estimate.explained
        assert estimate.event == "continued"


@pytest.mark.parametrize("which", ARMS)
@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_three_torques_give_the_link_and_about_the_point(noise: float, which: Which) -> None:
    # Over eight seeds a median of 17 mm, at most 59 mm.
    runs = [explored(3, seed, which=which) for seed in (41, 42, 43, 1041, 1042)]
    estimates = [follow(run, noise, which()) for run in runs]
    assert [estimate.link for estimate in estimates] == [run.link[-1] for run in runs]
    assert np.median([error(*pair) for pair in zip(estimates, runs, strict=True)]) < 0.04
    assert all(estimate.contact and estimate.explained for estimate in estimates)


def test_the_obstacles_stiffness_is_found() -> None:
    run = explored(5, 41)
    estimate = follow(run)
    assert estimate.stiffness == pytest.approx(run.settings["stiffness"], rel=0.1)


@pytest.mark.parametrize("kind", ["cube", "cylinder"])
def test_edges_and_poles_are_found_on_the_outer_links(kind: str) -> None:
    runs = [explored(link, seed, kind) for link in (4, 5, 6, 7) for seed in (61, 62)]
    estimates = [follow(run) for run in runs]
    errors = [error(*pair) for pair in zip(estimates, runs, strict=True)]
    assert np.mean(errors) < 0.03, errors
    honest = [
        estimate.link == run.link[-1] or estimate.ambiguous
        for estimate, run in zip(estimates, runs, strict=True)
    ]
    assert sum(honest) >= len(runs) - 1


def test_near_the_base_the_covariance_says_how_little_is_known() -> None:
    runs = [explored(link, seed) for link in (1, 2) for seed in range(41, 46)]
    inside = 0
    for run in runs:
        estimate = follow(run)
        apart = estimate.point - run.point[-1]
        inside += apart @ np.linalg.solve(estimate.covariance, apart) < CHI2_90
    assert inside >= 8


def test_baselines_are_worse_near_the_base() -> None:
    runs = [explored(link, seed) for link in (2, 3, 4) for seed in (41, 42, 43)]
    means = {
        motion: np.mean([error(follow(run, motion=motion), run) for run in runs])
        for motion in ("curvature", "fixed_on_link", "fixed_in_world")
    }
    assert means["curvature"] < 0.5 * means["fixed_on_link"]
    assert means["curvature"] < 0.5 * means["fixed_in_world"]
    assert follow(runs[0], motion="fixed_on_link").stiffness is None


def test_the_papers_likelihood_and_schedule_find_the_outer_links() -> None:
    run = explored(4, 41)
    assert error(follow(run, likelihood="exponential", schedule="paper"), run) < 0.015
    assert error(follow(run, schedule={"sharpness": (1, 10), "updates": 30}), run) < 0.03


def test_friction_is_told_from_the_normal_force() -> None:
    robot = arm()
    scene = sim.touch_scene(robot, "iiwa_link_6", seed=4)
    path = sim.joint_exploration(robot, scene, pace=sim.Pace(motions=40, duration=0.25), seed=4)
    run = sim.record_quasi_static(robot, scene.contact(robot), path.time[::4], path.q[::4])
    sideways = np.cross(run.normal, [0.3, -0.5, 0.8])
    sideways *= 0.2 * np.linalg.norm(run.force, axis=1)[:, None] / np.linalg.norm(sideways, axis=1)[:, None]
    torque = run.external_torque + np.array(
        [
            robot.jacobian(q, "iiwa_link_6", point)[:3].T @ force
            for q, point, force in zip(run.q, run.point, sideways, strict=True)
        ]
    )
    found = {}
    for measurement in ("normal", "friction_cone"):
        tracker = cs.ContactParticleFilter(robot, measurement=measurement)
        for q, tau in zip(run.q, torque, strict=True):
            estimate = tracker.update(q, tau)
        found[measurement] = float(np.linalg.norm(estimate.point - run.point[-1]))
    assert found["friction_cone"] < 0.02
    assert found["friction_cone"] < found["normal"]


@pytest.mark.parametrize("which", ARMS)
def test_the_first_particles_are_uniform_by_area_and_log_uniform_in_stiffness(which: Which) -> None:
    robot = which()
    run = explored(5, 41, which=which)
    tracker = cs.ContactParticleFilter(robot, particles=20_000, schedule={"sharpness": 1e-6})
    tracker.update(run.q[0], run.external_torque[0])
    particles = tracker.particles
    names = [robot.link_names[index] for index in range(len(robot.link_names))]
    assert names[0] not in tracker.update(run.q[0], run.external_torque[0]).link_probabilities
    areas = np.array([0.0] + [robot.surface(name).area for name in names[1:]])
    share = np.bincount(particles.link, minlength=len(names)) / particles.link.size
    if which is meshes:  # a single part a link: all of its area is exposed
        assert np.abs(share - areas / areas.sum()).max() < 0.03
    for index in (3, 5):
        pose = robot.link_pose(run.q[0], names[index])
        local = (particles.point[particles.link == index] - pose[:3, 3]) @ pose[:3, :3]
        assert np.abs(robot.surface(names[index]).closest_points(local).distances).max() < 1e-9
    logs = np.log10(particles.stiffness / 3e2) / 2.0  # two decades
    assert np.abs(np.quantile(logs, [0.25, 0.5, 0.75]) - [0.25, 0.5, 0.75]).max() < 0.06
    assert particles.weight.sum() == pytest.approx(1.0)
    assert np.abs(np.linalg.norm(particles.normal, axis=1) - 1.0).max() < 1e-9


def test_the_same_seed_gives_the_same_particles_on_any_number_of_threads() -> None:
    run = explored(4, 41)
    columns = []
    for threads in (1, 2, 4):
        tracker = cs.ContactParticleFilter(arm(), particles=3000, seed=5, threads=threads)
        for q, torque in zip(run.q[:15], run.external_torque[:15], strict=True):
            tracker.update(q, torque)
        particles = tracker.particles
        columns.append(
            [getattr(particles, name) for name in ("link", "point", "normal", "force", "stiffness", "weight")]
        )
    for other in columns[1:]:
        assert all(np.array_equal(a, b) for a, b in zip(columns[0], other, strict=True))
    fresh = cs.ContactParticleFilter(arm(), particles=3000, seed=6)
    fresh.update(run.q[0], run.external_torque[0])
    assert not np.array_equal(fresh.particles.point, columns[0][1])


def test_reset_begins_anew() -> None:
    run = explored(4, 41)
    tracker = cs.ContactParticleFilter(arm(), particles=2000)
    first = [tracker.update(q, tau).point for q, tau in zip(run.q[:5], run.external_torque, strict=False)]
    tracker.reset()
    again = [tracker.update(q, tau).point for q, tau in zip(run.q[:5], run.external_torque, strict=False)]
    assert np.array_equal(first, again)


def test_other_threads_run_during_an_update() -> None:
    run = explored(4, 41)
    robot = arm()
    tracker = cs.ContactParticleFilter(robot, particles=20_000)
    gate, had_its_turn = threading.Lock(), threading.Event()

    def wait() -> None:
        with gate:
            had_its_turn.set()

    gate.acquire()
    thread = threading.Thread(target=wait)
    thread.start()
    before = sys.getswitchinterval()
    # From here on a thread gets its turn only where another gives up the interpreter lock of itself [s].
    sys.setswitchinterval(1e4)
    try:
        gate.release()
        for _ in range(1000):
            robot.neutral()
        assert not had_its_turn.is_set()
        # The system may be slow to wake the thread, so that it misses some updates.
        updates = zip(run.q, run.external_torque, strict=True)
        assert any(tracker.update(*update) and had_its_turn.is_set() for update in updates)
    finally:
        sys.setswitchinterval(before)
        thread.join()


def test_loss_and_return_of_a_contact_are_noticed() -> None:
    run = explored(5, 42)
    tracker = cs.ContactParticleFilter(arm())
    nothing = np.zeros(7)
    q = run.q[0]
    still = tracker.update(q, nothing)
    assert (still.event, still.contact, still.link, still.modes) == ("none", False, "", ())
    assert np.isnan(still.point).all()
    assert np.isnan(still.covariance).all()
    assert still.stiffness is None
    assert tracker.update(q, run.external_torque[0]).event == "started"
    assert tracker.update(run.q[1], run.external_torque[1]).event == "continued"
    assert tracker.update(run.q[2], nothing).event == "lost"
    assert tracker.update(run.q[2], nothing).event == "none"
    for q, torque in zip(run.q, run.external_torque, strict=True):
        estimate = tracker.update(q, torque)
    assert estimate.link == run.link[-1]
    assert error(estimate, run) < 0.015


def test_a_contact_that_moves_elsewhere_is_found_again() -> None:
    first = explored(4, 41)
    robot = arm()
    tracker = cs.ContactParticleFilter(robot)
    for q, torque in zip(first.q, first.external_torque, strict=True):
        tracker.update(q, torque)
    # The same posture, another obstacle: no jump tells it.
    scene = sim.touch_scene(
        robot, "iiwa_link_6", q=first.q[-1], stiffness_range=(1e3, 1e4), least_torque=1.0, seed=3
    )
    path = sim.joint_exploration(robot, scene, pace=sim.Pace(motions=40, duration=0.25), seed=3)
    then = sim.record_quasi_static(robot, scene.contact(robot), path.time[::4], path.q[::4])
    events = []
    for q, torque in zip(then.q, then.external_torque, strict=True):
        estimate = tracker.update(q, torque)
        events.append(estimate.event)
    assert "changed" in events[:10]
    assert estimate.link == "iiwa_link_6"
    assert error(estimate, then) < 0.015
    # A jump of the pose is no motion to learn from.
    assert tracker.update(first.q[0] + 1.0, first.external_torque[0]).event == "jumped"


def test_an_arm_that_holds_still_learns_a_measurement_once() -> None:
    run = explored(3, 41)
    tracker = cs.ContactParticleFilter(arm())
    spreads = [
        float(np.sqrt(np.trace(tracker.update(run.q[0], run.external_torque[0]).covariance)))
        for _ in range(100)
    ]
    apart = tracker.update(run.q[0], run.external_torque[0]).point - run.point[0]
    assert spreads[-1] < spreads[0]
    assert np.linalg.norm(apart) < 3.0 * spreads[-1]


def test_a_floating_robot_can_be_looked_on() -> None:
    atlas = cs.Robot.named("atlas")
    generator = np.random.default_rng(12)
    found = 0
    for seed in range(10):
        q = atlas.neutral()
        q[7:] += generator.uniform(-0.4, 0.4, atlas.nq - 7)
        link = str(generator.choice(["utorso", "l_uleg", "r_lleg", "r_ufarm"]))
        pose = atlas.link_pose(q, link)
        sample = atlas.surface(link).sample(1, seed=seed)
        point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
        force = -20.0 * pose[:3, :3] @ sample.normals[0]
        torque = atlas.jacobian(q, link, point)[:3].T @ force
        tracker = cs.ContactParticleFilter(atlas)
        for _ in range(20):
            estimate = tracker.update(q, torque)
        apart = estimate.point - point
        near = np.linalg.norm(apart) < 0.03
        found += near
        assert near or estimate.ambiguous or np.linalg.norm(np.cross(apart, force)) < 0.03 * 20.0
    assert found >= 6
