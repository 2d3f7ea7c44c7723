"""Motions, controllers and pushes in the simulation, and that an observer sees what was applied."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
import pytest

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")


from contactsense import Robot
from contactsense.errors import InputError
from contactsense.sim import (
    ComputedTorqueController,
    Measurement,
    Push,
    SimulatedRobot,
    SineTrajectory,
    random_push,
)


def test_trajectory_is_smooth_fast_and_within_limits() -> None:
    model = Robot.named("iiwa14").model
    motion = SineTrajectory.for_model(model, peak_speed=1.9, seed=4, horizon=30.0)
    start = motion.at(0.0)
    np.testing.assert_array_equal(start.v, 0)
    np.testing.assert_array_equal(start.a, 0)
    times = np.arange(0.0, 30.0, 0.01)
    points = [motion.at(time) for time in times]
    speed = np.abs([point.v for point in points]).max(axis=0)
    np.testing.assert_allclose(speed, np.minimum(1.9, model.velocityLimit), rtol=0.01)
    q = np.array([point.q for point in points])
    assert (q > model.lowerPositionLimit).all()
    assert (q < model.upperPositionLimit).all()
    h = 1e-5
    for time in (0.7, 1.99, 11.3):
        before, here, after = motion.at(time - h), motion.at(time), motion.at(time + h)
        np.testing.assert_allclose((after.q - before.q) / (2 * h), here.v, atol=1e-7)
        np.testing.assert_allclose((after.v - before.v) / (2 * h), here.a, atol=1e-6)
    same = SineTrajectory.for_model(model, peak_speed=1.9, seed=4, horizon=30.0).at(5.0)
    other = SineTrajectory.for_model(model, peak_speed=1.9, seed=5, horizon=30.0).at(5.0)
    np.testing.assert_array_equal(same.q, motion.at(5.0).q)
    assert (other.q != same.q).all()


@dataclass
class _Run:
    measurements: list[Measurement]
    tracking: float


def _run(robot: SimulatedRobot, motion: SineTrajectory, seconds: float, push: Push | None = None) -> _Run:
    controller = ComputedTorqueController(robot.model)
    robot.reset(motion.at(0.0).q)
    measurements, tracking = [], 0.0
    for _ in range(round(seconds / robot.dt)):
        reference = motion.at(robot.time)
        q, v = robot.q, robot.v
        tracking = max(tracking, float(np.abs(reference.q - q).max()))
        robot.clear_forces()
        if push is not None:
            push.apply(robot)
        measurements.append(robot.step(controller.torque(q, v, reference)))
    return _Run(measurements, tracking)


def _observe(model: pin.Model, run: _Run, dt: float, torque: str, gain: float = 50.0) -> np.ndarray:
    """Momentum observer with p = M v at the ticks and the trapezoidal rule in between."""
    data = model.createData()
    integral: np.ndarray = np.zeros(model.nv)
    residual: np.ndarray = np.zeros(model.nv)
    start, last, residuals = None, None, []
    for sample in run.measurements:
        pin.crba(model, data, sample.q)
        mass = np.triu(data.M) + np.triu(data.M, 1).T
        pin.computeCoriolisMatrix(model, data, sample.q, sample.v)
        gravity = pin.computeGeneralizedGravity(model, model.createData(), sample.q)
        flow = getattr(sample, torque) + data.C.T @ sample.v - gravity
        momentum = mass @ sample.v
        if start is None:
            start = momentum
        else:
            integral = integral + 0.5 * dt * (flow + last)
            # r = K (p - p0 - integral - int r), r by the trapezoidal rule as well
            new = (gain * (momentum - start - integral) - 0.5 * gain * dt * residual) / (1 + 0.5 * gain * dt)
            integral = integral + 0.5 * dt * (residual + new)
            residual = new
        last = flow
        residuals.append(residual)
    return np.array(residuals)


def test_controller_tracks_and_observer_stays_silent() -> None:
    model = Robot.named("iiwa14").model
    motion = SineTrajectory.for_model(model, peak_speed=1.9, seed=1, horizon=6.0)
    run = _run(SimulatedRobot(model), motion, 6.0)
    assert run.tracking < 0.01
    # Half a tick of torque is worth 100 times what the rest of the discretisation is.
    assert np.abs(_observe(model, run, 0.001, "tau_mean")).max() < 1e-3
    assert np.abs(_observe(model, run, 0.001, "tau")).max() > 1e-2


def test_push_shows_in_the_observer_as_applied() -> None:
    model = Robot.named("iiwa14").model
    motion = SineTrajectory.for_model(model, peak_speed=1.0, seed=2, horizon=3.0)
    push = Push("iiwa_link_5", np.array([0.0, 0.1, 0.15]), np.array([0.0, -1.0, 0.2]), 30.0, 1.5, 0.5)
    robot = SimulatedRobot(model)
    run = _run(robot, motion, 1.75, push)
    truth = robot.external_torque()
    assert np.abs(truth).max() > 3.0
    seen = _observe(model, run, 0.001, "tau_mean", gain=300.0)[-1]
    np.testing.assert_allclose(seen, truth, atol=0.05 * np.abs(truth).max())


def test_torque_limits_hold() -> None:
    model = Robot.named("iiwa14").model
    controller = ComputedTorqueController(model, torque_limits=np.full(7, 1.0))
    motion = SineTrajectory.for_model(model, seed=1)
    torque = controller.torque(np.zeros(7), np.zeros(7), motion.at(3.0))
    assert np.abs(torque).max() == 1.0
    with pytest.raises(InputError, match="fixed base"):
        ComputedTorqueController(Robot.named("atlas").model)


def test_push_is_a_half_sine() -> None:
    push = Push("hand", np.array([0.1, 0.0, 0.0]), np.array([0.0, 0.0, 2.0]), 40.0, 1.0, 0.2)
    assert [push.magnitude(t) for t in (0.9, 1.0, 1.201, 1.5)] == [0.0] * 4
    assert push.magnitude(1.1) == pytest.approx(40.0)
    assert push.magnitude(1.05) == pytest.approx(40.0 * np.sin(np.pi / 4))
    pose = np.eye(4)
    pose[:3, :3] = pin.rpy.rpyToMatrix(np.pi / 2, 0.0, 0.0)
    pose[:3, 3] = [1.0, 2.0, 3.0]
    point, force = push.force_at(1.1, pose)
    np.testing.assert_allclose(point, [1.1, 2.0, 3.0])
    np.testing.assert_allclose(force, [0.0, -40.0, 0.0], atol=1e-12)
    world = Push("hand", push.point_local, push.direction, 40.0, 1.0, 0.2, frame="world")
    np.testing.assert_allclose(world.force_at(1.1, pose)[1], [0.0, 0.0, 40.0], atol=1e-12)
    with pytest.raises(InputError, match="duration"):
        Push("hand", push.point_local, push.direction, 40.0, 1.0, 0.0)


@dataclass
class _Samples:
    points: np.ndarray
    normals: np.ndarray


class _Ball:
    """Unit sphere."""

    def sample(self, n: int, seed: int = 0) -> _Samples:
        normals = np.random.default_rng(seed).normal(size=(n, 3))
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        return _Samples(normals.copy(), normals)


def test_random_pushes_go_inward_within_the_cone() -> None:
    angle = 0.5
    pushes = [
        random_push("ball", _Ball(), peak_force=1, start=0, duration=1, cone_angle=angle, seed=seed)
        for seed in range(400)
    ]
    cosines = np.array([-push.direction @ push.point_local for push in pushes])
    assert cosines.min() > np.cos(angle) - 1e-12
    # Uniform over the solid angle: the cosine is uniform.
    assert cosines.mean() == pytest.approx(0.5 * (1 + np.cos(angle)), abs=0.01)
    again = random_push("ball", _Ball(), peak_force=1, start=0, duration=1, cone_angle=angle, seed=7)
    np.testing.assert_array_equal(again.direction, pushes[7].direction)
    with pytest.raises(InputError, match="cone_angle"):
        random_push("ball", _Ball(), peak_force=1, start=0, duration=1, cone_angle=2.0)
