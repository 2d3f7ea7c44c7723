"""A contact on the second link of an arm is located by small motions.

It loads only two joints, so that one pose leaves most of the arm possible. While the arm moves by up to
2 degrees, the torques change in a way that few places explain. The estimate reports what remains uncertain.

Requires MuJoCo: pip install '.[sim]'
"""

import numpy as np

import contactsense as cs
from contactsense import sim

CHI_SQUARE = 6.25  # 90 % of a normal distribution of three dimensions

robot = cs.Robot.named("iiwa14")
touch = sim.touch_scene(
    robot, "iiwa_link_2", kind="sphere", force_range=(20.0, 30.0), least_torque=2.0, seed=0
)

# Stands in for your arm: 30 motions of 0.2 s in contact. External torques have 3 % and 0.02 Nm of noise. On
# your arm they are those of a calibrated `MomentumObserver`.
pace = sim.Pace(motions=30, duration=0.2)
path = sim.joint_exploration(robot, touch, amplitude=np.deg2rad(2.0), pace=pace, seed=0)
run = sim.record_quasi_static(robot, touch.contact(robot), path.time, path.q)
measured = sim.TorqueError(percent=3.0, newton_metres=0.02, seed=0).measure(run.external_torque)

tracker = cs.ContactParticleFilter(robot, seed=0)
for number, (q, external_torque) in enumerate(zip(run.q, measured, strict=True)):
    estimate = tracker.update(q, external_torque)
    if number in (0, 10, 100, len(run.q) - 1):
        spread = 100.0 * np.sqrt(np.trace(estimate.covariance))
        links = {link: round(p, 2) for link, p in estimate.link_probabilities.items() if p >= 0.05}
        print(f"{path.time[number]:.1f} s: +- {spread:.0f} cm, {links}, ambiguous: {estimate.ambiguous}")

error = estimate.point - run.point[-1]
inside = error @ np.linalg.solve(estimate.covariance, error) < CHI_SQUARE
print(f"{estimate.link}: error {100.0 * np.linalg.norm(error):.1f} cm, in the 90 % region: {inside}")
print(f"force {estimate.magnitude:.0f} N, true force {np.linalg.norm(run.force[-1]):.0f} N")
# If the estimate is ambiguous, all of these places are possible.
for mode in estimate.modes[:3]:
    print(f"  {100.0 * mode.probability:.0f} %: {mode.link}, {np.round(mode.point, 2)} m")
