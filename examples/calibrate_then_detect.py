"""An arm is calibrated on motion without contact. Then it detects two contacts of a person and locates one.

Without calibration, the errors of the same arm look like a contact nearly all the time.

Requires MuJoCo: pip install '.[sim]'
"""

import numpy as np

import contactsense as cs
from contactsense import sim

DT = 0.002  # [s]

robot = cs.Robot.named("iiwa14")
# Stands in for your arm: wrong masses, bias, friction, hysteresis, delays and noise.
arm = sim.ImperfectArm.typical(robot, seed=4)

# Run such a motion on the robot while nothing touches it, and record what the robot measures.
plan = cs.exciting_motion(robot, 20.0, dt=DT, seed=0)
free = sim.record_imperfect(robot, arm, sim.JointMotion(plan.time, plan.q, plan.v, plan.a), seed=1).log
calibration = cs.calibrate(robot, free)  # calibration.save("arm.yaml") keeps it
print(f"bias {np.round(calibration.torque_bias, 2)} Nm")
print(f"Coulomb friction {np.round(calibration.friction.coulomb, 2)} Nm")
for note in calibration.notes:
    print(f"note: {note}")


def push(link: str, place: list[float], start: float) -> sim.PersonContact:
    """40 N for 0.6 s on the place of the surface that is nearest to `place`, oblique."""
    face = robot.surface(link).closest_points([place])
    force = -39.0 * face.normals[0] + [0.0, 10.0, 0.0]
    return sim.PersonContact(link, face.points[0], force, start=start, duration=0.6, rise=0.05)


# Other motion of the same arm, in which a person pushes it twice.
pushes = [push("iiwa_link_5", [0.0, 0.3, 0.1], 5.0), push("iiwa_link_7", [0.3, 0.0, 0.03], 12.0)]
run = sim.record_imperfect(robot, arm, sim.random_moves(robot, 15.0, dt=DT, seed=6), pushes, seed=2)

for name, chosen in (("without", None), ("with", calibration)):
    result = cs.replay(run.log, cs.ContactMonitor(robot, dt=DT, calibration=chosen))
    share = 100.0 * result.ticks["collision"].mean()
    print(f"{name} calibration: {len(result.contacts)} contacts, {share:.0f} % of the time")

for contact, true in zip(result.contacts, run.truth.contacts, strict=True):
    delay = contact.start - true.contact.start
    error = np.linalg.norm(
        contact.point_local - true.contact.point_local
    )  # the arm moves: in the link's frame
    print(f"push on {true.contact.link}: detected after {1e3 * delay:.0f} ms, ", end="")
    print(f"{contact.link} ({100 * contact.link_probability:.0f} %), located: {contact.located}")
    print(f"  {contact.peak_force:.0f} N; 90 % of the possible points lie ", end="")
    print(f"within {100 * contact.region_radius:.1f} cm, error {100 * error:.1f} cm")
