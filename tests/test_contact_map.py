"""The posterior of one contact over the surface, against brute force, the prior itself and ideal torques."""

from __future__ import annotations

from functools import cache
from typing import Any

import map_reference as reference
import numpy as np
import pytest
from robots import robot_named

import contactsense as cs

IDEAL = cs.NoiseModel(torque=1e-6, model=0.0, relative=0.0)
Q = np.array([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.0])


@cache
def arm() -> cs.Robot:
    return cs.Robot.named("iiwa14")


@cache
def usual_map() -> cs.ContactMap:
    return cs.ContactMap(arm(), samples=500)


def shares(link: str) -> dict[str, float]:
    return {link: 1.0}


def same(one: cs.MapEstimate, other: cs.MapEstimate) -> bool:
    return repr(one.to_dict()) == repr(other.to_dict())


@pytest.mark.parametrize("name", ["iiwa14", "panda"])
def test_regions_and_link_probabilities_are_calibrated_on_contacts_from_the_prior(name: str) -> None:
    robot = robot_named(name)
    rng = np.random.default_rng(7)
    areas = reference.area_shares(robot)
    noise = cs.NoiseModel(torque=0.1, model=0.1, relative=0.0)
    contact_map = cs.ContactMap(robot, noise=noise)
    held, sure, right = [], [], []
    for _ in range(400):
        truth = reference.draw(robot, rng, areas)
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


def test_shares_of_the_area_are_the_prior() -> None:
    """Single solids that do not overlap: the surface's own area."""
    areas = {link: arm().surface(link).area for link in reference.area_shares(arm())}
    total = sum(areas.values())
    for link, share in reference.area_shares(arm()).items():
        assert share == pytest.approx(areas[link] / total, abs=0.02)


def test_shares_of_the_samples_sum_to_one() -> None:
    found = usual_map().evaluate(
        Q, reference.draw(arm(), np.random.default_rng(2), shares("iiwa_link_6"), q=Q).torque
    )
    # Samples with less than 1e-5 of the best one are not in the sum.
    assert np.exp(found.log_posterior).sum() == pytest.approx(1.0, abs=0.02)
    assert found.points.shape == (len(found.log_posterior), 3)
    assert not found.points.flags.writeable


@pytest.mark.parametrize("link", [5, 6, 7])
def test_ideal_torques_of_a_push_give_its_link_and_point(link: int) -> None:
    """The torques determine the line of a push there; where it enters the links more than once, one mode is the point."""
    rng = np.random.default_rng(link)
    contact_map = cs.ContactMap(arm(), noise=IDEAL)
    near = []
    for _ in range(20):
        truth = reference.draw(
            arm(), rng, shares(f"iiwa_link_{link}"), forces=(10.0, 60.0), friction=0.3, pull_probability=0.0
        )
        found = contact_map.evaluate(truth.q, truth.torque)
        modes = [mode for mode in found.modes if mode.probability > 0.02]
        near.append(
            any(mode.link == truth.link and np.linalg.norm(mode.point - truth.point) < 0.02 for mode in modes)
        )
    assert np.mean(near) >= 0.95


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


def far_side(robot: cs.Robot, truth: reference.Truth) -> np.ndarray | None:
    """Where the line of the force leaves the link, world frame; none where it does not run through it."""
    pose = robot.link_pose(truth.q, truth.link)
    direction = truth.force / np.linalg.norm(truth.force)
    start = (truth.point + 1e-4 * direction - pose[:3, 3]) @ pose[:3, :3]
    hits = robot.surface(truth.link).cast_rays(start[None], (direction @ pose[:3, :3])[None])
    if len(hits.points) != 1:
        return None
    out: np.ndarray = pose[:3, :3] @ hits.points[0] + pose[:3, 3]
    return out


def test_a_pull_is_a_mode_on_the_side_where_a_push_would_leave() -> None:
    """The same torque: a push where its line enters, or a pull where it leaves, `pull_probability` to one less that."""
    rng = np.random.default_rng(3)
    link = "iiwa_link_6"
    maps = {
        p: cs.ContactMap(
            arm(), noise=cs.NoiseModel(torque=0.05, model=0.0, relative=0.0), links=[link], pull_probability=p
        )
        for p in (0.0, 0.5, 0.99)
    }
    tried = 0
    while tried < 10:
        truth = reference.draw(
            arm(), rng, shares(link), forces=(40.0, 60.0), friction=0.1, pull_probability=0.0
        )
        out = far_side(arm(), truth)
        if out is None or np.linalg.norm(out - truth.point) < 0.1:
            continue
        tried += 1

        def pulls(p: float, truth: reference.Truth = truth) -> list[cs.Mode]:
            modes = maps[p].evaluate(truth.q, truth.torque).modes
            return [mode for mode in modes if mode.force @ mode.normal > 0.0 and mode.probability > 0.01]

        assert not pulls(0.0)
        likely = pulls(0.99)
        assert likely
        assert min(np.linalg.norm(mode.point - out) for mode in likely) < 0.05


def test_evidence_is_low_on_noise_and_high_on_contacts() -> None:
    rng = np.random.default_rng(5)
    noise = cs.NoiseModel(torque=0.1, model=0.1, relative=0.0)
    contact_map = cs.ContactMap(arm(), samples=2000, noise=noise)
    at_rest = reference.deviations(noise, np.zeros(7))
    quiet = [contact_map.evaluate(Q, at_rest * rng.standard_normal(7)).log_evidence for _ in range(200)]
    assert np.median(quiet) < 0.0
    assert np.percentile(quiet, 99) < 3.0
    areas = {f"iiwa_link_{k}": 1.0 for k in (3, 4, 5, 6, 7)}
    pushes = [reference.draw(arm(), rng, areas, forces=(20.0, 60.0), pull_probability=0.0) for _ in range(50)]
    loud = [contact_map.evaluate(push.q, push.torque).log_evidence for push in pushes]
    assert np.percentile(loud, 5) > 10.0


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
