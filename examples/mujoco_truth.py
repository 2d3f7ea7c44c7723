"""The true external torque of a MuJoCo simulation, beside that of an observer of the same robot.

The hand of an arm moves down onto a table. Then a force pushes its elbow as well.

Requires MuJoCo: pip install '.[sim]'
"""

import xml.etree.ElementTree as ET

import numpy as np

import contactsense as cs
from contactsense import sim

DT = 0.001  # [s]
GAIN = 200.0  # of the observer [1/s]
DOWN = np.array([0.0, 0.0, -0.1, 0.0, 0.0, 0.0])  # [m/s, rad/s]

# A world with the robot, exactly as described, and a table. `contype` lets only the two touch each other.
robot = cs.Robot.named("iiwa14")
root = sim.mjcf_tree(robot.model, dt=DT, geoms=sim.named_geoms("iiwa14", conaffinity=1))
world = root.find("worldbody")
assert world is not None
ET.SubElement(world, "geom", type="box", size="0.3 0.3 0.02", pos="0.55 0 0.25", contype="1", conaffinity="0")
arm = sim.SimulatedRobot(robot.model, dt=DT, mjcf=ET.tostring(root, encoding="unicode"))
controller = sim.ComputedTorqueController(robot.model)
observer = cs.MomentumObserver(robot, dt=DT, gain=GAIN)

goal = np.array([0.0, 0.6, 0.0, -1.6, 0.0, 0.9, 0.0])
arm.reset(goal)
delayed, errors, sizes = np.zeros(robot.nv), [], []
for tick in range(1500):
    arm.clear_forces()
    if tick >= 1200:
        arm.apply_force("iiwa_link_4", arm.link_pose("iiwa_link_4")[:3, 3], [0.0, 30.0, 0.0])
    # Of any state of any model: here, `mj_forward` has been called at the end of `arm.step`.
    truth = sim.external_torque(arm.mj_model, arm.mj_data)

    v = np.linalg.pinv(robot.jacobian(goal, "iiwa_link_7")) @ DOWN
    goal = goal + DT * v
    tau = controller.torque(arm.q, arm.v, sim.TrajectoryPoint(goal, v, np.zeros(robot.nv)))
    measured = arm.step(tau)
    estimate = observer.update(measured.q, measured.v, measured.tau_mean)

    # An observer is a low-pass of the truth. Without that of its gain, the delay would count as an error.
    delayed = delayed + (1.0 - np.exp(-GAIN * DT)) * (truth - delayed)
    errors.append(np.abs(estimate - delayed).max())
    sizes.append(np.abs(truth).max())
    if tick in (500, 1100, 1400):
        print(f"{measured.time:.1f} s: {arm.mj_data.ncon} contacts")
        print(f"  truth    {np.round(truth, 1)} Nm")
        print(f"  observer {np.round(estimate, 1)} Nm")
print(
    f"largest torque {max(sizes):.0f} Nm, mean error {np.mean(errors):.3f} Nm, largest {max(errors):.1f} Nm"
)
