"""What a monitor found in a log."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from .. import _core
from .._extras import require
from ..errors import InputError
from ..log import Log
from .summary import ReplayedContact


@dataclass(frozen=True, eq=False, repr=False)
class Replay:
    """A log with what a monitor says of it.

    Args:
        log: the log.
        robot: the monitor's robot.
        ticks: columns with one value a row that was replayed: `time`, `collision`, `onset`, `significance`,
            `external_torque` `(n, nv)` [s, Nm]; see `ContactReport`.
        contact_ticks: columns with one value for each contact in each tick: `row`, `time`, `id`, `link`,
            `link_probability`, `located`, `probability`, `point_std`, `region_radius`, `point`,
            `point_local`, `force`; see `Contact`. With a classifier also `clamped`, `transient`, `sustained`
            and `intended`, as it said in that tick; NaN where it said nothing of the contact.
        contacts: one for each contact, in the order of their begin.
        interrupted: whether Ctrl-C ended it before the log's end.
        sensors: of the monitor, in the order of the log's wrenches.

    Raises:
        TypeError: an argument is missing.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> q, still = np.tile(robot.neutral(), (600, 1)), np.zeros((600, 7))
        >>> tau = np.tile(robot.inverse_dynamics(q[0], still[0], still[0]), (600, 1))
        >>> push = robot.jacobian(q[0], "iiwa_link_3", point=[0.06, 0.0, 0.6])[:3].T @ [-40.0, 0.0, 0.0]
        >>> tau[200:400] -= push
        >>> log = cs.Log(np.arange(600) / 1000, q, still, tau)
        >>> result = cs.replay(log, cs.ContactMonitor(robot, dt=0.001))
        >>> result
        Replay(600 rows, 1 contacts)
    """

    log: Log
    robot: _core.Robot
    ticks: Mapping[str, NDArray[Any]]
    contact_ticks: Mapping[str, NDArray[Any]]
    contacts: tuple[ReplayedContact, ...]
    interrupted: bool
    sensors: tuple[_core.ForceTorqueSensor, ...] = ()

    def __repr__(self) -> str:
        return f"Replay({len(self.ticks['time'])} rows, {len(self.contacts)} contacts)"

    def to_parquet(self, folder: str | os.PathLike[str]) -> None:
        """Writes `contacts.parquet`, `contact_ticks.parquet` and `ticks.parquet` into a folder.

        Args:
            folder: made if there is none.

        Raises:
            MissingExtraError: pyarrow is not installed.
            OSError: a file cannot be written; none is left half written.
        """
        from .parquet import replay_tables, write_parquet

        write_parquet(replay_tables(self.contacts, self.contact_ticks, self.ticks), folder)

    def to_json_lines(self, path: str | os.PathLike[str]) -> None:
        """Writes one JSON object a contact, a line each; see `ReplayedContact.to_dict`.

        Args:
            path: the file; one that exists is replaced.

        Raises:
            OSError: the file cannot be written; none is left half written.
        """
        from .json_lines import write_json_lines  # it brings modules that few programs need

        write_json_lines((contact.to_dict() for contact in self.contacts), path)

    def to_mcap(self, path: str | os.PathLike[str]) -> None:
        """Writes the log with what was found as an MCAP file of ROS 2 messages, which Foxglove shows.

        Topics: `/joint_states` and `/contactsense/external_torque` of type `sensor_msgs/msg/JointState`, and
        `/contactsense/contacts` of type `visualization_msgs/msg/MarkerArray`, in the frame `world`; of a
        floating base `/base` of type `nav_msgs/msg/Odometry`; of a sensor `/NAME/wrench` of type
        `geometry_msgs/msg/WrenchStamped`.

        Args:
            path: the file; one that exists is replaced.

        Raises:
            MissingExtraError: rosbags or mcap is not installed.
            OSError: the file cannot be written; none is left half written.
        """
        from .mcap import write_mcap

        write_mcap(self.log, self.ticks, self.contact_ticks, path, self.robot, self.sensors)

    def to_png(self, path: str | os.PathLike[str], title: str = "Log") -> Path:
        """Draws where on the robot the contacts are, and when.

        Args:
            path: the file; one that exists is replaced, ".png" is added where there is no suffix.
            title: of the picture.

        Returns:
            The absolute path of the file.

        Raises:
            MissingExtraError: matplotlib is not installed.
            InputError: the file cannot be written, or the robot has no surface to draw.
        """
        require("plot", "matplotlib")
        if not self.robot.link_names:
            raise InputError("robot: has no surface that could be drawn")
        from .._pictures import picture_file
        from .contact_picture import save_contact_picture

        return save_contact_picture("path", picture_file("path", path), title, self)
