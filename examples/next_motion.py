"""A contact on the fourth link is located by motions that are chosen for what they tell.

`next_motion` chooses small motions that neither lose the contact nor press too hard, and says what it
expects of each.

Requires MuJoCo: pip install '.[sim]'
"""

import numpy as np

import contactsense as cs
from contactsense import sim
from contactsense.sim.penalty import joint_torque

MAX_FORCE = 60.0  # [N]
MAX_STEP = np.deg2rad(1.0)  # of each joint
MOTIONS = 3

robot = cs.Robot.named("iiwa14")
touch = sim.touch_scene(
    robot, "iiwa_link_4", kind="sphere", force_range=(10.0, 20.0), least_torque=1.0, seed=2
)
contact = touch.contact(robot)
noise = sim.TorqueNoise(percent=3.0, newton_metres=0.02, seed=0)


def measured(q: np.ndarray) -> np.ndarray:
    """Stands in for your arm: the external torque at rest. There it is that of a `MomentumObserver`."""
    return noise.measure(joint_torque(robot, q, contact.forces(q, np.zeros(robot.nv))))


tracker = cs.ContactParticleFilter(robot, seed=0)
q = touch.q
for _ in range(5):
    estimate = tracker.update(q, measured(q))
for number in range(MOTIONS):
    motion = cs.next_motion(
        robot,
        estimate,
        q,
        max_force=MAX_FORCE,
        max_step=MAX_STEP,
        particles=tracker.particles,
        seed=number,
        dt=0.1,
    )
    if not motion:
        print(motion.reason)
        break
    for q in motion.q:
        estimate = tracker.update(q, measured(q))
    (true,) = contact.forces(q, np.zeros(robot.nv))
    error = 100.0 * np.linalg.norm(estimate.point - true.point)
    spread = [round(100.0 * value, 1) for value in (motion.spread_before, motion.spread_after)]
    print(
        f"motion {number + 1}: expected {motion.information:.1f} nats, spread {spread[0]} -> {spread[1]} cm;"
        f" error {error:.1f} cm, force {np.linalg.norm(true.force):.0f} N"
    )
print(f"{estimate.link}: ambiguous: {estimate.ambiguous}")
