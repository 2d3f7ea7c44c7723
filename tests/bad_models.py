"""URDF texts that are refused, each with a pattern of the message."""

from urdf_text import joint, link, robot

AB = link("a") + link("b")
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def inertial(mass: str = "1", **moments: str) -> str:
    values = {"ixx": "1", "ixy": "0", "ixz": "0", "iyy": "1", "iyz": "0", "izz": "1", **moments}
    row = " ".join(f'{key}="{value}"' for key, value in values.items())
    return f'<inertial><mass value="{mass}"/><inertia {row}/></inertial>'


BAD_MODELS = {
    "not XML": ("<robot", "not XML"),
    "empty file": ("", "not XML"),
    "other root": ("<model/>", "root element is <model>"),
    "no links": (robot(), "no links"),
    "link without name": (robot("<link/>"), "<link> has no name"),
    "joint without name": (robot(AB, '<joint type="fixed"/>'), "<joint> has no name"),
    "duplicate link": (robot(link("a"), link("a")), "link names must be unique.*'a'"),
    "duplicate joint": (
        robot(AB, link("c"), joint("j", "a", "b"), joint("j", "a", "c")),
        "joint names .*'j'",
    ),
    "unknown link": (robot(AB, joint("j", "a", "ghost")), "joint 'j' names the link 'ghost'"),
    "no parent": (
        robot(AB, '<joint name="j" type="fixed"><child link="b"/></joint>'),
        "joint 'j' needs <parent",
    ),
    "two parents": (
        robot(AB, link("c"), joint("j", "a", "c"), joint("k", "b", "c")),
        "link 'c' has two parents, 'a' and 'b'",
    ),
    "two roots": (robot(AB), "one root.*'a', 'b'"),
    "only a cycle": (robot(AB, joint("j", "a", "b"), joint("k", "b", "a")), "cycle: 'a', 'b'"),
    "root and cycle": (robot(AB, link("c"), joint("j", "b", "c"), joint("k", "c", "b")), "cycle: 'b', 'c'"),
    "own parent": (robot(link("a"), joint("j", "a", "a")), "cycle: 'a'"),
    "zero axis": (robot(AB, joint("j", "a", "b", inside='<axis xyz="0 0 0"/>' + LIMIT)), "joint 'j': <axis>"),
    "nan axis": (robot(AB, joint("j", "a", "b", inside='<axis xyz="nan 0 0"/>' + LIMIT)), "joint 'j': 'xyz'"),
    "short axis": (robot(AB, joint("j", "a", "b", inside='<axis xyz="1 0"/>' + LIMIT)), "3 finite numbers"),
    "malformed limit": (
        robot(AB, joint("j", "a", "b", inside='<limit lower="low" effort="1" velocity="1"/>')),
        "joint 'j': 'lower'.*'low'",
    ),
    "infinite limit": (
        robot(AB, joint("j", "a", "b", inside='<limit lower="-1e999" effort="1" velocity="1"/>')),
        "joint 'j': 'lower'",
    ),
    "negative effort": (
        robot(AB, joint("j", "a", "b", inside='<limit effort="-1" velocity="1"/>')),
        "joint 'j': 'effort'.*negative",
    ),
    "revolute without limit": (robot(AB, joint("j", "a", "b", inside="")), "joint 'j' is revolute and needs"),
    "unknown type": (
        robot(AB, joint("j", "a", "b", "hinge")),
        "joint 'j' has the type 'hinge'; supported: rev",
    ),
    "planar": (robot(AB, joint("j", "a", "b", "planar")), "joint 'j' has the type 'planar'; supported: rev"),
    "floating inside": (
        robot(AB, link("c"), joint("i", "a", "b"), joint("j", "b", "c", "floating")),
        "joint 'j' floats inside the robot",
    ),
    "reserved name": (robot(AB, joint("universe", "a", "b")), "joint 'universe' has a name that Pinocchio"),
    "bad origin": (
        robot(AB, joint("j", "a", "b").replace("0 0 0.3", "0 0 x")),
        "joint 'j': 'xyz' of <origin>",
    ),
    "negative mass": (robot(link("a", inertial("-1"))), "link 'a': mass must not be negative"),
    "nan mass": (robot(link("a", inertial("nan"))), "link 'a': 'value' of <mass>"),
    "infinite inertia": (robot(link("a", inertial(ixx="inf"))), "link 'a': 'ixx'"),
    "missing inertia": (
        robot(link("a", '<inertial><mass value="1"/></inertial>')),
        "link 'a': <inertial> needs",
    ),
    "negative inertia": (
        robot(link("a"), link("b", inertial(iyy="-1")), joint("j", "a", "b")),
        "joint 'j'.*'b'.*negative principal moment",
    ),
    "huge number": (robot(link("a", inertial("1e300"))), "link 'a': 'value' of <mass>.*up to"),
    "deep chain": (
        robot(
            *(link(str(i)) for i in range(1200)), *(joint(f"j{i}", str(i), str(i + 1)) for i in range(1199))
        ),
        "longer than 1000",
    ),
}
