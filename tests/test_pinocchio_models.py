"""Pinocchio models: the same description as from their URDF, and refusals by name."""

import coal
import numpy as np
import pinocchio as pin
import pytest
from described import describe_urdf
from robots import PACKAGE_DIRS, PUBLISHED
from urdf_text import ARM, joint, link, robot, shape

import contactsense as cs
from contactsense.errors import GeometryError, InputError, ModelError
from contactsense.loading.describe_pinocchio import describe_pinocchio

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def geometry_object(shape, parent_joint=1, parent_frame=None, placement=None, name="shape"):
    frame = () if parent_frame is None else (parent_frame,)
    return pin.GeometryObject(name, parent_joint, *frame, placement or pin.SE3.Identity(), shape)


def arm():
    return pin.buildModelFromXML(robot(link("base"), link("upper"), joint("shoulder", "base", "upper")))


def with_shape(shape, model=None, **place):
    geometry = pin.GeometryModel()
    geometry.addGeometryObject(geometry_object(shape, **place))
    return describe_pinocchio(model or arm(), geometry)


def mesh():
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(FACES), len(TETRAHEDRON))
    model.addVertices(TETRAHEDRON)
    model.addTriangles(FACES)
    model.endModel()
    return model


@pytest.mark.parametrize("path", PUBLISHED)
def test_agrees_with_the_urdf(path):
    # Pinocchio finds no meshes by relative names.
    text = path.read_text().replace('filename="meshes/', f'filename="file://{path.parent}/meshes/')
    # An extension of Pinocchio's by which a cylinder becomes a capsule; it is not read from the URDF here.
    extended = "<collision_checking>" in text
    model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    packages = [str(folder) for folder in PACKAGE_DIRS]
    geometry = pin.buildGeomFromUrdfString(model, text, pin.GeometryType.COLLISION, package_dirs=packages)
    ours = describe_urdf(path, package_dirs=PACKAGE_DIRS, floating_base=True)
    theirs = describe_pinocchio(model, geometry)
    assert theirs.name == ours.name
    np.testing.assert_array_equal(theirs.gravity, ours.gravity)
    for a, b in zip(theirs.joints, ours.joints, strict=True):
        assert (a.name, a.parent, a.kind) == (b.name, b.parent, b.kind)
        for field in (
            "axis",
            "placement",
            "mass",
            "com",
            "inertia",
            "armature",
            "lower",
            "upper",
            "effort",
            "velocity",
        ):
            np.testing.assert_allclose(getattr(a, field), getattr(b, field), atol=1e-12, err_msg=field)
    for a, b in zip(theirs.links, ours.links, strict=True):
        assert (a.name, a.joint, len(a.geometry)) == (b.name, b.joint, len(b.geometry))
        np.testing.assert_allclose(a.placement, b.placement, atol=1e-12)
        for one, other in zip(a.geometry, b.geometry, strict=True):
            np.testing.assert_allclose(one.placement, other.placement, atol=1e-12)
            if not extended:
                assert one.kind == other.kind.removesuffix("_file")
            if one.kind != "mesh":
                np.testing.assert_allclose(one.params, other.params, rtol=1e-12)


@pytest.mark.parametrize(
    ("shape", "kind", "params"),
    [
        (coal.Box(0.1, 0.2, 0.3), "box", (0.1, 0.2, 0.3)),
        (coal.Sphere(0.1), "sphere", (0.1,)),
        (coal.Cylinder(0.1, 0.4), "cylinder", (0.1, 0.4)),
        (coal.Capsule(0.1, 0.4), "capsule", (0.1, 0.4)),
    ],
)
def test_primitives(shape, kind, params):
    (found,) = with_shape(shape).links[1].geometry
    assert found.kind == kind
    np.testing.assert_allclose(found.params, params, rtol=1e-15)


def test_meshes_keep_vertices_and_triangles():
    (found,) = with_shape(mesh()).links[1].geometry
    vertices, triangles = found.params
    np.testing.assert_array_equal(vertices, TETRAHEDRON)
    np.testing.assert_array_equal(triangles, FACES)
    assert (vertices.dtype, triangles.dtype) == (np.float64, np.uint32)


def test_convex_hulls_are_meshes():
    shape = mesh()
    shape.buildConvexHull(True, "Qt")
    vertices, triangles = with_shape(shape.convex).links[1].geometry[0].params
    assert {tuple(row) for row in vertices} == {tuple(row) for row in TETRAHEDRON}
    assert triangles.shape == (4, 3)


@pytest.mark.parametrize("scale", [(1, 1, 1), (2, -1, 0.5), (-1, -1, 1), (-1, -2, -3)])
def test_scaled_mesh_keeps_its_size_and_outside(scale, tmp_path):
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in TETRAHEDRON)
    faces = "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
    (tmp_path / "part.obj").write_text(corners + faces)
    row = " ".join(map(str, scale))
    text = robot(link("a", shape(f'<mesh filename="file://{tmp_path}/part.obj" scale="{row}"/>')))
    model = pin.buildModelFromXML(text)
    geometry = pin.buildGeomFromUrdfString(model, text, pin.GeometryType.COLLISION)
    vertices, triangles = describe_pinocchio(model, geometry).links[0].geometry[0].params
    volume = np.linalg.det(vertices[triangles]).sum() / 6
    assert volume == pytest.approx(abs(np.prod(scale)) / 6)


@pytest.mark.parametrize(
    ("shape", "message"),
    [
        (coal.Ellipsoid(1, 1, 1), "'shape' is a Ellipsoid; supported: triangle meshes"),
        (coal.Halfspace(), "'shape' is a Halfspace"),
        (coal.Sphere(0.0), "'shape': sizes must be positive"),
        (coal.BVHModelOBBRSS(), "'shape' has no triangles"),
    ],
)
def test_unsupported_shape_is_named(shape, message):
    with pytest.raises(GeometryError, match=message):
        with_shape(shape)


def test_shape_belongs_to_the_link_it_sits_behind():
    model = arm()
    body = model.getFrameId("upper", pin.FrameType.BODY)
    mount = pin.SE3(np.eye(3), np.array([0, 0, 0.2]))
    hand = model.addFrame(pin.Frame("hand", 1, body, mount, pin.FrameType.BODY))
    tip = model.addFrame(pin.Frame("tip", 1, hand, mount, pin.FrameType.OP_FRAME))
    place = pin.SE3(np.eye(3), np.array([0.5, 0, 0]))
    base, upper, behind = with_shape(coal.Sphere(0.1), model, parent_frame=tip, placement=place).links
    assert (base.name, upper.name, behind.name) == ("base", "upper", "hand")
    assert (base.geometry, upper.geometry) == ([], [])
    np.testing.assert_allclose(behind.geometry[0].placement[:3, 3], [0.5, 0, -0.2])


@pytest.mark.parametrize("parent_frame", [None, "shoulder"])
def test_shape_of_a_joint_belongs_to_its_first_link(parent_frame):
    model = arm()
    frame = model.getFrameId(parent_frame) if parent_frame else None
    description = with_shape(coal.Sphere(0.1), model, parent_frame=frame)
    assert [len(entry.geometry) for entry in description.links] == [0, 1]


def test_joint_without_body_frame_lends_its_name():
    model = pin.Model()
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "hinge")
    model.appendBodyToJoint(1, pin.Inertia.Random(), pin.SE3.Identity())
    description = with_shape(coal.Sphere(0.1), model)
    assert [(entry.name, entry.joint, len(entry.geometry)) for entry in description.links] == [
        ("hinge", 1, 1)
    ]
    assert any("'hinge'" in warning for warning in description.warnings)


def test_gravity_and_armature_are_those_of_the_model():
    model = arm()
    model.gravity.linear = np.array([1.0, 2.0, 3.0])
    model.armature = np.array([0.25])
    description = describe_pinocchio(model, pin.GeometryModel())
    np.testing.assert_array_equal(description.gravity, [1, 2, 3])
    assert description.joints[0].armature == 0.25
    assert any("no surface" in warning for warning in description.warnings)
    model.gravity.angular = np.array([0.0, 0.0, 1.0])
    with pytest.raises(ModelError, match="gravity"):
        describe_pinocchio(model, pin.GeometryModel())


@pytest.mark.parametrize("arguments", [(None, None), (arm(), None), ("arm.urdf", pin.GeometryModel())])
def test_wrong_types_are_refused(arguments):
    with pytest.raises(InputError, match=r"must be a pinocchio\.(Model|GeometryModel)"):
        describe_pinocchio(*arguments)


def test_geometry_of_another_model_is_refused():
    with pytest.raises(InputError, match="'shape'"):
        with_shape(coal.Sphere(0.1), parent_joint=7)


@pytest.mark.parametrize(
    "kind",
    [
        pin.JointModelSpherical(),
        pin.JointModelSphericalZYX(),
        pin.JointModelPlanar(),
        pin.JointModelTranslation(),
        pin.JointModelHX(),
        pin.JointModelUniversal(),
        pin.JointModelComposite(pin.JointModelRX(), pin.SE3.Identity()),
    ],
    ids=lambda kind: kind.shortname(),
)
def test_unsupported_joint_is_named(kind):
    model = pin.Model()
    model.addJoint(0, kind, pin.SE3.Identity(), "ball")
    with pytest.raises(ModelError, match=r"joint 'ball' is a JointModel.*supported: revolute"):
        describe_pinocchio(model, pin.GeometryModel())


def test_mimic_joint_is_named():
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    follower = joint("follower", "b", "c", inside=limit + '<mimic joint="leader" multiplier="2"/>')
    text = robot(link("a"), link("b"), link("c"), joint("leader", "a", "b"), follower)
    model = pin.buildModelFromXML(text, mimic=True)
    with pytest.raises(ModelError, match="joint 'follower' is a JointModelMimic"):
        describe_pinocchio(model, pin.GeometryModel())


def test_free_flyer_is_only_for_the_root():
    model = pin.Model()
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "hinge")
    model.addJoint(1, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "flyer")
    with pytest.raises(ModelError, match="joint 'flyer' is a free flyer"):
        describe_pinocchio(model, pin.GeometryModel())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mass": -1.0}, "joint 'shoulder'.*mass must not be negative"),
        ({"inertia": -np.eye(3)}, "joint 'shoulder'.*negative principal moment"),
        ({"lever": np.array([np.nan, 0, 0])}, "joint 'shoulder'.*must be finite"),
    ],
)
def test_impossible_body_is_refused(change, message):
    model = arm()
    for attribute, value in change.items():
        setattr(model.inertias[1], attribute, value)
    with pytest.raises(ModelError, match=message):
        cs.Robot.from_pinocchio(model, pin.GeometryModel())


def test_placement_that_is_not_rigid_is_refused():
    model = arm()
    model.jointPlacements[1] = pin.SE3(1.01 * np.eye(3), np.zeros(3))
    with pytest.raises(ModelError, match=r"joint 'shoulder'.*rotation.*off orthonormal"):
        cs.Robot.from_pinocchio(model, pin.GeometryModel())
    mirror = pin.SE3(np.diag([1.0, 1.0, -1.0]), np.zeros(3))
    geometry = pin.GeometryModel()
    geometry.addGeometryObject(geometry_object(coal.Sphere(0.1), placement=mirror))
    with pytest.raises(ModelError, match=r"link 'upper'.*determinant"):
        cs.Robot.from_pinocchio(arm(), geometry)


def test_axes_of_every_joint_model_agree_with_the_urdf(tmp_path):
    (tmp_path / "arm.urdf").write_text(ARM.replace("0 1 0", "0 0 -1"))
    model = pin.buildModelFromUrdf(str(tmp_path / "arm.urdf"))
    geometry = pin.GeometryModel()
    axes = [entry.axis for entry in describe_pinocchio(model, geometry).joints]
    np.testing.assert_allclose(axes, [[0, 0, -1], [0, 0.6, 0.8], [0, 0, -1]], atol=1e-15)


def test_pinocchio_sample_models_load():
    for model, geometry in (
        (pin.buildSampleModelManipulator(), pin.buildSampleGeometryModelManipulator),
        (pin.buildSampleModelHumanoid(), pin.buildSampleGeometryModelHumanoid),
    ):
        description = describe_pinocchio(model, geometry(model))
        assert sum(len(entry.geometry) for entry in description.links) == geometry(model).ngeoms
