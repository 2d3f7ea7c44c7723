"""The layout of messages: every number as rosbags itself decodes it, in both byte orders and for ROS 1."""

import numpy as np
import pytest
from bag_files import (
    ARM,
    CUSTOM,
    JOINT_STATE,
    MUTATIONS,
    STORES,
    flat_numbers,
    joint_state,
    mutated,
    random_message,
)
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from contactsense.log.formats.layout import LayoutError
from contactsense.log.formats.messages import default_wanted, types_of
from contactsense.log.formats.walk import MAX_ELEMENTS, Walk

KINDS = [
    JOINT_STATE,
    "geometry_msgs/msg/WrenchStamped",
    "std_msgs/msg/Float64MultiArray",
    "trajectory_msgs/msg/JointTrajectory",
    "sensor_msgs/msg/Imu",
    "sensor_msgs/msg/BatteryState",
    "nav_msgs/msg/Odometry",
    "diagnostic_msgs/msg/DiagnosticArray",
    "control_msgs/msg/DynamicJointState",
    "std_msgs/msg/Empty",
    "my_msgs/msg/State",
]


def encoded(message, kind, form):
    if form == "ros1":
        return bytes(STORES["ros1"].serialize_ros1(message, kind))
    return bytes(STORES["cdr"].serialize_cdr(message, kind, little_endian=form == "little"))


def read_one(data, kind, encoding, definition=""):
    layout = Walk(data, types_of(kind, encoding, definition), encoding).layout(kind)
    rows = np.frombuffer(data, np.uint8)[None]
    assert layout.fits(rows).all()
    return dict(zip(layout.names, layout.read(rows)[0], strict=True))


@pytest.mark.parametrize("form", ["little", "big", "ros1"])
@pytest.mark.parametrize("kind", KINDS)
def test_every_number_is_that_of_rosbags(kind, form):
    rng = np.random.default_rng(3)
    encoding = "ros1" if form == "ros1" else "cdr"
    definition = CUSTOM if kind.startswith("my_msgs") else ""
    for _ in range(40):
        data = encoded(random_message(rng, encoding, kind), kind, form)
        store = STORES[encoding]
        decode = store.deserialize_ros1 if form == "ros1" else store.deserialize_cdr
        wanted = flat_numbers(decode(data, kind), encoding, kind)
        np.testing.assert_array_equal(list(read_one(data, kind, encoding, definition).values()), wanted)


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_joint_states_are_named_by_joint(encoding):
    data = joint_state(encoding, ARM, 5_000_000_007, np.arange(7.0), effort=[])
    found = read_one(data, JOINT_STATE, encoding)
    assert found["header.stamp"] == 5 + 7e-9
    assert found["position[arm_joint3]"] == found["velocity[arm_joint3]"] == 2.0
    assert not [name for name in found if name.startswith("effort")]


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_mutated_messages_are_refused_or_read(encoding):
    rng, read = np.random.default_rng(31), 0
    for i in range(MUTATIONS):
        kind = KINDS[i % len(KINDS)]
        definition = CUSTOM if kind.startswith("my_msgs") else ""
        data = encoded(random_message(rng, encoding, kind), kind, "ros1" if encoding == "ros1" else "little")
        try:
            read_one(mutated(rng, data or b"\0"), kind, encoding, definition)
            read += 1
        except LayoutError:
            continue
    assert MUTATIONS // 20 < read < MUTATIONS


def test_mutated_definitions_give_types_or_none():
    rng = np.random.default_rng(37)
    for _ in range(MUTATIONS):
        types = types_of("my_msgs/msg/State", "cdr", mutated(rng, CUSTOM.encode()).decode("utf-8", "replace"))
        try:
            Walk(b"\0\1" + bytes(400), types or {}, "cdr").layout("my_msgs/msg/State")
        except LayoutError:
            continue


def test_names_that_repeat_name_nothing():
    data = joint_state("cdr", ("a", "a"), 0, [1.0, 2.0])
    assert read_one(data, JOINT_STATE, "cdr")["position[1]"] == 2.0


def test_interfaces_and_joints_name_dynamic_states():
    types = STORES["cdr"].types
    head = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](1, 0), "")
    value = types["control_msgs/msg/InterfaceValue"]
    values = [value(["position", "effort"], np.array([1.0, 2.0])), value(["position"], np.array([3.0]))]
    message = types["control_msgs/msg/DynamicJointState"](head, ["a", "b"], values)
    kind = "control_msgs/msg/DynamicJointState"
    assert read_one(encoded(message, kind, "little"), kind, "cdr") == {
        "header.stamp": 1.0,
        "interface_values[a].values[position]": 1.0,
        "interface_values[a].values[effort]": 2.0,
        "interface_values[b].values[position]": 3.0,
    }


NESTED = """std_msgs/Header header
sensor_msgs/JointState measured_joint_state
sensor_msgs/JointState tau_ext_hat_filtered
geometry_msgs/WrenchStamped o_f_ext_hat_k
float64[2] plain
"""


def test_joints_name_states_within_states():
    """As in franka_msgs/FrankaRobotState; an array beside them is not named by their joints."""
    kind, types = "my_msgs/msg/RobotState", types_of("my_msgs/msg/RobotState", "cdr", NESTED)
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(NESTED, kind))
    rng, of = np.random.default_rng(43), STORES["cdr"].types
    state = of[JOINT_STATE](
        random_message(rng, "cdr", "std_msgs/msg/Header"), ["a", "b"], *[np.arange(2.0)] * 3
    )
    wrench = random_message(rng, "cdr", "geometry_msgs/msg/WrenchStamped")
    message = store.types[kind](state.header, state, state, wrench, np.array([5.0, 6.0]))
    assert types is not None
    found = read_one(bytes(store.serialize_cdr(message, kind)), kind, "cdr", NESTED)
    assert found["measured_joint_state.position[b]"] == found["tau_ext_hat_filtered.effort[b]"] == 1.0
    assert found["o_f_ext_hat_k.wrench.force.x"] == wrench.wrench.force.x
    assert found["plain[1]"] == 6.0


def test_long_arrays_give_no_columns():
    kind = "std_msgs/msg/Float64MultiArray"
    layout = STORES["cdr"].types["std_msgs/msg/MultiArrayLayout"]([], 0)
    message = STORES["cdr"].types[kind](layout, np.zeros(MAX_ELEMENTS + 1))
    assert list(read_one(encoded(message, kind, "little"), kind, "cdr")) == ["layout.data_offset"]


def test_another_shape_does_not_fit():
    first = joint_state("cdr", ("ab", "cd"), 0, [1.0, 2.0])
    layout = Walk(first, types_of(JOINT_STATE, "cdr", ""), "cdr").layout(JOINT_STATE)
    others = [
        joint_state("cdr", ("ab", "cd"), 9, [3.0, 4.0]),
        joint_state("cdr", ("cd", "ab"), 0, [1.0, 2.0]),
        b"\0\0" + first[2:],
    ]
    rows = np.frombuffer(b"".join(others), np.uint8).reshape(3, -1)
    assert layout.fits(rows).tolist() == [True, False, False]


@pytest.mark.parametrize("kept", range(0, 300, 7))
def test_a_cut_message_is_refused(kept):
    data = joint_state("cdr", ARM, 0, np.zeros(7))
    with pytest.raises(LayoutError):
        Walk(data[:kept], types_of(JOINT_STATE, "cdr", ""), "cdr").layout(JOINT_STATE)


@pytest.mark.parametrize(
    "definition",
    ["float64[4000000000] a", "State[] a", "State a", "wstring a", "Unknown a", "float64[] a\nfloat64[] a"],
)
def test_a_hostile_definition_is_refused(definition):
    kind = "my_msgs/msg/State"
    with pytest.raises(LayoutError):
        Walk(b"\0\1\0\0" + b"\1\0\0\0" * 1000, types_of(kind, "cdr", definition), "cdr").layout(kind)


def test_a_definition_that_branches_without_end_takes_no_time():
    parts = [f"MSG: my_msgs/T{i}\nT{i + 1} a\nT{i + 1} b\n" for i in range(31)] + [
        "MSG: my_msgs/T31\nint8 a\n"
    ]
    text = "T0 a\n" + "".join("=" * 80 + "\n" + part for part in parts)
    types = types_of("my_msgs/msg/State", "cdr", text)
    assert "my_msgs/msg/T31" in types
    assert not default_wanted("my_msgs/msg/State", types)
    with pytest.raises(LayoutError):
        Walk(b"\0\1\0\0" + bytes(10**6), types, "cdr").layout("my_msgs/msg/State")


def test_a_long_name_is_refused():
    text = "Part[2000] " + "a" * 2000 + "\n" + "=" * 80 + "\nMSG: my_msgs/Part\nint8 b\n"
    with pytest.raises(LayoutError, match="too long"):
        Walk(b"\0\1\0\0" + bytes(2000), types_of("my_msgs/msg/State", "cdr", text), "cdr").layout(
            "my_msgs/msg/State"
        )


def test_a_broken_definition_gives_no_type():
    assert types_of("my_msgs/msg/State", "cdr", "float64 [[[") is None
    assert types_of("my_msgs/msg/State", "cdr", "\0" * 1000) is None
