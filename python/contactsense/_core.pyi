"""Types of the compiled core. Its docstrings are written here by tools/stub_docs.py."""

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Self, disjoint_base

__all__ = [
    "_LINK_PREFIX",
    "BodyInertia",
    "Calibration",
    "Candidate",
    "ClosestPoints",
    "Contact",
    "ContactClass",
    "ContactClassifier",
    "ContactEstimate",
    "ContactIsolator",
    "ContactMap",
    "ContactMemory",
    "ContactMonitor",
    "ContactParticleFilter",
    "ContactReport",
    "ContactSenseError",
    "Finding",
    "ForceTorqueSensor",
    "GeometryError",
    "Identifiability",
    "InputError",
    "Isolation",
    "JointFriction",
    "LoadCompensator",
    "MapEstimate",
    "Mode",
    "ModelError",
    "MomentumObserver",
    "Motion",
    "NextMotion",
    "NoiseModel",
    "Particles",
    "Payload",
    "PayloadProposal",
    "RayHits",
    "Reaction",
    "Robot",
    "StaticObstacleSampler",
    "Surface",
    "SurfaceSamples",
    "ToolLoad",
    "__version__",
    "_best_cone_forces",
    "_calibrate",
    "_checked_urdf",
    "_restore",
    "_robot_from_urdf",
    "build_profile",
    "diagnose",
    "exciting_motion",
    "identify_tool",
    "next_motion",
]

__version__: Final[str]
_LINK_PREFIX: Final[str]
build_profile: Final[Literal["debug", "release"]]

class ContactSenseError(Exception):
    """Root of every error this library raises on purpose."""

class ModelError(ContactSenseError):
    """The robot's description (URDF or Pinocchio model) cannot be used; the message names the element."""

class GeometryError(ContactSenseError):
    """A mesh or shape of the robot's surface cannot be used; the message names the link or file."""

class InputError(ContactSenseError, ValueError):
    """An argument of a call is wrong; the message names it and says what would be right.

    The object's state is as it was before the call. Also raised where another thread is using the object.
    """

def _best_cone_forces(
    grams: ArrayLike, products: ArrayLike, frictions: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], list[str]]:
    """Forces `(n, 3)`, objectives `(n,)` and parts of the cone; a problem a row, of Gram matrices by rows, `(n, 9)`, products
    `(n, 3)` and friction coefficients `(n,)`.
    """

def _restore(kind: str, version: str, content: Any) -> Any:
    """The object of a class, from what `__reduce__` gave."""

def _checked_urdf(
    path: str | PathLike[str],
    package_dirs: Sequence[str | PathLike[str]],
    floating_base: bool,
    geometry: str,
    missing_meshes: str,
) -> tuple[str, list[tuple[str, int, tuple[Any, tuple[Any, ...]]]], list[str]]:
    """Text for Pinocchio, its shapes that stand for others, and warnings (`contactsense::load::CheckedUrdf`)."""

def _robot_from_urdf(
    path: str | PathLike[str],
    package_dirs: Sequence[str | PathLike[str]] = ...,
    floating_base: bool = False,
    locked: Sequence[tuple[str, float]] = ...,
    geometry: str = "collision",
    gravity: Sequence[float] = ...,
    armature: Sequence[tuple[str, float]] = ...,
    missing_meshes: str = "error",
) -> Robot:
    """A robot read without Pinocchio."""

@disjoint_base
class Robot:
    """A robot: immutable, shareable between threads."""

    def __new__(cls, description: tuple[Any, ...] | Robot) -> Self: ...
    @property
    def name(self) -> str:
        """The robot's name."""
    @property
    def nq(self) -> int:
        """Number of configuration variables."""
    @property
    def nv(self) -> int:
        """Number of velocity variables."""
    @property
    def floating_base(self) -> bool:
        """Whether the base moves freely."""
    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the moving joints, in the order of `v`."""
    @property
    def joint_kinds(self) -> tuple[str, ...]:
        """How each joint moves: "free_flyer", "revolute", "continuous" or "prismatic"."""
    @property
    def link_names(self) -> tuple[str, ...]:
        """Names of the links that have a surface."""
    @property
    def all_link_names(self) -> tuple[str, ...]:
        """Names of all links, also those without a surface."""
    @property
    def actuated_joint_names(self) -> tuple[str, ...]:
        """Names of the joints that an actuator can move: all but a floating base's."""
    @property
    def mass(self) -> float:
        """Mass of all that moves [kg]."""
    @property
    def gravity(self) -> NDArray[np.float64]:
        """Gravity, `(3,)`, world frame [m/s^2]."""
    @property
    def position_limits(self) -> NDArray[np.float64]:
        """Smallest and largest value of each configuration variable, `(nq, 2)` [rad or m]; infinite where there is none.

        The (cos, sin) pairs of continuous joints and the pose of a floating base have none.
        """
    @property
    def velocity_limits(self) -> NDArray[np.float64]:
        """Largest velocity of each velocity variable, `(nv,)` [rad/s, m/s].

        It is infinite where there is no limit, and for a floating base.
        """
    @property
    def effort_limits(self) -> NDArray[np.float64]:
        """Largest effort of each velocity variable, `(nv,)` [Nm, N].

        It is infinite where there is no limit, and zero for a floating base, which no actuator moves.
        """
    @property
    def warnings(self) -> tuple[str, ...]:
        """What was odd in the description, and what was done about it; also logged as warnings of "contactsense"."""
    def configuration(
        self, positions: Mapping[str, float], *, base: ArrayLike | None = None
    ) -> NDArray[np.float64]:
        """A configuration from joint positions by name, in any order; joints that are not named are neutral.

        Args:
            positions: `{joint: position}` [rad; m for sliding joints]; continuous joints take their angle.
            base: pose of a floating base in the world: position [m] and quaternion xyzw, `(7,)`, or a matrix, `(4, 4)`.

        Returns:
            `(nq,)`, writable.

        Raises:
            InputError: a name is no joint's (the message lists those that are), a value is not finite, or the base of this
                robot is fixed.
        """
    def velocity(
        self, velocities: Mapping[str, float], *, base: ArrayLike | None = None
    ) -> NDArray[np.float64]:
        """A velocity from joint velocities by name, in any order; joints that are not named stand still.

        Args:
            velocities: `{joint: velocity}` [rad/s; m/s for sliding joints].
            base: linear [m/s] and angular [rad/s] velocity of a floating base in its own frame, `(6,)`.

        Returns:
            `(nv,)`, writable.

        Raises:
            InputError: as for `configuration`.
        """
    def torque(self, torques: Mapping[str, float]) -> NDArray[np.float64]:
        """Torques from joint torques by name, in any order; the others, and a floating base's, are zero.

        Args:
            torques: `{joint: torque}` [Nm; N for sliding joints].

        Returns:
            `(nv,)`, writable.

        Raises:
            InputError: as for `configuration`.
        """
    def integrate(self, q: ArrayLike, v: ArrayLike) -> NDArray[np.float64]:
        """The configuration that a second of motion at constant velocity leads to, as `pinocchio.integrate`.

        A floating base moves along its twist, which is given in its own frame; (cos, sin) pairs turn. For a step of `dt` pass
        `dt * v`.

        Args:
            q: configuration, `(nq,)`.
            v: velocity, `(nv,)` [rad/s, m/s].

        Returns:
            `(nq,)`, writable.

        Raises:
            InputError: an argument cannot be used; names it.
        """
    def random_configuration(self, seed: int) -> NDArray[np.float64]:
        """A random configuration; the same for the same seed.

        Joints are uniform within their limits, within half a turn either way where they have none (sliding joints within 1 m).
        A floating base is within 1 m of the origin along each axis, and its orientation is uniform.

        Args:
            seed: a whole number, not negative.

        Returns:
            `(nq,)`, writable.

        Raises:
            InputError: the seed is no such number.
        """
    def _with_payload(self, link: str, mass: float, com: ArrayLike, inertia: ArrayLike) -> Robot: ...
    def neutral(self) -> NDArray[np.float64]:
        """The neutral configuration, `(nq,)`."""
    def mass_matrix(self, q: ArrayLike) -> NDArray[np.float64]:
        """The joint-space mass matrix `M(q)`.

        Args:
            q: configuration, `(nq,)`.

        Returns:
            `(nv, nv)` [kg m^2; kg for sliding joints and a base's linear part].

        Raises:
            InputError: `q` is not finite, or without unit quaternions and (cos, sin) pairs.
        """
    def inverse_dynamics(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> NDArray[np.float64]:
        """The torque of a motion, `M(q) a + C(q, v) v + g(q)`.

        Args:
            q: configuration, `(nq,)`.
            v: velocity, `(nv,)` [rad/s, m/s].
            a: acceleration, `(nv,)` [rad/s^2, m/s^2].

        Returns:
            `(nv,)` [Nm; N for sliding joints and a base's linear part].

        Raises:
            InputError: an argument cannot be used; names it.
        """
    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, tau_ext: ArrayLike | None = None
    ) -> NDArray[np.float64]:
        """The acceleration of torques, `M(q)^-1 (tau + tau_ext - C(q, v) v - g(q))`.

        A joint that moves no inertia gets acceleration 0.

        Args:
            q: configuration, `(nq,)`.
            v: velocity, `(nv,)` [rad/s, m/s].
            tau: motor torque, `(nv,)`, or `(nv - 6,)` for a floating base [Nm, N].
            tau_ext: external torque, `(nv,)` [Nm, N]; none by default.

        Returns:
            `(nv,)` [rad/s^2, m/s^2].

        Raises:
            InputError: an argument cannot be used; names it.
        """
    def link_pose(self, q: ArrayLike, link: str) -> NDArray[np.float64]:
        """Pose of a link in the world.

        Args:
            q: configuration, `(nq,)`.
            link: name of any link, also one without surface.

        Returns:
            `(4, 4)`, homogeneous [m].

        Raises:
            InputError: an argument cannot be used; an unknown link's message lists the links.
        """
    def jacobian(self, q: ArrayLike, link: str, point: ArrayLike | None = None) -> NDArray[np.float64]:
        """Geometric Jacobian of a link, linear rows first, world axes.

        Args:
            q: configuration, `(nq,)`.
            link: name of any link.
            point: a point fixed to the link, `(3,)`, world frame [m]; the link's origin by default.

        Returns:
            `(6, nv)`.

        Raises:
            InputError: an argument cannot be used; names it.
        """
    def surface(self, link: str) -> Surface:
        """The surface of a link, in the link frame.

        Args:
            link: name of a link that has a surface.

        Returns:
            A `Surface`.

        Raises:
            InputError: the link is unknown or has no surface; the message lists those that have one.
        """

@final
class Surface:
    """One link's surface, in the link frame.

    `Robot.surface` gives it. Frozen, shareable between threads; can be pickled and copied where its robot can.

    Example:
        >>> import contactsense as cs
        >>> robot = cs.Robot.named("iiwa14")
        >>> surface = robot.surface(robot.link_names[-1])
        >>> samples = surface.sample(100)
        >>> bool((surface.closest_points(samples.points).distances < 1e-9).all())
        True
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def vertices(self) -> NDArray[np.float64]:
        """Vertices, `(n, 3)`, link frame [m]; of exact primitives a tessellation, for display; read-only."""
    @property
    def triangles(self) -> NDArray[np.int64]:
        """Vertex indices, `(m, 3)`, counter-clockwise seen from outside; read-only."""
    @property
    def area(self) -> float:
        """Sum of the parts' areas [m^2]; where parts overlap, both count."""
    @property
    def watertight(self) -> bool:
        """Whether every part is closed."""
    def closest_points(self, points: ArrayLike) -> ClosestPoints:
        """The nearest surface point of each query: the minimum over the link's parts.

        Args:
            points: Queries, `(n, 3)`, or one `(3,)`, link frame [m].

        Returns:
            One row a query; distances are unsigned.

        Raises:
            InputError: Names the argument.
            MemoryError: The answer does not fit into memory.
        """
    def cast_rays(self, origins: ArrayLike, directions: ArrayLike) -> RayHits:
        """Every intersection of each ray, sorted by distance per ray.

        Watertight: a closed mesh is entered as often as left. Intersections inside another closed part of the link are
        left out.

        Args:
            origins: Where the rays begin, `(n, 3)`, or one `(3,)`, link frame [m].
            directions: Of the rays, as many, link frame; they need not be unit vectors.

        Returns:
            One row an intersection; distances are in metres.

        Raises:
            InputError: Names the argument.
            MemoryError: The answer does not fit into memory.
        """
    def sample(self, n: int, seed: int = 0) -> SurfaceSamples:
        """Draws random points, uniform by area over the exposed surface; the same for the same seed.

        Args:
            n: How many; a larger number appends to the same points.
            seed: A whole number.

        Returns:
            One row a point, link frame.

        Raises:
            InputError: Names the argument.
            MemoryError: The points do not fit into memory.
        """

@final
class ClosestPoints:
    """Nearest points, one row a query; all arrays are read-only.

    Frozen; can be pickled and copied.

    Example:
        >>> import contactsense as cs
        >>> robot = cs.Robot.named("iiwa14")
        >>> surface = robot.surface(robot.link_names[-1])
        >>> surface.closest_points([[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]).points.shape
        (2, 3)
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def points(self) -> NDArray[np.float64]:
        """Nearest point of each query, `(n, 3)`, link frame [m]."""
    @property
    def normals(self) -> NDArray[np.float64]:
        """Outward unit normals there, `(n, 3)`, link frame."""
    @property
    def distances(self) -> NDArray[np.float64]:
        """Unsigned distances, `(n,)` [m]."""
    @property
    def triangles(self) -> NDArray[np.int64]:
        """Rows of `Surface.triangles`, `(n,)`; -1 on an exact primitive."""

@final
class RayHits:
    """Every intersection of a batch of rays, sorted per ray; all arrays are read-only.

    Frozen; can be pickled and copied.

    Example:
        >>> import contactsense as cs
        >>> robot = cs.Robot.named("iiwa14")
        >>> surface = robot.surface(robot.link_names[-1])
        >>> hits = surface.cast_rays([[0.0, 0.0, 1.0]], [[0.0, 0.0, -1.0]])
        >>> len(hits.ray) % 2
        0
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def ray(self) -> NDArray[np.int64]:
        """Row of the query, `(k,)`."""
    @property
    def distance(self) -> NDArray[np.float64]:
        """Distance from the ray's origin, `(k,)` [m]."""
    @property
    def point(self) -> NDArray[np.float64]:
        """Point of intersection, `(k, 3)`, link frame [m]."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward unit normal there, `(k, 3)`, link frame."""
    @property
    def triangle(self) -> NDArray[np.int64]:
        """Row of `Surface.triangles`, `(k,)`; -1 on an exact primitive."""

@final
class SurfaceSamples:
    """Random points of a surface; all arrays are read-only.

    Frozen; can be pickled and copied.

    Example:
        >>> import contactsense as cs
        >>> robot = cs.Robot.named("iiwa14")
        >>> surface = robot.surface(robot.link_names[-1])
        >>> surface.sample(100, seed=1).points.shape
        (100, 3)
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def points(self) -> NDArray[np.float64]:
        """Points, `(n, 3)`, link frame [m]."""
    @property
    def normals(self) -> NDArray[np.float64]:
        """Outward unit normals there, `(n, 3)`, link frame."""
    @property
    def triangles(self) -> NDArray[np.int64]:
        """Rows of `Surface.triangles`, `(n,)`; -1 on an exact primitive."""

@final
class MomentumObserver:
    """The generalised momentum observer (Vorndamme 2017, eqs. 4-6) with its acceleration (eq. 9).

    Estimates the external torque from positions, velocities and motor torques; each component is the true one behind a
    first-order low-pass with time constant `1 / gain`. Stable for any `gain * dt`. One thread at a time may use it.

    Args:
        robot: The robot.
        dt: Time between two calls [s].
        gain: Scalar or `(nv,)` [1/s].
        calibration: A `Calibration` of this robot: velocities and torques are corrected, and inertias are those that its
            motion showed. Torques, velocities and the pose are those of one time, when the latest of the measured signals
            was what it is (`velocity_delay`, `torque_delay`).

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> q, v = np.full(7, 0.4), np.zeros(7)
        >>> tau = robot.inverse_dynamics(q, v, v)
        >>> tau[1] -= 2.0
        >>> observer = cs.MomentumObserver(robot, dt=1e-3)
        >>> for _ in range(500):
        ...     external_torque = observer.update(q, v, tau)
        >>> round(float(external_torque[1]), 6)
        2.0
    """

    def __new__(
        cls, robot: Robot, *, dt: float, gain: ArrayLike = 50.0, calibration: Calibration | None = None
    ) -> Self: ...
    @property
    def robot(self) -> Robot:
        """The robot."""
    @property
    def dt(self) -> float:
        """Time between two calls that is assumed where `update` is given none [s]."""
    @property
    def gain(self) -> NDArray[np.float64]:
        """The gain, `(nv,)` [1/s]; a read-only copy.

        A scalar or `(nv,)` may be set; the external torque goes on from where it is.
        """
    @gain.setter
    def gain(self, value: ArrayLike) -> None: ...
    def update(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        *,
        dt: float | None = None,
        friction: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Takes in one tick. The first call sets the initial momentum and returns zeros.

        Args:
            q: Configuration, `(nq,)`.
            v: Velocity, `(nv,)` [rad/s; m/s for sliding joints], measured when `q` was.
            tau: Motor torque, `(nv,)`, or `(nv - 6,)` for a floating base [Nm; N for sliding joints]: at that instant, or
                better the mean of the torques held before and after it.
            dt: Time since the last call [s]; None for the constructor's.
            friction: Torque of friction, shaped as `tau` [Nm, N], which is subtracted from it; None for no friction.

        Returns:
            The external torque, `(nv,)` [Nm; N for sliding joints and a base's linear part]; read-only.

        Raises:
            InputError: Names the argument; the state is then unchanged.
        """
    def reset(self) -> None:
        """Forgets all ticks; the next call is a first call."""
    @property
    def external_torque(self) -> NDArray[np.float64]:
        """External torque of the last tick, `(nv,)` [Nm; N for sliding joints]; a read-only copy."""
    @property
    def acceleration(self) -> NDArray[np.float64]:
        """Acceleration estimated at the last tick, `(nv,)` [rad/s^2; m/s^2 for sliding joints]; a read-only copy.

        Forward dynamics with the external torque (Vorndamme 2017, eq. 9).
        """

@final
class ForceTorqueSensor:
    """A six-axis force/torque sensor where `link` joins its parent: `link` and all behind it load the sensor.

    A reading is (force, moment) about the sensor frame's origin, in its axes [N, Nm]. Frozen; equal where all arguments
    are; can be pickled and copied.

    Args:
        name: Its name, unique among a robot's sensors.
        link: Name of the link that it joins to the link's parent.
        pose: The sensor frame in the link's, `(4, 4)` [m]; None for the link frame itself.
        convention: "load": what the distal side exerts on the sensor (a free hand at rest: its weight); "support": the
            opposite.
        offset: What the sensor reads without load, `(6,)` [N, Nm], in its own axes and convention: subtracted from
            readings before all else. None for zeros.

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs
        >>> sensor = cs.ForceTorqueSensor("wrist", "link_7", convention="support")
        >>> sensor
        ForceTorqueSensor('wrist', 'link_7', convention='support')
        >>> sensor.pose.shape
        (4, 4)
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    def __new__(
        cls,
        name: str,
        link: str,
        *,
        pose: ArrayLike | None = None,
        convention: Literal["load", "support"] = "load",
        offset: ArrayLike | None = None,
    ) -> Self: ...
    @property
    def name(self) -> str:
        """Name of the sensor."""
    @property
    def link(self) -> str:
        """Name of the link that it joins to the link's parent."""
    @property
    def pose(self) -> NDArray[np.float64]:
        """The sensor frame in the link's, `(4, 4)` [m]; a read-only copy."""
    @property
    def convention(self) -> Literal["load", "support"]:
        """What a reading means: "load" or "support"."""
    @property
    def offset(self) -> NDArray[np.float64]:
        """What the sensor reads without load, `(6,)` [N, Nm], in its own axes and convention; a read-only copy."""
    def __hash__(self) -> int: ...

@final
class LoadCompensator:
    """Frees the readings of force/torque sensors of the weight and inertia behind them (Vorndamme 2017, eqs. 13-19).

    One pass for all sensors, also for several in a chain and at fixed joints. One thread at a time may use it.

    Args:
        robot: The robot.
        sensors: Of `ForceTorqueSensor`; names and links are unique.
        calibration: A `Calibration` of this robot: inertias are those that its motion showed, and its `sensor_offsets`
            replace the offset of each sensor that they name.

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> compensator = cs.LoadCompensator(robot, [cs.ForceTorqueSensor("wrist", robot.link_names[-1])])
        >>> compensator.update(np.zeros(7), np.zeros(7), np.zeros(7), np.zeros((1, 6))).shape
        (1, 6)
    """

    def __new__(
        cls, robot: Robot, sensors: Iterable[ForceTorqueSensor], *, calibration: Calibration | None = None
    ) -> Self: ...
    @property
    def robot(self) -> Robot:
        """The robot."""
    @property
    def sensors(self) -> tuple[ForceTorqueSensor, ...]:
        """The sensors, of `ForceTorqueSensor`, in the order of the wrenches, with their present offsets."""
    @property
    def offsets(self) -> NDArray[np.float64]:
        """What is subtracted from the readings, `(n_sensors, 6)` [N, Nm], sensor axes; a read-only copy. Can be set."""
    @offsets.setter
    def offsets(self, offsets: ArrayLike) -> None: ...
    def tare(self, q: ArrayLike, wrenches: ArrayLike) -> NDArray[np.float64]:
        """Sets the offsets so that the free load reads zero.

        The robot is at rest at `q`, and nothing touches it behind the sensors. One pose cannot tell an offset from a
        weight that the robot lacks: where the tool is not in the model, see `identify_tool`.

        Args:
            q: Configuration, `(nq,)`.
            wrenches: Readings as the sensors give them, `(n_sensors, 6)`, or several rows `(n, n_sensors, 6)`, whose mean
                counts [N, Nm], sensor axes. A NaN leaves a reading out; a sensor without any keeps its offset.

        Returns:
            The offsets, `(n_sensors, 6)` [N, Nm]; read-only.

        Raises:
            InputError: Names the argument; the offsets are then unchanged.
        """
    def update(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, wrenches: ArrayLike) -> NDArray[np.float64]:
        """The external wrench that each sensor sees.

        Args:
            q: Configuration, `(nq,)`.
            v: Velocity, `(nv,)` [rad/s; m/s for sliding joints].
            a: Acceleration, `(nv,)` [rad/s^2; m/s^2 for sliding joints].
            wrenches: The readings, `(n_sensors, 6)` [N, Nm], sensor axes. A NaN in a row leaves its sensor out: its row of
                the answer is NaN, the others hold.

        Returns:
            `(n_sensors, 6)` [N, Nm]: (force, moment) on the robot at each sensor's origin, world axes; read-only.

        Raises:
            InputError: Names the argument.
        """

@final
class PayloadProposal:
    """A payload that recent motion shows and the model lacks, as `ContactMonitor.propose_payload` finds it.

    Frozen; equal where all numbers are; can be pickled and copied.

    Example:
        >>> import contactsense as cs
        >>> monitor = cs.ContactMonitor(cs.Robot.named("iiwa14"), dt=1e-3)
        >>> monitor.propose_payload() is None  # of a robot that has not moved
        True
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def link(self) -> str:
        """Name of the link that carries it."""
    @property
    def mass(self) -> float:
        """Mass in addition to what `monitor.robot` has [kg]."""
    @property
    def mass_std(self) -> float:
        """Standard deviation of `mass` [kg]."""
    @property
    def com(self) -> NDArray[np.float64]:
        """Centre of mass, `(3,)`, link frame [m]; a read-only copy."""
    @property
    def com_std(self) -> NDArray[np.float64]:
        """Standard deviation of each coordinate of `com`, `(3,)` [m]; a read-only copy."""
    @property
    def evidence(self) -> float:
        """Share of the time with an external torque in which the payload explains it, from 0 to 1."""
    @property
    def poses(self) -> int:
        """Number of poses of the link towards gravity in which it does."""
    @property
    def seconds(self) -> float:
        """Length of the motion that it was found in, up to now [s]."""
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays.
        """

@final
class ToolLoad:
    """A tool behind a force/torque sensor, and the sensor's offset, as `identify_tool` finds them.

    `robot.with_payload(tool.link, tool.mass, tool.com)` and a sensor with `offset=tool.offset` read zero where nothing
    touches the robot. Frozen; equal where all numbers are; can be pickled and copied.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_7")
        >>> q = np.array([robot.random_configuration(seed) for seed in range(6)])
        >>> compensator = cs.LoadCompensator(robot, [sensor])
        >>> readings = np.concatenate([-compensator.tare(row, np.zeros((1, 6))) for row in q])
        >>> tool = cs.identify_tool(robot, sensor, q, readings)  # of a robot that has no tool
        >>> round(tool.mass, 6), tool.com_std.round(3).tolist()
        (0.0, [0.3, 0.3, 0.3])
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def link(self) -> str:
        """The sensor's link, which holds the tool."""
    @property
    def mass(self) -> float:
        """Mass in addition to the robot's description [kg]; not negative."""
    @property
    def mass_std(self) -> float:
        """Standard deviation of `mass` [kg]."""
    @property
    def com(self) -> NDArray[np.float64]:
        """Its centre of mass, `(3,)`, link frame [m]; a read-only copy."""
    @property
    def com_std(self) -> NDArray[np.float64]:
        """Standard deviation of each coordinate of `com`, `(3,)` [m]; a read-only copy.

        It is 0.3 m where the mass is too small to tell.
        """
    @property
    def offset(self) -> NDArray[np.float64]:
        """What the sensor reads without load, `(6,)` [N, Nm], in its own axes and convention; a read-only copy."""
    @property
    def offset_std(self) -> NDArray[np.float64]:
        """Standard deviation of each number of `offset`, `(6,)` [N, Nm]; a read-only copy."""
    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of mass, centre of mass and offset, in this order, `(10, 10)` [kg, m, N, Nm]; a read-only copy."""
    @property
    def residual(self) -> NDArray[np.float64]:
        """What is left of the mean readings, root mean square over the poses, `(6,)` [N, Nm]; a read-only copy."""
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays.
        """

def identify_tool(robot: Robot, sensor: ForceTorqueSensor, q: ArrayLike, wrenches: ArrayLike) -> ToolLoad:
    """Finds the mass and centre of a tool that the robot's description lacks, and the sensor's offset, from poses at rest.

    For a sensor that was zeroed with the tool on, or never: one pose cannot tell offset from weight, four can. Gravity must
    point in four directions of the sensor frame that differ about two axes; more and larger differences are better. The
    robot stands still in each pose, and nothing touches it behind the sensor. The sensor's own `offset` is not looked at.

    Args:
        robot: The robot, without the tool.
        sensor: A `ForceTorqueSensor`.
        q: Configurations, `(n, nq)`, one for each pose.
        wrenches: Readings as the sensor gives them, `(n, 6)`, or several in each pose, `(n, k, 6)`, whose mean counts
            [N, Nm], sensor axes. A NaN leaves a reading out; a pose without any is left out.

    Returns:
        A `ToolLoad`.

    Raises:
        InputError: Names the argument: also where the poses do not suffice, with the directions of gravity that are missing,
            and where the readings are those of no tool.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_7")
        >>> loaded = cs.LoadCompensator(robot.with_payload("iiwa_link_7", 1.2, [0.0, 0.0, 0.1]), [sensor])
        >>> q = np.array([robot.random_configuration(seed) for seed in range(6)])
        >>> readings = np.concatenate([-loaded.tare(row, np.zeros((1, 6))) for row in q])
        >>> tool = cs.identify_tool(robot, sensor, q, readings + [5.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        >>> round(tool.mass, 3), round(float(tool.com[2]), 3), round(float(tool.offset[0]), 3)
        (1.2, 0.1, 5.0)
    """

@disjoint_base
class Calibration:
    """Base of the class that users have, which adds files."""

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    def __new__(cls, content: Calibration | str) -> Self: ...
    def _content(self) -> str:
        """The core's content as JSON."""
    @staticmethod
    def _load(path: str | PathLike[str]) -> Calibration: ...
    def _to_yaml(self, source: str, date: str) -> str:
        """The text of a file."""
    @staticmethod
    def _of_description(robot: Robot) -> Calibration: ...
    @property
    def robot_name(self) -> str:
        """Name of the robot that it is of."""
    @property
    def fingerprint(self) -> str:
        """Of that robot's joints and inertias, to tell it from others."""
    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the robot's moving joints, in the order of `v`."""
    @property
    def torque_bias(self) -> NDArray[np.float64]:
        """Constant torque that the measurement adds, `(nv,)` [Nm; N for sliding joints]; a read-only copy."""
    @property
    def torque_bias_std(self) -> NDArray[np.float64]:
        """Standard deviation of `torque_bias`, `(nv,)` [Nm; N for sliding joints]; a read-only copy."""
    @property
    def torque_scale(self) -> NDArray[np.float64]:
        """Factor from measured to true torque, its sign included, `(nv,)`; a read-only copy."""
    @property
    def torque_is_external(self) -> bool:
        """Whether the torques are external torques of the vendor: then only bias, scale and noise are corrected."""
    @property
    def friction(self) -> JointFriction:
        """Friction inside the measured torque: a `JointFriction`."""
    @property
    def hysteresis(self) -> NDArray[np.float64]:
        """Share of a change of the torque that gears keep back, `(nv,)`; a read-only copy.

        Three times this share while the torque has changed by at most twice `hysteresis_width` since it last turned
        round, twice up to six widths, once up to eighteen, none beyond.
        """
    @property
    def hysteresis_std(self) -> NDArray[np.float64]:
        """Standard deviation of `hysteresis`, `(nv,)`; a read-only copy."""
    @property
    def hysteresis_width(self) -> NDArray[np.float64]:
        """The scale of the torque over which hysteresis levels off, `(nv,)` [Nm; N for sliding joints]; a read-only copy."""
    @property
    def armature(self) -> NDArray[np.float64]:
        """Rotor inertia, reflected through the gear, `(nv,)` [kg m^2; kg for sliding joints]; a read-only copy."""
    @property
    def armature_std(self) -> NDArray[np.float64]:
        """Standard deviation of `armature`, `(nv,)` [kg m^2; kg for sliding joints]; a read-only copy."""
    @property
    def bodies(self) -> tuple[BodyInertia, ...]:
        """Inertias of all that moves with each joint, without the payload: a tuple of `BodyInertia`, one a joint."""
    @property
    def payload(self) -> Payload | None:
        """What the description lacks on `payload_link`: a `Payload`, or None where none was asked for."""
    @property
    def inertial_change(self) -> float:
        """The share by which inertias may differ from the description, as held-out blocks of the log chose it."""
    @property
    def velocity_delay(self) -> float:
        """How late the velocity is against the position [s]."""
    @property
    def torque_delay(self) -> float:
        """How late the torque is against the position [s]."""
    @property
    def sensor_offsets(self) -> dict[str, NDArray[np.float64]]:
        """What force/torque sensors read without load, by name: a new dict of `(6,)` arrays [N, Nm]."""
    @property
    def noise(self) -> NoiseModel:
        """Errors of the external torque that are left: a `NoiseModel`."""
    @property
    def residual(self) -> NDArray[np.float64]:
        """What is left of the low-passed torque, `(nv,)` [Nm; N for sliding joints]; a read-only copy.

        Root mean square over blocks of the log that were held out of the fit, behind a low-pass of 8/s (slower where the log has few rows a second).
        """
    @property
    def tails(self) -> NDArray[np.float64]:
        """How large the errors made the statistic of detection on those blocks, `(k, 3)`; a read-only copy.

        One row a gain of the observers: the gain [1/s], the statistic that was exceeded 0.8 times a second, and by how much
        more it is at a rate that is a factor of e lower. Where the torques contain the friction
        of gears, no less than of Gaussian errors.
        """
    @property
    def model_errors(self) -> NDArray[np.float64]:
        """Errors of the model that the motion of the log leaves possible and did not show, `(k, joints, 6)`; a read-only copy.

        The k errors are independent of each other, each one standard deviation. By joint: mass [kg] and first moment [kg m] of
        all that moves with the joint, about the joint's origin in its axes; bias of the torque [Nm, N]; and viscous friction
        [Nm s/rad, N s/m]. Where the log visited most poses and speeds, there are few or none. A monitor expects less accurate
        torques at poses and speeds where these errors matter.
        """
    @property
    def false_alarms_per_hour(self) -> float:
        """The rate of false alarms that thresholds are set for [1/h]."""
    @property
    def contacts(self) -> NDArray[np.float64]:
        """From when to when contacts were found in the log and left out, `(k, 2)` [s]; a read-only copy."""
    @property
    def notes(self) -> tuple[str, ...]:
        """What the motion could not tell, and which motion would: a tuple of sentences."""
    def check(self, robot: Robot) -> None:
        """Whether it is of this robot and can be used.

        Args:
            robot: The robot.

        Raises:
            InputError: The calibration is of another robot, or a number cannot be used; the message says which.
        """
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays.
        """

@final
class JointFriction:
    """Friction of the joints inside the measured torque.

    At a velocity `v` it is `coulomb * share + viscous * v`, where the share is between -1 and 1 and `reversal` says how it
    changes its sign. Frozen; equal where all numbers are; can be pickled and copied.

    Example:
        >>> import contactsense as cs
        >>> friction = cs.Calibration.of_description(cs.Robot.named("iiwa14")).friction
        >>> friction.coulomb.shape, friction.reversal[0]
        ((7,), ('velocity', 0.03))
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def coulomb(self) -> NDArray[np.float64]:
        """Coulomb friction, `(nv,)` [Nm; N for sliding joints]; a read-only copy."""
    @property
    def coulomb_std(self) -> NDArray[np.float64]:
        """Standard deviation of `coulomb`, `(nv,)` [Nm; N for sliding joints]; a read-only copy."""
    @property
    def viscous(self) -> NDArray[np.float64]:
        """Viscous friction, `(nv,)` [Nm s/rad; N s/m for sliding joints]; a read-only copy."""
    @property
    def viscous_std(self) -> NDArray[np.float64]:
        """Standard deviation of `viscous`, `(nv,)` [Nm s/rad; N s/m for sliding joints]; a read-only copy."""
    @property
    def reversal(self) -> tuple[tuple[Literal["velocity", "displacement"], float], ...]:
        """How Coulomb friction changes its sign: pairs, one a joint.

        `("velocity", s)`: with the velocity as `tanh(v / s)` [rad/s, m/s]. `("displacement", s)`: with the path since the
        joint turned round, and whole after `2 s` [rad, m].
        """
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays.
        """

@final
class BodyInertia:
    """The inertia of all that moves with one joint, in the frame of the link that the joint moves.

    Frozen; equal where all numbers are; can be pickled and copied.

    Example:
        >>> import contactsense as cs
        >>> body = cs.Calibration.of_description(cs.Robot.named("iiwa14")).bodies[0]
        >>> body.link, round(body.mass, 3)
        ('iiwa_link_1', 5.76)
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def link(self) -> str:
        """Name of that link."""
    @property
    def mass(self) -> float:
        """Mass [kg]."""
    @property
    def com(self) -> NDArray[np.float64]:
        """Centre of mass, `(3,)`, link frame [m]; a read-only copy."""
    @property
    def inertia(self) -> NDArray[np.float64]:
        """Inertia about the centre of mass, `(3, 3)`, in the link's axes [kg m^2]; a read-only copy."""
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays.
        """

@final
class Payload:
    """A payload at a link.

    Frozen; equal where all numbers are; can be pickled and copied.

    Example:
        >>> import contactsense as cs
        >>> cs.Calibration.of_description(cs.Robot.named("iiwa14")).payload is None
        True
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def link(self) -> str:
        """Name of the link that holds it."""
    @property
    def mass(self) -> float:
        """Mass [kg]."""
    @property
    def mass_std(self) -> float:
        """Standard deviation of `mass` [kg]."""
    @property
    def com(self) -> NDArray[np.float64]:
        """Centre of mass, `(3,)`, link frame [m]; a read-only copy."""
    @property
    def com_std(self) -> NDArray[np.float64]:
        """Standard deviation of each coordinate of `com`, `(3,)` [m]; a read-only copy."""
    @property
    def moment(self) -> float:
        """Moment of inertia about the centre of mass, taken to be the same about all axes [kg m^2]."""
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays.
        """

@disjoint_base
class Motion:
    """A planned motion: where the robot is at each instant, `n` rows at equal distances of time. Read-only.

    Velocities and accelerations are the derivatives of the positions, and zero at both ends. Can be pickled and copied.

    Example:
        >>> import contactsense as cs
        >>> motion = cs.exciting_motion(cs.Robot.named("iiwa14"), 2.0)
        >>> q, v, a = motion.at(0.5)
        >>> len(motion), q.shape
        (2001, (7,))
    """

    def at(self, time: float) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """The motion at any time; before and after it, its ends at rest.

        Args:
            time: [s].

        Returns:
            `(q, v, a)`: `(nq,)`, `(nv,)` and `(nv,)`, writable.

        Raises:
            InputError: the time is not a finite number.
        """
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays.
        """
    def __len__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def time(self) -> NDArray[np.float64]:
        """Time of each row, `(n,)`, from zero [s]."""
    @property
    def q(self) -> NDArray[np.float64]:
        """Configurations, `(n, nq)`."""
    @property
    def v(self) -> NDArray[np.float64]:
        """Velocities, `(n, nv)` [rad/s, m/s]."""
    @property
    def a(self) -> NDArray[np.float64]:
        """Accelerations, `(n, nv)` [rad/s^2, m/s^2]."""
    @property
    def duration(self) -> float:
        """Length [s]."""
    @property
    def unchecked(self) -> tuple[tuple[str, str], ...]:
        """Pairs of links whose distance was not checked: neighbours, and those that cross in nearly all poses."""

@final
class NoiseModel:
    """Errors of the external torque of the untouched robot, each as one standard deviation.

    What says how large errors are takes it as `noise`. Frozen; equal where all numbers are; can be pickled and copied.

    Args:
        torque: White noise of the torque, per sample, scalar or `(nv,)` [Nm; N for sliding joints].
        velocity: White noise of the velocity, scalar or `(nv,)` [rad/s; m/s for sliding joints]. It acts through the gain
            of an observer and the mass matrix; what is given an external torque leaves it out.
        relative: Share of the contact's own torque, scalar or `(nv,)`; a tenth of it also of the largest torque.
        model: Slow errors left over (bias, friction, masses), scalar or `(nv,)` [Nm; N for sliding joints].
        model_time: Time over which these change, scalar or `(nv,)` [s].
        friction: Errors of friction while a joint starts, stops or turns round, scalar or `(nv,)` [Nm; N for sliding joints].
        bias: What the bias differs by from one start to the next, scalar or `(nv,)` [Nm; N for sliding joints].
        position_step: Step between two positions that an encoder counts, scalar or `(nv,)` [rad; m for sliding joints]; no
            standard deviation. A joint that starts to move within it still seems to stand.

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs
        >>> noise = cs.NoiseModel(model=0.2)
        >>> noise.torque, noise.model
        (0.05, 0.2)
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    def __new__(
        cls,
        *,
        torque: ArrayLike = 0.05,
        velocity: ArrayLike = 0.0,
        relative: ArrayLike = 0.03,
        model: ArrayLike = 0.1,
        model_time: ArrayLike = 1.0,
        friction: ArrayLike = 0.0,
        bias: ArrayLike = 0.0,
        position_step: ArrayLike = 0.0,
    ) -> Self: ...
    @property
    def torque(self) -> float | NDArray[np.float64]:
        """White noise of the torque [Nm; N for sliding joints]: a number or `(nv,)`; a read-only copy."""
    @property
    def velocity(self) -> float | NDArray[np.float64]:
        """White noise of the velocity [rad/s, m/s]: a number or `(nv,)`; a read-only copy."""
    @property
    def relative(self) -> float | NDArray[np.float64]:
        """Share of the contact's own torque: a number or `(nv,)`; a read-only copy."""
    @property
    def model(self) -> float | NDArray[np.float64]:
        """Slow errors left over [Nm; N for sliding joints]: a number or `(nv,)`; a read-only copy."""
    @property
    def friction(self) -> float | NDArray[np.float64]:
        """Errors of friction at starts and stops [Nm; N for sliding joints]: a number or `(nv,)`; a read-only copy."""
    @property
    def bias(self) -> float | NDArray[np.float64]:
        """What the bias differs by from one start to the next [Nm; N for sliding joints]: a number or `(nv,)`; a read-only copy."""
    @property
    def position_step(self) -> float | NDArray[np.float64]:
        """Step between two positions that an encoder counts [rad; m for sliding joints]: a number or `(nv,)`; a read-only copy."""
    @property
    def model_time(self) -> float | NDArray[np.float64]:
        """Time over which slow errors change [s]: a number or `(nv,)`; a read-only copy."""
    def covariance(
        self, robot: Robot, q: ArrayLike, *, gain: float = 50.0, dt: float = 0.001
    ) -> NDArray[np.float64]:
        """Covariance of the external torque of the untouched robot behind an observer.

        White noise of the torque is averaged, white noise of the velocity passes through gain and mass matrix, and slow errors
        pass as far as the observer follows them.

        Args:
            robot: The robot.
            q: Configuration, `(nq,)`.
            gain: Of the observer [1/s].
            dt: Time between two calls [s].

        Returns:
            `(nv, nv)` [Nm^2].

        Raises:
            InputError: Names the argument.
        """
    def correlation_time(
        self, robot: Robot, q: ArrayLike, *, gain: float = 50.0, dt: float = 0.001
    ) -> NDArray[np.float64]:
        """Over which time errors of the external torque behind an observer stay alike: samples so far apart are independent.

        Args:
            robot: The robot.
            q: Configuration, `(nq,)`.
            gain: Of the observer [1/s].
            dt: Time between two calls [s].

        Returns:
            `(nv,)` [s].

        Raises:
            InputError: Names the argument.
        """
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, and lists in place of arrays.
        """

def diagnose(
    robot: Robot,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    *,
    sensors: Iterable[ForceTorqueSensor] = (),
    wrenches: ArrayLike | None = None,
    time: ArrayLike | None = None,
) -> tuple[Finding, ...]:
    """Finds what is wrong with a robot's model or measurements, from motion without contact.

    Ten seconds or more in which all joints move say most. A few rows with contacts do no harm.

    Args:
        robot: The robot.
        q: Configurations, `(n, nq)`, at least 30 rows in the order of time.
        v: Velocities, `(n, nv)` [rad/s; m/s for sliding joints].
        tau: Joint torques, `(n, nv)`, or `(n, nv - 6)` for a floating base [Nm; N for sliding joints].
        sensors: Force/torque sensors, of `ForceTorqueSensor`.
        wrenches: Their readings, `(n, n_sensors, 6)` [N, Nm], sensor axes; NaN where there is none.
        time: Time of each row, `(n,)`, increasing [s]. Without it, equal steps are assumed, and their length follows from
            `q` and `v`.

    Returns:
        What is wrong, the most important first; empty where all is well.

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> rng = np.random.default_rng(0)
        >>> q, v = rng.uniform(-1.0, 1.0, (60, 7)), np.zeros((60, 7))
        >>> [finding.code for finding in cs.diagnose(robot, q, v, np.zeros((60, 7)))]
        ['gravity_free', 'not_judged']
    """

@final
class Finding:
    """One thing that is wrong with a robot's model or measurements, as `diagnose` finds it.

    Frozen; equal where all attributes are; can be pickled and copied.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> time = np.arange(0.0, 12.0, 0.01)[:, None]
        >>> phase = time * np.linspace(1.0, 2.0, 7) + np.arange(7)
        >>> q, v, a = 0.5 * np.sin(phase), 0.5 * np.linspace(1.0, 2.0, 7) * np.cos(phase), -0.5 * np.linspace(1.0, 2.0, 7) ** 2 * np.sin(phase)
        >>> tau = np.array([robot.inverse_dynamics(*row) for row in zip(q, v, a)])
        >>> cs.diagnose(robot, q, v, tau)
        ()
        >>> finding = cs.diagnose(robot, q, v, -tau)[0]
        >>> finding.code, finding.severity, finding.joint
        ('sign', 'major', None)
    """

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, None, and a list in place of the array.
        """
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def code(self) -> str:
        """What is wrong.

        "sign", "scale", "gravity_free", "permuted", "payload", "tool", "armature", "friction", "bias", "delay",
        "filtered", "limit", "sensor_offset", "gravity_direction", "units", or "not_judged" where something could not be
        judged.
        """
    @property
    def joint(self) -> str | None:
        """Name of the joint; None where it is not one joint."""
    @property
    def link(self) -> str | None:
        """Name of the link that carries a payload or a tool; otherwise None."""
    @property
    def sensor(self) -> str | None:
        """Name of the force/torque sensor; otherwise None."""
    @property
    def value(self) -> float:
        """How large it is, in `unit`; NaN where the fault has no size. Of several joints, the worst."""
    @property
    def unit(self) -> str:
        """Unit of `value`, such as "kg", "Nm", "s" or "deg"; empty for a factor."""
    @property
    def vector(self) -> NDArray[np.float64]:
        """Centre of mass of a payload in the link's frame [m], gravity in the world frame [m/s^2], or the offset of a sensor.

        `(3,)`, NaN for other faults; read-only.
        """
    @property
    def message(self) -> str:
        """What is wrong, with sizes and units."""
    @property
    def evidence(self) -> float:
        """Share of the variance, unexplained until then, that it explains, from 0 to 1."""
    @property
    def severity(self) -> Literal["minor", "major"]:
        """How much it matters: "major" where it spoils the detection of contacts, otherwise "minor"."""

@final
class ContactIsolator:
    """Finds the contacts that explain an external torque and the wrenches that sensors see: links, points and forces.

    One contact by Vorndamme 2017, eqs. 22-26; several with sensors by eq. 27, without by eqs. 28-31. Where torques leave
    parts of two wrenches open, it is used that a contact's force has no moment, acts on the surface and pushes; several
    solutions are candidates. One thread at a time may use it.

    Args:
        robot: The robot.
        sensors: Of `ForceTorqueSensor`, in the order of the wrenches.
        torque_threshold: Scalar or `(nv,)` [Nm; N for sliding joints]. A joint feels a contact above it, and a third of
            it is the standard deviation of a torque. With `noise` the default is three standard deviations at rest.
        wrench_threshold: On external wrenches: scalar, `(6,)` or `(n_sensors, 6)` [N, Nm].
        wanted_contacts: Names of sensors whose contacts are meant and not reported (eq. 20).
        max_contacts: Contacts reported at most.
        pushing: Whether forces push on the surface. If False the point cannot be determined: `located` is False.
        noise: A `NoiseModel` of the torques, in place of what the thresholds say.
        locate_within: A contact is located if 90 % of the places that explain the torques are within this distance of
            its point [m].
        calibration: A `Calibration` of this robot, whose noise takes the place of `noise`.
        samples: Samples of the surface from which the posterior of a single contact is worked out, as `ContactMap` does, where the
            standard deviation of a torque is 3 mNm or more; 0 for closed forms only. Wrenches of
            sensors count as the torques do. Not with `pushing=False`.
        pull_probability: Probability that a contact pulls on the surface, for this posterior.

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> q = np.full(7, 0.4)
        >>> link = robot.link_names[-1]
        >>> sample = robot.surface(link).sample(1, seed=2)
        >>> pose = robot.link_pose(q, link)
        >>> point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
        >>> force = -20.0 * pose[:3, :3] @ sample.normals[0]
        >>> tau_ext = robot.jacobian(q, link, point)[:3].T @ force
        >>> contact = cs.ContactIsolator(robot).isolate(q, tau_ext).contacts[0]
        >>> bool(np.allclose(contact.point, point, atol=1e-6)), bool(np.allclose(contact.force, force, atol=1e-6))
        (True, True)
    """

    def __new__(
        cls,
        robot: Robot,
        *,
        sensors: Iterable[ForceTorqueSensor] = (),
        torque_threshold: ArrayLike = 0.001,
        wrench_threshold: ArrayLike = 0.001,
        wanted_contacts: Iterable[str] = (),
        max_contacts: int = 5,
        pushing: bool = True,
        noise: NoiseModel | None = None,
        locate_within: float = 0.05,
        calibration: Calibration | None = None,
        samples: int = 1000,
        pull_probability: float = 0.05,
    ) -> Self: ...
    @property
    def robot(self) -> Robot:
        """The robot."""
    @property
    def sensors(self) -> tuple[ForceTorqueSensor, ...]:
        """The sensors, of `ForceTorqueSensor`, in the order of the wrenches."""
    @property
    def torque_threshold(self) -> NDArray[np.float64]:
        """Thresholds on the torques, `(nv,)` [Nm; N for sliding joints]; a read-only copy."""
    @property
    def wrench_threshold(self) -> NDArray[np.float64]:
        """Thresholds on the external wrenches, `(n_sensors, 6)` [N, Nm]; a read-only copy."""
    def isolate(self, q: ArrayLike, tau_ext: ArrayLike, wrenches: ArrayLike | None = None) -> Isolation:
        """Finds the contacts that explain an external torque.

        Args:
            q: Configuration, `(nq,)`.
            tau_ext: External torque, `(nv,)` [Nm; N for sliding joints and a base's linear part].
            wrenches: The external wrench that each sensor sees, `(n_sensors, 6)` [N, Nm], as `LoadCompensator` gives it:
                (force, moment) at the sensor's origin, world axes. A NaN in a row leaves its sensor out. Needed where
                there are sensors.

        Returns:
            The contacts of this instant.

        Raises:
            InputError: Names the argument.
        """

@final
class Isolation:
    """All contacts of one instant.

    Frozen; can be pickled and copied.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> isolation = cs.ContactIsolator(robot).isolate(np.full(7, 0.4), [1.0, 2.0, 0.5, 0.0, 0.0, 0.0, 0.0])
        >>> len(isolation.contacts), isolation.rank_deficit
        (1, 3)
    """

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, lists in place of arrays and tuples, and dicts in place of contacts.
        """
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts, farthest from the base first; the same tuple at every access."""
    @property
    def rank_deficit(self) -> int:
        """Components of the contacts' wrenches that the torques leave open (Vorndamme 2017, eq. 31)."""
    @property
    def residual(self) -> float:
        """Norm of the external torque that the contacts do not explain [Nm, N]."""
    @property
    def link_candidates(self) -> tuple[str, ...]:
        """Names of the links that may carry a contact, likeliest first."""
    @property
    def truncated(self) -> bool:
        """Whether something was left out.

        There were more contacts than `max_contacts`, more intersections of a line than are kept (the nearest are), or
        more explanations to try than the bounded work of a call allows.
        """

@final
class Contact:
    """One contact; vectors that the data do not determine are NaN.

    Frozen; can be pickled and copied.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> tau_ext = [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]
        >>> contact = cs.ContactIsolator(robot).isolate(np.full(7, 0.4), tau_ext).contacts[0]
        >>> contact.source
        'joint torques'
        >>> contact.wrench.shape
        (6,)
    """

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, lists in place of arrays and tuples, and dicts in place of candidates.
        """
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def link(self) -> str:
        """Name of the link that is touched."""
    @property
    def point(self) -> NDArray[np.float64]:
        """Point of contact, `(3,)`, world frame [m]; read-only."""
    @property
    def point_local(self) -> NDArray[np.float64]:
        """Point of contact, `(3,)`, link frame [m]; read-only."""
    @property
    def force(self) -> NDArray[np.float64]:
        """Force on the robot, `(3,)`, world frame [N]; read-only."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward unit normal of the surface at the point, `(3,)`, world frame; read-only."""
    @property
    def wrench(self) -> NDArray[np.float64]:
        """Force and moment on the robot at the link's origin, `(6,)`, world axes [N, Nm]; read-only."""
    @property
    def source(self) -> str:
        """What saw it: "joint torques", or the name of a sensor."""
    @property
    def located(self) -> bool:
        """Whether 90 % of the places that explain the torques lie within `locate_within` of the point.

        If not, the link may be known, the point is not.
        """
    @property
    def point_std(self) -> float:
        """Standard deviation of the point [m]; NaN where there is no point.

        The standard deviation of a torque is taken as a third of its threshold, and as more where the torques contradict
        one force. Other places that explain the torques about as well are included. Errors common to all torques, such
        as those of a wrong payload, are not.
        """
    @property
    def verified(self) -> bool:
        """Whether redundant torques agree with the contacts reported.

        False where they do not, and where there are as many unknowns as torques: nothing then checks the assumption that
        each contact is one force without moment.
        """
    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Where it may be, best first.

        Every intersection of the line of action with a surface, points on other links that explain the torques about as
        well, or the points of several solutions. The same tuple at every access.
        """
    @property
    def probability(self) -> float:
        """Probability that the contact is on `link`; NaN where no posterior was worked out.

        A monitor works out the posterior of a single contact over all surface (`ContactMap`), from the wrenches of sensors as well as
        the torques, where `samples` is not zero and there are no wanted points. It takes some ticks from the onset on.
        """
    @property
    def link_probabilities(self) -> dict[str, float]:
        """Probability that the contact is on each link, by the link's name; a new dict at every access, empty without posterior."""
    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of the point, `(3, 3)`, world frame [m^2]; NaN without posterior; read-only.

        The second moment of the posterior about `point`, other modes included.
        """
    @property
    def determined_wrench(self) -> NDArray[np.float64]:
        """What is known of the wrench where the point cannot be determined, `(6,)`; read-only.

        Force and moment on the robot at the link's origin, world axes [N, Nm]. NaN for a contact that is located, and where there are several contacts. `determined_wrench_covariance` says which
        components, or combinations of them, are determined.
        """
    @property
    def determined_wrench_covariance(self) -> NDArray[np.float64]:
        """Covariance of `determined_wrench`, `(6, 6)` [N^2, N^2 m, N^2 m^2]; NaN where that is NaN; read-only.

        Before anything is measured, the standard deviation of each component is 100 N for the force, and 100 N times the distance of
        the link's farthest point from its origin for the moment. What the torques do not determine keeps it.
        """
    @property
    def region_radius(self) -> float:
        """Radius of the ball about `point` that holds 90 % of the posterior [m]; NaN without posterior."""
    @property
    def modes(self) -> tuple[Mode, ...]:
        """Places where the contact may be, most probable first; at most eight, empty without posterior.

        The same tuple at every access.
        """
    @property
    def id(self) -> int | None:
        """Which contact it is over time: the same number in all ticks of one contact; None where contacts are not followed."""
    @property
    def since(self) -> float:
        """Time of the contact's first tick, as `ContactReport.time` [s]; NaN where contacts are not followed."""
    @property
    def peak_force(self) -> float:
        """Greatest force so far [N]; NaN where contacts are not followed."""
    @property
    def path_local(self) -> NDArray[np.float64]:
        """Where the contact has been, oldest first, `(n, 3)`, each point in the frame of its link in `path_links` [m]; read-only.

        A point is added where the torques show that the contact has moved to another place on the robot; until then, the last
        point becomes more exact. At most 32: of a longer path, every second point is left out. Empty where contacts are not
        followed, and where neither a posterior nor a located point has been found yet.
        """
    @property
    def path_times(self) -> NDArray[np.float64]:
        """From when on the contact has been at each point of `path_local`, `(n,)`, as `ContactReport.time` [s]; read-only."""
    @property
    def path_links(self) -> tuple[str, ...]:
        """Names of the links of the points of `path_local`."""

@final
class Candidate:
    """A place where the line of action meets a surface.

    Frozen; can be pickled and copied.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> tau_ext = [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]
        >>> contact = cs.ContactIsolator(robot).isolate(np.full(7, 0.4), tau_ext).contacts[0]
        >>> all(candidate.point.shape == (3,) for candidate in contact.candidates)
        True
    """

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays.
        """
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def link(self) -> str:
        """Name of the link."""
    @property
    def point(self) -> NDArray[np.float64]:
        """Where the line meets the surface, `(3,)`, world frame [m]; read-only."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward unit normal of the surface, `(3,)`, world frame; read-only."""
    @property
    def pushing(self) -> bool:
        """Whether the force enters the surface here."""

@final
class ContactMonitor:
    """The sense of touch of one robot, called once a control tick: observer, compensation, bias, detection, isolation.

    The pipeline of Vorndamme 2017 on one pass over the robot's kinematics. One thread at a time may use it.

    Args:
        robot: The robot.
        dt: Time between two calls [s].
        sensors: Of `ForceTorqueSensor`, in the order of the readings.
        wanted_contacts: Names of the sensors whose contacts are meant (feet, hands): what touches behind them is no
            collision (eq. 20). Or pairs `(link, point_local)` without a sensor: any force at that point of the link
            [m] is meant, and what it cannot explain of the torques is tested.
        observer_gain: Of the momentum observer, scalar or `(nv,)` [1/s].
        torque_threshold: Scalar or `(nv,)` [Nm; N for sliding joints]. With a calibration and without a threshold, all
            joints are tested at once, at three gains, against a level for the calibration's rate of false alarms.
        wrench_threshold: On external wrenches: scalar, `(6,)` or `(n_sensors, 6)` [N, Nm].
        wrench_gain: Of the low-pass on external wrenches, whose readings and velocities are noisy [1/s]; infinite for
            none. None: the smallest of `observer_gain`, and no low-pass where that is at least `0.5 / dt`.
        bias_time_constant: Tracks the torque that errors of the model cause while nothing touches [s]; None for no
            tracking, or 3 s where all joints are tested at once. With thresholds, nothing is detected in the first time
            constant, and what touches in less than half of it is not learnt.
        bias_limit: Greatest bias of each joint, in thresholds.
        bias_settle_time: A torque that stands still for so long becomes the bias [s]; None: a contact may last for ever.
        hysteresis: Share of its greatest torque in a contact that a joint's gear or sensor may keep after it, scalar or
            `(nv,)`; such a remainder becomes the bias up to two thresholds.
        hold_time: A signal stays on so long after it was last over its threshold [s].
        max_contacts: Contacts reported at most.
        pushing: Whether forces push on the surface. If False the point of a contact cannot be determined.
        calibration: A `Calibration` of this robot: velocities and torques are corrected, inertias are those that its motion
            showed, and the noise left over sets thresholds and says how well a contact is located.
        locate_within: A contact is located if 90 % of the places that explain the torques are within this distance of
            its point [m].
        samples: Samples of the surface from which the posterior of a single contact is worked out, as `ContactMap` does,
            spread over ticks; 0 for closed forms only. Wrenches of sensors count as the torques do. Not with wanted points.

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> q, v = np.full(7, 0.4), np.zeros(7)
        >>> tau = robot.inverse_dynamics(q, v, v)
        >>> monitor = cs.ContactMonitor(robot, dt=1e-3)
        >>> monitor.update(q, v, tau).collision
        False
        >>> for _ in range(100):
        ...     report = monitor.update(q, v, tau - 3.0)
        >>> report.collision
        True
        >>> monitor.torque_threshold = 5.0
    """

    def __new__(
        cls,
        robot: Robot,
        *,
        dt: float,
        sensors: Iterable[ForceTorqueSensor] = (),
        wanted_contacts: Iterable[str] = (),
        observer_gain: ArrayLike = 50.0,
        torque_threshold: ArrayLike = 0.5,
        wrench_threshold: ArrayLike = 2.0,
        wrench_gain: float | None = None,
        bias_time_constant: float | None = None,
        bias_limit: float = 30.0,
        bias_settle_time: float | None = None,
        hysteresis: ArrayLike = 0.2,
        hold_time: float = 0.02,
        max_contacts: int = 5,
        pushing: bool = True,
        calibration: Calibration | None = None,
        locate_within: float = 0.05,
        samples: int = 1000,
    ) -> Self: ...
    @property
    def sensors(self) -> tuple[ForceTorqueSensor, ...]:
        """The sensors, of `ForceTorqueSensor`, in the order of the readings, with the offsets that are subtracted now."""
    @property
    def torque_threshold(self) -> NDArray[np.float64]:
        """Thresholds on the torques, `(nv,)` [Nm; N for sliding joints]; a read-only copy.

        A scalar or `(nv,)` may be set; bias, observer and signals stay as they are.
        """
    @torque_threshold.setter
    def torque_threshold(self, value: ArrayLike) -> None: ...
    @property
    def wrench_threshold(self) -> NDArray[np.float64]:
        """Thresholds on the external wrenches, `(n_sensors, 6)` [N, Nm]; a read-only copy.

        A scalar, `(6,)` or `(n_sensors, 6)` may be set; bias, observers and signals stay as they are.
        """
    @wrench_threshold.setter
    def wrench_threshold(self, value: ArrayLike) -> None: ...
    @property
    def observer_gain(self) -> NDArray[np.float64]:
        """Gain of the momentum observer, `(nv,)` [1/s]; a read-only copy.

        A scalar or `(nv,)` may be set; the external torque goes on from where it is, and `wrench_gain` follows where the
        constructor was not given one.
        """
    @observer_gain.setter
    def observer_gain(self, value: ArrayLike) -> None: ...
    @property
    def wrench_gain(self) -> float | None:
        """Gain of the low-pass on the external wrenches [1/s]; infinite for no low-pass, None without sensors.

        A number may be set, or None for what follows from `observer_gain`; the wrenches go on from where they are.
        """
    @wrench_gain.setter
    def wrench_gain(self, value: float | None) -> None: ...
    def update(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        wrenches: ArrayLike | None = None,
        *,
        dt: float | None = None,
        friction: ArrayLike | None = None,
    ) -> ContactReport:
        """Takes in one tick.

        Args:
            q: Configuration, `(nq,)`.
            v: Velocity, `(nv,)` [rad/s; m/s for sliding joints], measured when `q` was.
            tau: Motor torque, `(nv,)`, or `(nv - 6,)` for a floating base [Nm; N for sliding joints]: at that instant, or
                better the mean of the torques held before and after it.
            wrenches: The sensors' readings, `(n_sensors, 6)` [N, Nm], sensor axes. A NaN in a row leaves its sensor out
                for this tick. Needed where there are sensors.
            dt: Time since the last accepted sample [s], for clocks that jitter and samples that were lost. None: the
                constructor's, and as much again for every sample refused in between. Over a longer step than 50 ms (or
                five times the constructor's) the external torque is kept as it was.
            friction: Torque of friction, shaped as `tau` [Nm, N], which is subtracted from it; None for no friction.

        Returns:
            What the monitor says of this tick.

        Raises:
            InputError: Names the argument; the state is then unchanged but for the time that passed.
        """
    def _update_rows(
        self,
        arrays: list[NDArray[np.float64]],
        wrenches: NDArray[np.float64] | None,
        external: bool,
        classifier: ContactClassifier | None,
    ) -> tuple[
        NDArray[np.float64],
        NDArray[np.float64],
        NDArray[np.float64],
        NDArray[np.float64],
        list[tuple[int, tuple[Contact, ...]]],
        list[tuple[int, int, int | None, ContactClass]],
    ]:
        """`update` of rows one after the other, or `update_external` where `external` says so.

        All arrays are flat; a step of NaN is that of the monitor, `wrenches` has one row for each sensor of each row. Without a
        `classifier` there are no classes.
        """
    def update_external(
        self,
        q: ArrayLike,
        tau_ext: ArrayLike,
        wrenches: ArrayLike | None = None,
        *,
        v: ArrayLike | None = None,
        dt: float | None = None,
    ) -> ContactReport:
        """Takes in one tick with an external torque that the robot's controller estimates, as those of Franka, KUKA and Doosan do.

        It takes the place of the observer's: masses and friction of the model do not matter, and `observer_gain` filters
        nothing. With a `calibration` of such torques (`torque_is_external`) all joints are tested at once. A monitor takes
        torques of one source: `update` after `update_external`, or the other way round, is refused until `reset()`.

        Args:
            q: Configuration, `(nq,)`.
            tau_ext: External torque of forces on the robot, `(nv,)` [Nm; N for sliding joints].
            wrenches: The sensors' readings, as in `update`.
            v: Velocity, `(nv,)` [rad/s; m/s for sliding joints]; None: not known, and taken to be slow. It says where friction is
                uncertain, and what inertia does to the sensors.
            dt: Time since the last accepted sample [s], as in `update`; the torque after a gap is known at once.

        Returns:
            What the monitor says of this tick: `external_torque` is `tau_ext` less its bias, `acceleration` NaN.

        Raises:
            InputError: Names the argument; the state is then unchanged but for the time that passed.
        """
    def set_payload(self, link: str, mass: float, com: ArrayLike) -> None:
        """Says what the robot carries from the next tick on.

        The payload takes the place of one that was set before; what the description or a calibration has stays, and so does
        the payload over `reset()`. External torque, bias and contacts go on. Call it at the tick at which the robot bears the
        weight. Where all joints are tested at once (`calibration`), that may be up to half a second later: for so long the
        weight counts as unknown, and a contact with the same torques is not seen. A weight that is borne before it is set
        is an external torque. Not for the control loop: it allocates.

        Args:
            link: Name of the link that holds it.
            mass: Mass [kg].
            com: Centre of mass in the link's frame, `(3,)` [m].

        Raises:
            InputError: Names the argument; nothing is then changed.

        Example:
            >>> import contactsense as cs
            >>> robot = cs.Robot.named("iiwa14")
            >>> monitor = cs.ContactMonitor(robot, dt=1e-3)
            >>> monitor.set_payload("iiwa_link_7", 1.5, [0.0, 0.0, 0.1])
            >>> round(monitor.robot.mass - robot.mass, 6)
            1.5
            >>> monitor.clear_payload()
            >>> monitor.robot.mass == robot.mass
            True
        """
    def propose_payload(self) -> PayloadProposal | None:
        """The payload that recent motion shows and the model lacks.

        It is a force that turns with gravity, at a link at the end of a chain, in the external torque of the last minute or
        less. `set_payload(found.link, found.mass, found.com)` takes it where no payload was set before. A constant force
        straight down at one point of the link is a payload, whoever exerts it. Not for the control loop: it takes some
        milliseconds and allocates.

        Returns:
            A `PayloadProposal`, or None where recent motion shows none: without an external torque, in fewer than three poses,
            of a contact, and on a floating base. `set_payload`, `clear_payload` and `reset` begin anew.

        Example:
            >>> import contactsense as cs, numpy as np
            >>> robot = cs.Robot.named("iiwa14")
            >>> loaded = robot.with_payload("iiwa_link_7", 0.7, [0.0, 0.0, 0.1])
            >>> monitor = cs.ContactMonitor(robot, dt=0.01)
            >>> for angle in np.arange(0.0, 10.0, 0.01)[:, None] + np.arange(7):
            ...     q, v, a = np.sin(angle), np.cos(angle), -np.sin(angle)
            ...     _ = monitor.update(q, v, loaded.inverse_dynamics(q, v, a))
            >>> found = monitor.propose_payload()
            >>> found.link, round(found.mass, 1), found.com.round(2).tolist()[2]
            ('iiwa_link_7', 0.7, 0.1)
        """
    def clear_payload(self) -> None:
        """Says that the robot carries nothing from the next tick on but what its description or calibration has.

        As `set_payload`. Not for the control loop: it frees memory.
        """
    def tare(self) -> None:
        """Makes zero of what the robot reads now: it is untouched and at rest.

        The offsets of the sensors and the bias become what the last 0.25 s showed, without following it any longer. A sensor
        without readings keeps its offset. `sensors` and `bias` are the new ones; `reset()` forgets the bias, not the offsets.
        A contact that has been reported ever since the first call or `reset()` may be a bias or an offset, and ends.
        Where a tool is not in the model, see `identify_tool`. Not for the control loop: it allocates.

        Raises:
            InputError: The observers do not know the torque yet (5 time constants of the slowest); there is a contact that
                began after a time without; the bias is beyond `bias_limit`. Nothing is then changed.

        Example:
            >>> import contactsense as cs, numpy as np
            >>> robot = cs.Robot.named("iiwa14")
            >>> q, v = np.full(7, 0.4), np.zeros(7)
            >>> tau = robot.inverse_dynamics(q, v, v) + 0.3
            >>> monitor = cs.ContactMonitor(robot, dt=1e-3)
            >>> for _ in range(200):
            ...     report = monitor.update(q, v, tau)
            >>> monitor.tare()
            >>> bool(abs(monitor.update(q, v, tau).external_torque).max() < 1e-3)
            True
        """
    def reset(self) -> None:
        """Forgets all ticks, the bias too; torques may then come from another source. A payload and offsets of sensors stay."""
    @property
    def robot(self) -> Robot:
        """The robot that is monitored, with the payload that was set."""
    @property
    def dt(self) -> float:
        """Time between two calls that is assumed where `update` is given none [s]."""
    @property
    def bias(self) -> NDArray[np.float64]:
        """The bias that is subtracted, `(nv,)` [Nm; N for sliding joints]; zeros without `bias_time_constant` and `tare()`; read-only."""

@final
class ContactReport:
    """What the monitor says of one tick.

    Frozen; can be pickled and copied.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> monitor = cs.ContactMonitor(cs.Robot.named("iiwa14"), dt=1e-3)
        >>> report = monitor.update(np.zeros(7), np.zeros(7), np.zeros(7))
        >>> report.collision, report.contacts, report.to_dict()["time"]
        (False, (), 0.0)
    """

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, lists in place of arrays and tuples, and dicts in place of contacts.
        """
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def time(self) -> float:
        """Time since the first accepted call [s]."""
    @property
    def collision(self) -> bool:
        """Whether there is a contact."""
    @property
    def onset(self) -> bool:
        """Whether the contact began with this tick."""
    @property
    def significance(self) -> float | None:
        """How unlikely the torques are without contact [standard deviations], or None where each joint has a threshold.

        A Gaussian number would be so many standard deviations off as rarely; the largest over the gains of all observers.
        """
    @property
    def remainder_learned(self) -> bool:
        """Whether a torque that stood still became the bias in this tick, which ended the contact.

        That is what `hysteresis` may have left, what outlasted `bias_settle_time`, or no torque at all where the bias
        before was wrong.
        """
    @property
    def links(self) -> tuple[str, ...]:
        """Names of the links that detection alone leaves for a contact.

        On every branch those between the last joint or sensor over its threshold and the next (Vorndamme 2017, eq. 21).
        """
    @property
    def external_torque(self) -> NDArray[np.float64]:
        """External torque of all contacts, free of the tracked bias, `(nv,)` [Nm; N for sliding joints]; read-only."""
    @property
    def collision_torque(self) -> NDArray[np.float64]:
        """`external_torque` without wanted contacts and stops, `(nv,)` [Nm; N for sliding joints]; read-only.

        Zero at joints left out. Of contacts wanted at points, what no force there explains, by least squares.
        """
    @property
    def wrenches(self) -> NDArray[np.float64]:
        """The external wrench that each sensor sees, `(n_sensors, 6)` [N, Nm]; read-only.

        (force, moment) on the robot at the sensor's origin, world axes; NaN where a sensor is left out.
        """
    @property
    def sensors_left_out(self) -> tuple[str, ...]:
        """Names of the sensors without a reading in this tick."""
    @property
    def joints_left_out(self) -> tuple[str, ...]:
        """Names of the joints whose torques say nothing of a collision, since a wanted contact loads them unmeasured.

        Those behind its sensor, and while that gives no reading (and a little after) those between it and the base.
        """
    @property
    def limited_joints(self) -> tuple[str, ...]:
        """Names of the joints at a limit of their position whose stop pushes them inward, which is no contact.

        Within 0.005 rad, 1 mm for sliding joints, and at most 0.2 % of the range, or ten times that beyond the limit.
        """
    @property
    def acceleration(self) -> NDArray[np.float64]:
        """Estimated acceleration, `(nv,)` [rad/s^2; m/s^2 for sliding joints]; read-only.

        NaN after `update_external`: the motors' torque is not known there.
        """
    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts; empty while there is no collision. The same tuple at every access."""
    @property
    def truncated(self) -> bool:
        """Whether something was left out.

        There were more contacts than `max_contacts`, more intersections of a line than are kept (the nearest are), or
        more explanations to try than the bounded work of a call allows.
        """

@final
class ContactParticleFilter:
    """Finds one contact or several anywhere on a robot from joint torques, by particles on its surface (Bimbo 2019).

    Each particle is a hypothesis of link, point, obstacle, force and stiffness; those that predict the torques while the
    robot makes small motions in contact survive. Obstacles are convex and stay where they are. Of several contacts, each has
    particles of its own (Manuelli and Tedrake 2016). One thread at a time may use it.

    Args:
        robot: The robot.
        particles: How many.
        motion: "curvature" (eq. 8), or the baselines "fixed_on_link" and "fixed_in_world".
        measurement: "normal" (frictionless) or "friction_cone": forces across the normal up to `friction` of it,
            integrated out.
        friction: Coefficient of friction of the cone.
        links: Names of the links to look on; None for all that move and have a surface.
        seed: A whole number. Same seed, same answer, for any number of `threads`.
        force_range: Least and greatest force at the start [N].
        stiffness_range: Least and greatest stiffness at the start [N/m].
        radius_range: Least and greatest radius of the obstacle's curvature at the start [m].
        schedule: How sharply torques are weighed and how far particles are moved at random: "adaptive" (by what the data
            show), "paper", or a mapping of some of "sharpness" (alpha, eq. 5) [1/Nm], "point_noise" [m], "force_noise" and
            "stiffness_noise" (relative), each a number or a pair (first, last), and "updates", after which the last is
            reached. None is "adaptive".
        threads: How many threads share an update.
        likelihood: "gaussian" (force and stiffness are integrated out) or "exponential" (eq. 5, both are drawn at random).
        torque_noise: Standard deviation of the torque at rest, scalar or `(nv,)` [Nm; N for sliding joints]. Greater noise
            is learnt from what is left over.
        relative_noise: Standard deviation relative to the torque.
        torque_threshold: Below it on every joint there is no contact, scalar or `(nv,)` [Nm; N for sliding joints]. By
            default three standard deviations at rest where these are more; with `noise` always these.
        noise: A `NoiseModel` in place of `torque_noise` and `relative_noise`.
        calibration: A `Calibration` of this robot, whose noise takes the place of `noise`.
        max_contacts: Contacts that there may be at the same time, 1 to 4; several only with the Gaussian likelihood. Particles
            of one more contact are added where the others do not explain the torques at some poses, and dropped when they
            explain nothing. `estimate.contacts` has an estimate of each. An update takes as long for each contact.

    Raises:
        InputError: Names the argument.
        MemoryError: The particles do not fit into memory.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> particle_filter = cs.ContactParticleFilter(robot, particles=500, seed=1)
        >>> particle_filter.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]).event
        'started'
        >>> again = cs.ContactParticleFilter(robot, **particle_filter.options)
    """

    def __new__(
        cls,
        robot: Robot,
        *,
        particles: int = 10000,
        motion: Literal["curvature", "fixed_on_link", "fixed_in_world"] = "curvature",
        measurement: Literal["normal", "friction_cone"] = "normal",
        friction: float = 0.5,
        links: Iterable[str] | None = None,
        seed: int = 0,
        force_range: ArrayLike = (1, 100),
        stiffness_range: ArrayLike = (300.0, 30000.0),
        radius_range: ArrayLike = (0.005, 1.0),
        schedule: Literal["adaptive", "paper"]
        | Mapping[str, float | tuple[float, float]]
        | None = "adaptive",
        threads: int = 1,
        likelihood: Literal["gaussian", "exponential"] = "gaussian",
        torque_noise: ArrayLike = 0.02,
        relative_noise: float = 0.03,
        torque_threshold: ArrayLike = 0.2,
        noise: NoiseModel | None = None,
        calibration: Calibration | None = None,
        max_contacts: int = 1,
    ) -> Self: ...
    @property
    def robot(self) -> Robot:
        """The robot."""
    @property
    def options(self) -> dict[str, Any]:
        """The keyword arguments in use, by name; `ContactParticleFilter(robot, **options)` makes an equal filter.

        A new dict at every access. `noise` stands in it where it was given, otherwise `torque_noise` and
        `relative_noise` do. Vectors are `(nv,)` or one number for all, as given.
        """
    def update(self, q: ArrayLike, tau_ext: ArrayLike, *, time: float | None = None) -> ContactEstimate:
        """Takes in a configuration and the external torque measured there.

        The first call that feels a contact spreads the particles over the surface. Other Python threads run meanwhile.
        With many particles Ctrl-C stops the call, and the filter has then forgotten all updates.

        Args:
            q: Configuration, `(nq,)`.
            tau_ext: External torque, `(nv,)` [Nm; N for sliding joints and a base's linear part]: what `MomentumObserver`
                gives, or `g(q) - tau` where the robot holds still.
            time: Handed on to the estimate [s]; None for the number of updates.

        Returns:
            What the particles say.

        Raises:
            InputError: Names the argument; the filter is then unchanged.
        """
    def reset(self) -> None:
        """Forgets all updates."""
    @property
    def particles(self) -> Particles:
        """The particles after the last update, one row each; a read-only copy."""

@final
class StaticObstacleSampler:
    """Finds contacts anywhere on a robot from all joint torques that were measured of them (algorithm C3).

    Where `ContactParticleFilter` forgets what earlier motions taught, each particle here is an obstacle that stays where it is
    for good, and predicts the torques of a whole window of poses. Particles are taken from one measurement to the next by
    tempered sequential Monte Carlo (Del Moral, Doucet and Jasra 2006). An update takes some milliseconds with 10,000 particles,
    and up to some tenths of a second where particles are drawn anew. Noise that is greater than stated is learnt from what is
    left over. One thread at a time may use it.

    Args:
        robot: The robot.
        particles: How many.
        models: What the contact may be with, one name or several: "obstacle" (round, stays where it is), "person" (the point
            stays on the link, the force changes as it likes), "both" (the point stays on the link, and a spring ties it to
            where it was in the world). Of several, `model_probabilities` says which explains the torques.
        max_contacts: Contacts that there may be at the same time, 1 to 4. Of more than one, all are with obstacles, and there are
            as many particles for each number of contacts: an update takes several times as long. `number_probabilities`
            says how many contacts there are, `estimate.contacts` has an estimate of each. Where one comes or goes, the
            window begins anew.
        window: Poses whose torques are kept, 2 to 1000.
        forgetting_time: Time after which a measurement counts for a part in e of what it did when it was new [s], so that
            an obstacle that creeps is followed. None for obstacles that stay.
        moves: Moves of each particle in an update at most where the window is full, 1 to 1000; more where it is not, for the
            same work. Twice as many of particles of several contacts.
        measurement: "normal" (frictionless) or "friction_cone": forces across the normal up to `friction` of it,
            integrated out.
        friction: Coefficient of friction of the cone.
        links: Names of the links to look on; None for all that move and have a surface.
        seed: A whole number. Same seed, same answer, for any number of `threads`.
        force_range: Least and greatest force at the first touch [N].
        stiffness_range: Least and greatest stiffness [N/m].
        radius_range: Least and greatest radius of the obstacle's curvature [m].
        threads: How many threads share an update.
        torque_noise: Standard deviation of the torque at rest, scalar or `(nv,)` [Nm; N for sliding joints].
        relative_noise: Standard deviation relative to the torque.
        torque_threshold: Below it on every joint there is no contact, scalar or `(nv,)` [Nm; N for sliding joints]. By
            default three standard deviations at rest where these are more; with `noise` always these.
        noise: A `NoiseModel` in place of `torque_noise` and `relative_noise`.
        calibration: A `Calibration` of this robot, whose noise takes the place of `noise`.

    Raises:
        InputError: Names the argument.
        MemoryError: The particles do not fit into memory.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> sampler = cs.StaticObstacleSampler(robot, particles=500, models=("obstacle", "person"), seed=1)
        >>> sampler.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]).event
        'started'
        >>> round(sum(sampler.model_probabilities.values()), 9)
        1.0
    """

    def __new__(
        cls,
        robot: Robot,
        *,
        particles: int = 10000,
        models: Literal["obstacle", "person", "both"] | Iterable[str] = "obstacle",
        max_contacts: int = 1,
        window: int = 40,
        forgetting_time: float | None = None,
        moves: int = 1,
        measurement: Literal["normal", "friction_cone"] = "normal",
        friction: float = 0.5,
        links: Iterable[str] | None = None,
        seed: int = 0,
        force_range: ArrayLike = (1, 100),
        stiffness_range: ArrayLike = (300.0, 30000.0),
        radius_range: ArrayLike = (0.005, 1.0),
        threads: int = 1,
        torque_noise: ArrayLike = 0.02,
        relative_noise: float = 0.03,
        torque_threshold: ArrayLike = 0.2,
        noise: NoiseModel | None = None,
        calibration: Calibration | None = None,
    ) -> Self: ...
    @property
    def robot(self) -> Robot:
        """The robot."""
    @property
    def options(self) -> dict[str, Any]:
        """The keyword arguments in use, by name; `StaticObstacleSampler(robot, **options)` makes an equal sampler.

        A new dict at every access. `noise` stands in it where it was given, otherwise `torque_noise` and
        `relative_noise` do. Vectors are `(nv,)` or one number for all, as given.
        """
    def update(self, q: ArrayLike, tau_ext: ArrayLike, *, time: float | None = None) -> ContactEstimate:
        """Takes in a configuration and the external torque measured there.

        The first call that feels a contact spreads the particles over the surface. A pose that hardly differs from the last
        one takes its place in the window. Other Python threads run meanwhile. With many
        particles Ctrl-C ends the call early; `estimate` then has what was found, and later calls go on from there.

        Args:
            q: Configuration, `(nq,)`.
            tau_ext: External torque, `(nv,)` [Nm; N for sliding joints and a base's linear part]: what `MomentumObserver`
                gives, or `g(q) - tau` where the robot holds still.
            time: Of the measurement [s], which must be given where there is a `forgetting_time`, and never less than at the
                last update. The estimate hands it on; None for the number of updates.

        Returns:
            What the particles say.

        Raises:
            InputError: Names the argument; the sampler is then unchanged.
        """
    @property
    def estimate(self) -> ContactEstimate:
        """What the particles said at the last update; no contact before the first one."""
    def reset(self) -> None:
        """Forgets all updates."""
    @property
    def model_probabilities(self) -> dict[str, float]:
        """Probability of each of `models`, by name; all zero without a contact. A new dict at every access."""
    @property
    def number_probabilities(self) -> NDArray[np.float64]:
        """Probability that there are one, two, ... contacts, `(max_contacts,)`; all zero without a contact. A new array at every access.

        Beforehand, each further contact is a million times less probable than none: small errors of the model feign none.
        """
    @property
    def log_evidence(self) -> float:
        """How many times as likely all torques are under one of the models as without a contact, its natural logarithm.

        Two samplers that were given the same measurements are compared by it.
        """
    @property
    def particles(self) -> Particles:
        """The particles after the last update, one row a contact of each, of the most probable number of contacts; a read-only copy."""

@final
class Particles:
    """A copy of the particles, one row each; all arrays are read-only.

    Frozen; can be pickled and copied.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> particle_filter = cs.ContactParticleFilter(cs.Robot.named("iiwa14"), particles=500)
        >>> estimate = particle_filter.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
        >>> particle_filter.particles.point.shape
        (500, 3)
    """

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def contact(self) -> NDArray[np.int64]:
        """Number of the contact, `(n,)`: zero where there is one. Of several contacts, the rows of the second follow those of the first."""
    @property
    def link(self) -> NDArray[np.int64]:
        """Index into `robot.link_names`, `(n,)`."""
    @property
    def point(self) -> NDArray[np.float64]:
        """Points on the surface, `(n, 3)`, world frame [m]."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward unit normals there, `(n, 3)`, world frame."""
    @property
    def force(self) -> NDArray[np.float64]:
        """Force along the inward normal, `(n,)` [N]."""
    @property
    def stiffness(self) -> NDArray[np.float64]:
        """Stiffness of the contact, `(n,)` [N/m]."""
    @property
    def weight(self) -> NDArray[np.float64]:
        """Weights, `(n,)`, which sum to one for each contact."""

@disjoint_base
class ContactEstimate:
    """The contact as a filter or a sampler sees it, and others beside it.

    Frozen; can be pickled and copied.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> particle_filter = cs.ContactParticleFilter(robot, particles=500)
        >>> particle_filter.update(np.full(7, 0.4), np.zeros(7))
        ContactEstimate(no contact, event='none')
        >>> particle_filter.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0]).ambiguous
        True
    """

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, lists in place of arrays and tuples, and dicts in place of modes and of
            `contacts`.
        """
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def contact(self) -> bool:
        """Whether the torques show a contact."""
    @property
    def event(self) -> Literal["none", "started", "continued", "lost", "changed", "jumped"]:
        """What happened at this update.

        "none", "started", "continued", "lost", "changed" (the contact is elsewhere than it was held to be, or there is one more or
        one less of several) or "jumped" (the pose did, so the search began anew).
        """
    @property
    def link(self) -> str:
        """Name of the most probable link; empty without contact."""
    @property
    def point(self) -> NDArray[np.float64]:
        """The most probable place on that link, `(3,)`, world frame [m]; NaN without contact; read-only."""
    @property
    def force(self) -> NDArray[np.float64]:
        """Force on the robot, `(3,)`, world frame [N]; NaN without contact; read-only."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward unit normal of the contact, `(3,)`, world frame; NaN without contact; read-only."""
    @property
    def magnitude(self) -> float:
        """Magnitude of the force [N]; NaN without contact."""
    @property
    def stiffness(self) -> float | None:
        """Stiffness of the contact [N/m]; None without contact, and where the motion model has none."""
    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of the point, `(3, 3)`, world frame [m^2]; NaN without contact; read-only.

        The second moment of all particles about `point`, other modes included.
        """
    @property
    def link_probabilities(self) -> dict[str, float]:
        """Share of the particles' weight on each link that is looked on, by the link's name; a new dict at every access."""
    @property
    def modes(self) -> tuple[Mode, ...]:
        """Clusters of particles, best first; at most eight. The same tuple at every access."""
    @property
    def contacts(self) -> tuple[ContactEstimate, ...]:
        """One estimate for each contact, of which this is the first; empty without contact.

        More than one only where several contacts are looked for (`max_contacts`). From update to update they stay in the same order
        as long as there are as many.
        """
    @property
    def ambiguous(self) -> bool:
        """Whether the data do not say which link, or where on it, or motion has not confirmed yet that it is a single push.

        Confirmed: one obstacle that stays explains the torques at the last poses, touches the link near `point`, and its
        force follows the motion.
        """
    @property
    def explained(self) -> bool:
        """Whether a push by one obstacle that stays explains the torques at the last poses.

        These are 24 at most, each 5 mm from the one before. What is left over is within three times the stated noise (a
        chi-square test at 99 %), and the force follows the motion no less than on the softest obstacle of
        `stiffness_range` (another one at 99 %). Where not, the estimate is ambiguous, too: two contacts, a moment, a
        payload, a pull, or biased torques.
        """

    @property
    def residual(self) -> float:
        """What the best push leaves over at this update: root mean square over the joints, in standard deviations.

        The standard deviations are those of the stated noise (`noise`, or `torque_noise` and `relative_noise`).
        """

    @property
    def effective_samples(self) -> float:
        """Effective number of particles, before resampling."""
    @property
    def time(self) -> float:
        """Time as given to `update` [s]; otherwise the number of updates since the start."""

@final
class Mode:
    """A place where the contact may be.

    Frozen; can be pickled and copied.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> particle_filter = cs.ContactParticleFilter(robot, particles=500)
        >>> estimate = particle_filter.update(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
        >>> 0.0 < estimate.modes[0].probability <= 1.0
        True
    """

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays.
        """
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def link(self) -> str:
        """Name of the link."""
    @property
    def point(self) -> NDArray[np.float64]:
        """Where it is on the link's surface, `(3,)`, world frame [m]; read-only."""
    @property
    def force(self) -> NDArray[np.float64]:
        """Force on the robot, `(3,)`, world frame [N]; read-only."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward unit normal of the surface, `(3,)`, world frame; read-only."""
    @property
    def probability(self) -> float:
        """Share of the particles' weight."""
    @property
    def spread(self) -> float:
        """Root of the mean squared distance of the mode's particles from their mean [m]."""

@final
class ContactClassifier:
    """Says of each contact that a monitor reports whether it is clamped, transient or sustained, and whether it is intended.

    The probabilities follow from a few features of force and motion by logistic regression, whose weights were found on
    simulated scenes. It is not a safety function. One thread at a time may use it.

    Args:
        robot: The robot.
        dt: Time between two calls [s]: from how long before a contact velocities are kept. Times are those of the reports.
        prior: Shares of contacts that are clamped, transient and sustained, `(3,)`; None for those of the simulated scenes.
        intended_prior: Share of contacts that are intended.

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> monitor, classifier = cs.ContactMonitor(robot, dt=1e-3), cs.ContactClassifier(robot, dt=1e-3)
        >>> q, still = np.full(7, 0.4), np.zeros(7)
        >>> weight = robot.inverse_dynamics(q, still, still)
        >>> for push in np.minimum(np.arange(600) / 300, 1.0) * 5.0:
        ...     contacts = classifier.update(q, still, monitor.update(q, still, weight - push))
        >>> contacts[0].running, contacts[0].intended > 0.5
        (True, True)
    """

    def __new__(
        cls,
        robot: Robot,
        *,
        dt: float,
        prior: ArrayLike | None = None,
        intended_prior: float = 0.26,
    ) -> Self: ...
    @property
    def robot(self) -> Robot:
        """The robot."""
    def update(self, q: ArrayLike, v: ArrayLike, report: ContactReport) -> tuple[ContactClass, ...]:
        """Takes in one tick.

        Args:
            q: Configuration, `(nq,)`, as the monitor got it.
            v: Velocity, `(nv,)` [rad/s; m/s for sliding joints], as the monitor got it.
            report: What the monitor said of this tick.

        Returns:
            The contacts that run, and those that have ended: once each, 0.1 s after their last tick.

        Raises:
            InputError: Names the argument; the state is then unchanged.
        """
    def reset(self) -> None:
        """Forgets all contacts."""

@final
class ContactClass:
    """What one contact is.

    Frozen; can be pickled and copied. `clamped`, `transient` and `sustained` sum to one.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> monitor, classifier = cs.ContactMonitor(robot, dt=1e-3), cs.ContactClassifier(robot, dt=1e-3)
        >>> q, still = np.full(7, 0.4), np.zeros(7)
        >>> tau = robot.inverse_dynamics(q, still, still)
        >>> for _ in range(50):
        ...     contacts = classifier.update(q, still, monitor.update(q, still, tau))
        ...     tau = tau - 0.1
        >>> contacts[0].running, sorted(contacts[0].features)[:2]
        (True, ['advance', 'approach_speed'])
    """

    @property
    def id(self) -> int | None:
        """Number of the contact, as `Contact.id`; None where contacts are not followed."""
    @property
    def running(self) -> bool:
        """Whether the contact goes on; False once, when it has ended."""
    @property
    def since(self) -> float:
        """Time of its first tick, as `ContactReport.time` [s]."""
    @property
    def duration(self) -> float:
        """From its first tick to its last so far [s]."""
    @property
    def kind(self) -> Literal["clamped", "transient", "sustained"]:
        """The likeliest of "clamped", "transient" and "sustained"."""
    @property
    def clamped(self) -> float:
        """Probability that it is held between the robot and something fixed."""
    @property
    def transient(self) -> float:
        """Probability that it ends by itself shortly."""
    @property
    def sustained(self) -> float:
        """Probability that it lasts with something that follows or yields."""
    @property
    def intended(self) -> float:
        """Probability that it is intended."""
    @property
    def features(self) -> dict[str, float]:
        """What was measured of it, by name; a new dict at every access.

        `rise_time` [s], `width` [s], `remaining`, `approach_speed` [m/s], `onset_work`, `advance` [m], `retreat` [m],
        `net_work` [m] and `peak` [N]; forces and ways are equivalents of torques and their power.
        """
    @property
    def contributions(self) -> dict[str, dict[str, float]]:
        """What each feature adds to each logit: a dict by "clamped", "transient", "sustained" and "intended" of dicts by feature."""
    @property
    def _scaled(self) -> list[float]:
        """The features as the weights take them, in the order of `contributions`."""
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers and dicts.
        """
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...

@final
class Reaction:
    """Reactions to a contact: stop, retreat and gravity compensation, within limits.

    Each call is one control tick and returns the next command. Whatever the finite arguments, velocities, accelerations and
    torques of the commands stay within the limits. It is not a safety function. One thread at a time may use it.

    Args:
        robot: The robot.
        dt: Time between two calls [s].
        velocity_limit: Scalar or `(nv,)` [rad/s; m/s for sliding joints]; None for a quarter of the robot's limits.
        acceleration_limit: Scalar or `(nv,)` [rad/s^2; m/s^2]; None for what reaches the velocity limit in 0.25 s.
        torque_limit: Scalar or `(nv,)` [Nm; N]; None for the efforts of the robot's description.
        distance: Of a retreat: the most that a joint moves after it has come to rest [rad; m].
        duration: Of a retreat: when the robot comes to rest [s].

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> reaction = cs.Reaction(cs.Robot.named("iiwa14"), dt=1e-3, acceleration_limit=2.0)
        >>> for _ in range(100):
        ...     command = reaction.stop(np.full(7, 0.2))
        >>> bool(abs(command).max() < 1e-9)
        True
    """

    def __new__(
        cls,
        robot: Robot,
        *,
        dt: float,
        velocity_limit: ArrayLike | None = None,
        acceleration_limit: ArrayLike | None = None,
        torque_limit: ArrayLike | None = None,
        distance: float = 0.1,
        duration: float = 1.0,
    ) -> Self: ...
    @property
    def robot(self) -> Robot:
        """The robot."""
    def stop(self, v: ArrayLike) -> NDArray[np.float64]:
        """The next velocity of a stop in the direction of the motion.

        Args:
            v: Velocity, `(nv,)` [rad/s; m/s for sliding joints]; of the first call, what is braked from.

        Returns:
            Commanded velocity, `(nv,)` [rad/s; m/s]; read-only.

        Raises:
            InputError: Names the argument; the state is then unchanged.
        """
    def retract(
        self, v: ArrayLike, collision_torque: ArrayLike, *, admittance: float = 0.02
    ) -> NDArray[np.float64]:
        """The next velocity of a retreat along which the torque of the collision falls.

        Each joint comes to rest and then moves by `admittance` times its torque, until `distance` or `duration` is used up.

        Args:
            v: Velocity, `(nv,)` [rad/s; m/s for sliding joints]; of the first call, what is braked from.
            collision_torque: `ContactReport.collision_torque`, `(nv,)` [Nm; N].
            admittance: Velocity over torque [rad/s/Nm; m/s/N].

        Returns:
            Commanded velocity, `(nv,)` [rad/s; m/s]; read-only.

        Raises:
            InputError: Names the argument; the state is then unchanged.
        """
    def gravity_compensation(
        self, q: ArrayLike, v: ArrayLike, *, damping: float = 1.0
    ) -> NDArray[np.float64]:
        """The torque that carries the robot's weight and damps its motion, clipped to the torque limits.

        Args:
            q: Configuration, `(nq,)`.
            v: Velocity, `(nv,)` [rad/s; m/s for sliding joints].
            damping: [Nm s/rad; N s/m].

        Returns:
            Motor torque, `(nv,)` [Nm; N]; read-only.

        Raises:
            InputError: Names the argument.
        """
    def reset(self) -> None:
        """The next call begins a new reaction."""

@final
class ContactMap:
    """Says where on a robot a contact is, and how certain that is: the posterior over samples of all surface.

    Beforehand, every link is equally likely, and on a link every place of the same area. Every sample of the surface is a
    contact of unknown force: along the inward normal with a logarithm that is uniform from 2 to 300 N, across it by friction.
    Where the posterior is narrower than the samples are apart, they are divided on the true surface. One contact; one thread
    at a time may use it.

    Args:
        robot: The robot.
        samples: Samples of the surface, over all links: in proportion to the root of a link's area, so that small ones have
            enough.
        friction: Coefficient of friction; the force across the normal has half of it, times the normal force, as its standard
            deviation in each direction.
        noise: A `NoiseModel`; None for the default one.
        links: Names of the links to look on; None for all that move and have a surface.
        pull_probability: Probability that a contact pulls on the surface.
        calibration: A `Calibration` of this robot, whose noise takes the place of `noise`.

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> contact_map = cs.ContactMap(cs.Robot.named("iiwa14"), samples=1000)
        >>> estimate = contact_map.evaluate(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
        >>> estimate.log_evidence > 0.0
        True
    """

    def __new__(
        cls,
        robot: Robot,
        *,
        samples: int = 5000,
        friction: float = 0.5,
        noise: NoiseModel | None = None,
        links: Iterable[str] | None = None,
        pull_probability: float = 0.05,
        calibration: Calibration | None = None,
    ) -> Self: ...
    @property
    def robot(self) -> Robot:
        """The robot."""
    def evaluate(self, q: ArrayLike, tau_ext: ArrayLike) -> MapEstimate:
        """The posterior of one contact from an external torque.

        Args:
            q: Configuration, `(nq,)`.
            tau_ext: External torque, `(nv,)` [Nm; N for sliding joints and a base's linear part]: what `MomentumObserver`
                gives, or `g(q) - tau` where the robot holds still.

        Returns:
            The posterior.

        Raises:
            InputError: Names the argument.
        """
    def identifiability(self, q: ArrayLike, *, force: float = 10.0) -> Identifiability:
        """What the joint torques would tell of a contact at each sample: how exactly its point would be known.

        Args:
            q: Configuration, `(nq,)`.
            force: Normal force of the contacts [N].

        Returns:
            By sample: standard deviation of the point, rank, and whether the contact can be detected.

        Raises:
            InputError: Names the argument.
        """

@final
class MapEstimate(ContactEstimate):
    """The posterior of one contact as a map sees it: a `ContactEstimate` with what it says of every sample.

    Frozen; can be pickled and copied. It assumes that there is a contact, so `contact` is True; `log_evidence` says whether
    there is one. `modes` are clusters of the posterior, `stiffness` is None, `effective_samples` the
    effective number of pieces of surface that the posterior is spread over; `residual` is what the best contact leaves over,
    and `explained` says whether the noise explains that (a chi-square test at 99 %).

    Example:
        >>> import contactsense as cs, numpy as np
        >>> contact_map = cs.ContactMap(cs.Robot.named("iiwa14"), samples=1000)
        >>> estimate = contact_map.evaluate(np.full(7, 0.4), [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
        >>> estimate.points.shape == (len(estimate.log_posterior), 3)
        True
    """

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, lists in place of arrays and tuples, and dicts in place of modes and of
            `contacts`.
        """
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def points(self) -> NDArray[np.float64]:
        """The samples' points, `(n, 3)`, world frame [m]; read-only."""
    @property
    def log_posterior(self) -> NDArray[np.float64]:
        """Logarithm of each sample's share of the posterior, `(n,)`; the shares sum to one; read-only."""
    @property
    def log_evidence(self) -> float:
        """Logarithm of how many times as likely the torque is with a contact as without."""
    @property
    def region_radius(self) -> float:
        """Radius of the ball about `point` that holds 90 % of the posterior [m]; NaN without contact."""

@final
class Identifiability:
    """What the joint torques would tell of a contact at each of a map's samples, at one pose.

    The torque of a contact is linearised in five unknowns: the three components of its force, and two coordinates of its point
    in the tangent plane of the surface. Noise of the torques, force and point are Gaussian. The noise has the standard
    deviations of the `NoiseModel` at the contact's own torque, the force those of the map's prior: tangentially `friction *
    force / 2` in each direction, along the normal 1.45 times `force`, which is that of a logarithm uniform from 2 to 300 N. The
    point has the covariance of the link's whole surface: where the torques say nothing of it, its standard deviation is that
    of a point anywhere on the link. Confusion with other links, or with the other side of the same one, is not in it.

    Frozen; can be pickled and copied; arrays are read-only. `n` is the number of samples.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> contact_map = cs.ContactMap(cs.Robot.named("iiwa14"), samples=1000)
        >>> told = contact_map.identifiability(np.full(7, 0.4), force=20.0)
        >>> bool(told.point_std[-1] < told.point_std[0]), int(told.rank[-1])
        (True, 5)
    """

    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays and tuples.
        """
    def __len__(self) -> int: ...
    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]: ...
    @property
    def force(self) -> float:
        """Normal force of the contacts [N]."""
    @property
    def links(self) -> tuple[str, ...]:
        """Each sample's link, `n` names."""
    @property
    def points(self) -> NDArray[np.float64]:
        """The samples' points, `(n, 3)`, world frame [m], in the order of `MapEstimate.points`."""
    @property
    def point_std(self) -> NDArray[np.float64]:
        """Standard deviation of the point of a contact there, `(n,)` [m]: the root of the trace of its covariance."""
    @property
    def rank(self) -> NDArray[np.int64]:
        """How many of the five unknowns torques without noise determine, `(n,)`, from 0 to 5.

        It is the rank of the derivatives of the torque. The prior plays no part in it.
        """
    @property
    def significance(self) -> NDArray[np.float64]:
        """Norm of the torque of the normal force over its noise without contact, `(n,)` [standard deviations]."""
    @property
    def detectable(self) -> NDArray[np.bool_]:
        """Whether this norm is greater than that of the noise without contact is in 99 % of cases, `(n,)`."""

def _calibrate(
    robot: Robot,
    time: ArrayLike,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    false_alarms_per_hour: float,
    payload_link: str | None,
    torque_is_external: bool,
) -> Calibration:
    """From the columns of a log, each flat."""

@final
class NextMotion(Motion):
    """A small motion in contact, and what it is expected to tell: a `Motion` that explains itself. Read-only.

    Where nothing was found it has no rows and is false: `if motion:` asks whether there is one. `reason` then says why. Can be
    pickled and copied.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot, q = cs.Robot.named("iiwa14"), np.full(7, 0.4)
        >>> particle_filter = cs.ContactParticleFilter(robot, particles=500)
        >>> estimate = particle_filter.update(q, [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
        >>> motion = cs.next_motion(robot, estimate, q, max_force=60.0, max_step=0.03)
        >>> motion.spread_after < motion.spread_before
        True
    """

    @property
    def information(self) -> float:
        """Expected information about the contact [nats]: by how much the entropy of the hypotheses is expected to fall."""
    @property
    def spread_before(self) -> float:
        """Root mean square distance of the contact point from its mean, now [m]; NaN without contact."""
    @property
    def spread_after(self) -> float:
        """The same after the motion, as expected [m]."""
    @property
    def force_range(self) -> NDArray[np.float64]:
        """Least and greatest predicted force on the way, `(2,)` [N]; NaN where there is no motion; read-only.

        Over the hypotheses that are noticeable, each with its own stiffness. Greater than `max_force` only where a hypothesis
        has such a force already.
        """
    @property
    def candidates(self) -> int:
        """How many motions were drawn."""
    @property
    def admissible(self) -> int:
        """How many of them neither lose the contact nor press too hard."""
    @property
    def reason(self) -> str:
        """Why there is no motion: "no contact" or "no admissible motion"; empty where there is one."""
    def to_dict(self) -> dict[str, Any]:
        """All attributes by name.

        Returns:
            Plain Python values: numbers, strings, and lists in place of arrays.
        """
    def __reduce__(self) -> tuple[Any, ...]: ...

def next_motion(
    robot: Robot,
    estimate: ContactEstimate,
    q: ArrayLike,
    *,
    max_force: float,
    max_step: ArrayLike,
    count: int = 64,
    seed: int = 0,
    particles: Particles | None = None,
    noise: NoiseModel | None = None,
    calibration: Calibration | None = None,
    duration: float = 0.5,
    dt: float = 0.001,
) -> NextMotion:
    """The small motion in contact that is expected to tell most about where the contact is.

    `count` motions are drawn at random. Each hypothesis about the contact is an obstacle that stays where it is, and predicts
    how force and torque change with a motion. A motion is admissible where, under all hypotheses but those that are less
    probable than 4 % together, the force stays between a quarter of what it is and `max_force`; stiffnesses are taken as a
    fifth greater. Forces that are greater than `max_force` already are held to be impossible, or, where a quarter of the
    probability has such, must not rise. Of the admissible ones the one is taken after which the
    expected spread of the contact point is least: each hypothesis in turn is held to be true, torques are drawn with their
    noise, and what they leave of the others is averaged.

    Collisions of the robot with itself and its surroundings are not looked at. Nothing is known of friction. After the
    motion give the filter the torques at its end, better also those on the way, and plan the next one.

    Args:
        robot: With a fixed base.
        estimate: The contact: a `ContactEstimate` of `ContactParticleFilter.update`, or a `MapEstimate`.
        q: Configuration that it was made at, `(nq,)`: the start of the motion.
        max_force: Greatest normal force that is allowed [N].
        max_step: How far each joint moves at most, scalar or `(nv,)` [rad; m for sliding joints].
        count: How many motions are drawn, from 1 to 10,000.
        seed: Of the random numbers: the same seed gives the same motion.
        particles: `ContactParticleFilter.particles`, after the same update. They say more than `estimate.modes` with their
            spreads, which are the hypotheses where this is None.
        noise: A `NoiseModel`, the errors of the torques; None for the default of the filter.
        calibration: A `Calibration` of this robot, whose noise takes the place of `noise`.
        duration: Length of the motion, at least `dt` [s].
        dt: Time between its rows [s].

    Returns:
        A `NextMotion`, from `q` along a straight line of joint positions, at rest at both ends. Without rows, and false, where
        the estimate shows no contact or no motion that was drawn is admissible.

    Raises:
        InputError: Names the argument; the base of the robot is free to move.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot, q = cs.Robot.named("iiwa14"), np.full(7, 0.4)
        >>> particle_filter = cs.ContactParticleFilter(robot, particles=500)
        >>> estimate = particle_filter.update(q, [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
        >>> motion = cs.next_motion(
        ...     robot, estimate, q, max_force=60.0, max_step=0.03, particles=particle_filter.particles
        ... )
        >>> bool(motion), bool(np.abs(motion.q[-1] - q).max() <= 0.03)
        (True, True)
    """

@final
class ContactMemory:
    """Where obstacles are and where none are, fused from contacts and from the space that the robot's body has been in.

    Space is divided into voxels in the world frame; of those of which something is known, the logarithm of the odds that they
    are occupied is kept. A planner that has no camera asks it where the robot may go. The world is held to stand still.

    A voxel whose centre the body has been in is free, but for `free_error`. A contact is in one of the voxels of the distribution
    of its point, half a voxel outward of the surface, the likelier the likelier that voxel was occupied before, or, with
    `contact_error`, elsewhere: a voxel is occupied if the contact is there, else as likely as before. One thread at a time may
    use it.

    Args:
        robot: The robot.
        resolution: Edge of a voxel, from 0.001 to 1 [m].
        prior: Probability that a voxel is occupied of which nothing is known.
        free_error: Probability that a voxel is occupied although the body has been there.
        contact_error: Probability that a contact is at none of its places.
        max_voxels: How many voxels are kept at most. What would need more is refused.

    Raises:
        InputError: Names the argument.

    Example:
        >>> import contactsense as cs, numpy as np
        >>> robot = cs.Robot.named("iiwa14")
        >>> memory = cs.ContactMemory(robot, resolution=0.05)
        >>> memory.add_free(robot.neutral())
        >>> points, probabilities = memory.points()
        >>> bool(memory.is_free(points).all())
        True
    """

    def __new__(
        cls,
        robot: Robot,
        *,
        resolution: float = 0.02,
        prior: float = 0.5,
        free_error: float = 0.01,
        contact_error: float = 0.05,
        max_voxels: int = 2_000_000,
    ) -> Self: ...
    @property
    def robot(self) -> Robot:
        """The robot."""
    @property
    def resolution(self) -> float:
        """Edge of a voxel [m]."""
    @property
    def prior(self) -> float:
        """Probability that a voxel is occupied of which nothing is known."""
    @property
    def free_error(self) -> float:
        """Probability that a voxel is occupied although the body has been there."""
    @property
    def contact_error(self) -> float:
        """Probability that a contact is at none of its places."""
    @property
    def max_voxels(self) -> int:
        """How many voxels are kept at most."""
    def add_free(self, q: ArrayLike) -> None:
        """The robot touched nothing: where its body is there is no obstacle.

        Links whose surface is not closed have no inside, and say nothing. Adding a configuration again changes nothing. Other
        Python threads run meanwhile.

        Args:
            q: A configuration, `(nq,)`, or several, `(n, nq)`.

        Raises:
            InputError: Names the argument; also where more than `max_voxels` would be known. Of several configurations those before
                the one that is refused are kept.
        """
    def add_contact(
        self, contact: ContactEstimate | Contact | tuple[ArrayLike, ArrayLike, ArrayLike]
    ) -> None:
        """There was one contact: an obstacle is at one of its places. To be called once a contact, not once a tick.

        Args:
            contact: A `ContactEstimate` or `MapEstimate`, a `Contact` of a report, or a tuple `(point, normal, covariance)` of
                `(3,)` [m], `(3,)` outward, and `(3, 3)` [m^2], symmetric and positive semidefinite, world frame. Voxels reach
                2^31 `resolution`s from the origin along each axis. Modes share the evidence by their probabilities.
                An estimate stands for the first of its `contacts`: of several, add each.

        Raises:
            InputError: Names the argument, or `max_voxels` where more would be known; the memory is unchanged.
        """
    def probability(self, points: ArrayLike) -> NDArray[np.float64]:
        """Probability that the voxel of each point is occupied; the prior where nothing is known of it.

        Args:
            points: `(n, 3)`, world frame [m].

        Returns:
            `(n,)`.

        Raises:
            InputError: Names the argument.
        """
    def is_free(self, points: ArrayLike, *, below: float = 0.1) -> NDArray[np.bool_]:
        """Whether the voxel of each point is known to be free.

        Args:
            points: `(n, 3)`, world frame [m].
            below: Free is what is occupied with a lower probability.

        Returns:
            `(n,)` of bool; False where nothing is known.

        Raises:
            InputError: Names the argument.
        """
    def known(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Whether anything is known of the voxel of each point.

        Args:
            points: `(n, 3)`, world frame [m].

        Returns:
            `(n,)` of bool.

        Raises:
            InputError: Names the argument.
        """
    def points(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Centres of all voxels of which something is known, and the probability that each is occupied.

        Returns:
            `(points, probabilities)`: `(n, 3)`, world frame [m], and `(n,)`; in the order of x, y, z; read-only.
        """
    def boxes(
        self, *, least: float = 0.5, most: float = 1.0
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Axis-aligned boxes that hold exactly the known voxels whose probability is in a range, each once.

        Args:
            least: Least probability.
            most: Greatest probability.

        Returns:
            `(lower, upper)`: corners, `(m, 3)` each, world frame [m]; read-only.

        Raises:
            InputError: Names the argument.
        """
    def save(self, path: str | PathLike[str]) -> None:
        """Writes all that is known as arrays of NumPy: `indices` (n, 3), `log_odds` (n,), and the options.

        A voxel spans from `indices * resolution` to `(indices + 1) * resolution` in the world frame [m].

        Args:
            path: A file, which should end in ".npz".

        Raises:
            InputError: The file cannot be written.
        """
    @staticmethod
    def load(path: str | PathLike[str], robot: Robot) -> ContactMemory:
        """The memory that `save` wrote.

        Args:
            path: The file.
            robot: The robot whose body and contacts are added from here on.

        Raises:
            InputError: The file cannot be read, or is none of `save`.
        """
    def __reduce__(self) -> tuple[Any, ...]: ...
    def clear(self) -> None:
        """Forgets all."""
    def _voxels(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Indices `(n, 3)` and log-odds `(n,)` of the known voxels: all that is known."""
    def _set_voxels(self, indices: ArrayLike, log_odds: ArrayLike) -> None:
        """Takes on what `_voxels` gave."""
    def __len__(self) -> int: ...

def exciting_motion(
    robot: Robot,
    seconds: float,
    *,
    max_velocity: ArrayLike | None = None,
    seed: int = 0,
    dt: float = 0.001,
    joints: Sequence[str] | None = None,
) -> Motion:
    """A contact-free motion that calibration learns from: rest to rest, within limits, clear of the robot itself.

    It is a chain of moves from rest to rest, in which each joint goes far and fast, with sines added, slowly, or not at all.
    Of several random moves, each time the one is taken and improved that tells most per second about inertial parameters,
    bias, Coulomb and viscous friction and rotor inertia.

    Links with a surface stay 1 cm away from each other and from a plane under the base, or 2 mm from links that are
    nearer by design; neighbours and links that cross in nearly all poses are not checked (`Motion.unchecked`).
    Nothing else around the robot is known: look at the motion before running it, and run it slowly first.

    Args:
        robot: with a fixed base.
        seconds: length, 1 to 600 [s]; 30 to 60 s suit an arm.
        max_velocity: largest speed of each joint, scalar or `(nv,)` [rad/s; m/s for sliding joints]; where the robot's own
            velocity limit is smaller, that one counts. By default half of the robot's velocity limits, and 1 rad/s or
            0.25 m/s where there are none. A joint comes to its largest speed in 0.25 s or more.
        seed: of the random numbers; the same seed gives the same motion.
        dt: time between rows [s].
        joints: names of the joints that move; the others are held in a pose in which weights load those that move. All by
            default.

    Returns:
        A `Motion`.

    Raises:
        InputError: An argument cannot be used; the base of the robot is free to move; no pose without collision was found.

    Example:
        >>> import contactsense as cs
        >>> motion = cs.exciting_motion(cs.Robot.named("iiwa14"), 5.0)
        >>> motion.q.shape
        (5001, 7)
    """
