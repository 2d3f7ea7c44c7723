"""A robot from a URDF: unusual parts cause warnings; an unusable part causes an error that names it."""

import logging
import tempfile
from pathlib import Path

import contactsense as cs

URDF = """
<robot name="two_links">
  <link name="base"/>
  <link name="upper">
    <inertial><origin xyz="0 0 0.2"/><mass value="2"/>
      <inertia ixx="0.03" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.002"/></inertial>
    <collision><origin xyz="0 0 0.2"/><geometry><cylinder radius="0.05" length="0.4"/></geometry></collision>
  </link>
  <link name="lower">
    <inertial><origin xyz="0 0 0.15"/><mass value="1"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.05"/></inertial>
    <collision><origin xyz="0 0 0.15"/><geometry><box size="0.06 0.06 0.3"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="50" velocity="3"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
    <origin xyz="0 0 0.4"/><axis xyz="0 2 0"/><limit lower="-2" upper="2" effort="50" velocity="3"/></joint>
</robot>
"""

# The warnings are printed below, so they need not be logged as well.
logging.getLogger("contactsense").setLevel(logging.ERROR)

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "two_links.urdf"
    path.write_text(URDF)

    robot = cs.Robot.from_urdf(path)  # meshes are read only from the URDF's folder and `package_dirs`
    print(robot)
    for warning in robot.warnings:
        print(f"warning: {warning}")

    held = cs.Robot.from_urdf(path, locked_joints={"elbow": 0.5})
    print(f"elbow locked: joints {held.joint_names}, links with a surface {held.link_names}")

    path.write_text(URDF.replace('radius="0.05"', 'radius="-0.05"'))
    try:
        cs.Robot.from_urdf(path)
    except cs.GeometryError as error:
        print(f"refused: {error}")
