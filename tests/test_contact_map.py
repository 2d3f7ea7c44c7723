"""The posterior of one contact over the surface, against brute force, the prior itself and ideal torques."""

from __future__ import annotations

from functools import cache
from importlib import resources
from typing import Any
from xml.etree import ElementTree

import map_reference as reference
import numpy as np
import pinocchio as pin
import pytest
from robots import robot_named

import contactsense as cs

IDEAL = cs.NoiseModel(torque=1e-6, model=0.0, relative=0.0)
SAMPLES = 1000
DRAWN = 6  # points drawn for a sample that is kept
Q = np.array([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0])


@cache
def arm() -> cs.Robot:
    return cs.Robot.named("iiwa14")


@cache
def usual_map() -> cs.ContactMap:
    return cs.ContactMap(arm(), samples=500)


@cache
def packaged_model() -> pin.Model:
    text = (resources.files("contactsense") / "descriptions" / "iiwa14.urdf").read_text()
    root = ElementTree.fromstring(text)
    for link in root.iter("link"):  # the model needs no shapes
        for shape in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(shape)
    return pin.buildModelFromXML(ElementTree.tostring(root, "unicode"))


def shares(link: str) -> dict[str, float]:
    return {link: 1.0}


def same(one: cs.MapEstimate, other: cs.MapEstimate) -> bool:
    return repr(one.to_dict()) == repr(other.to_dict())


@pytest.mark.parametrize("name", ["iiwa14", "panda", "atlas"])
def test_regions_and_link_probabilities_are_calibrated_on_contacts_from_the_prior(name: str) -> None:
    robot = robot_named(name)
    rng = np.random.default_rng(7)
    prior = reference.prior_shares(robot)
    noise = cs.NoiseModel(torque=0.1, model=0.1, relative=0.0)
    contact_map = cs.ContactMap(robot, noise=noise)
    held, sure, right = [], [], []
    for _ in range(400):
        truth = reference.draw(robot, rng, prior)
        deviation = reference.deviations(noise, truth.torque)
        found = contact_map.evaluate(truth.q, truth.torque + deviation * rng.standard_normal(robot.nv))
        held.append(np.linalg.norm(found.point - truth.point) <= found.region_radius)
        best = max(found.link_probabilities, key=lambda link: found.link_probabilities[link])
        sure.append(found.link_probabilities[best])
        right.append(best == truth.link)
        assert sum(found.link_probabilities.values()) == pytest.approx(1.0)
    # Four standard errors of 400 draws are 6 %.
    assert 0.84 < np.mean(held) < 0.96
    assert abs(np.mean(sure) - np.mean(right)) < 0.09
    # Ten bins of 40 that were perfectly calibrated would show 0.05 or so.
    assert reference.calibration_error(np.array(sure), np.array(right)) < 0.09


@pytest.mark.parametrize("name", ["iiwa14", "panda", "atlas"])
def test_every_link_is_equally_likely_beforehand(name: str) -> None:
    prior = reference.prior_shares(robot_named(name))
    assert len(prior) > 5
    np.testing.assert_allclose(list(prior.values()), 1.0 / len(prior), rtol=1e-6)


@pytest.mark.parametrize("link", ["iiwa_link_3", "iiwa_link_5", "iiwa_link_7"])
def test_the_posterior_of_samples_is_that_of_an_integral_over_the_force(link: str) -> None:
    """With noise so large that patches hardly matter, only the error of Laplace's method is left."""
    rng = np.random.default_rng(1)
    model = packaged_model()
    noise = cs.NoiseModel(torque=2.0, model=0.0, relative=0.0)
    contact_map = cs.ContactMap(arm(), samples=SAMPLES, links=[link], noise=noise)
    errors = []
    for _ in range(3):
        truth = reference.draw(arm(), rng, shares(link), forces=(10.0, 60.0))
        deviation = reference.deviations(noise, truth.torque)
        torque = truth.torque + deviation * rng.standard_normal(7)
        found = contact_map.evaluate(truth.q, torque)
        patch = reference.patches(arm(), truth.q, link, found.points, DRAWN * SAMPLES)
        log = found.log_posterior - patch.log_areas
        some = rng.choice(np.flatnonzero(log > log.max() - 8.0), 12)
        jacobians = reference.jacobians(model, truth.q, link, patch.points[some])
        integrals = reference.log_likelihoods(jacobians, -patch.normals[some], torque, deviation, 0.5, 0.05)
        error = log[some] - integrals
        errors += list(np.abs(error - np.median(error)))
    assert np.median(errors) < 0.5
    assert np.percentile(errors, 80) < 2.0


@pytest.mark.parametrize("torque", [0.1, 0.02])
def test_how_many_samples_there_are_hardly_matters(torque: float) -> None:
    rng = np.random.default_rng(11)
    areas = reference.area_shares(arm())
    noise = cs.NoiseModel(torque=torque, model=0.0, relative=0.0)
    few, many = (cs.ContactMap(arm(), samples=samples, noise=noise) for samples in (500, 20_000))
    links, evidence = [], []
    for _ in range(40):
        truth = reference.draw(arm(), rng, areas, forces=(5.0, 60.0))
        measured = truth.torque + torque * rng.standard_normal(7)
        one, other = few.evaluate(truth.q, measured), many.evaluate(truth.q, measured)
        links.append(max(abs(one.link_probabilities[k] - other.link_probabilities[k]) for k in areas))
        evidence.append(abs(one.log_evidence - other.log_evidence))
    assert np.median(links) < 0.05
    assert np.percentile(links, 90) < 0.15
    assert np.median(evidence) < 0.6


def test_shares_of_the_samples_sum_to_one() -> None:
    found = usual_map().evaluate(
        Q, reference.draw(arm(), np.random.default_rng(2), shares("iiwa_link_6"), q=Q).torque
    )
    # Samples with less than 1e-5 of the best one are not in the sum.
    assert np.exp(found.log_posterior).sum() == pytest.approx(1.0, abs=0.02)
    assert found.points.shape == (len(found.log_posterior), 3)
    assert not found.points.flags.writeable


def share_found(noise: cs.NoiseModel, link: str, count: int) -> float:
    """Share of pushes with a mode of more than 2 % within 2 cm."""
    rng = np.random.default_rng(int(link[-1]))
    contact_map = cs.ContactMap(arm(), noise=noise)
    near = 0
    for _ in range(count):
        truth = reference.draw(
            arm(), rng, shares(link), forces=(10.0, 60.0), friction=0.3, pull_probability=0.0
        )
        found = contact_map.evaluate(truth.q, truth.torque)
        modes = [mode for mode in found.modes if mode.probability > 0.02 and mode.link == link]
        near += any(np.linalg.norm(mode.point - truth.point) < 0.02 for mode in modes)
    return near / count


@pytest.mark.parametrize("link", ["iiwa_link_6", "iiwa_link_7"])
def test_torques_with_little_noise_give_the_link_and_the_point(link: str) -> None:
    noise = cs.NoiseModel(torque=0.05, model=0.0, relative=0.0)
    assert share_found(noise, link, 60) >= 0.93


@pytest.mark.parametrize("link", ["iiwa_link_5", "iiwa_link_6", "iiwa_link_7"])
def test_ideal_torques_give_the_link_and_the_point(link: str) -> None:
    assert share_found(IDEAL, link, 60) >= 0.98


@pytest.mark.parametrize("link", [2, 3])
def test_where_the_torques_do_not_determine_the_point_the_region_is_large(link: int) -> None:
    rng = np.random.default_rng(link)
    contact_map = cs.ContactMap(arm(), samples=2000)
    for _ in range(5):
        truth = reference.draw(
            arm(), rng, shares(f"iiwa_link_{link}"), forces=(10.0, 60.0), pull_probability=0.0
        )
        found = contact_map.evaluate(truth.q, truth.torque)
        assert found.region_radius > 0.05
        assert found.effective_samples > 5.0


def crossings(robot: cs.Robot, truth: reference.Truth, sign: float) -> np.ndarray:
    """Points where the force's line enters the link (`sign` 1) or leaves it (-1), `(n, 3)`, world frame."""
    pose = robot.link_pose(truth.q, truth.link)
    direction = truth.force / np.linalg.norm(truth.force)
    start = (truth.point - 5.0 * direction - pose[:3, 3]) @ pose[:3, :3]
    hits = robot.surface(truth.link).cast_rays(start[None], (direction @ pose[:3, :3])[None])
    chosen = sign * (hits.normal @ pose[:3, :3].T @ direction) < 0.0
    points: np.ndarray = hits.point[chosen] @ pose[:3, :3].T + pose[:3, 3]
    return points


def nearest(modes: list[cs.Mode], point: np.ndarray) -> float:
    return min((float(np.linalg.norm(mode.point - point)) for mode in modes), default=np.inf)


def test_a_pull_is_a_mode_on_the_side_where_a_push_would_leave() -> None:
    """The same torque: a push where its line enters, or a pull where it leaves."""
    rng = np.random.default_rng(3)
    link = "iiwa_link_6"
    maps = {
        p: cs.ContactMap(
            arm(), noise=cs.NoiseModel(torque=0.05, model=0.0, relative=0.0), links=[link], pull_probability=p
        )
        for p in (0.0, 0.5, 0.99)
    }
    tried, near, two = 0, 0, 0
    while tried < 10:
        truth = reference.draw(
            arm(), rng, shares(link), forces=(40.0, 60.0), friction=0.1, pull_probability=0.0
        )
        left = crossings(arm(), truth, -1.0)
        if len(left) != 1 or np.linalg.norm(left[0] - truth.point) < 0.1:
            continue
        out = left[0]
        tried += 1

        found = [
            [mode for mode in maps[p].evaluate(truth.q, truth.torque).modes if mode.probability > 0.01]
            for p in (0.0, 0.5, 0.99)
        ]
        pulls = [[mode for mode in modes if mode.force @ mode.normal > 0.0] for modes in found]
        assert not pulls[0]
        near += nearest(pulls[2], out) < 0.05
        two += all(nearest(found[1], point) < 0.05 for point in (truth.point, out))
    assert near == 10
    assert two >= 8


def test_evidence_is_low_on_noise_and_high_on_contacts() -> None:
    rng = np.random.default_rng(5)
    noise = cs.NoiseModel(torque=0.1, model=0.1, relative=0.0)
    contact_map = cs.ContactMap(arm(), samples=2000, noise=noise)
    at_rest = reference.deviations(noise, np.zeros(7))
    quiet = [contact_map.evaluate(Q, at_rest * rng.standard_normal(7)).log_evidence for _ in range(200)]
    assert np.median(quiet) < 0.0
    assert np.percentile(quiet, 99) < 3.0
    links = {f"iiwa_link_{k}": 1.0 for k in (3, 4, 5, 6, 7)}
    pushes = [reference.draw(arm(), rng, links, forces=(20.0, 60.0), pull_probability=0.0) for _ in range(50)]
    loud = [contact_map.evaluate(push.q, push.torque).log_evidence for push in pushes]
    assert np.percentile(loud, 5) > 10.0


def test_a_torque_that_no_push_explains_is_ambiguous() -> None:
    twist = np.zeros(7)
    twist[5] = 5.0
    estimate = usual_map().evaluate([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0], twist)
    assert not estimate.explained
    assert estimate.ambiguous


def test_the_force_is_the_one_at_the_point() -> None:
    precise = cs.ContactMap(arm(), noise=cs.NoiseModel(torque=0.05, model=0, relative=0))
    found = []
    for seed in range(30):
        q, link = arm().random_configuration(seed), f"iiwa_link_{2 + seed % 6}"
        sample, pose = arm().surface(link).sample(1, seed=seed), arm().link_pose(q, link)
        point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
        tau_ext = arm().jacobian(q, link, point)[:3].T @ (-40.0 * pose[:3, :3] @ sample.normals[0])
        estimate = precise.evaluate(q, tau_ext)
        own = arm().jacobian(q, estimate.link, estimate.point)[:3].T @ estimate.force
        found.append(np.linalg.norm(own - tau_ext) <= 0.15 + 0.1 * np.linalg.norm(tau_ext))
    # Where the torques determine no force in the usual range, it is a mean.
    assert np.mean(found) >= 0.9


def test_an_evaluation_depends_on_nothing_before_it() -> None:
    torque = reference.draw(arm(), np.random.default_rng(4), shares("iiwa_link_5"), q=Q).torque
    fresh = cs.ContactMap(arm(), samples=500).evaluate(Q, torque)
    used = cs.ContactMap(arm(), samples=500)
    for size in (1e-9, 1.0, 1e3, 1e6, 1e9):
        found = used.evaluate(-Q, size * np.cos(np.arange(7.0)))
        numbers = [found.log_evidence, found.region_radius, found.effective_samples, found.magnitude]
        assert np.isfinite(numbers).all(), size
        assert np.isfinite(found.point).all()
        assert sum(found.link_probabilities.values()) == pytest.approx(1.0)
        assert not np.isnan(found.log_posterior).any()
        # Pieces of the surface: samples that push or pull, and those made by twelve divisions of 64.
        assert found.effective_samples <= 2 * 500 + 12 * 64 * 4
    assert same(used.evaluate(Q, torque), fresh)
    assert same(used.evaluate(Q, torque), fresh)


def test_what_it_finds_names_its_class() -> None:
    found = usual_map().evaluate(Q, np.full(7, 2.0))
    assert repr(found).startswith(f"MapEstimate('{found.link}', point=[")
    assert repr(cs.ContactMap(arm(), samples=500)).startswith("ContactMap('iiwa14', samples=")
    assert isinstance(found, cs.ContactEstimate)
    assert found.stiffness is None
    assert usual_map().robot is arm()


def test_links_that_are_not_looked_on_have_no_share() -> None:
    wanted = ["iiwa_link_6", "iiwa_link_4"]
    found = cs.ContactMap(arm(), samples=500, links=wanted).evaluate(Q, np.full(7, 2.0))
    assert set(found.link_probabilities) == set(wanted)
    assert found.link in wanted
    assert len(found.modes) <= 8


def test_a_calibration_brings_its_noise() -> None:
    calibration = cs.Calibration.of_description(arm())
    torque = np.full(7, 2.0)
    given = cs.ContactMap(arm(), samples=500, calibration=calibration).evaluate(Q, torque)
    stated = cs.ContactMap(arm(), samples=500, noise=calibration.noise).evaluate(Q, torque)
    assert same(given, stated)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"samples": 0}, "samples"),
        ({"samples": -3}, "samples"),
        ({"samples": 2.5}, "samples"),
        ({"samples": 10**7}, "samples"),
        ({"samples": "many"}, "samples"),
        ({"friction": -0.1}, "friction"),
        ({"friction": np.nan}, "friction"),
        ({"friction": np.inf}, "friction"),
        ({"friction": "rough"}, "friction"),
        ({"noise": 0.1}, "noise"),
        ({"noise": cs.NoiseModel(torque=[0.1, 0.2])}, "noise.torque"),
        ({"noise": cs.NoiseModel(torque=0.0, model=0.0)}, "noise.torque"),
        ({"links": ["elbow"]}, "links"),
        ({"links": ["iiwa_link_0"]}, "links"),  # does not move
        ({"links": []}, "links"),
        ({"links": "iiwa_link_3"}, "links"),
        ({"pull_probability": 1.0}, "pull_probability"),
        ({"pull_probability": -0.1}, "pull_probability"),
        ({"pull_probability": np.nan}, "pull_probability"),
        ({"pull_probability": "never"}, "pull_probability"),
        ({"calibration": 3}, "calibration"),
        ({"calibration": cs.Calibration.of_description(cs.Robot.named("atlas"))}, "calibration"),
    ],
)
def test_options_are_checked_by_name(options: dict[str, Any], name: str) -> None:
    with pytest.raises(cs.InputError, match=rf"^{name}\b"):
        cs.ContactMap(arm(), **options)


@pytest.mark.parametrize("robot", [None, "iiwa14", 3])
def test_a_robot_is_asked_for(robot: Any) -> None:
    with pytest.raises(cs.InputError, match=r"^robot\b"):
        cs.ContactMap(robot)


@pytest.mark.parametrize(
    ("q", "torque", "name"),
    [
        (np.zeros(6), np.ones(7), "q"),
        (np.full(7, np.nan), np.ones(7), "q"),
        (None, np.ones(7), "q"),
        (np.zeros((7, 1)), np.ones(7), "q"),
        (np.zeros(7), np.ones(6), "tau_ext"),
        (np.zeros(7), np.ones((1, 7)), "tau_ext"),
        (np.zeros(7), np.array([1, 2, np.nan, 0, 0, 0, 0]), "tau_ext"),
        (np.zeros(7), np.array([1, 2, np.inf, 0, 0, 0, 0]), "tau_ext"),
        (np.zeros(7), "torques", "tau_ext"),
        (np.zeros(7), None, "tau_ext"),
    ],
)
def test_bad_measurements_leave_the_map_as_it_was(q: Any, torque: Any, name: str) -> None:
    before = usual_map().evaluate(Q, np.full(7, 2.0))
    with pytest.raises(cs.InputError, match=rf"^{name}\b"):
        usual_map().evaluate(q, torque)
    assert same(usual_map().evaluate(Q, np.full(7, 2.0)), before)


def test_rounding_makes_no_probability_greater_than_one() -> None:
    for samples in (300, 500, 700, 1000):
        contact_map = cs.ContactMap(arm(), samples=samples, links=["iiwa_link_7"])
        estimate = contact_map.evaluate(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
        assert estimate.link_probabilities["iiwa_link_7"] == pytest.approx(1.0)
        assert max(estimate.link_probabilities.values()) <= 1.0
        assert max(mode.probability for mode in estimate.modes) <= 1.0
