"""`NoiseModel`: its values, and that whatever takes it takes the same meaning from it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import contactsense as cs

Q = np.array([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.2])


def test_values_are_kept_as_given() -> None:
    noise = cs.NoiseModel(torque=0.2, model=[0.1] * 7)
    assert noise.torque == 0.2
    assert noise.velocity == 0.0
    assert noise.relative == 0.03
    assert isinstance(noise.model, np.ndarray)
    with pytest.raises(ValueError, match="read-only"):
        noise.model[0] = 9.0
    np.testing.assert_array_equal(noise.model, [0.1] * 7)
    assert noise == cs.NoiseModel(torque=0.2, model=[0.1] * 7)
    assert noise != cs.NoiseModel(torque=0.2)
    assert "torque=0.2" in repr(noise)


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        ("torque", -0.1),
        ("velocity", np.nan),
        ("relative", np.inf),
        ("model", [0.1, -1.0]),
        ("torque", "much"),
    ],
)
def test_what_is_no_standard_deviation_is_refused(argument: str, value: Any) -> None:
    with pytest.raises(cs.InputError, match=argument):
        cs.NoiseModel(**{argument: value})


@pytest.mark.parametrize("takes", [cs.ContactIsolator, cs.ContactParticleFilter])
def test_a_noise_that_does_not_fit_the_robot_is_refused(takes: Any) -> None:
    robot = cs.Robot.named("iiwa14")
    with pytest.raises(cs.InputError, match=r"noise\.model"):
        takes(robot, noise=cs.NoiseModel(model=[0.1, 0.2]))
    with pytest.raises(cs.InputError, match=r"noise\.torque"):
        takes(robot, noise=cs.NoiseModel(torque=0.0, model=0.0))
    with pytest.raises(cs.InputError, match="noise"):
        takes(robot, noise=0.1)


def test_noise_and_its_short_form_are_not_given_both() -> None:
    with pytest.raises(cs.InputError, match="noise"):
        cs.ContactParticleFilter(cs.Robot.named("iiwa14"), noise=cs.NoiseModel(), torque_noise=0.1)


def test_the_same_torques_are_a_contact_to_isolator_and_filter() -> None:
    robot = cs.Robot.named("iiwa14")
    noise = cs.NoiseModel(torque=[0.3, 0.3, 0.2, 0.2, 0.1, 0.1, 0.05], model=0.2)
    isolator = cs.ContactIsolator(robot, noise=noise)
    at_rest = np.hypot(noise.torque, noise.model)
    rng = np.random.default_rng(5)
    felt = []
    for _ in range(30):
        torque = at_rest * rng.uniform(-3.4, 3.4, 7)
        isolation = isolator.isolate(Q, torque)
        estimate = cs.ContactParticleFilter(robot, particles=50, noise=noise).update(Q, torque)
        felt.append(estimate.contact)
        assert felt[-1] == bool(isolation.contacts or isolation.link_candidates)
        assert felt[-1] == bool(np.any(np.abs(torque) > 3.0 * at_rest))
    assert True in felt
    assert False in felt


def test_a_located_point_is_as_uncertain_as_the_noise_says() -> None:
    robot = cs.Robot.named("iiwa14")
    link = robot.link_names[-1]
    sample = robot.surface(link).sample(50, seed=3)
    pose = robot.link_pose(Q, link)
    deviations = []
    for size in (0.01, 0.02):
        noise = cs.NoiseModel(torque=size, model=0.0, relative=0.0)
        isolator = cs.ContactIsolator(robot, noise=noise)
        found = []
        for point, normal in zip(sample.points, sample.normals, strict=True):
            torque = robot.jacobian(Q, link, pose[:3, :3] @ point + pose[:3, 3])[:3].T @ (
                pose[:3, :3] @ (-30.0 * normal)
            )
            found.append(
                {c.link: c.point_std for c in isolator.isolate(Q, torque).contacts}.get(link, np.nan)
            )
        deviations.append(found)
    narrow, wide = np.array(deviations)
    both = np.isfinite(narrow) & np.isfinite(wide)
    assert both.sum() > 5
    assert np.median(wide[both] / narrow[both]) == pytest.approx(2.0, rel=0.2)
