"""Three reactions to a contact: stop, retract along the force, and give way to the external torque.

The hand of a simulated arm moves against a wall. Requires MuJoCo: pip install '.[sim]'
"""

from collections.abc import Callable

import numpy as np

import contactsense as cs
from contactsense import sim

DT = 0.001  # [s]
SPEED = 0.2  # of the hand, forward and back [m/s]
TURN = 0.2  # of the joints while the torques do not determine a force [rad/s]
LEFT = 3.0  # an external torque that is smaller (norm) may be what is left of a contact that has ended [Nm]
DAMPING = 20.0  # of the admittance [Nm s/rad]
WALL, STIFFNESS = 0.04, 10_000.0  # in front of the hand [m], [N/m]
START, END = 0.4, 1.1  # of the motion [s]
LINK = "iiwa_link_7"

robot = cs.Robot.named("iiwa14")
Reaction = Callable[[cs.ContactReport, np.ndarray], np.ndarray]  # joint velocities [rad/s]


def move_point(q: np.ndarray, link: str, point: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """The joint velocities that move a point of a link with a velocity [m/s]."""
    # Directions that the joints can hardly move the point in are left out.
    return np.linalg.pinv(robot.jacobian(q, link, point)[:3], rcond=0.05) @ velocity


def stop(report: cs.ContactReport, q: np.ndarray) -> np.ndarray:
    return np.zeros(robot.nv)


def retract(report: cs.ContactReport, q: np.ndarray) -> np.ndarray:
    """Moves the contact point the way it is pushed, until the force is gone."""
    if not report.contacts:
        return np.zeros(robot.nv)
    contact = report.contacts[0]
    # The likeliest point will do for the direction of a retreat, also where it is not `located`.
    if np.isfinite([contact.point, contact.force]).all():
        direction = contact.force / np.linalg.norm(contact.force)
        return move_point(q, contact.link, contact.point, SPEED * direction)
    size = np.linalg.norm(report.external_torque)
    return TURN * report.external_torque / size if size > LEFT else np.zeros(robot.nv)


def admittance(report: cs.ContactReport, q: np.ndarray) -> np.ndarray:
    """Joints yield to their external torque as dampers do."""
    # Without a contact, the external torque is an error of the model, to which the arm must not yield.
    return report.external_torque / DAMPING if report.collision else np.zeros(robot.nv)


def push_against_wall(reaction: Reaction | None) -> tuple[float, float]:
    """The largest force on the hand and the force at the end [N]."""
    # The masses are not those of the description, and the torques are noisy.
    real = sim.perturbed_model(robot.model, mass=0.02, seed=0)
    arm = sim.SimulatedRobot(real, dt=DT, noise=sim.TorqueNoise(newton_metres=0.05, seed=0))
    monitor = cs.ContactMonitor(robot, dt=DT, torque_threshold=1.0, bias_time_constant=0.3)
    controller = sim.ComputedTorqueController(robot.model, kp=2500.0, kd=100.0)  # stiff, as arms are
    goal, v = np.array([0.3, 0.6, -0.4, -1.4, 0.5, 1.2, 0.1]), np.zeros(robot.nv)
    arm.reset(goal)
    front = robot.surface(LINK).closest_points([[0.3, 0.0, 0.04]]).points[0]
    wall = (arm.link_pose(LINK) @ [*front, 1.0])[0] + WALL
    touched, forces = False, []
    while arm.time < END:
        point = (arm.link_pose(LINK) @ [*front, 1.0])[:3]
        forces.append(STIFFNESS * max(0.0, point[0] - wall))
        arm.clear_forces()
        arm.apply_force(LINK, point, [-forces[-1], 0.0, 0.0])
        tau = controller.torque(arm.q, arm.v, sim.TrajectoryPoint(goal, v, np.zeros(robot.nv)))
        measured = arm.step(tau)
        report = monitor.update(measured.q, measured.v, measured.tau_mean)
        touched |= report.onset
        if touched and reaction is not None:
            v = reaction(report, measured.q)
        elif arm.time > START:
            v = move_point(goal, LINK, point, np.array([SPEED, 0.0, 0.0]))
        goal = goal + DT * v
    return max(forces), forces[-1]


for reaction in (None, stop, retract, admittance):
    largest, last = push_against_wall(reaction)
    name = "no reaction" if reaction is None else reaction.__name__
    print(f"{name}: {largest:.0f} N at most, {last:.1f} N at the end")
