"""The first contact: an arm at rest is pushed, and the monitor says when, where and how hard."""

import numpy as np

import contactsense as cs

robot = cs.Robot.named("iiwa14")
monitor = cs.ContactMonitor(robot, dt=0.001, torque_threshold=0.5, bias_time_constant=0.5)
q, v = np.array([0.0, 0.5, 0.0, -1.4, 0.0, 0.9, 0.0]), np.zeros(7)

# Stand-in for your driver: torque sensors with a bias and noise, and 40 N on link 6 from 1.5 s on.
rng = np.random.default_rng(0)
at_rest = robot.inverse_dynamics(q, v, v) + rng.normal(0.0, 0.3, 7)
push = robot.jacobian(q, "iiwa_link_6", point=[0.515, 0.013, 0.605])[:3].T @ [38.0, 0.0, 13.0]

for tick in range(2000):
    tau = at_rest + rng.normal(0.0, 0.05, 7) - (push if tick >= 1500 else 0.0)
    report = monitor.update(q, v, tau)
    if report.onset:
        print(f"contact at {report.time:.3f} s")
for contact in report.contacts:
    where = f"{np.round(contact.point, 2)} +- {100 * contact.point_std:.1f} cm" if contact.located else "?"
    print(f"{contact.link}, point {where}, {np.linalg.norm(contact.force):.0f} N")
