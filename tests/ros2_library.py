"""Stands in for `rclpy` and the message classes of ROS 2, as strict about types of fields as they are."""

from __future__ import annotations

from array import array
from collections.abc import Callable
from types import ModuleType
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
PACKAGES = (
    "builtin_interfaces",
    "std_msgs",
    "geometry_msgs",
    "sensor_msgs",
    "visualization_msgs",
    "diagnostic_msgs",
)
# Types of fields; a byte is one of `bytes`.
TYPES = {"string": str, "bool": bool, "byte": bytes, "float32": float, "float64": float}
DEFAULTS = {str: "", bool: False, bytes: b"\0", float: 0.0, int: 0}


class Message:
    """A message whose fields are given by name; others have their defaults."""

    kind = ""

    def __init__(self, **given: Any) -> None:
        fields = dict(STORE.fielddefs[self.kind][1])
        assert set(given) <= set(fields), (self.kind, set(given) - set(fields))
        for name, desc in fields.items():
            value = given.get(name)
            if value is None:
                value = _default(desc)
            elif not _fits(value, desc):
                raise AssertionError(f"{self.kind}: {name} cannot be {value!r}")
            elif desc[0] == Nodetype.SEQUENCE and desc[1][0] == (Nodetype.BASE, ("float64", 0)):
                value = array("d", value)
            setattr(self, name, value)


def _default(desc: Any) -> Any:
    if desc[0] == Nodetype.NAME:
        return class_of(desc[1])()
    if desc[0] == Nodetype.BASE:
        return DEFAULTS[TYPES.get(desc[1][0], int)]
    return []


def _fits(value: Any, desc: Any) -> bool:
    if desc[0] == Nodetype.NAME:
        return isinstance(value, class_of(desc[1]))
    if desc[0] == Nodetype.BASE:
        return type(value) is TYPES.get(desc[1][0], int)
    # Arrays of NumPy are no sequences.
    return isinstance(value, list | tuple | array) and all(_fits(it, desc[1][0]) for it in value)


_classes: dict[str, type[Message]] = {}


def class_of(kind: str) -> type[Message]:
    """The class of a type such as `sensor_msgs/msg/JointState`."""
    if kind not in _classes:
        _classes[kind] = type(kind.rpartition("/")[2], (Message,), {"kind": kind})
    return _classes[kind]


class Publisher:
    def __init__(self, kind: type[Message]) -> None:
        self.kind = kind
        self.published: list[Any] = []

    def publish(self, message: Any) -> None:
        assert type(message) is self.kind
        self.published.append(message)


class Node:
    """Keeps what it publishes by topic; messages are sent to it by `send`."""

    made: list[Node] = []  # noqa: RUF012

    def __init__(self, name: str) -> None:
        self.name = name
        self.publishers: dict[str, Publisher] = {}
        self.subscriptions: dict[str, tuple[type[Message], Callable[[Any], None], Any]] = {}
        self.timers: list[tuple[float, Callable[[], None]]] = []
        self.is_destroyed = False
        Node.made.append(self)

    def create_publisher(self, kind: type[Message], topic: str, depth: int) -> Publisher:
        assert topic not in self.publishers
        self.publishers[topic] = Publisher(kind)
        return self.publishers[topic]

    def create_subscription(
        self, kind: type[Message], topic: str, callback: Callable[[Any], None], qos: Any
    ) -> None:
        self.subscriptions[topic] = kind, callback, qos

    def create_timer(self, period: float, callback: Callable[[], None]) -> None:
        self.timers.append((period, callback))

    def send(self, topic: str, message: Message) -> None:
        kind, callback, _ = self.subscriptions[topic]
        assert type(message) is kind
        callback(message)

    def on(self, topic: str) -> list[Any]:
        return self.publishers[topic].published

    def destroy_node(self) -> None:
        self.is_destroyed = True


def install(spin: Callable[[Node], None]) -> dict[str, ModuleType]:
    """The modules by name, for `sys.modules`; `spin` does what a robot would."""
    modules: dict[str, ModuleType] = {}

    def module(name: str, **content: Any) -> None:
        modules[name] = ModuleType(name)
        vars(modules[name]).update(content)

    contexts: list[str] = []
    module(
        "rclpy",
        init=lambda: contexts.append("init"),
        try_shutdown=lambda: contexts.append("shutdown"),
        spin=spin,
        contexts=contexts,
    )
    module("rclpy.node", Node=Node)
    module("rclpy.qos", qos_profile_sensor_data="sensor data")
    module("rclpy.executors", ExternalShutdownException=type("ExternalShutdownException", (Exception,), {}))
    for package in PACKAGES:
        module(package)
        kinds = [kind for kind in STORE.fielddefs if kind.startswith(f"{package}/msg/")]
        module(f"{package}.msg", **{kind.rpartition("/")[2]: class_of(kind) for kind in kinds})
    return modules
