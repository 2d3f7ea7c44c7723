"""An arm that measures motor currents, as those of Universal Robots do: contacts from its log files.

Currents times torque constants are torques that contain all the friction of the gears. The arm is therefore
calibrated first. Weak contacts remain hidden in the friction.

Requires MuJoCo: pip install '.[sim]'
"""

import tempfile
from pathlib import Path

import numpy as np

import contactsense as cs
from contactsense import sim

DT = 0.002  # [s]
TORQUE_CONSTANTS = [12.6, 12.6, 12.6, 9.3, 9.3, 9.3]  # at the joint, gear ratio included [Nm/A]

# A six-joint arm of about the size of a UR5, each link a cylinder along z. Use the URDF of your arm instead.
# Name, origin of the joint [m], its pitch [rad], axis, mass [kg], radius, length, centre [m], effort [Nm]
LINKS = (
    ("shoulder_pan", "0 0 0.09", 0.0, "0 0 1", 3.7, 0.06, 0.15, 0.0, 150.0),
    ("shoulder_lift", "0 0.136 0", 1.57, "0 1 0", 8.4, 0.06, 0.50, 0.21, 150.0),
    ("elbow", "0 -0.12 0.425", 0.0, "0 1 0", 2.3, 0.05, 0.45, 0.2, 150.0),
    ("wrist_1", "0 0 0.392", 1.57, "0 1 0", 1.2, 0.04, 0.12, 0.0, 28.0),
    ("wrist_2", "0 0.093 0", 0.0, "0 0 1", 1.2, 0.04, 0.12, 0.0, 28.0),
    ("wrist_3", "0 0 0.095", 0.0, "0 1 0", 0.4, 0.04, 0.08, 0.0, 28.0),
)


def urdf() -> str:
    parts = ['<robot name="ur_like"><link name="base"/>']
    parent = "base"
    for name, origin, pitch, axis, mass, radius, length, centre, effort in LINKS:
        across, along = mass * (3 * radius**2 + length**2) / 12, mass * radius**2 / 2
        parts.append(f"""
<link name="{name}_link"><inertial><origin xyz="0 0 {centre}"/><mass value="{mass}"/>
<inertia ixx="{across}" ixy="0" ixz="0" iyy="{across}" iyz="0" izz="{along}"/></inertial>
<collision><origin xyz="0 0 {centre}"/><geometry><cylinder radius="{radius}" length="{length}"/></geometry>
</collision></link><joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{name}_link"/>
<origin xyz="{origin}" rpy="0 {pitch} 0"/><axis xyz="{axis}"/>
<limit lower="-3.1" upper="3.1" effort="{effort}" velocity="3.1"/></joint>""")
        parent = f"{name}_link"
    return "".join(parts) + "</robot>"


def write_log(path: Path, log: cs.Log) -> None:
    """Stands in for the recorder of the robot."""
    names = ["timestamp", *(f"actual_{kind}_{n}" for kind in ("q", "qd", "current") for n in range(robot.nv))]
    table = np.column_stack([log.time, log.q, log.v, log.tau / TORQUE_CONSTANTS])
    np.savetxt(path, table, delimiter=",", header=",".join(names), comments="")


def push(robot: cs.Robot, link: str, place: list[float], start: float) -> sim.PersonContact:
    """60 N on the place of the surface that is nearest to `place`."""
    face = robot.surface(link).closest_points([place])
    force = -60.0 * face.normals[0]
    return sim.PersonContact(link, face.points[0], force, start=start, duration=0.8, rise=0.1)


with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    (folder / "arm.urdf").write_text(urdf())
    robot = cs.Robot.from_urdf(folder / "arm.urdf")

    # Two recordings of the arm: motion without contact, and work in which a person pushes it twice.
    arm = sim.ImperfectArm.motor_currents(robot, seed=2)
    plan = cs.exciting_motion(robot, 20.0, dt=DT, max_velocity=1.5, seed=0)
    motion = sim.JointMotion(plan.time, plan.q, plan.v, plan.a)
    write_log(folder / "free.csv", sim.record_imperfect(robot, arm, motion, seed=1).log)
    pushes = [
        push(robot, "elbow_link", [0.3, 0.05, 0.25], 5.0),
        push(robot, "wrist_3_link", [0.3, 0.2, 0.02], 11.0),
    ]
    motion = sim.random_moves(robot, 15.0, dt=DT, seed=6)
    write_log(folder / "work.csv", sim.record_imperfect(robot, arm, motion, pushes, seed=2).log)

    free, work = (
        cs.read_log(folder / file, robot, torque_constants=TORQUE_CONSTANTS)
        for file in ("free.csv", "work.csv")
    )

for line in free.reading.chosen:
    print(f"read: {line}")
calibration = cs.calibrate(robot, free)
print(f"Coulomb friction {np.round(calibration.friction.coulomb, 1)} Nm")
for note in calibration.notes:
    print(f"note: {note}")

for name, chosen in (("without", None), ("with", calibration)):
    result = cs.replay(work, cs.ContactMonitor(robot, dt=DT, calibration=chosen))
    share = 100.0 * result.ticks["collision"].mean()
    print(f"{name} calibration: {len(result.contacts)} contacts, {share:.0f} % of the time")
for contact in result.contacts:
    print(
        f"contact at {contact.start:.2f} s: {contact.link} ({100 * contact.link_probability:.0f} %), ", end=""
    )
    where = f"point within {100 * contact.region_radius:.0f} cm" if contact.located else "not located"
    print(f"{contact.peak_force:.0f} N, {where}")
