"""Bad URDF files are refused with a typed error that names what is wrong; odd ones load with a warning."""

import math
import re

import numpy as np
import pytest
from bad_models import AB, BAD_MODELS, LIMIT, inertial
from described import describe_urdf
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from urdf_text import ARM, SOLID, joint, link, robot, shape, write

from contactsense.errors import ContactSenseError, GeometryError, InputError, ModelError
from contactsense.loading.description import RobotDescription


def test_arm_is_described_as_written(tmp_path):
    description = describe_urdf(write(tmp_path, ARM), gravity=(0, 0, 9))
    assert description.name == "arm"
    assert [j.name for j in description.joints] == ["shoulder", "elbow", "rail"]
    assert [j.kind for j in description.joints] == ["revolute", "continuous", "prismatic"]
    assert [j.parent for j in description.joints] == [0, 1, 2]
    assert [(entry.name, entry.joint) for entry in description.links] == [
        ("base", 0),
        ("upper", 1),
        ("lower", 2),
        ("tool", 2),
        ("slide", 3),
    ]
    shoulder, elbow, _ = description.joints
    np.testing.assert_allclose(elbow.axis, [0, 0.6, 0.8], atol=1e-15)
    assert (shoulder.lower, shoulder.upper, shoulder.effort, shoulder.velocity) == (-1, 2, 30, 3)
    assert (elbow.lower, elbow.upper, elbow.effort) == (-math.inf, math.inf, math.inf)
    assert elbow.velocity == math.inf
    assert shoulder.mass == 1
    np.testing.assert_allclose(shoulder.com, [0, 0, 0.1], atol=1e-15)
    shapes = {entry.name: [(g.kind, g.params) for g in entry.geometry] for entry in description.links}
    assert shapes["upper"] == [("box", (0.1, 0.2, 0.3))]
    assert shapes["lower"] == [("cylinder", (0.05, 0.3)), ("sphere", (0.1,))]
    assert shapes["tool"] == [("capsule", (0.02, 0.1))]
    np.testing.assert_array_equal(description.gravity, [0, 0, 9])
    assert description.warnings == []


def test_floating_base_is_joint_one(tmp_path):
    description = describe_urdf(write(tmp_path, ARM), floating_base=True)
    base = description.joints[0]
    assert (base.kind, base.parent, base.lower, base.upper) == ("free_flyer", 0, -math.inf, math.inf)
    assert base.mass == 1
    assert [entry.joint for entry in description.links] == [1, 2, 3, 3, 4]


@pytest.mark.parametrize("case", BAD_MODELS)
def test_bad_model_is_refused_by_name(case, tmp_path):
    text, message = BAD_MODELS[case]
    with pytest.raises(ModelError, match=message):
        describe_urdf(write(tmp_path, text))


def test_missing_file_is_named(tmp_path):
    with pytest.raises(ModelError, match=re.escape(str(tmp_path / "none.urdf"))):
        describe_urdf(tmp_path / "none.urdf")
    with pytest.raises(ModelError, match=re.escape(str(tmp_path))):
        describe_urdf(tmp_path)


def test_name_of_the_floating_base_joint_is_reserved(tmp_path):
    path = write(tmp_path, ARM.replace("shoulder", "root_joint"))
    assert describe_urdf(path).joints[0].name == "root_joint"
    with pytest.raises(ModelError, match="'root_joint'"):
        describe_urdf(path, floating_base=True)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('<box size="0.1 -1 0.1"/>', "link 'a'.*<box> must be positive"),
        ('<box size="0.1 0.1"/>', "link 'a'.*3 finite numbers"),
        ("<box/>", "link 'a'.*'size'"),
        ('<sphere radius="-1"/>', "link 'a'.*<sphere> must be positive"),
        ('<sphere radius="nan"/>', "link 'a'.*'radius'"),
        ('<cylinder radius="1"/>', "link 'a'.*needs the attribute 'length'"),
        ('<capsule radius="1" length="-1"/>', "link 'a'.*<capsule> must be positive"),
        ('<cone radius="1" length="1"/>', "link 'a'.*unknown shape <cone>; supported: mesh, box"),
        ("", "link 'a'.*needs one <geometry>"),
        ("<mesh/>", "link 'a'.*'filename'"),
        ('<mesh filename="a.stl" scale="1 1 0"/>', "link 'a'.*must not be zero"),
        ('<mesh filename="a.stl" scale="1 1 inf"/>', "link 'a'.*'scale'"),
    ],
)
def test_bad_shape_is_refused_by_link(body, message, tmp_path):
    path = write(tmp_path, robot(link("a", SOLID + shape(body))))
    with pytest.raises(GeometryError, match=message):
        describe_urdf(path)
    # Shapes of the other role are not looked at.
    assert describe_urdf(path, geometry="visual").links[0].geometry == []


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"geometry": "both"}, "'collision', 'visual' or 'collision_or_visual', not 'both'"),
        ({"geometry": None}, "geometry: must be a string"),
        ({"gravity": (0, 0)}, "gravity: must be 3"),
        ({"gravity": (0, 0, math.nan)}, "gravity: must be 3"),
        ({"gravity": "down"}, "gravity: must be 3"),
        ({"package_dirs": 3}, "package_dirs"),
        ({"package_dirs": [3]}, "package_dirs"),
    ],
)
def test_bad_argument_is_named(arguments, message, tmp_path):
    with pytest.raises(InputError, match=message):
        describe_urdf(write(tmp_path, ARM), **arguments)


@pytest.mark.parametrize("path", [3, None, b"arm.urdf", "arms/\0/arm.urdf", "\0"])
def test_bad_path_is_an_input_error(path):
    with pytest.raises(InputError, match="path: must be"):
        describe_urdf(path)


@pytest.mark.parametrize(
    "head",
    [
        '<?xml version="1.0" encoding="klingon"?>',
        '<?xml version="1.0" encoding="utf-32"?>',
        '<!DOCTYPE r [<!ENTITY e SYSTEM "file:///etc/hostname">]>',
    ],
)
def test_foreign_xml_is_refused(head, tmp_path):
    with pytest.raises(ModelError, match="not XML"):
        describe_urdf(write(tmp_path, head + '<robot name="&e;"><link name="a"/></robot>'))


def test_mimic_joints_stay_independent_with_one_warning(tmp_path):
    mimic = joint("k", "b", "c", inside='<axis xyz="1 0 0"/>' + LIMIT + '<mimic joint="j"/>')
    description = describe_urdf(write(tmp_path, robot(AB, link("c"), joint("j", "a", "b"), mimic)))
    assert [entry.name for entry in description.joints] == ["j", "k"]
    assert [w for w in description.warnings if "mimic" in w] == [
        "Joints that mimic another (kept as independent joints): 'k' ('j')"
    ]


@pytest.mark.parametrize(
    ("body", "warning"),
    [
        (link("b", inertial(ixx="5")) + joint("j", "a", "b"), "no rigid body has.*'b'"),
        (link("b", "") + joint("j", "a", "b"), "have no mass.*'b'"),
        (link("b", "") + joint("j", "a", "b"), "mass matrix is singular.*'j'"),
        (
            link("b", inertial("0", ixx="0", iyy="0", izz="0")) + joint("j", "a", "b"),
            "matrix is singular.*'j'",
        ),
        (link("b") + joint("j", "a", "b", inside='<axis xyz="0 0 2"/>' + LIMIT), "not of unit length.*'j'"),
        (
            link("b") + joint("j", "a", "b", inside='<limit lower="1" upper="-1" effort="1" velocity="1"/>'),
            "leave no range.*'j'",
        ),
        (link("b") + joint("j", "a", "b"), "no surface"),
    ],
)
def test_oddity_is_warned_of(body, warning, tmp_path):
    description = describe_urdf(write(tmp_path, robot(link("a"), body)))
    assert any(re.search(warning, text) for text in description.warnings), description.warnings


def test_zero_mass_link_inside_a_chain_is_not_called_singular(tmp_path):
    text = robot(
        link("a"), link("b", ""), link("c"), joint("j", "a", "b"), joint("k", "b", "c", inside=LIMIT)
    )
    assert not any("singular" in text for text in describe_urdf(write(tmp_path, text)).warnings)


def test_nameless_robot_takes_the_file_name(tmp_path):
    path = write(tmp_path, ARM.replace(' name="arm"', ""), "walker.urdf")
    assert describe_urdf(path).name == "walker"


def load_or_refuse(path):
    try:
        assert isinstance(describe_urdf(path), RobotDescription)
    except ContactSenseError as error:
        assert str(error)  # noqa: PT017


@settings(max_examples=400, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(changes=st.lists(st.tuples(st.integers(0, len(ARM) - 1), st.integers(0, 255)), min_size=1, max_size=6))
def test_corrupt_bytes_raise_nothing_but_our_errors(changes, tmp_path):
    text = bytearray(ARM.encode())
    for position, byte in changes:
        text[position] = byte
    load_or_refuse(write(tmp_path, bytes(text)))


NUMBERS = [found.span() for found in re.finditer(r"(?<=[\" ])-?[\d.]+(?=[\" ])", ARM)][1:]


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    span=st.sampled_from(NUMBERS),
    number=st.one_of(
        st.floats().map(repr), st.sampled_from(["1e12", "-1e12", "1e-320", "0", "-0", "1,5", "٣", ""])
    ),
)
def test_any_number_in_any_place_raises_nothing_but_our_errors(span, number, tmp_path):
    load_or_refuse(write(tmp_path, ARM[: span[0]] + number + ARM[span[1] :]))


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(start=st.integers(0, len(ARM)), length=st.integers(1, 200))
def test_cut_text_raises_nothing_but_our_errors(start, length, tmp_path):
    load_or_refuse(write(tmp_path, ARM[:start] + ARM[start + length :]))


def test_zero_mass_is_warned_of(tmp_path):
    text = robot(link("a"), link("b", inertial("0")), joint("j", "a", "b"))
    warnings = describe_urdf(write(tmp_path, text)).warnings
    assert "These links move with a joint but have no mass (used as given): 'b'" in warnings
