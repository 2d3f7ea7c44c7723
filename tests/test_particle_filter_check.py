"""Whether the particle filter is sure of single pushes, soon, and of nothing else."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from particle_runs import arm, error, explored, follow, scene_run
from robots import example_arm, meshes, packaged

import contactsense as cs
from contactsense import sim


def test_a_torque_that_nothing_explains_is_said_to_be_so() -> None:
    robot = arm()
    tracker = cs.ContactParticleFilter(robot, particles=3000, links=["iiwa_link_2"])
    # The wrist alone: no contact on link 2 does that.
    torque = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 8.0, 5.0])
    q = robot.neutral() + 0.3
    for _ in range(8):
        estimate = tracker.update(q, torque)
    assert estimate.contact
    assert not estimate.explained
    assert estimate.ambiguous
    assert estimate.residual > 5.0  # standard deviations of the noise
    assert np.isfinite(estimate.point).all()
    assert set(estimate.link_probabilities) == {"iiwa_link_2"}


def violated(run: sim.ContactRun, robot: cs.Robot) -> dict[str, tuple[np.ndarray, list[np.ndarray]]]:
    """Torques of what is no single push, and where the pushes among it are."""
    link, last = run.link[0], run_links(robot)[-1]
    # The second push, on another link.
    other = next(name for name in run_links(robot)[::-1] if name != link)
    sample = robot.surface(other).sample(1, seed=9)
    signs = np.resize([1.0, -1.0, 1.0, 1.0, -1.0], robot.nv)
    turned, loaded, second, places = [], [], [], []
    for q in run.q:
        rotation = robot.link_pose(q, link)[:3, :3]
        turned.append(robot.jacobian(q, link)[3:].T @ rotation @ [3.0, -2.0, 4.0])
        loaded.append(robot.jacobian(q, last, robot.link_pose(q, last)[:3, 3])[:3].T @ [0.0, 0.0, -15.0])
        pose = robot.link_pose(q, other)
        places.append(pose[:3, :3] @ sample.points[0] + pose[:3, 3])
        second.append(robot.jacobian(q, other, places[-1])[:3].T @ pose[:3, :3] @ (-20.0 * sample.normals[0]))
    torque = run.external_torque
    return {
        "bias": (torque + 0.3 * signs, [run.point]),
        "moment": (np.array(turned), []),
        "payload": (np.array(loaded), []),
        "push and payload": (torque + np.array(loaded), [run.point]),
        "pull": (-torque, []),
        "two pushes": (torque + np.array(second), [run.point, np.array(places)]),
    }


def run_links(robot: cs.Robot) -> list[str]:
    """Links that two joints or more move, from the base outwards."""
    q = robot.neutral() + 0.3
    count = {
        name: int(np.any(np.abs(robot.jacobian(q, name)) > 1e-12, axis=0).sum()) for name in robot.link_names
    }
    return [name for name, joints in count.items() if joints >= 2]


# Constants were chosen on other seeds of the iiwa14 and the panda.
@pytest.mark.parametrize("which", ["iiwa14", "ur5", "xarm7"])
def test_what_is_no_single_push_is_not_sure(which: str) -> None:
    robot = packaged() if which == "iiwa14" else example_arm(which)
    links = run_links(robot)
    chosen = [links[1], links[2], links[4]]  # three joints, four and six, or so
    runs = [scene_run(robot, link, seed) for seed, link in enumerate(chosen, 31)]
    updates, sure, wrong = 0, 0, 0
    for run in runs:
        for torques, points in violated(run, robot).values():
            tracker = cs.ContactParticleFilter(robot, particles=1000)
            for row, (q, torque) in enumerate(zip(run.q, torques, strict=True)):
                estimate = tracker.update(q, torque)
                assert estimate.explained or estimate.ambiguous
                updates += 1
                if estimate.contact and not estimate.ambiguous:
                    sure += 1
                    wrong += all(np.linalg.norm(estimate.point - point[row]) > 0.05 for point in points)
    assert wrong <= 0.1 * sure, (wrong, sure)
    assert sure <= 0.1 * updates, (sure, updates)
    # The pushes alone, although noisy. Of 216 (on other seeds, too) 207 were explained.
    pushes = [
        follow(scene_run(robot, link, seed), 0.1, robot, particles=1000)
        for link in chosen
        for seed in range(31, 37)
    ]
    assert sum(not estimate.explained for estimate in pushes) <= 2
    assert sum(not estimate.ambiguous for estimate in pushes[-6:]) >= 4


def test_a_payload_whose_force_follows_the_motion_is_not_sure() -> None:
    # A weight in the gripper of the Talos arm fits a point of link 5 whose force follows a spring of 360 N/m.
    robot = example_arm("talos_left_arm")
    run = scene_run(robot, "gripper_left_inner_single_link", 21)
    payload, last = [], run_links(robot)[-1]
    for q in run.q:
        pose = robot.link_pose(q, last)
        place = pose[:3, :3] @ [-0.00326, -0.00261, 0.09795] + pose[:3, 3]
        payload.append(robot.jacobian(q, last, place)[:3].T @ [0.0, 0.0, -8.2728])
    tracker = cs.ContactParticleFilter(robot, particles=4000)
    estimates = [tracker.update(q, torque) for q, torque in zip(run.q, payload, strict=True)]
    assert all(estimate.contact and estimate.ambiguous for estimate in estimates)


def test_a_push_is_sure_once_motion_has_confirmed_it() -> None:
    run = explored(6, 42)
    tracker = cs.ContactParticleFilter(arm(), particles=3000)
    sure = [
        not tracker.update(q, torque).ambiguous for q, torque in zip(run.q, run.external_torque, strict=True)
    ]
    assert not any(sure[:5])
    assert all(sure[25:])
    # The same torque again and again is no motion: a pull would look the same.
    still = cs.ContactParticleFilter(arm(), particles=3000)
    assert all(still.update(run.q[0], run.external_torque[0]).ambiguous for _ in range(40))


def test_a_soft_obstacle_is_sure_too() -> None:
    robot = arm()
    run = scene_run(robot, "iiwa_link_6", 45, stiffness=(4e2, 5e2))
    estimate = follow(run, particles=3000)
    assert error(estimate, run) < 0.02
    assert not estimate.ambiguous


@pytest.mark.parametrize("which", [packaged, pytest.param(meshes, marks=pytest.mark.shared)])
@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_a_push_on_an_outer_link_is_sure_after_few_poses(noise: float, which: Any) -> None:
    robot = which()
    generator = np.random.default_rng(7)
    for link in (4, 5, 6, 7):
        run = explored(link, 43, which=which)
        tracker = cs.ContactParticleFilter(robot, particles=3000)
        sure = []
        for q, torque in zip(run.q, run.external_torque, strict=True):
            estimate = tracker.update(q, torque * (1.0 + noise * generator.standard_normal(torque.size)))
            sure.append(not estimate.ambiguous)
        # Motions of three updates each. Measured: sure by the thirteenth update, then at 83 % or more. Link 7
        # is told from link 6 by the seventh joint alone, which the tenth motion moves first.
        soon = 33 if link == 7 else 18
        assert any(sure[:soon])
        assert np.mean(sure[soon:]) > 0.75


def test_a_push_with_friction_is_sure_in_a_cone() -> None:
    robot = arm()
    run = explored(6, 42)
    rotated = [np.cross(normal, [0.0, 0.6, 0.8]) for normal in run.normal]
    across = 0.2 * np.linalg.norm(run.force, axis=1)[:, None] * np.array(rotated)
    forces = run.force + across
    places = zip(run.q, run.point, forces, strict=True)
    torque = np.array([robot.jacobian(q, run.link[0], point)[:3].T @ force for q, point, force in places])
    tracker = cs.ContactParticleFilter(robot, particles=3000, measurement="friction_cone")
    sure = [not tracker.update(q, tau).ambiguous for q, tau in zip(run.q, torque, strict=True)]
    assert np.mean(sure[25:]) > 0.9


@pytest.mark.parametrize("options", [{"motion": "fixed_on_link"}, {"motion": "fixed_in_world"}])
def test_baselines_doubt_what_no_push_explains(options: dict[str, Any]) -> None:
    robot = arm()
    run = explored(5, 41)
    signs = np.resize([1.0, -1.0], robot.nv)
    tracker = cs.ContactParticleFilter(robot, particles=3000, **options)
    for q, torque in zip(run.q, run.external_torque, strict=True):
        estimate = tracker.update(q, torque + 2.0 * signs)
    assert not estimate.explained
    assert estimate.ambiguous
