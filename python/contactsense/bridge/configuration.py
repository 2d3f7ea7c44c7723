"""What a bridge is to do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

Effort = Literal["motor", "external"]
Geometry = Literal["collision", "visual", "collision_or_visual"]
PerJoint = float | list[float]


@dataclass(frozen=True)
class SensorTopic:
    """A force/torque sensor whose readings come on a topic.

    Args:
        link: joined by the sensor to its parent; readings are in its frame.
        topic: of `geometry_msgs/WrenchStamped`.
        convention: "load" or "support", as of `ForceTorqueSensor`.
        wanted: whether contacts behind it are meant.
    """

    link: str
    topic: str
    convention: Literal["load", "support"] = "load"
    wanted: bool = False


@dataclass(frozen=True)
class Configuration:
    """The parameters of a bridge; `docs/bridge.md` explains each.

    Args:
        robot: name of a packaged robot, or path of a URDF.
        package_dirs: folders of the packages that the URDF names.
        geometry: shapes of the surface.
        locked_joints: position of joints that do not move [rad, m].
        calibration: file of `contactsense calibrate`.
        torque_threshold: [Nm, N], one or one a joint; None for the monitor's own.
        wrench_threshold: [N, Nm].
        observer_gain: [1/s].
        bias_time: time constant of the bias [s]; None for the monitor's own.
        effort: what the efforts are: torques of the motors, or an external torque.
        torque_constants: torque for each unit of effort, one or one a joint [Nm, N].
        rate: of the joint states [Hz].
        sensors: by name.
        wrench_timeout: age from which on a reading of a sensor is none [s].
        joint_states: topic that is read.
        prefix: of the topics that are written.
        diagnostics: topic of the diagnostics.
        frame: that the markers are in; None for the robot's root link.
        marker_rate: most arrays of markers a second while contacts last [Hz].
        node: name in the graph of ROS 2.
        domain: of ROS 2.
        type_hash: whether key expressions of Zenoh have the hash of a type, as from ROS 2 Iron on.
    """

    robot: str
    package_dirs: tuple[Path, ...] = ()
    geometry: Geometry = "collision"
    locked_joints: Mapping[str, float] = field(default_factory=dict)
    calibration: Path | None = None
    torque_threshold: PerJoint | None = None
    wrench_threshold: float = 2.0
    observer_gain: float = 50.0
    bias_time: float | None = None
    effort: Effort = "motor"
    torque_constants: PerJoint = 1.0
    rate: float = 1000.0
    sensors: Mapping[str, SensorTopic] = field(default_factory=dict)
    wrench_timeout: float = 0.1
    joint_states: str = "/joint_states"
    prefix: str = "/contactsense"
    diagnostics: str = "/diagnostics"
    frame: str | None = None
    marker_rate: float = 30.0
    node: str = "contactsense"
    domain: int = 0
    type_hash: bool = True

    @property
    def external_torque_topic(self) -> str:
        """Where the external torque goes."""
        return f"{self.prefix}/external_torque"

    @property
    def contacts_topic(self) -> str:
        """Where wrenches of located contacts go."""
        return f"{self.prefix}/contacts"

    @property
    def not_located_topic(self) -> str:
        """Where wrenches of the other contacts go."""
        return f"{self.prefix}/contacts_not_located"

    @property
    def markers_topic(self) -> str:
        """Where markers go."""
        return f"{self.prefix}/markers"
