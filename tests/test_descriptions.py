"""The robot descriptions inside the package: complete, physical, symmetric, and true to their figures."""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from robots import SHARED

ROOT = Path(__file__).resolve().parents[1]
DESCRIPTIONS = ROOT / "python" / "contactsense" / "descriptions"
ROBOTS = ("iiwa14", "atlas")
SIZES = {
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "sphere": ("radius",),
}


def _xml(name: str) -> ET.Element:
    return ET.parse(DESCRIPTIONS / f"{name}.urdf").getroot()


def _model(path: Path, *, floating: bool) -> pin.Model:
    """Kinematics and inertias only; some URDF parsers know no capsule."""
    root = ET.parse(path).getroot()
    for link in root.findall("link"):
        for part in link.findall("visual") + link.findall("collision"):
            link.remove(part)
    text = ET.tostring(root, encoding="unicode")
    if floating:
        return pin.buildModelFromXML(text, pin.JointModelFreeFlyer())
    return pin.buildModelFromXML(text)


def _own(name: str, *, floating: bool = False) -> pin.Model:
    return _model(DESCRIPTIONS / f"{name}.urdf", floating=floating)


def _primitives(link: ET.Element, kind: str = "collision") -> list[tuple[str, np.ndarray]]:
    shapes = []
    for part in link.findall(kind):
        shape = part.find("geometry")[0]
        values = " ".join(shape.get(key) for key in SIZES[shape.tag]).split()
        shapes.append((shape.tag, np.array(values, dtype=float)))
    return shapes


@pytest.mark.parametrize(("name", "nv", "mass"), [("iiwa14", 7, 30.61), ("atlas", 30, 174.308)])
def test_counts_and_total_mass(name: str, nv: int, mass: float) -> None:
    model = _own(name)
    assert (model.nq, model.nv) == (nv, nv)
    # What is welded to the world does not count in Pinocchio's sum.
    root_mass = float(_xml(name).find("link/inertial/mass").get("value"))
    assert pin.computeTotalMass(model) == pytest.approx(mass - root_mass, abs=5e-4)
    floating = _own(name, floating=True)
    assert (floating.nq, floating.nv) == (nv + 7, nv + 6)
    assert pin.computeTotalMass(floating) == pytest.approx(mass, abs=5e-4)


def test_atlas_loads_as_it_stands() -> None:
    """Boxes and cylinders only: any URDF parser reads it."""
    path = str(DESCRIPTIONS / "atlas.urdf")
    model = pin.buildModelFromUrdf(path)
    geometry = pin.buildGeomFromUrdf(model, path, pin.GeometryType.COLLISION)
    written = sum(len(link.findall("collision")) for link in _xml("atlas").findall("link"))
    assert len(geometry.geometryObjects) == written


@pytest.mark.parametrize("name", ROBOTS)
def test_every_inertia_is_physical(name: str) -> None:
    for link in _xml(name).findall("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        i = {key: float(value) for key, value in inertial.find("inertia").attrib.items()}
        tensor = [
            [i["ixx"], i["ixy"], i["ixz"]],
            [i["ixy"], i["iyy"], i["iyz"]],
            [i["ixz"], i["iyz"], i["izz"]],
        ]
        a, b, c = np.linalg.eigvalsh(np.array(tensor))
        assert a > 0, link.get("name")
        assert a + b >= c, link.get("name")
        assert float(inertial.find("mass").get("value")) > 0, link.get("name")


@pytest.mark.parametrize("name", ROBOTS)
def test_geometry_is_exact_primitives_and_has_mass(name: str) -> None:
    root = _xml(name)
    assert root.find(".//mesh") is None
    for link in root.findall("link"):
        shapes = _primitives(link)
        assert len(shapes) <= 4
        visual = _primitives(link, "visual")
        assert [kind for kind, _ in visual] == [kind for kind, _ in shapes]
        for (_, a), (_, b) in zip(shapes, visual, strict=True):
            np.testing.assert_array_equal(a, b)
        assert all((size > 0).all() for _, size in shapes)
        assert bool(shapes) == (link.find("inertial") is not None), link.get("name")
        if name == "atlas":
            assert {kind for kind, _ in shapes} <= {"box", "cylinder"}


@pytest.mark.parametrize("name", ROBOTS)
def test_file_is_small(name: str) -> None:
    assert (DESCRIPTIONS / f"{name}.urdf").stat().st_size < 60_000


def test_iiwa_names_limits_and_reach() -> None:
    model = _own("iiwa14")
    assert list(model.names)[1:] == [f"iiwa_joint_{i}" for i in range(1, 8)]
    assert {f"iiwa_link_{i}" for i in range(8)} | {"iiwa_link_ee"} <= {f.name for f in model.frames}
    np.testing.assert_allclose(
        np.rad2deg(model.upperPositionLimit), [170, 120, 170, 120, 170, 120, 175], atol=1e-3
    )
    np.testing.assert_allclose(model.lowerPositionLimit, -model.upperPositionLimit)
    data = model.createData()
    pin.framesForwardKinematics(model, data, np.zeros(7))
    flange = data.oMf[model.getFrameId("iiwa_link_ee")].translation
    # 360 + 420 + 400 + 126 mm: the maker's drawing, arm upright.
    np.testing.assert_allclose(flange, [0, 0, 1.306], atol=1e-9)


def test_atlas_joint_groups() -> None:
    names = list(_own("atlas").names)[1:]
    count = {
        prefix: sum(n.startswith(prefix) for n in names) for prefix in ("back", "neck", "l_arm", "r_arm")
    }
    assert count == {"back": 3, "neck": 1, "l_arm": 7, "r_arm": 7}
    assert sum("_leg_" in n for n in names) == 12


def _mirrored_posture(model: pin.Model, q: np.ndarray) -> np.ndarray:
    """The posture seen in a mirror: sides swapped, roll and yaw joints turned the other way."""
    mirrored = q.copy()
    for joint in range(2, model.njoints):
        name = model.names[joint]
        partner = {"l": "r", "r": "l"}.get(name[0]) if name[1] == "_" else None
        other = model.getJointId(partner + name[1:] if partner else name)
        keep = name.endswith(("ely", "wry")) or ("_arm_" not in name and name.endswith("y"))
        sign = 1.0 if keep else -1.0
        mirrored[model.joints[other].idx_q] = sign * q[model.joints[joint].idx_q]
    return mirrored


def test_atlas_sides_mirror_each_other() -> None:
    model = _own("atlas", floating=True)
    data, mirror_data = model.createData(), model.createData()
    rng = np.random.default_rng(3)
    q = pin.neutral(model)
    q[7:] = rng.uniform(model.lowerPositionLimit[7:], model.upperPositionLimit[7:])
    pin.framesForwardKinematics(model, data, q)
    pin.framesForwardKinematics(model, mirror_data, _mirrored_posture(model, q))
    for joint in range(2, model.njoints):
        name = model.names[joint]
        if not name.startswith("l_"):
            continue
        other = model.getJointId("r" + name[1:])
        left, right = model.inertias[joint], model.inertias[other]
        assert left.mass == right.mass
        seen = data.oMi[joint].act(left.lever) * [1, -1, 1]
        # Left and right forearm are one part, turned over: its centre of mass lies 1.6 mm off the plane.
        np.testing.assert_allclose(mirror_data.oMi[other].act(right.lever), seen, atol=4e-3, err_msg=name)
        spread = np.linalg.eigvalsh(left.inertia) - np.linalg.eigvalsh(right.inertia)
        np.testing.assert_allclose(spread, 0, atol=1e-12, err_msg=name)
    links = {link.get("name"): link for link in _xml("atlas").findall("link")}
    for name, link in links.items():
        if name.startswith("l_"):
            other_side = _primitives(links["r" + name[1:]])
            for (a, size_a), (b, size_b) in zip(_primitives(link), other_side, strict=True):
                assert a == b
                np.testing.assert_array_equal(size_a, size_b)


@pytest.mark.shared
@pytest.mark.parametrize(
    ("name", "other"),
    [("iiwa14", "iiwa14/iiwa14.urdf"), ("atlas", "atlas/atlas_v5_simple_shapes.urdf")],
)
def test_dynamics_follow_the_published_figures(name: str, other: str) -> None:
    path = SHARED / "robots" / other
    floating = name == "atlas"
    own, published = _own(name, floating=floating), _model(path, floating=floating)
    assert list(own.names) == list(published.names)
    rng = np.random.default_rng(0)
    for _ in range(10):
        q = pin.randomConfiguration(own, np.full(own.nq, -1.0), np.full(own.nq, 1.0))
        v, a = rng.normal(size=(2, own.nv))
        tau = pin.rnea(own, own.createData(), q, v, a)
        expected = pin.rnea(published, published.createData(), q, v, a)
        # Rounding of the figures is all that may differ.
        np.testing.assert_allclose(tau, expected, atol=2e-3 * np.abs(expected).max())
