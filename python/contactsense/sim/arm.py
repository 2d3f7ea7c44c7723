"""A robot in MuJoCo that is driven and measured as a real one is."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from contactsense import ForceTorqueSensor
from contactsense.errors import InputError, ModelError

from ._arrays import FloatArray, positive, vector
from ._mujoco import mujoco
from .coordinates import Coordinates
from .external_torque import applied_torque
from .floor import Floor
from .geoms import Geom
from .measurement import Measurement
from .mjcf import Integrator, mjcf_string
from .noise import TorqueNoise, WrenchNoise
from .sensors import WrenchReader


class SimulatedRobot:
    """A torque-controlled robot without friction, on which forces can be put at any point.

    Positions, velocities and torques are in the order of `model`; a free base has no motors, so torques are
    `(nv - 6,)` there and `(nv,)` elsewhere.

    Args:
        model: Pinocchio model; also names the links.
        dt: control tick [s]; the motors hold their torque in between.
        substeps: simulation steps a tick.
        integrator: see `mjcf_tree`.
        geoms: shapes to attach, see `geoms_of`.
        mjcf: MJCF text to simulate in place of the one made from `model`, for worlds with more in them; its
            robot's joints and motors bear the joint names of `model`; its time step is overridden.
        noise: of the measured torques; none by default.
        floor: to stand on; it touches the `geoms` that have its bit in `conaffinity`.
        sensors: force/torque sensors, read in this order; with `mjcf`, it must have them.
        wrench_noise: of their readings; none by default.

    Raises:
        ModelError: the model cannot be simulated; names the joint.
        InputError: another argument; names it.
    """

    def __init__(
        self,
        model: pin.Model,
        *,
        dt: float = 0.001,
        substeps: int = 1,
        integrator: Integrator = "RK4",
        geoms: Iterable[Geom] = (),
        mjcf: str | None = None,
        noise: TorqueNoise | None = None,
        floor: Floor | None = None,
        sensors: Sequence[ForceTorqueSensor] = (),
        wrench_noise: WrenchNoise | None = None,
    ) -> None:
        if substeps < 1:
            raise InputError(f"substeps must be 1 or more, not {substeps}")
        step = positive("dt", dt) / substeps
        shapes = tuple(geoms)
        if mjcf is not None and (shapes or floor):
            raise InputError("geoms and floor must be in mjcf itself where that is given")
        text = mjcf or mjcf_string(
            model, dt=step, integrator=integrator, geoms=shapes, floor=floor, sensors=sensors
        )
        self.model = model
        self.dt = dt
        try:
            self.mj_model = mujoco.MjModel.from_xml_string(text)
        except ValueError as cause:
            raise ModelError(f"MuJoCo cannot read the model: {cause}") from cause
        self.mj_model.opt.timestep = step
        self.mj_data = mujoco.MjData(self.mj_model)
        self.coordinates = Coordinates(model, self.mj_model)
        self._base = 6 if self.coordinates.floating_base else 0
        self._substeps = substeps
        self._noise, self._wrench_noise = noise, wrench_noise
        self._wrenches = WrenchReader(self.mj_model, sensors)
        self._motors = _motor_numbers(model, self.mj_model, self._base)
        self.reset(pin.neutral(model))

    @property
    def time(self) -> float:
        """[s] since the last reset."""
        return float(self.mj_data.time)

    @property
    def q(self) -> FloatArray:
        """(nq,) present position."""
        return self.coordinates.q(self.mj_data.qpos)

    @property
    def v(self) -> FloatArray:
        """(nv,) present velocity."""
        return self.coordinates.v(self.q, self.mj_data.qvel)

    def reset(self, q: ArrayLike, v: ArrayLike | None = None) -> None:
        """Start anew at time zero in posture `q` (nq,), at velocity `v` (nv,), at rest by default."""
        posture = vector("q", q, self.model.nq)
        velocity = np.zeros(self.model.nv) if v is None else vector("v", v, self.model.nv)
        mujoco.mj_resetData(self.mj_model, self.mj_data)
        self.mj_data.qpos[:] = self.coordinates.qpos(posture)
        self.mj_data.qvel[:] = self.coordinates.qvel(posture, velocity)
        self._tau: FloatArray | None = None
        mujoco.mj_forward(self.mj_model, self.mj_data)
        self._load = self._wrenches.read(self.mj_data)
        self._measurement = self._sample(np.zeros(self.model.nv - self._base), (0.0, self.q, self.v))

    def step(self, tau: ArrayLike) -> Measurement:
        """Hold motor torques `tau` [Nm] for one tick and move on; returns the measurement at its beginning.

        Forces put on with `apply_force` act throughout, until cleared.
        """
        torques = vector("tau", tau, self.model.nv - self._base)
        self.mj_data.ctrl[self._motors] = torques
        state = (self.time, self.q, self.v)
        mujoco.mj_step(self.mj_model, self.mj_data)
        self._measurement = self._sample(torques, state)
        self._tau = torques
        for _ in range(self._substeps - 1):
            mujoco.mj_step(self.mj_model, self.mj_data)
        # mj_step leaves poses, contacts and sensors of the step's beginning; bring them to the present.
        mujoco.mj_forward(self.mj_model, self.mj_data)
        self._load = self._wrenches.read(self.mj_data)
        return self._measurement

    def measure(self) -> Measurement:
        """The measurement at the beginning of the last `step`; before any, the start with zero torque."""
        return self._measurement

    def apply_force(self, link: str, point: ArrayLike, force: ArrayLike) -> None:
        """Put `force` (3,) [N] on `link` at `point` (3,) [m], both in the world frame, until `clear_forces`.

        Forces add up. Within a tick the point goes along with the centre of mass of the link's body.
        """
        body = self._body(link)
        push = vector("force", force, 3)
        arm = vector("point", point, 3) - self.mj_data.xipos[body]
        # Not qfrc_applied: force/torque sensors would not see it.
        self.mj_data.xfrc_applied[body, :3] += push
        self.mj_data.xfrc_applied[body, 3:] += np.cross(arm, push)

    def clear_forces(self) -> None:
        """Take off all forces put on with `apply_force`."""
        self.mj_data.xfrc_applied[:] = 0.0

    def external_torque(self) -> FloatArray:
        """(nv,) what the applied forces put on the joints now: the truth an observer looks for [Nm]."""
        return self.coordinates.v(self.q, applied_torque(self.mj_model, self.mj_data))

    def link_pose(self, link: str) -> FloatArray:
        """(4, 4) pose of the link's frame in the world, now."""
        frame = self._frame(link)
        body = self.coordinates.bodies[frame.parentJoint]
        pose = np.eye(4)
        pose[:3, :3] = self.mj_data.xmat[body].reshape(3, 3)
        pose[:3, 3] = self.mj_data.xpos[body]
        return pose @ np.asarray(frame.placement.homogeneous, dtype=np.float64)

    def _frame(self, link: str) -> pin.Frame:
        if not self.model.existFrame(link, pin.FrameType.BODY):
            links = [frame.name for frame in self.model.frames if frame.type == pin.FrameType.BODY]
            raise InputError(f"link: no link '{link}'; the robot has {', '.join(links)}")
        return self.model.frames[self.model.getFrameId(link, pin.FrameType.BODY)]

    def _body(self, link: str) -> int:
        joint = self._frame(link).parentJoint
        if joint == 0:
            raise InputError(f"link: '{link}' is fixed to the world, a force on it moves nothing")
        return int(self.coordinates.bodies[joint])

    def _sample(self, tau: FloatArray, state: tuple[float, FloatArray, FloatArray]) -> Measurement:
        """MuJoCo's sensors are those with `tau` in `state`; `_load` is as it was under the torque before."""
        load = self._wrenches.read(self.mj_data)
        before, load_before = (tau, load) if self._tau is None else (self._tau, self._load)
        error = 0.0 if self._noise is None else self._noise.measure(tau) - tau
        wrenches = 0.5 * (load_before + load)
        if self._wrench_noise is not None:
            wrenches = self._wrench_noise.measure(wrenches)
        return Measurement(*state, tau + error, 0.5 * (before + tau) + error, wrenches)


def _motor_numbers(model: pin.Model, mj_model: mujoco.MjModel, base: int) -> list[int]:
    names = [str(name) for name in model.names[1 + (base > 0) :]]
    numbers = [int(mujoco.mj_name2id(mj_model, mujoco.mjtObj.mjOBJ_ACTUATOR, name)) for name in names]
    for name, number in zip(names, numbers, strict=True):
        if number < 0:
            raise ModelError(f"the MuJoCo model has no motor '{name}'")
    return numbers
