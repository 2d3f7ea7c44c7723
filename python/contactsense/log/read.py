"""From a file or folder to a `Log` of a robot."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from ..errors import InputError
from .log import Log

if TYPE_CHECKING:
    from .sensors import Sensors


def read_log(
    path: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    robot: _core.Robot,
    *,
    columns: Mapping[str, str | Sequence[str]] | None = None,
    topics: Sequence[str] | None = None,
    units: Mapping[str, str] | None = None,
    torque_constants: ArrayLike | Mapping[str, float] | None = None,
    external: bool = False,
    rate: float | None = None,
    sensors: Sensors = (),
) -> Log:
    r"""A robot's log from a file: rosbag2, rosbag1, MCAP, CSV, Parquet, NumPy or MATLAB v7.3.

    Topics, columns, joints and units are found by their names where these are unambiguous; `Log.reading` says
    what was chosen, mended and left out. Joints are matched by name, in any order, with or without namespaces
    and prefixes; columns that are only numbered, such as `q0` to `q6`, are the robot's joints in order. Rows
    are kept as they were measured: values of other topics are the last ones by then, missing velocities are
    central differences over 20 ms, or over two rows where rows are farther apart.

    Args:
        path: the file, the folder of a bag, or several files that together have the columns.
        robot: with a fixed base, or one that floats: its pose is that of `nav_msgs/Odometry`,
            `geometry_msgs/PoseStamped` or `sensor_msgs/Imu`, or of columns such as `base_x` and `base_qw`;
            its velocity is what these or a `TwistStamped` have, or the differences of the pose.
        columns: what columns hold, by quantity: "time", "position", "velocity", "torque", "external_torque",
            "current"; each a pattern with `*` in place of the joint's name or number, such as `"actual_q_*"`,
            or one name for each of `robot.actuated_joint_names`. Also "base_pose" and "base_twist": a topic,
            a pattern, or all columns, of position and quaternion x y z w, of linear and angular velocity.
        topics: topics of a bag, or names of tables, that alone are looked at.
        units: by quantity: "rad" or "deg", "rad/s" or "deg/s", "Nm" or "mNm", "A" or "mA".
        torque_constants: torque for each unit of the recorded torque or current [Nm/A], signs and gear ratios
            included; one number, one for each of `robot.actuated_joint_names`, or by name. Needed for
            currents.
        external: whether the vendor's external torque is taken alone, in place of the torques of the motors;
            `torque_constants` then multiply it: -1 where it is what the robot exerts (Franka), not what acts
            on it.
        rate: of a log that is interpolated to equal steps [1/s]; None keeps the rows.
        sensors: the `ForceTorqueSensor`s, or their names, that `Log.wrenches` has, in this order, such as
            `monitor.sensors`. Readings are found by their frame, topic or columns. Where names do not tell, a
            mapping from each to its topic, a pattern with `*` in place of the component, such as `"ft_*"`, or
            six columns; None to find them. Readings must be in the frame of the sensor [N, Nm], as they are
            for the monitor: messages of another frame of the robot are refused.

    Returns:
        A `Log`; of a damaged file, what could be read, with `Log.reading.damage`.

    Raises:
        InputError: the file cannot be read, or it is ambiguous what to take from it; names what would help.
        MissingExtraError: the format needs a package of the extra `log`.
        OSError: the file cannot be opened.

    Example:
        >>> import contactsense as cs, pathlib, tempfile
        >>> robot = cs.Robot.named("iiwa14")
        >>> names = ["time", *(f"{name}{joint}" for name in ("q", "dq", "tau") for joint in range(1, 8))]
        >>> file = pathlib.Path(tempfile.mkdtemp()) / "arm.csv"
        >>> rows = [[0.001 * k, *[0.1] * 7, *[0.0] * 7, *[1.0] * 7] for k in range(3)]
        >>> _ = file.write_text("\n".join([",".join(names), *(",".join(map(str, row)) for row in rows)]))
        >>> cs.read_log(file, robot)
        Log(3 rows, 0.002 s: time, q, v, tau)
    """
    # These take milliseconds that programs without files do not need.
    from .choice import COLUMNS
    from .files import read_recording
    from .robot_log import Wishes, robot_log
    from .sensors import wanted_sensors
    from .torque_constants import check_constants
    from .units import check_units

    if not isinstance(robot, _core.Robot):
        raise InputError(f"robot: expected a contactsense.Robot, got {type(robot).__name__}")
    if not isinstance(external, bool | np.bool_):
        raise InputError(f"external: expected True or False, got {type(external).__name__}")
    for argument, given in [("columns", columns), ("units", units)]:
        if given is not None and not isinstance(given, Mapping):
            raise InputError(f"{argument}: expected a mapping, got {type(given).__name__}")
    if rate is not None and not isinstance(rate, Real):
        raise InputError(f"rate: expected a number, got {type(rate).__name__}")
    if external and robot.floating_base:
        raise InputError("external: an external torque alone is read for robots with a fixed base")
    columns, units = dict(columns or {}), dict(units or {})
    wanted = wanted_sensors(sensors, robot)
    for name in columns:
        if name not in COLUMNS:
            raise InputError(f"columns: there is no {name!r}; there are {', '.join(COLUMNS)}")
    check_units(units)
    if rate is not None and not (np.isfinite(rate) and rate > 0.0):
        raise InputError(f"rate: must be positive [1/s], not {rate}")
    paths = [path] if isinstance(path, str | os.PathLike) else list(path)
    constants = check_constants(torque_constants, robot.actuated_joint_names)
    recording = read_recording([Path(each) for each in paths], topics)
    title = ", ".join(os.fspath(each) for each in paths)
    return robot_log(title, recording, robot, Wishes(columns, units, constants, external, rate, wanted))
