"""The wrench of contacts whose point cannot be determined, against least squares with Pinocchio."""

from __future__ import annotations

import map_reference
import numpy as np
import pinocchio as pin
import pytest

import contactsense as cs

SIGMA = 0.1  # of every torque [Nm]
FORCE = 100.0  # standard deviation of a contact's force beforehand [N]
ROBOT = cs.Robot.named("iiwa14")


def stated(q: np.ndarray, link: str, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean and covariance of the wrench on a link by the torques of the joints that move it."""
    model, data = ROBOT.model, ROBOT.model.createData()
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    jacobian = pin.getFrameJacobian(
        model, data, model.getFrameId(link, pin.FrameType.BODY), pin.LOCAL_WORLD_ALIGNED
    )
    vertices = np.asarray(ROBOT.surface(link).vertices)
    reach = np.linalg.norm(vertices, axis=1).max()
    # A hundredth of the torque, and a tenth of that of the largest one, as thresholds state.
    deviation = np.sqrt(SIGMA**2 + (0.01 * tau) ** 2 + (0.001 * np.abs(tau).max()) ** 2)
    white = (jacobian / deviation).T
    prior = np.diag([FORCE**-2] * 3 + [(FORCE * reach) ** -2] * 3)
    covariance = np.linalg.inv(white.T @ white + prior)
    return covariance @ white.T @ (tau / deviation), covariance


def pushes(count: int, seed: int) -> list[tuple[map_reference.Truth, np.ndarray]]:
    rng = np.random.default_rng(seed)
    links = map_reference.area_shares(ROBOT)
    prior = {"forces": (10.0, 60.0), "pull_probability": 0.0}
    drawn = [map_reference.draw(ROBOT, rng, links, **prior) for _ in range(count)]
    return [(truth, truth.torque + SIGMA * rng.standard_normal(7)) for truth in drawn]


def test_it_is_that_of_least_squares_and_covers_the_truth() -> None:
    isolator = cs.ContactIsolator(ROBOT, torque_threshold=3 * SIGMA)
    squared = []
    for truth, tau in pushes(300, 3):
        contacts = isolator.isolate(truth.q, tau).contacts
        if len(contacts) != 1 or contacts[0].located:
            continue
        (contact,) = contacts
        wrench, covariance = stated(truth.q, contact.link, tau)
        got = contact.determined_wrench_covariance
        # The moment's prior by vertices and by a sphere about them differ by less than a factor of two.
        low, high = np.linalg.eigvalsh(covariance), np.linalg.eigvalsh(got)
        ratio = high / low
        assert ratio.min() > 0.5
        assert ratio.max() < 4.0
        white = np.linalg.solve(np.linalg.cholesky(covariance), contact.determined_wrench - wrench)
        assert np.linalg.norm(white) < 1.0
        if contact.link == truth.link:
            origin = ROBOT.link_pose(truth.q, truth.link)[:3, 3]
            true = np.concatenate([truth.force, np.cross(truth.point - origin, truth.force)])
            error = contact.determined_wrench - true
            squared.append(error @ np.linalg.solve(got, error))
    assert len(squared) > 80
    # Nine tenths of a chi-square distribution of six variables; less where only the prior limits a direction.
    assert np.mean(np.array(squared) < 10.64) > 0.9
    assert np.median(squared) > 0.5


@pytest.mark.parametrize("options", [{}, {"samples": 0}, {"torque_threshold": 1e-3}])
def test_what_no_joint_feels_keeps_its_uncertainty(options: dict[str, object]) -> None:
    """Three joints carry link 3: three of six components stay open, without noise as well."""
    isolator = cs.ContactIsolator(ROBOT, **({"torque_threshold": 3 * SIGMA} | options))
    q = np.array([0.3, 0.6, -0.2, -1.3, 0.4, 0.9, 0.1])
    point = ROBOT.link_pose(q, "iiwa_link_3")[:3, 3] + [0.05, 0.02, 0.1]
    tau = ROBOT.jacobian(q, "iiwa_link_3", point)[:3].T @ [10.0, 30.0, -20.0]
    (contact,) = isolator.isolate(q, tau).contacts
    assert not contact.located
    again = ROBOT.jacobian(q, contact.link).T @ contact.determined_wrench
    np.testing.assert_allclose(again, tau, atol=0.2)
    deviations = np.sqrt(np.linalg.eigvalsh(contact.determined_wrench_covariance))
    assert deviations[-1] == pytest.approx(FORCE, rel=0.3)
    assert np.sum(deviations > 10.0) >= 2


def test_a_monitor_says_it_too_and_a_located_contact_does_not() -> None:
    monitor = cs.ContactMonitor(ROBOT, dt=1e-3, torque_threshold=3 * SIGMA)
    q, zero = np.full(7, 0.4), np.zeros(7)
    weight = ROBOT.inverse_dynamics(q, zero, zero)
    tau_ext = ROBOT.jacobian(q, "iiwa_link_2", ROBOT.link_pose(q, "iiwa_link_2")[:3, 3] + 0.1)[:3].T @ [
        9.0,
        40.0,
        5.0,
    ]
    for _ in range(400):
        report = monitor.update(q, zero, weight - tau_ext)
    (contact,) = report.contacts
    assert not contact.located
    np.testing.assert_allclose(
        ROBOT.jacobian(q, contact.link).T @ contact.determined_wrench, tau_ext, atol=0.3
    )
    exact = cs.ContactIsolator(ROBOT)
    pose = ROBOT.link_pose(q, "iiwa_link_7")
    surface = ROBOT.surface("iiwa_link_7").sample(1, seed=4)
    point = pose[:3, :3] @ surface.points[0] + pose[:3, 3]
    force = -20.0 * pose[:3, :3] @ surface.normals[0]
    located = exact.isolate(q, ROBOT.jacobian(q, "iiwa_link_7", point)[:3].T @ force).contacts[0]
    assert located.located
    assert np.isnan(located.determined_wrench).all()
    assert np.isnan(located.determined_wrench_covariance).all()
