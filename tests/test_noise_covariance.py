"""The covariance that a noise model predicts is the one that observers show."""

import numpy as np
import pytest

import contactsense as cs

DT = 1e-3


@pytest.mark.parametrize("gain", [8.0, 50.0, 200.0])
def test_white_noise_behind_an_observer_has_the_predicted_covariance(gain: float) -> None:
    robot = cs.Robot.named("iiwa14")
    q = np.array([0.3, 0.8, -0.4, 0.9, 0.5, 0.7, 0.2])
    noise = cs.NoiseModel(torque=0.2, velocity=0.003, model=0.0)
    rng = np.random.default_rng(4)
    weight = robot.inverse_dynamics(q, np.zeros(7), np.zeros(7))
    observer = cs.MomentumObserver(robot, dt=DT, gain=gain)
    outputs = []
    for tick in range(60_000):
        v = 0.003 * rng.standard_normal(7)
        tau = weight + 0.2 * rng.standard_normal(7)
        external = observer.update(q, v, tau)
        if tick > 5.0 / gain / DT:
            outputs.append(np.array(external))
    predicted = noise.covariance(robot, q, gain=gain, dt=DT)
    seen = np.cov(np.array(outputs).T)
    scale = np.sqrt(np.diag(predicted))
    # Some 60 s of a signal that is correlated over 1 / gain: slow gains leave fewer independent samples.
    np.testing.assert_allclose(seen / np.outer(scale, scale), predicted / np.outer(scale, scale), atol=0.2)


def test_slow_errors_pass_as_far_as_the_observer_follows() -> None:
    robot = cs.Robot.named("iiwa14")
    noise = cs.NoiseModel(torque=1e-6, model=0.5, model_time=0.1)
    slow, fast = (np.sqrt(noise.covariance(robot, robot.neutral(), gain=k)[2, 2]) for k in (1.0, 1e3))
    assert slow == pytest.approx(0.5 * np.sqrt(0.1 / 1.1), rel=1e-3)
    assert fast == pytest.approx(0.5, rel=0.01)
    times = [noise.correlation_time(robot, robot.neutral(), gain=k)[2] for k in (1.0, 1e3)]
    assert times == pytest.approx([1.1, 0.101], rel=1e-3)


def test_what_is_no_gain_or_time_step_is_refused() -> None:
    robot = cs.Robot.named("iiwa14")
    with pytest.raises(cs.InputError, match="gain"):
        cs.NoiseModel().covariance(robot, robot.neutral(), gain=0.0)
    with pytest.raises(cs.InputError, match="dt"):
        cs.NoiseModel().correlation_time(robot, robot.neutral(), dt=-1.0)
