"""Force/torque sensors inside the simulated robot."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence

import numpy as np
import pinocchio as pin

from contactsense import ForceTorqueSensor
from contactsense.errors import InputError

from ._arrays import FloatArray
from ._mujoco import mujoco
from ._text import pose_attributes


def write_sensors(
    root: ET.Element, bodies: Mapping[int, ET.Element], model: pin.Model, sensors: Sequence[ForceTorqueSensor]
) -> None:
    """Add a `<site>`, a `<force>` and a `<torque>` for each sensor; `bodies` by Pinocchio's joint numbers."""
    if not sensors:
        return
    names = [sensor.name for sensor in sensors]
    if len(set(names)) < len(names):
        raise InputError(f"sensors: names must differ, not {', '.join(names)}")
    element = root.find("sensor")
    readings = ET.SubElement(root, "sensor") if element is None else element
    for sensor in sensors:
        joint, placement = _joint_before(model, sensor)
        ET.SubElement(bodies[joint], "site", pose_attributes(placement @ sensor.pose), name=sensor.name)
        for kind in ("force", "torque"):
            ET.SubElement(readings, kind, name=f"{sensor.name}:{kind}", site=sensor.name)


class WrenchReader:
    """Readings of all sensors, in their order, as their conventions have them."""

    def __init__(self, mj_model: mujoco.MjModel, sensors: Sequence[ForceTorqueSensor]) -> None:
        rows = []
        for sensor in sensors:
            for kind in ("force", "torque"):
                name = f"{sensor.name}:{kind}"
                number = mujoco.mj_name2id(mj_model, mujoco.mjtObj.mjOBJ_SENSOR, name)
                if number < 0:
                    raise InputError(f"sensors: the MuJoCo model has no sensor '{name}'")
                start = int(mj_model.sensor_adr[number])
                rows.append(np.arange(start, start + 3))
        self._rows = np.array(rows, dtype=np.intp).reshape(-1, 6)
        # MuJoCo gives what the parent exerts to hold the child.
        signs = [1.0 if sensor.convention == "support" else -1.0 for sensor in sensors]
        self._signs = np.array(signs).reshape(-1, 1)
        self._offsets = np.array([sensor.offset for sensor in sensors]).reshape(-1, 6)

    def read(self, mj_data: mujoco.MjData) -> FloatArray:
        """(n, 6) force [N] and moment about each origin [Nm], in the sensors' frames, offsets included."""
        wrenches: FloatArray = self._signs * mj_data.sensordata[self._rows] + self._offsets
        return wrenches


def _joint_before(model: pin.Model, sensor: ForceTorqueSensor) -> tuple[int, FloatArray]:
    """The joint that `sensor.link` hangs on, and the link's pose in the joint's frame."""
    if not model.existFrame(sensor.link, pin.FrameType.BODY):
        raise InputError(f"sensors: '{sensor.name}' sits before link '{sensor.link}', which does not exist")
    frame = model.frames[model.getFrameId(sensor.link, pin.FrameType.BODY)]
    kind = model.frames[frame.parentFrame].type
    if kind != pin.FrameType.JOINT or model.joints[frame.parentJoint].nv != 1:
        raise InputError(
            f"sensors: '{sensor.name}' sits before link '{sensor.link}', which no moving joint joins to"
            " another link; MuJoCo has no forces inside a rigid body"
        )
    return int(frame.parentJoint), np.asarray(frame.placement.homogeneous, dtype=np.float64)
