"""Magnitudes and sizes of robots that are refused or loaded."""

import numpy as np
import pinocchio as pin
import pytest

import contactsense as cs


def chain(joints, mass="1", moment="0.01"):
    inertial = (
        f'<inertial><mass value="{mass}"/><inertia ixx="{moment}" iyy="{moment}" izz="{moment}" '
        'ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    text = ['<robot name="chain"><link name="l0"/>']
    for k in range(1, joints + 1):
        text.append(f'<link name="l{k}">{inertial}</link>')
        text.append(
            f'<joint name="j{k}" type="continuous"><parent link="l{k - 1}"/><child link="l{k}"/>'
            '<axis xyz="0 1 0"/><origin xyz="0 0 0.1"/></joint>'
        )
    return "".join([*text, "</robot>"])


def load(folder, text, **options):
    path = folder / "robot.urdf"
    path.write_text(text)
    return cs.Robot.from_urdf(path, **options)


@pytest.mark.parametrize("size", ["1e-320", "1e-70", "1e70"])
def test_a_mass_or_inertia_that_cannot_be_computed_with_is_named(tmp_path, size):
    with pytest.raises(cs.ModelError, match=r"mass|inertia"):
        load(tmp_path, chain(1, moment=size))
    with pytest.raises(cs.ModelError, match="mass"):
        load(tmp_path, chain(1, mass=size))


@pytest.mark.parametrize("gravity", [(0, 0, 1e308), (1e60, 0, 0)])
def test_a_gravity_that_cannot_be_computed_with_is_named(tmp_path, gravity):
    with pytest.raises(cs.ContactSenseError, match="gravity"):
        load(tmp_path, chain(1), gravity=gravity)
    model = pin.buildModelFromXML(chain(1))
    model.gravity.linear = np.array(gravity, dtype=float)
    with pytest.raises(cs.ContactSenseError, match="gravity"):
        cs.Robot.from_pinocchio(model, pin.GeometryModel())


def test_a_robot_of_many_joints_needs_no_data_of_pinocchio(tmp_path, monkeypatch):
    """`pinocchio.Data` takes memory with the cube of the joints."""

    def refuse(*_):
        raise AssertionError("pinocchio.Data was made")

    monkeypatch.setattr(pin.Model, "createData", refuse)
    robot = load(tmp_path, chain(300))
    assert robot.nv == 300
    with pytest.raises(cs.InputError, match=r"locked_joints: .* up to 200"):
        load(tmp_path, chain(201), locked_joints=["j1"])
