"""Published robots load, in the order and with the numbers of Pinocchio's own model."""

import numpy as np
import pinocchio as pin
import pytest
from described import describe_urdf
from robots import PACKAGE_DIRS, PUBLISHED, example

from contactsense.errors import GeometryError, ModelError

WIDTHS = {"free_flyer": (7, 6), "continuous": (2, 1), "revolute": (1, 1), "prismatic": (1, 1)}


def rebuilt(description):
    """A Pinocchio model made from nothing but the description."""
    makers = {
        "revolute": pin.JointModelRevoluteUnaligned,
        "prismatic": pin.JointModelPrismaticUnaligned,
    }
    model = pin.Model()
    for joint in description.joints:
        if joint.kind == "free_flyer":
            kind = pin.JointModelFreeFlyer()
        else:
            kind = makers["revolute" if joint.kind == "continuous" else joint.kind](joint.axis)
        index = model.addJoint(joint.parent, kind, pin.SE3(joint.placement), joint.name)
        # Pinocchio's constructor refuses inertias that its URDF reader takes.
        body = pin.Inertia.Zero()
        body.mass, body.lever, body.inertia = joint.mass, joint.com, joint.inertia
        model.appendBodyToJoint(index, body, pin.SE3.Identity())
    return model


def angles(model, description, q):
    """The configuration with (cos, sin) of continuous joints as angles."""
    parts = []
    for index, joint in enumerate(description.joints, start=1):
        part = q[model.joints[index].idx_q :][: model.joints[index].nq]
        parts.append([np.arctan2(part[1], part[0])] if joint.kind == "continuous" else part)
    return np.concatenate(parts) if parts else np.zeros(0)


@pytest.mark.parametrize("floating_base", [False, True])
@pytest.mark.parametrize("path", PUBLISHED)
def test_agrees_with_pinocchio(path, floating_base):
    root = (pin.JointModelFreeFlyer(),) if floating_base else ()
    model = pin.buildModelFromUrdf(str(path), *root)
    description = describe_urdf(path, package_dirs=PACKAGE_DIRS, floating_base=floating_base)

    assert description.name == model.name
    assert [joint.name for joint in description.joints] == list(model.names)[1:]
    assert [joint.parent for joint in description.joints] == list(model.parents)[1:]
    widths = [(model.joints[i].nq, model.joints[i].nv) for i in range(1, model.njoints)]
    assert [WIDTHS[joint.kind] for joint in description.joints] == widths
    bodies = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
    assert [(link.name, link.joint) for link in description.links] == [
        (f.name, f.parentJoint) for f in bodies
    ]
    for link, frame in zip(description.links, bodies, strict=True):
        np.testing.assert_allclose(link.placement, frame.placement.homogeneous, atol=1e-12)

    # Axis, placement and inertia together: the same dynamics in a random state.
    copy = rebuilt(description)
    generator = np.random.default_rng(1)
    v, a = generator.normal(size=(2, model.nv))
    q = pin.integrate(model, pin.neutral(model), generator.uniform(-1, 1, model.nv))
    expected = pin.rnea(model, model.createData(), q, v, a)
    actual = pin.rnea(copy, copy.createData(), angles(model, description, q), v, a)
    np.testing.assert_allclose(actual, expected, rtol=1e-10, atol=1e-10)


def test_what_is_odd_in_romeo_is_said():
    path = example("romeo_description/urdf/romeo_laas_small.urdf")
    warnings = "\n".join(describe_urdf(path, package_dirs=PACKAGE_DIRS).warnings)
    assert "have no mass (used as given): 'l_gripper', 'r_gripper'" in warnings
    assert "'LHipPitch_link'" in warnings
    assert "singular" in warnings


def test_meshes_of_unknown_kind_are_refused():
    path = example("romeo_description/urdf/romeo_laas_small.urdf")
    with pytest.raises(GeometryError, match=r"romeo/Torso.mesh' is of an unknown kind"):
        describe_urdf(path, package_dirs=PACKAGE_DIRS, geometry="visual")


def test_description_without_links_is_refused():
    with pytest.raises(ModelError, match="no links"):
        describe_urdf(example("ur_description/urdf/ur3.urdf"))
