"""What the particle filter is given: options and measurements, good, bad and any."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from particle_runs import arm, explored

import contactsense as cs


def test_too_many_particles_for_the_memory_are_refused() -> None:
    pytest.importorskip("resource")
    script = f"""
import resource
import contactsense as cs
robot = cs.Robot.named("iiwa14")
resource.setrlimit(resource.RLIMIT_AS, ({2 * 10**9}, resource.getrlimit(resource.RLIMIT_AS)[1]))
try:
    cs.ContactParticleFilter(robot, particles=10_000_000)
except MemoryError as error:
    assert str(error).startswith("particles"), error
    cs.ContactParticleFilter(robot, particles=1000)
    print("refused")
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.stdout == "refused\n", done.stderr


def test_one_particle_will_do() -> None:
    run = explored(5, 41)
    tracker = cs.ContactParticleFilter(arm(), particles=1)
    for q, torque in zip(run.q[:10], run.external_torque, strict=False):
        estimate = tracker.update(q, torque)
    assert np.isfinite(estimate.point).all()
    assert sum(estimate.link_probabilities.values()) == pytest.approx(1.0)
    assert tracker.particles.weight.tolist() == [1.0]


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"particles": 0}, "particles"),
        ({"particles": -3}, "particles"),
        ({"particles": 2.5}, "particles"),
        ({"particles": 10**12}, "particles"),
        ({"motion": "rolling"}, "motion"),
        ({"motion": 5}, "motion"),
        ({"motion": None}, "motion"),
        ({"measurement": 3}, "measurement"),
        ({"likelihood": None}, "likelihood"),
        ({"schedule": object()}, "schedule"),
        ({"measurement": "skin"}, "measurement"),
        ({"measurement": "friction_cone", "friction": -0.1}, "friction"),
        ({"measurement": "friction_cone", "friction": np.nan}, "friction"),
        ({"friction": -0.3}, "friction"),  # also where it is not used
        ({"likelihood": "poisson"}, "likelihood"),
        ({"links": ["elbow"]}, "links"),
        ({"links": ["iiwa_link_0"]}, "links"),  # does not move
        ({"links": []}, "links"),
        ({"links": "iiwa_link_3"}, "links"),
        ({"seed": -1}, "seed"),
        ({"threads": 0}, "threads"),
        ({"force_range": (5, 1)}, "force_range"),
        ({"force_range": (0, 1)}, "force_range"),
        ({"force_range": (1, np.inf)}, "force_range"),
        ({"stiffness_range": (1, 2, 3)}, "stiffness_range"),
        ({"radius_range": (np.nan, 1)}, "radius_range"),
        ({"torque_noise": 0.0}, "torque_noise"),
        ({"torque_noise": [0.1, 0.2]}, "torque_noise"),
        ({"relative_noise": -1.0}, "relative_noise"),
        ({"torque_threshold": np.nan}, "torque_threshold"),
        ({"schedule": "slow"}, "schedule"),
        ({"schedule": 3}, "schedule"),
        ({"schedule": {"alpha": 3}}, "schedule"),
        ({"schedule": {1: 3}}, "schedule"),
        ({"torque_noise": 1e-300}, "torque_noise"),
        ({"schedule": {"sharpness": (1, -3)}}, "schedule"),
        ({"schedule": {"updates": -3}}, "schedule"),
    ],
)
def test_options_are_checked_by_name(options: dict[str, Any], name: str) -> None:
    with pytest.raises(cs.InputError, match=rf"^{name}\b"):
        cs.ContactParticleFilter(arm(), **options)


def test_a_robot_without_surface_is_refused() -> None:
    pin = pytest.importorskip("pinocchio")
    model = pin.buildSampleModelManipulator()
    bare = cs.Robot.from_pinocchio(model, pin.GeometryModel())
    with pytest.raises(cs.InputError, match="robot: no link that moves has a surface"):
        cs.ContactParticleFilter(bare)


@pytest.mark.parametrize(
    ("q", "torque", "name"),
    [
        (np.zeros(6), np.ones(7), "q"),
        (np.full(7, np.nan), np.ones(7), "q"),
        (np.zeros(7), np.ones(6), "tau_ext"),
        (np.zeros(7), np.array([1, 2, np.nan, 0, 0, 0, 0]), "tau_ext"),
        (np.zeros(7), np.array([1, 2, np.inf, 0, 0, 0, 0]), "tau_ext"),
        (np.zeros(7), "torques", "tau_ext"),
        (None, np.ones(7), "q"),
    ],
)
def test_bad_measurements_leave_the_filter_as_it_was(q: Any, torque: Any, name: str) -> None:
    run = explored(5, 41)
    trackers = [cs.ContactParticleFilter(arm(), particles=500) for _ in range(2)]
    for tracker in trackers:
        tracker.update(run.q[0], run.external_torque[0])
    with pytest.raises(cs.InputError, match=rf"^{name}\b"):
        trackers[0].update(q, torque)
    with pytest.raises(cs.InputError, match=r"^time\b"):
        trackers[0].update(run.q[1], run.external_torque[1], time=np.nan)
    after = [tracker.update(run.q[1], run.external_torque[1]).point for tracker in trackers]
    assert np.array_equal(*after)


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_whatever_is_measured_the_answer_is_finite_and_the_weights_sum_to_one(data: st.DataObject) -> None:
    robot = arm()
    tracker = cs.ContactParticleFilter(robot, particles=200, seed=data.draw(st.integers(0, 9)))
    number = st.one_of(st.floats(-300, 300), st.floats(-1e-6, 1e-6), st.sampled_from([0.0, 1e12, -1e50]))
    for _ in range(data.draw(st.integers(1, 6))):
        q = data.draw(st.lists(st.floats(-7, 7), min_size=7, max_size=7))
        estimate = tracker.update(q, data.draw(st.lists(number, min_size=7, max_size=7)))
        assert tracker.particles.weight.sum() == pytest.approx(1.0)
        if estimate.contact:
            assert np.isfinite(estimate.point).all()
            assert np.isfinite(estimate.force).all()
            assert np.isfinite(estimate.covariance).all()
            assert np.linalg.eigvalsh(estimate.covariance).min() > 0.0
            assert sum(estimate.link_probabilities.values()) == pytest.approx(1.0)
            assert estimate.modes
            assert 0.0 <= estimate.modes[0].probability <= 1.0 + 1e-9
