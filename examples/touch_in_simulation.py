"""A simulated arm is pushed while it moves; the monitor detects the contact and estimates point and force.

Requires MuJoCo: pip install '.[sim]'
"""

import numpy as np

import contactsense as cs
from contactsense import sim

DT = 0.001  # [s]
THRESHOLD = 0.1  # [Nm]

robot = cs.Robot.named("iiwa14")
monitor = cs.ContactMonitor(robot, dt=DT, observer_gain=500.0, torque_threshold=THRESHOLD)
motion = sim.SineTrajectory.for_model(robot.model, peak_speed=1.0, horizon=3.0, seed=2)
controller = sim.ComputedTorqueController(robot.model)
arm = sim.SimulatedRobot(robot.model, dt=DT)
arm.reset(motion.at(0.0).q)

# 40 N at the centre of the outer face of link 7, close to the inward normal.
face = robot.surface("iiwa_link_7").closest_points([[0.0, 0.0, 1.0]])
push = sim.Push(
    link="iiwa_link_7",
    point_local=face.points[0],
    direction=-face.normals[0] + [0.2, 0.1, 0.0],
    peak_force=40.0,
    start=2.0,
    duration=0.1,
)

strongest, answer = 0.0, None
for _ in range(2500):
    arm.clear_forces()
    point, force = push.apply(arm)
    measured = arm.step(controller.torque(arm.q, arm.v, motion.at(arm.time)))
    # The motors hold their torque between ticks, so that its mean belongs to q and v.
    report = monitor.update(measured.q, measured.v, measured.tau_mean)
    if report.onset:
        print(f"contact detected {1e3 * (measured.time - push.start):.0f} ms after its start")
    # The estimate is most accurate when the torques are largest.
    if report.contacts and np.linalg.norm(report.external_torque) > strongest:
        strongest = float(np.linalg.norm(report.external_torque))
        answer = report.contacts[0], point, force

if answer is not None:
    contact, point, force = answer
    print(f"link: {contact.link}, located: {contact.located}")
    error = np.linalg.norm(contact.point - point)
    print(f"point error: {1e3 * error:.2f} mm (std {1e3 * contact.point_std:.2f} mm)")
    print(f"force: {np.linalg.norm(contact.force):.1f} N, true force {np.linalg.norm(force):.1f} N")
