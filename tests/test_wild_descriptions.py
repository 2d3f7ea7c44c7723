"""Descriptions as they are found in the wild: each loads, or is refused for a reason.

Both readers are tried: the package's, which builds with Pinocchio, and the core's own.
"""

import numpy as np
import pinocchio as pin
import pytest
from urdf_text import ARM, SOLID, joint, link, robot, shape, write

import contactsense as cs
from contactsense import _core

READERS = pytest.mark.parametrize(
    "read", [cs.Robot.from_urdf, _core._robot_from_urdf], ids=["package", "core"]
)
BALL = shape('<sphere radius="0.1"/>')


def two(of_a: str, of_b: str = BALL) -> str:
    return robot(link("a", SOLID + of_a), link("b", SOLID + of_b), joint("j", "a", "b"))


@READERS
@pytest.mark.parametrize(
    "body",
    [
        '<sphere radius="0"/>',
        '<cylinder radius="0" length="0"/>',
        '<cylinder radius="0.1" length="0.0"/>',
        '<box size="0 0 0"/>',
        '<box size="1 1 0"/>',
        '<capsule radius="0" length="1"/>',
        '<plane normal="0 0 1" size="1 1"/>',
        "<plane><normal>0 0 1</normal></plane>",
    ],
)
def test_shape_without_extent_is_left_out(read, body, tmp_path):
    found = read(write(tmp_path, two(shape(body))))
    assert found.link_names == ("b",)
    (warning,) = [text for text in found.warnings if "left out" in text]
    assert warning.startswith("link 'a': <collision>")


@READERS
@pytest.mark.parametrize(
    "text",
    [
        "\ufeff" + ARM,
        "\n\n  " + ARM,
        "\ufeff\n" + ARM,
        ARM.replace("</robot>", "<ns:plugin ns:name='x'><gz:depth/></ns:plugin></robot>"),
        ARM.replace("<robot", '<robot xmlns:xacro="http://ros.org/wiki/xacro"'),
        ARM.replace("</robot>", "<material name='m'><texture/></material><gazebo/></robot>"),
        ARM.replace("</robot>", '<transmission name="t"><joint name="elbow"/></transmission></robot>'),
    ],
    ids=["mark", "blank lines", "both", "unbound prefix", "bound prefix", "material", "transmission"],
)
def test_text_is_read_as_urdfdom_reads_it(read, text, tmp_path):
    found = read(write(tmp_path, text))
    plain = read(write(tmp_path, ARM, "plain.urdf"))
    assert (found.joint_names, found.link_names) == (plain.joint_names, plain.link_names)
    q = plain.random_configuration(1)
    np.testing.assert_array_equal(found.mass_matrix(q), plain.mass_matrix(q))


@READERS
def test_floating_joint_from_the_root_is_a_floating_base(read, tmp_path):
    text = ARM.replace('<link name="base">', f'{link("world", "")}<link name="base">')
    text = text.replace("</robot>", joint("free", "world", "base", "floating", "") + "</robot>")
    found = read(write(tmp_path, text))
    assert found.floating_base
    assert found.joint_kinds[0] == "free_flyer"
    assert found.joint_names == ("free", "shoulder", "elbow", "rail")
    assert found.actuated_joint_names == ("shoulder", "elbow", "rail")
    model = pin.buildModelFromXML(text)
    data = model.createData()
    q = np.array(found.random_configuration(3))
    rng = np.random.default_rng(0)
    v, a = rng.standard_normal((2, found.nv))
    np.testing.assert_allclose(found.inverse_dynamics(q, v, a), pin.rnea(model, data, q, v, a), atol=1e-10)
    for refused in (
        {"path": write(tmp_path, text), "floating_base": True},
        {"path": write(tmp_path, text.replace('shoulder" type="revolute', 'shoulder" type="floating'))},
    ):
        with pytest.raises(cs.ModelError, match="floats inside the robot; a joint can float from the root"):
            read(**refused)


@READERS
def test_visual_shapes_where_there_are_no_others(read, tmp_path):
    visual = shape('<box size="0.1 0.2 0.3"/>', "visual")
    path = write(tmp_path, two(visual, BALL + visual))
    assert read(path).link_names == ("b",)
    both = read(path, geometry="collision_or_visual")
    assert both.link_names == ("a", "b")
    assert both.surface("b").area == pytest.approx(4 * np.pi * 0.01)
    assert read(path, geometry="visual").surface("b").area == pytest.approx(0.22)
    bare = write(tmp_path, two(visual, visual), "bare.urdf")
    assert read(bare).link_names == ()
    (warning,) = [text for text in read(bare).warnings if "surface" in text]
    assert 'geometry="visual" takes the <visual> shapes that 2 links have' in warning
    nothing = write(tmp_path, two("", ""), "nothing.urdf")
    (warning,) = [text for text in read(nothing).warnings if "surface" in text]
    assert "geometry=" not in warning


@READERS
def test_rotor_inertia_is_added_to_the_mass_matrix(read, tmp_path):
    path = write(tmp_path, ARM)
    plain = read(path)
    given = {"elbow": 0.25, "rail": 3}
    if read == cs.Robot.from_urdf:
        geared = read(path, armature=given)
    else:
        geared = read(path, armature=list(given.items()))
    q = plain.random_configuration(2)
    np.testing.assert_allclose(
        np.diag(geared.mass_matrix(q) - plain.mass_matrix(q)), [0.0, 0.25, 3.0], atol=1e-14
    )


@pytest.mark.parametrize(
    ("armature", "message"),
    [
        ({"wrist": 1.0}, "armature: .*'shoulder', 'elbow', 'rail'; 'wrist' is none of them"),
        ({"elbow": -1.0}, "armature: the value of 'elbow' must not be negative"),
        ({"elbow": np.inf}, "armature: the value of 'elbow' must be a finite number"),
        ([("elbow", 1.0)], "armature: must be"),
    ],
)
def test_wrong_armature_is_refused(armature, message, tmp_path):
    with pytest.raises(cs.InputError, match=message):
        cs.Robot.from_urdf(write(tmp_path, ARM), armature=armature)


@READERS
def test_capsules_are_capsules(read, tmp_path):
    found = read(write(tmp_path, two(shape('<capsule radius="0.1" length="0.4"/>'))))
    assert found.surface("a").area == pytest.approx(2 * np.pi * 0.1 * 0.4 + 4 * np.pi * 0.01)


def test_pinocchio_models_are_kept(tmp_path):
    found = cs.Robot.from_urdf(write(tmp_path, ARM))
    assert found.model.nq == found.nq
    shapes = {item.name: type(item.geometry).__name__ for item in found.geometry_model.geometryObjects}
    assert shapes == {"upper_0": "Box", "lower_0": "Cylinder", "lower_1": "Sphere", "tool_0": "Capsule"}
    assert found.geometry_model is found.geometry_model
    again = cs.Robot.from_pinocchio(found.model, found.geometry_model)
    assert again.model is found.model
    assert again.link_names == found.link_names
    for name in found.link_names:
        assert again.surface(name).area == pytest.approx(found.surface(name).area)


@READERS
def test_limits_are_those_of_the_file(read, tmp_path):
    found = read(write(tmp_path, ARM), floating_base=True)
    np.testing.assert_array_equal(
        found.position_limits, [*[[-np.inf, np.inf]] * 7, [-1, 2], *[[-np.inf, np.inf]] * 2, [-1, 2]]
    )
    np.testing.assert_array_equal(found.effort_limits, [0] * 6 + [30, np.inf, 30])
    np.testing.assert_array_equal(found.velocity_limits, [np.inf] * 6 + [3, np.inf, 3])
    for array in (found.position_limits, found.effort_limits, found.velocity_limits, found.gravity):
        assert not array.flags.writeable
