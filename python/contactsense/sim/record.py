"""Contact runs in physics: an arm under impedance control explores in contact, simulated with MuJoCo."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pinocchio as pin

from contactsense import MomentumObserver, Robot
from contactsense.errors import InputError

from ._arrays import FloatArray, not_negative, positive
from .contact_path import ContactPath
from .disturbance import TorqueError
from .impedance import ImpedanceController
from .noise import TorqueNoise
from .penalty import ContactForce, PenaltyContact, joint_torque
from .quasi_static import contact_run
from .run import ContactRun


def record_run(
    robot: Robot,
    contact: PenaltyContact,
    path: ContactPath,
    *,
    controller: ImpedanceController | None = None,
    true_model: pin.Model | None = None,
    error: TorqueError | None = None,
    sensor_noise: TorqueNoise | None = None,
    external_torque: Literal["observer", "static"] = "observer",
    observer_gain: float = 50.0,
    rate: float = 50.0,
    settle: float = 0.3,
    dt: float = 0.001,
    settings: dict[str, Any] | None = None,
) -> ContactRun:
    """Simulate an arm that follows `path` softly, pressing on the obstacle; record at `rate`.

    It starts at rest at the path's first pose. The controller is fed the path's poses, and the torques with
    which the contact is planned to push back: a soft arm alone would stop short of the obstacle.

    Args:
        robot: what is known of the arm: the observer and the controller use it.
        contact: a spring at the deepest point of the true surface.
        path: see `joint_exploration` and its like.
        controller: `ImpedanceController(robot.model)` by default; its `torque` is called once a tick.
        true_model: the arm as it is (see `perturbed_model`), which is simulated; `robot.model` by default.
        error: added to the recorded external torque, once a sample.
        sensor_noise: of the measured motor torques at every tick; what of it gets through depends on
            `external_torque`.
        external_torque: "observer": `MomentumObserver`; "static": `g(q) - tau`, right while the arm is slow.
        observer_gain: [1/s].
        rate: of the samples [Hz]; a whole number of ticks must fit between them.
        settle: rest at the path's first pose before time zero, so that the observer has caught up [s].
        dt: control tick and simulation step [s].
        settings: added to those of the record.

    Raises:
        InputError: names the argument; also if the obstacle's core is reached, or the arm becomes unstable.
    """
    ticks = round(1.0 / (positive("rate", rate) * positive("dt", dt)))
    if ticks < 1 or abs(ticks * dt * rate - 1.0) > 1e-6:
        raise InputError(
            f"rate must leave a whole number of ticks of {dt:g} s between samples, not {rate:g} Hz"
        )
    if external_torque not in ("observer", "static"):
        raise InputError(f"external_torque must be 'observer' or 'static', not {external_torque!r}")
    control = controller or ImpedanceController(robot.model)
    arm = contact.arm(true_model or robot.model, dt=dt, noise=sensor_noise)
    observer = MomentumObserver(robot, dt=dt, gain=observer_gain)
    arm.reset(path.q[0])
    still = np.zeros(robot.nv)
    rows: list[tuple[FloatArray, ...]] = []
    forces: list[tuple[ContactForce, ...]] = []
    for tick in range(-round(not_negative("settle", settle) / dt), round(float(path.time[-1]) / dt) + 1):
        q, v = arm.q, arm.v
        goal = path.at(tick * dt)
        arm.clear_forces()
        contact.apply(arm)
        sampled = tick >= 0 and tick % ticks == 0
        if sampled:
            forces.append(contact.present(arm))
        measured = arm.step(control.torque(q, v, goal.q, goal.v, -goal.external_torque))
        felt = observer.update(q, v, measured.tau_mean)
        if sampled:
            if external_torque == "static":
                felt = robot.inverse_dynamics(q, still, still) - measured.tau_mean
            true = joint_torque(robot, q, forces[-1])
            rows.append((np.array([tick * dt]), q, v, measured.tau_mean, felt, true))
    if any(int(warning.number) for warning in arm.mj_data.warning):
        raise InputError("controller: the simulated arm has become unstable; softer control may hold it")
    time, q, v, tau, felt, true = (np.array(column) for column in zip(*rows, strict=True))
    offset = np.zeros_like(true) if error is None else error.measure(true) - true
    plain = contact.to_dict() | {
        "recorder": "physics",
        "robot": robot.name,
        "error": (error or TorqueError()).to_dict(),
        "external_torque": external_torque,
        "observer_gain": observer_gain,
        "rate": rate,
        "dt": dt,
    }
    plain |= settings or {}
    return contact_run(time[:, 0], q, v, tau - offset, felt + offset, true, forces, plain)
