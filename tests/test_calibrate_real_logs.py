"""Real arms in free motion: calibrated on the first part of a log, judged on the rest."""

import csv
import gzip

import numpy as np
import pytest
from joint_states import joint_states
from numpy.typing import NDArray
from robots import EXAMPLE_SHARE, SHARED

import contactsense as cs

pytestmark = pytest.mark.shared
GAIN = 8.0
ROBOTS = EXAMPLE_SHARE / "example-robot-data" / "robots"
TIAGO_JOINTS = ["torso_lift_joint", *(f"arm_{k}_joint" for k in range(1, 8))]


def example(path: str, keep: list[str] | None = None) -> cs.Robot:
    urdf = ROBOTS / path
    if not urdf.exists():
        pytest.skip(f"{urdf} is absent: example-robot-data is not installed")
    robot = cs.Robot.from_urdf(urdf, package_dirs=[EXAMPLE_SHARE], missing_meshes="warn")
    locked = [joint for joint in robot.joint_names if keep is not None and joint not in keep]
    return cs.Robot.from_urdf(
        urdf, package_dirs=[EXAMPLE_SHARE], missing_meshes="warn", locked_joints=locked or None
    )


def panda() -> tuple[cs.Robot, cs.Log]:
    robot = example("panda_description/urdf/panda.urdf", keep=[f"panda_joint{k}" for k in range(1, 8)])
    names = [f"fer_joint{k}" for k in range(1, 8)]
    return robot, cs.Log(*joint_states(SHARED / "real/panda_free/panda_exciting_trajectory.db3", names))


def ur10() -> tuple[cs.Robot, cs.Log]:
    robot = example("ur_description/urdf/ur10_robot.urdf")
    path = SHARED / "real/ur10_free/ur10_exciting_trajectory.db3"
    return robot, cs.Log(*joint_states(path, list(robot.joint_names)))


def tiago() -> tuple[cs.Robot, cs.Log]:
    robot = example("tiago_description/robots/tiago.urdf", keep=TIAGO_JOINTS)

    def columns(name: str) -> NDArray[np.float64]:
        with gzip.open(SHARED / f"real/tiago_free/tiago_{name}.csv.gz", "rt") as file:
            rows = list(csv.reader(file))
        return np.array(rows[1:], dtype=float)

    position, velocity, effort = (columns(name) for name in ("position", "velocity", "effort"))
    reduction = np.array([1, 100, 100, 100, 100, 336, 336, 336])
    constant = np.array([1, 0.136, 0.136, -0.087, -0.087, -0.0613, -0.0613, -0.0613])
    tau = effort[:, 1:] * reduction * constant
    return robot, cs.Log(position[:, 0], position[:, 1:], velocity[:, 1:], tau)


def halves(log: cs.Log) -> tuple[cs.Log, cs.Log]:
    middle = int(np.searchsorted(log.time, 0.5 * (log.time[0] + log.time[-1])))
    return log[:middle], log[middle:]


def left(robot: cs.Robot, log: cs.Log, calibration: cs.Calibration | None) -> NDArray[np.float64]:
    """Root mean square of the external torque, by joint, once the observer has settled [Nm]."""
    step = float(np.median(np.diff(log.time)))
    observer = cs.MomentumObserver(robot, dt=step, gain=GAIN, calibration=calibration)
    steps = np.diff(log.time, prepend=log.time[0] - step)
    assert log.tau is not None
    rows = zip(log.q, log.v, log.tau, steps, strict=True)
    torque = np.array([observer.update(q, v, tau, dt=dt) for q, v, tau, dt in rows])
    return np.sqrt(np.mean(torque[log.time - log.time[0] > 4.0 / GAIN] ** 2, axis=0))


def contacts(robot: cs.Robot, log: cs.Log, calibration: cs.Calibration) -> int:
    step = float(np.median(np.diff(log.time)))
    monitor = cs.ContactMonitor(robot, dt=step, observer_gain=GAIN, calibration=calibration)
    assert log.tau is not None
    rows = zip(log.q, log.v, log.tau, strict=True)
    return sum(monitor.update(q, v, tau).onset for q, v, tau in rows)


def test_a_panda_is_quiet_after_twelve_seconds_of_motion() -> None:
    robot, log = panda()
    fitted, judged = halves(log)
    calibration = cs.calibrate(robot, fitted)
    assert (left(robot, judged, calibration) <= [0.25, 0.25, 0.25, 0.2, 0.15, 0.1, 0.1]).all()
    assert contacts(robot, judged, calibration) == 0


def test_motor_currents_of_a_ur10_become_torques() -> None:
    robot, log = ur10()
    fitted, judged = halves(log)
    calibration = cs.calibrate(robot, fitted)
    assert (left(robot, judged, None) >= 3.0 * left(robot, judged, calibration)).all()
    assert contacts(robot, judged, calibration) == 0
    # Coulomb friction of 3 to 15 Nm is inside these torques.
    assert (calibration.friction.coulomb > 2.0).all()


def test_joints_of_a_tiago_without_information_are_named() -> None:
    robot, log = tiago()
    notes = "\n".join(cs.calibrate(robot, log).notes)
    assert "'arm_5_joint'" in notes
    assert "'torso_lift_joint'" in notes
    assert "exciting_motion" in notes


def test_opposite_torques_of_a_panda_are_found() -> None:
    robot, log = panda()
    assert log.tau is not None
    for sign in (-np.ones(7), np.array([1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -1.0])):
        opposite = cs.Log(log.time, log.q, log.v, sign * log.tau)
        np.testing.assert_array_equal(np.sign(cs.calibrate(robot, opposite).torque_scale), sign)
