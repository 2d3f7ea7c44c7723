"""A standing humanoid with force/torque sensors at its feet and hands is pushed on the torso and on a hand.

The forces of the ground are wanted contacts: the sensors of the feet tell them apart from pushes.

Requires MuJoCo: pip install '.[sim]'
"""

import numpy as np

import contactsense as cs
from contactsense import sim
from contactsense.sim.atlas import FEET, controller, posture

robot = cs.Robot.named("atlas")
sensors = [cs.ForceTorqueSensor(link, link) for link in (*FEET, "l_hand", "r_hand")]

# Its masses differ from the description by 1 %, and torques and sensors have noise.
atlas = sim.SimulatedRobot(
    sim.perturbed_model(robot.model, mass=0.01, seed=0),
    geoms=sim.named_geoms("atlas", conaffinity=sim.FLOOR_TYPE),
    floor=sim.Floor(),
    sensors=sensors,
    noise=sim.TorqueNoise(newton_metres=0.1, seed=0),
    wrench_noise=sim.WrenchNoise(newtons=1.0, newton_metres=0.05, seed=0),
)
q = posture(robot.model, seed=0)
balance = controller(robot.model, q)
atlas.reset(q)

monitor = cs.ContactMonitor(
    robot,
    dt=atlas.dt,
    sensors=sensors,
    wanted_contacts=FEET,
    torque_threshold=2.0,  # [Nm], and [N] for the forces on the floating base
    wrench_threshold=10.0,  # [N, Nm]
    bias_time_constant=0.3,  # [s] learns what the wrong masses cause
)


def push(link: str, place: list[float], peak: float, start: float) -> sim.Push:
    """For 0.2 s, on the place of the surface that is nearest to `place`."""
    face = robot.surface(link).closest_points([place])
    return sim.Push(link, face.points[0], -face.normals[0], peak, start=start, duration=0.2)


def run(push: sim.Push) -> None:
    """Until after the push; the contact is judged while its torques are largest."""
    strongest = 0.0
    while atlas.time < push.start + 0.4:
        atlas.clear_forces()
        _, force = push.apply(atlas)
        measured = atlas.step(balance.torque(atlas.q, atlas.v))
        report = monitor.update(measured.q, measured.v, measured.tau_mean, measured.wrenches)
        if report.onset:
            print(f"contact detected {1e3 * (atlas.time - push.start):.0f} ms after the push on {push.link}")
        # The first three are the sum of all forces on the robot but the wanted ones.
        total = float(np.linalg.norm(report.collision_torque[:3]))
        if report.contacts and total > strongest:
            strongest, contact, true = total, report.contacts[0], float(np.linalg.norm(force))
    ground = measured.wrenches[:2, 2].sum()
    print(f"  {contact.link}, located: {contact.located}, by {contact.source}")
    print(f"  total force {strongest:.0f} N, true force {true:.0f} N, forces on the feet {ground:.0f} N")


run(push("utorso", [0.5, 0.05, 0.3], peak=60.0, start=0.6))
run(push("l_hand", [0.2, 0.1, 0.1], peak=40.0, start=1.1))
