"""Which types of messages matter to a robot's sense of touch, and how their definitions are found."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache
from typing import Any

from .walk import BASE, NAME, Types

IsWanted = Callable[[str, str], bool]

WANTED = frozenset(
    {
        "sensor_msgs/msg/JointState",
        "geometry_msgs/msg/Wrench",
        "geometry_msgs/msg/WrenchStamped",
        "std_msgs/msg/Float64MultiArray",
        "std_msgs/msg/Float32MultiArray",
        "control_msgs/msg/DynamicJointState",
        "control_msgs/msg/JointTrajectoryControllerState",
        "control_msgs/msg/JointControllerState",
    }
)
# What says where a floating base is.
BASE_KINDS = frozenset(
    {
        "nav_msgs/msg/Odometry",
        "geometry_msgs/msg/PoseStamped",
        "geometry_msgs/msg/PoseWithCovarianceStamped",
        "geometry_msgs/msg/TwistStamped",
        "geometry_msgs/msg/TwistWithCovarianceStamped",
        "sensor_msgs/msg/Imu",
    }
)
# Packages of the distributions themselves: what of them is not named above says nothing of joints or forces.
COMMON_PACKAGES = frozenset(
    {
        "action_msgs",
        "actionlib",
        "actionlib_msgs",
        "builtin_interfaces",
        "composition_interfaces",
        "control_msgs",
        "diagnostic_msgs",
        "dynamic_reconfigure",
        "geometry_msgs",
        "lifecycle_msgs",
        "map_msgs",
        "moveit_msgs",
        "nav_msgs",
        "object_recognition_msgs",
        "octomap_msgs",
        "pcl_msgs",
        "rcl_interfaces",
        "ros2cli_test_interfaces",
        "rosapi",
        "rosbag2_interfaces",
        "roscpp",
        "rosgraph_msgs",
        "rospy",
        "sensor_msgs",
        "shape_msgs",
        "statistics_msgs",
        "std_msgs",
        "stereo_msgs",
        "tf",
        "tf2_msgs",
        "theora_image_transport",
        "trajectory_msgs",
        "unique_identifier_msgs",
        "vision_msgs",
        "visualization_msgs",
    }
)
# Their numbers are no measurements.
_HEADERS = ("std_msgs/msg/Header", "builtin_interfaces/msg/Time", "builtin_interfaces/msg/Duration")
MAX_DEFINITION = 2**18  # characters of one definition; franka_msgs/FrankaState has 8,000
MAX_TYPES = 64  # definitions kept from file to file

# ros2_control's own state message: its bags before ROS 2 Iron hold no definitions.
DYNAMIC_JOINT_STATE = """std_msgs/Header header
string[] joint_names
control_msgs/InterfaceValue[] interface_values
================================================================================
MSG: control_msgs/InterfaceValue
string[] interface_names
float64[] values
"""


def normal_kind(kind: str) -> str:
    """`pkg/msg/Type` also for ROS 1, which writes `pkg/Type`."""
    parts = kind.split("/")
    return f"{parts[0]}/msg/{parts[1]}" if len(parts) == 2 else kind


def default_wanted(kind: str, types: Types | None) -> bool:
    """Whether a type is read unless the caller says otherwise."""
    if kind in WANTED or kind in BASE_KINDS:
        return True
    package = kind.split("/")[0]
    if package in COMMON_PACKAGES or "/srv/" in kind or "/action/" in kind:
        return False
    return types is None or _has_floats(kind, types)


def _has_floats(kind: str, types: Types) -> bool:
    """Whether a message of this type can hold numbers that are measured."""
    waiting, seen = [kind], set(_HEADERS)
    while waiting:
        kind = waiting.pop()
        if kind in seen or kind not in types:
            continue
        seen.add(kind)
        for _, (node, what) in types[kind][1]:
            while node not in (BASE, NAME):
                node, what = what[0]
            if node == NAME:
                waiting.append(what)
            elif what[0] in ("float32", "float64"):
                return True
    return False


@cache
def common_types(encoding: str) -> Types:
    """Types of a distribution: that of ROS 1 for `ros1`, of ROS 2 otherwise."""
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    types: dict[Any, Any] = dict(
        get_typestore(Stores.ROS1_NOETIC if encoding == "ros1" else Stores.ROS2_HUMBLE).fielddefs
    )
    types.update(get_types_from_msg(DYNAMIC_JOINT_STATE, "control_msgs/msg/DynamicJointState"))
    return types


@lru_cache(MAX_TYPES)
def types_of(kind: str, encoding: str, definition: str, is_idl: bool = False) -> Types | None:
    """The type and all within it, by the file's definition or else the distribution's; None for neither."""
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    common = common_types(encoding)
    if definition.strip() and len(definition) <= MAX_DEFINITION:
        try:
            given = get_types_from_idl(definition) if is_idl else get_types_from_msg(definition, kind)
        except Exception:  # rosbags' parser of hostile text may raise anything
            given = {}
        if kind in given:
            return {**common, **given}
    return common if kind in common else None
