"""Contacts that move over a link, or with it, and what the monitor says of their place over time."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import contactsense as cs

IIWA = cs.Robot.named("iiwa14")
LINK = "iiwa_link_6"
DT = 1e-3
Q = np.array([0.3, 0.6, -0.4, -1.2, 0.5, 0.9, 0.1])
# Standard deviation of the torques' slow errors [Nm] and their time constant [s].
NOISE, SLOW = 0.1, 0.5
FORCE, SECONDS, QUIET = 25.0, 1.2, 100
SEEDS = range(12)

Vector = NDArray[np.float64]
# Link's point [m] and outward normal at a time [s], and the configuration.
Motion = Callable[[float], tuple[Vector, Vector, Vector]]


@dataclass
class Followed:
    """The last report of a contact, and its truth."""

    contact: cs.Contact
    truth: Vector
    ids: set[int | None]

    @property
    def error(self) -> float:
        return float(np.linalg.norm(self.contact.point - self.truth))


def on_surface(point: Vector) -> tuple[Vector, Vector]:
    near = IIWA.surface(LINK).closest_points(point[None])
    return near.points[0], near.normals[0]


def place(pose: Vector, point: Vector) -> Vector:
    moved: Vector = pose[:3, :3] @ point + pose[:3, 3]
    return moved


def follow(motion: Motion, seed: int, noise: float = NOISE) -> Followed:
    """The monitor behind torques with slow errors, less those just before the contact."""
    generator = np.random.default_rng(seed)
    monitor = cs.ContactMonitor(IIWA, dt=DT, torque_threshold=3 * noise, hold_time=0.1)
    keep = DT / SLOW
    error = noise * generator.normal(size=7)
    bias, ids, seen, truth = error, set(), None, np.zeros(3)
    for tick in range(QUIET + int(SECONDS / DT)):
        error = error * (1.0 - keep) + noise * np.sqrt(2 * keep) * generator.normal(size=7)
        local, normal, q = motion(max(0.0, (tick - QUIET) * DT))
        pose = IIWA.link_pose(q, LINK)
        truth = place(pose, local)
        force = -FORCE * (pose[:3, :3] @ normal) if tick >= QUIET else np.zeros(3)
        if tick == QUIET:
            bias = error
        torque = IIWA.jacobian(q, LINK, point=truth)[:3].T @ force + error - bias
        report = monitor.update_external(q, torque if tick >= QUIET else np.zeros(7))
        if report.contacts:
            seen = report.contacts[0]
            ids.add(seen.id)
    assert seen is not None
    return Followed(seen, truth, ids)


def start(seed: int) -> tuple[Vector, Vector]:
    samples = IIWA.surface(LINK).sample(1, seed=seed)
    return samples.points[0], samples.normals[0]


def person(seed: int) -> Motion:
    """Stays on the link, while the arm moves."""
    (point, normal), turn = start(seed), np.random.default_rng(seed).uniform(-0.3, 0.3, 7)
    return lambda time: (point, normal, Q + turn * time)


def slide(seed: int) -> Motion:
    """Slides 10 cm along the link in a second, and stays there; the arm stands still."""
    (point, normal), generator = start(seed), np.random.default_rng(seed)
    heading = np.cross(normal, generator.normal(size=3))
    path = [(point, normal)]
    for _ in range(100):
        heading -= normal * (heading @ normal)
        if np.linalg.norm(heading) < 1e-3:
            heading = np.cross(normal, generator.normal(size=3))
        heading /= np.linalg.norm(heading)
        point, normal = on_surface(point + 1e-3 * heading)
        path.append((point, normal))
    return lambda time: (*path[min(100, int(100 * time))], Q)


def jump(seed: int) -> Motion:
    """At half time, the same force is about 10 cm aside."""
    before, samples = start(seed), IIWA.surface(LINK).sample(200, seed=seed + 1)
    which = np.abs(np.linalg.norm(samples.points - before[0], axis=1) - 0.1).argmin()
    after = samples.points[which], samples.normals[which]
    return lambda time: (*(before if time < SECONDS / 2 else after), Q)


def test_a_contact_that_stays_on_its_link_is_at_one_place() -> None:
    followed = [follow(person(seed), seed) for seed in SEEDS]
    assert all(len(each.ids) == 1 for each in followed)
    # A posterior's change of mind is no path.
    assert np.mean([len(each.contact.path_times) == 1 for each in followed]) >= 0.9
    assert np.median([each.error for each in followed]) < 0.03


def test_a_contact_that_slides_is_followed() -> None:
    followed = [follow(slide(seed), seed) for seed in SEEDS]
    assert all(len(each.ids) == 1 for each in followed)
    # With all torques of the contact fused as of one place, 3 cm.
    assert np.median([each.error for each in followed]) < 0.025
    # The others move by less than what the torques tell apart.
    assert np.mean([len(each.contact.path_times) > 1 for each in followed]) > 0.3


def test_the_path_of_a_contact_that_moves_says_where_it_was_and_when() -> None:
    errors = []
    for seed in SEEDS:
        contact = follow(jump(seed), seed, noise=0.2 * NOISE).contact
        count = len(contact.path_times)
        assert contact.path_local.shape == (count, 3)
        assert len(contact.path_links) == count
        assert contact.path_times[0] >= contact.since
        assert (np.diff(contact.path_times) > 0).all()
        if count == 2 and set(contact.path_links) == {LINK}:
            middle = QUIET * DT + SECONDS / 2
            # A torque that gets weak counts only if it lasts.
            assert middle - DT < contact.path_times[1] < middle + 0.3
            truth = jump(seed)
            ends = zip(contact.path_local, (0.0, SECONDS), strict=True)
            errors.append(max(float(np.linalg.norm(point - truth(time)[0])) for point, time in ends))
    assert len(errors) > len(SEEDS) / 2
    assert np.median(errors) < 0.02


def test_a_contact_that_jumps_is_followed() -> None:
    # With all torques of the contact fused as of one place, 10 cm.
    assert np.median([follow(jump(seed), seed).error for seed in SEEDS]) < 0.03


def test_a_path_can_be_pickled_and_written() -> None:
    contact = follow(jump(0), 0).contact
    again = pickle.loads(pickle.dumps(contact))
    np.testing.assert_array_equal(again.path_local, contact.path_local)
    assert again.path_links == contact.path_links
    written = contact.to_dict()
    assert written["path_local"] == contact.path_local.tolist()
    assert written["path_times"] == contact.path_times.tolist()
    assert not contact.path_local.flags.writeable


def test_contacts_that_are_not_followed_have_no_path() -> None:
    torque = IIWA.jacobian(Q, LINK)[:3].T @ [20.0, 5.0, 3.0]
    contact = cs.ContactIsolator(IIWA).isolate(Q, torque).contacts[0]
    assert contact.path_local.shape == (0, 3)
    assert contact.path_times.shape == (0,)
    assert contact.path_links == ()
