"""A simulated arm explores a contact with a sphere by small motions; the recording is saved and loaded.

Requires MuJoCo: pip install '.[sim]'
"""

import tempfile
from pathlib import Path

import numpy as np

import contactsense as cs
from contactsense import sim

robot = cs.Robot.named("iiwa14")
scene = sim.touch_scene(robot, "iiwa_link_4", kind="sphere", force_range=(15.0, 25.0), seed=3)
print(
    f"a sphere of {1e2 * scene.obstacle.radius:.1f} cm on {scene.link}, {np.linalg.norm(scene.force):.1f} N"
)

# Eight motions of up to 3 degrees per joint, planned so that the contact is maintained.
pace = sim.Pace(motions=8, duration=0.5)
path = sim.joint_exploration(robot, scene, amplitude=np.deg2rad(3.0), pace=pace, seed=0)

# Physics simulation: compliant control, masses with an error of 5 %, friction, an observer, 5 % torque noise.
contact = scene.contact(robot, friction=0.2, dissipation=1.0)
real = sim.perturbed_model(robot.model, mass=0.05, seed=1)
noise = sim.TorqueError(percent=5.0, seed=2)
run = sim.record_run(robot, contact, path, true_model=real, error=noise)
with tempfile.TemporaryDirectory() as folder:
    run.save(Path(folder) / "run.npz")
    run = sim.ContactRun.load(Path(folder) / "run.npz")
force = np.linalg.norm(run.force, axis=1)
wander = 1e2 * np.ptp(run.point, axis=0).max()
error = np.abs(run.external_torque - run.true_external_torque).mean()
print(
    f"physics: {len(run)} samples, {force.min():.0f} to {force.max():.0f} N, the point moves {wander:.1f} cm"
)
print(f"mean error of the external torque: {error:.2f} Nm")

# The same motions in closed form, without a physics simulation, for studies with thousands of trials.
plain = sim.record_quasi_static(robot, scene.contact(robot), path.time, path.q)
apart = 1e3 * np.linalg.norm(plain.point - run.point, axis=1).max()
print(f"closed form: points within {apart:.0f} mm of those of the physics simulation")
