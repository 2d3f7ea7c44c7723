"""What torques would tell of contacts, against NumPy, known limits and the posterior itself."""

from __future__ import annotations

from functools import cache

import map_reference as reference
import numpy as np
import pytest
from numpy.typing import NDArray
from robots import robot_named
from test_contact_map import Q, arm, packaged_model

import contactsense as cs

FloatArray = NDArray[np.float64]

SAMPLES = 700
DRAWN = 6  # points drawn for a sample that is kept
IDEAL = cs.NoiseModel(torque=1e-6, model=0.0, relative=0.0)
# Standard deviation of the logarithm of a force whose logarithm is uniform.
LOG_FORCE = np.log(reference.FORCES[1] / reference.FORCES[0]) / np.sqrt(12.0)


@cache
def usual() -> cs.Identifiability:
    return cs.ContactMap(arm(), samples=SAMPLES).identifiability(Q, force=20.0)


def tangents(normal: FloatArray) -> FloatArray:
    """Two directions across a normal, `(2, 3)`."""
    _, _, axes = np.linalg.svd(normal[None])
    directions: FloatArray = axes[1:]
    return directions


def spread(points: FloatArray, shares: FloatArray) -> FloatArray:
    """Covariance of points `(n, 3)` with shares of a surface."""
    apart = points - shares @ points
    covariance: FloatArray = (apart * shares[:, None]).T @ apart
    return covariance


@pytest.mark.parametrize("friction", [0.0, 0.5])
@pytest.mark.parametrize("link", [f"iiwa_link_{k}" for k in range(1, 8)])
def test_deviations_ranks_and_significance_are_those_of_numpy(link: str, friction: float) -> None:
    noise = cs.NoiseModel(torque=np.linspace(0.05, 0.2, 7), model=0.1, relative=0.04)
    force = 15.0
    told = cs.ContactMap(
        arm(), samples=SAMPLES, links=[link], friction=friction, noise=noise
    ).identifiability(Q, force=force)
    patch = reference.patches(arm(), Q, link, told.points, DRAWN * SAMPLES)
    shares = np.exp(patch.log_areas)
    # Without the extent of the patch that each sample stands for, which is little.
    extent = spread(told.points, shares / shares.sum())
    some = np.random.default_rng(0).choice(len(told), 25, replace=False)
    jacobians = reference.jacobians(packaged_model(), Q, link, patch.points[some])
    # The derivative of the torque by the point, by differences.
    step = 1e-5
    for k, jacobian in zip(some, jacobians, strict=True):
        inward = -patch.normals[k]
        across = tangents(inward)
        torque = force * inward @ jacobian
        deviation = reference.deviations(noise, torque)
        moved = reference.jacobians(packaged_model(), Q, link, patch.points[k] + step * across)
        by_point = (force * np.einsum("i,kij->kj", inward, moved) - torque) / step
        by_force = np.vstack([inward @ jacobian, across @ jacobian])
        prior = np.array([LOG_FORCE * force, *2 * [0.5 * friction * force]])
        # The force adds to the covariance of the torque; the point is found from what is left.
        noisy = np.diag(deviation**2) + (by_force.T * prior**2) @ by_force
        plane = across @ extent @ across.T
        left = np.linalg.inv(np.linalg.inv(plane) + by_point @ np.linalg.inv(noisy) @ by_point.T)
        height = inward @ extent @ inward * (np.trace(left) / np.trace(plane)) ** 2
        assert told.point_std[k] == pytest.approx(np.sqrt(np.trace(left) + height), rel=6e-3)

        unknowns = np.vstack([force * by_force, np.sqrt(np.trace(extent)) * by_point]) / deviation
        assert told.rank[k] == np.linalg.matrix_rank(unknowns, tol=1e-6 * np.linalg.norm(unknowns))
        at_rest = np.hypot(noise.torque, noise.model)
        assert told.significance[k] == pytest.approx(np.linalg.norm(torque / at_rest))


def test_ranks_grow_along_an_arm() -> None:
    told, links = usual(), np.array(usual().links)
    for joints in range(1, 8):
        ranks = told.rank[links == f"iiwa_link_{joints}"]
        assert ranks.max() == min(joints, 5)
        assert np.mean(ranks == min(joints, 5)) > 0.9


@pytest.mark.parametrize("name", ["atlas", "talos"])
def test_a_floating_base_determines_all_five(name: str) -> None:
    robot = robot_named(name)
    contact_map = cs.ContactMap(robot, samples=500, noise=IDEAL)
    told = contact_map.identifiability(robot.random_configuration(3))
    assert (told.rank == 5).all()
    assert told.point_std.max() < 1e-3


def test_ideal_torques_determine_the_point_where_the_rank_is_full() -> None:
    told = cs.ContactMap(arm(), samples=SAMPLES, noise=IDEAL).identifiability(Q)
    full = told.rank == 5
    assert np.median(told.point_std[full]) < 1e-5
    assert np.percentile(told.point_std[full], 95) < 1e-3
    assert told.point_std[told.rank <= 3].min() > 1e-2
    assert told.detectable[np.array(told.links) != "iiwa_link_1"].mean() > 0.99


def test_useless_torques_leave_the_whole_link() -> None:
    told = cs.ContactMap(arm(), samples=SAMPLES, noise=cs.NoiseModel(torque=1e6)).identifiability(Q)
    for link in arm().link_names[1:]:
        own = np.array(told.links) == link
        if not own.any():
            continue
        points = arm().surface(link).sample(20000, seed=5).points
        extent = np.sqrt(np.trace(np.cov(points.T)))
        np.testing.assert_allclose(told.point_std[own], extent, rtol=0.05)
    assert not told.detectable.any()


def test_less_noise_and_more_force_never_hide_the_point() -> None:
    exact = cs.NoiseModel(torque=0.05, model=0.0, relative=0.0)
    rough = cs.NoiseModel(torque=0.2, model=0.0, relative=0.0)
    near, far = (cs.ContactMap(arm(), samples=SAMPLES, noise=noise) for noise in (exact, rough))
    less, more = near.identifiability(Q).point_std, far.identifiability(Q).point_std
    assert (less <= more * (1.0 + 1e-9)).all()
    # Four times the force, all of whose priors grow with it, is a quarter of the noise.
    np.testing.assert_allclose(far.identifiability(Q, force=40.0).point_std, less, rtol=1e-9)


@pytest.mark.parametrize("name", ["iiwa14", "panda"])
def test_the_posterior_is_as_wide_as_stated(name: str) -> None:
    """Contacts from the map's prior at one force: the error of the posterior's mean on the link."""
    robot = robot_named(name)
    noise, friction, force = cs.NoiseModel(torque=0.1, model=0.0, relative=0.02), 0.5, 20.0
    shares = reference.prior_shares(robot)
    links = [link for link in shares if robot.jacobian(robot.neutral(), link).any(axis=0).sum() >= 3]
    for number, link in enumerate(links):
        rng = np.random.default_rng(number)
        contact_map = cs.ContactMap(robot, samples=1000, links=[link], noise=noise, pull_probability=0.0)
        stated, errors = [], []
        for _ in range(60):
            truth = reference.draw(
                robot, rng, {link: 1.0}, friction=friction, forces=(force, force), pull_probability=0.0
            )
            deviation = reference.deviations(noise, truth.torque)
            found = contact_map.evaluate(
                truth.q, truth.torque + deviation * rng.standard_normal(len(deviation))
            )
            share = np.exp(found.log_posterior - found.log_posterior.max())
            mean = share @ found.points / share.sum()
            told = contact_map.identifiability(truth.q, force=force)
            nearest = np.linalg.norm(told.points - truth.point, axis=1).argmin()
            stated.append(told.point_std[nearest])
            errors.append(np.linalg.norm(mean - truth.point))
        ratio = np.sqrt(np.mean(np.square(stated)) / np.mean(np.square(errors)))
        assert 0.5 < ratio < 2.0, f"{link}: {ratio:.2f}"


def test_what_it_tells_is_plain_and_frozen() -> None:
    told = usual()
    points = cs.ContactMap(arm(), samples=SAMPLES).evaluate(Q, np.full(7, 2.0)).points
    np.testing.assert_array_equal(told.points, points)
    assert len(told) == len(points)
    assert (told.points.shape, told.point_std.shape) == ((len(told), 3), (len(told),))
    assert (told.rank.dtype, told.detectable.dtype) == (np.dtype(np.int64), np.dtype(np.bool_))
    assert told.force == 20.0
    assert set(told.links) == set(arm().link_names) & {f"iiwa_link_{k}" for k in range(1, 8)}
    for name in ("points", "point_std", "rank", "significance", "detectable"):
        assert not getattr(told, name).flags.writeable
        assert getattr(told, name) is getattr(told, name)
    plain = told.to_dict()
    assert plain["point_std"] == told.point_std.tolist()
    assert plain["links"] == list(told.links)
    assert repr(told).startswith(f"Identifiability({len(told)} samples, force=20 N, point_std: ")


@pytest.mark.parametrize("force", [0.0, -1.0, np.nan, np.inf, "strong"])
def test_a_force_must_push(force: object) -> None:
    with pytest.raises(cs.InputError, match=r"^force: "):
        cs.ContactMap(arm(), samples=50).identifiability(Q, force=force)  # type: ignore[arg-type]


@pytest.mark.parametrize("q", [np.zeros(6), np.full(7, np.nan), np.zeros((7, 1))])
def test_a_configuration_must_be_the_robots(q: FloatArray) -> None:
    with pytest.raises(cs.InputError, match=r"^q: "):
        cs.ContactMap(arm(), samples=50).identifiability(q)


@pytest.mark.parametrize("force", [1e-12, 1e12])
def test_any_force_has_a_deviation(force: float) -> None:
    told = cs.ContactMap(arm(), samples=50).identifiability(Q, force=force)
    assert (told.point_std > 0.0).all()
    assert np.isfinite(told.point_std).all()
    np.testing.assert_array_equal(told.rank, cs.ContactMap(arm(), samples=50).identifiability(Q).rank)


def test_a_link_of_one_sample_has_its_patch() -> None:
    told = cs.ContactMap(arm(), samples=1, links=["iiwa_link_7"], noise=IDEAL).identifiability(Q)
    assert len(told) == 1
    assert 0.0 < told.point_std[0] < 1e-4
