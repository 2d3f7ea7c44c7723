"""Types of the compiled core, with its docstrings (`tools/stub_docs.py` writes them)."""

from collections.abc import Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Self, disjoint_base

__all__ = [
    "Candidate",
    "ClosestPoints",
    "Contact",
    "ContactEstimate",
    "ContactIsolator",
    "ContactMonitor",
    "ContactParticleFilter",
    "ContactReport",
    "ContactSenseError",
    "ForceTorqueSensor",
    "GeometryError",
    "InputError",
    "Isolation",
    "LoadCompensator",
    "Mode",
    "ModelError",
    "MomentumObserver",
    "NoiseModel",
    "Particles",
    "RayHits",
    "Robot",
    "Surface",
    "SurfaceSamples",
    "__version__",
    "_checked_urdf",
    "_restore",
    "_robot_from_urdf",
    "build_profile",
]

__version__: Final[str]
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

def _checked_urdf(
    path: str | PathLike[str],
    package_dirs: Sequence[str | PathLike[str]],
    floating_base: bool,
    geometry: str,
    missing_meshes: str,
) -> tuple[str, list[tuple[str, int, tuple[Any, tuple[Any, ...]]]], list[str]]: ...
def _restore(class_: str, state: bytes) -> Any: ...
def _robot_from_urdf(
    path: str | PathLike[str],
    package_dirs: Sequence[str | PathLike[str]] = ...,
    floating_base: bool = False,
    locked: Sequence[tuple[str, float]] = ...,
    geometry: str = "collision",
    gravity: Sequence[float] = ...,
    armature: Sequence[tuple[str, float]] = ...,
    missing_meshes: str = "error",
) -> Robot: ...

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
    def effort_limits(self) -> NDArray[np.float64]:
        """Largest effort of each velocity variable, `(nv,)` [Nm or N]; infinite where there is no limit, zero for a
        floating base, which no actuator moves.
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
    """The surface of one link, in the link frame.

    `Robot.surface` gives it.

    Example:
        >>> import contactsense as cs
        >>> surface = cs.Robot.named("iiwa14").surface("iiwa_link_3")
        >>> surface.closest_points([[0.0, 0.0, 1.0]]).points.shape
        (1, 3)
    """
    @property
    def vertices(self) -> NDArray[np.float64]:
        """Vertices, `(n, 3)`, link frame [m]; of exact primitives a tessellation, for display."""
    @property
    def triangles(self) -> NDArray[np.int64]:
        """Vertex indices, `(m, 3)`, counter-clockwise seen from outside."""
    @property
    def area(self) -> float:
        """Sum of the areas of the parts [m^2]; where parts overlap, both count."""
    @property
    def watertight(self) -> bool:
        """Whether every part is closed."""
    def closest_points(self, points: ArrayLike) -> ClosestPoints:
        """The nearest surface point of each query, over all parts of the link.

        Args:
            points: `(n, 3)`, link frame [m].

        Returns:
            `ClosestPoints`; distances are unsigned.

        Raises:
            InputError: the argument cannot be used.
            MemoryError: the answer does not fit into memory.
        """
    def cast_rays(self, origins: ArrayLike, directions: ArrayLike) -> RayHits:
        """All hits of each ray, sorted by distance per ray.

        It is watertight: a closed mesh is entered as often as left. Hits inside another closed part of the link are left out.

        Args:
            origins: `(n, 3)`, link frame [m].
            directions: `(n, 3)`, link frame; they need not be unit vectors.

        Returns:
            `RayHits`; distances are in metres.

        Raises:
            InputError: an argument cannot be used; names it.
            MemoryError: the answer does not fit into memory.
        """
    def sample(self, n: int, seed: int = 0) -> SurfaceSamples:
        """Random points, uniform by area over the exposed surface.

        Args:
            n: number of points. A larger number appends to the same points.
            seed: the same seed gives the same points.

        Returns:
            `SurfaceSamples`.

        Raises:
            InputError: an argument cannot be used; names it.
            MemoryError: the points do not fit into memory.
        """

@final
class ClosestPoints:
    """Nearest points of a surface, one row per query."""
    def __new__(
        cls,
        points: NDArray[np.float64],
        normals: NDArray[np.float64],
        distances: NDArray[np.float64],
        triangles: NDArray[np.int64],
    ) -> Self: ...
    def __len__(self) -> int: ...
    @property
    def points(self) -> NDArray[np.float64]:
        """Points, `(n, 3)`, link frame [m]."""
    @property
    def normals(self) -> NDArray[np.float64]:
        """Outward normals, `(n, 3)`, link frame."""
    @property
    def distances(self) -> NDArray[np.float64]:
        """Distances, `(n,)`, unsigned [m]."""
    @property
    def triangles(self) -> NDArray[np.int64]:
        """Triangles, `(n,)`: rows of `Surface.triangles`; -1 on an exact primitive."""

@final
class RayHits:
    """All hits of a batch of rays, sorted by distance per ray."""
    def __new__(
        cls,
        ray: NDArray[np.int64],
        distance: NDArray[np.float64],
        point: NDArray[np.float64],
        normal: NDArray[np.float64],
        triangle: NDArray[np.int64],
    ) -> Self: ...
    def __len__(self) -> int: ...
    @property
    def ray(self) -> NDArray[np.int64]:
        """Rays, `(k,)`: rows of the query."""
    @property
    def distance(self) -> NDArray[np.float64]:
        """Distances from the origin, `(k,)` [m]."""
    @property
    def point(self) -> NDArray[np.float64]:
        """Points, `(k, 3)`, link frame [m]."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward normals, `(k, 3)`, link frame."""
    @property
    def triangle(self) -> NDArray[np.int64]:
        """Triangles, `(k,)`: rows of `Surface.triangles`; -1 on an exact primitive."""

@final
class SurfaceSamples:
    """Random points of a surface."""
    def __new__(
        cls,
        points: NDArray[np.float64],
        normals: NDArray[np.float64],
        triangles: NDArray[np.int64],
    ) -> Self: ...
    def __len__(self) -> int: ...
    @property
    def points(self) -> NDArray[np.float64]:
        """Points, `(n, 3)`, link frame [m]."""
    @property
    def normals(self) -> NDArray[np.float64]:
        """Outward normals, `(n, 3)`, link frame."""
    @property
    def triangles(self) -> NDArray[np.int64]:
        """Triangles, `(n,)`: rows of `Surface.triangles`; -1 on an exact primitive."""

@final
class MomentumObserver:
    """The generalised momentum observer (Vorndamme 2017, eqs. 4-6) with its acceleration (eq. 9).

    It estimates the external torque from positions, velocities and motor torques. Each component is the true one behind
    a first-order low-pass with time constant `1 / gain`, for any `gain * dt`.

    Args:
        robot: the robot that is observed.
        dt: time between two calls [s].
        gain: scalar or `(nv,)` [1/s].

    Raises:
        InputError: an argument cannot be used; names it.

    Example:
        >>> import contactsense as cs
        >>> robot = cs.Robot.named("iiwa14")
        >>> observer = cs.MomentumObserver(robot, dt=1e-3)
        >>> q, v = robot.neutral(), robot.velocity({})
        >>> observer.update(q, v, robot.inverse_dynamics(q, v, v)).shape
        (7,)
    """
    def __new__(cls, robot: Robot, *, dt: float, gain: ArrayLike = 50.0) -> Self: ...
    def update(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        *,
        dt: float | None = None,
        friction: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """One tick. The first call sets the initial momentum and returns zeros.

        Args:
            q: configuration, `(nq,)`.
            v: velocity, `(nv,)` [rad/s, m/s], measured at the same instant.
            tau: motor torque, `(nv,)`, or `(nv - 6,)` for a floating base [Nm, N]; of a torque that is held over the steps
                before and after, their mean.
            dt: length of this step [s], where it differs from the constructor's.
            friction: torque of friction, shaped as `tau`, which is subtracted from it [Nm, N].

        Returns:
            The external torque, `(nv,)` [Nm, N].

        Raises:
            InputError: an argument cannot be used; names it. The state is then unchanged.
        """
    def reset(self) -> None:
        """Forgets all ticks; the next call is a first call."""
    @property
    def external_torque(self) -> NDArray[np.float64]:
        """The external torque of the last tick, `(nv,)` [Nm, N]."""
    @property
    def acceleration(self) -> NDArray[np.float64]:
        """The acceleration estimated at the last tick, `(nv,)` [rad/s^2, m/s^2]: forward dynamics with the external torque."""
    @property
    def robot(self) -> Robot:
        """The robot observed."""
    @property
    def dt(self) -> float:
        """Time between two calls that is assumed where `update` is given none [s]."""
    @property
    def gain(self) -> NDArray[np.float64]:
        """The gain, `(nv,)` [1/s]."""

@final
class ForceTorqueSensor:
    """A six-axis force/torque sensor where `link` joins its parent: `link` and all behind it load the sensor.

    A reading is (force, moment) about the origin of the sensor frame, in its axes [N, Nm].

    Args:
        name: its name, as results report it.
        link: name of the link that it joins to the link's parent.
        pose: the sensor frame in the link's, `(4, 4)`; the link frame itself by default.
        convention: "load", what the distal side exerts on the sensor (a free hand at rest: its weight), or "support", the
            opposite.

    Raises:
        InputError: an argument cannot be used; names it.

    Example:
        >>> import contactsense as cs
        >>> cs.ForceTorqueSensor("wrist", "iiwa_link_7").convention
        'load'
    """
    def __new__(
        cls,
        name: str,
        link: str,
        *,
        pose: ArrayLike | None = None,
        convention: Literal["load", "support"] = "load",
    ) -> Self: ...
    @property
    def name(self) -> str:
        """Its name."""
    @property
    def link(self) -> str:
        """Name of the link that it joins to the link's parent."""
    @property
    def pose(self) -> NDArray[np.float64]:
        """The sensor frame in the link's, `(4, 4)`; a copy."""
    @property
    def convention(self) -> Literal["load", "support"]:
        """ "load" or "support"."""
    def __hash__(self) -> int: ...

@final
class LoadCompensator:
    """Frees the readings of force/torque sensors of the weight and inertia behind them (Vorndamme 2017, eqs. 13-19).

    One pass serves all sensors, also several in a chain and those at fixed joints.

    Args:
        robot: the robot that carries the sensors.
        sensors: the sensors, in the order of the readings; names and links are unique.

    Raises:
        InputError: a sensor cannot be used; names it.

    Example:
        >>> import contactsense as cs
        >>> robot = cs.Robot.named("iiwa14")
        >>> compensator = cs.LoadCompensator(robot, [cs.ForceTorqueSensor("wrist", "iiwa_link_7")])
        >>> q, v = robot.neutral(), robot.velocity({})
        >>> compensator.update(q, v, v, [[0.0, 0.0, -3.0, 0.0, 0.0, 0.0]]).shape
        (1, 6)
    """
    def __new__(cls, robot: Robot, sensors: Iterable[ForceTorqueSensor]) -> Self: ...
    def update(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, wrenches: ArrayLike) -> NDArray[np.float64]:
        """The external wrench that each sensor measures.

        Args:
            q: configuration, `(nq,)`.
            v: velocity, `(nv,)` [rad/s, m/s].
            a: acceleration, `(nv,)` [rad/s^2, m/s^2].
            wrenches: the readings, `(n_sensors, 6)`, sensor axes [N, Nm]. A NaN in a reading leaves its sensor out.

        Returns:
            `(n_sensors, 6)` [N, Nm]: force and moment on the robot at the sensor's origin, world axes; NaN for a sensor that
            is left out.

        Raises:
            InputError: an argument cannot be used; names it.
        """

@final
class NoiseModel:
    """Errors of the external torque of the untouched robot, each as one standard deviation.

    What says how large errors are takes it as `noise`.

    Args:
        torque: white noise of the torque, per sample, scalar or `(nv,)` [Nm; N for sliding joints].
        velocity: white noise of the velocity, per sample, scalar or `(nv,)` [rad/s; m/s for sliding joints]. It acts
            through the gain of an observer and the mass matrix; what is given an external torque leaves it out.
        relative: share of the contact's own torque, scalar or `(nv,)`; a tenth of it also of the largest one.
        model: slow errors left over (bias, friction, masses), scalar or `(nv,)` [Nm; N for sliding joints].

    Raises:
        InputError: an argument is negative, not finite, or of a wrong shape; names it.

    Example:
        >>> import contactsense as cs
        >>> cs.NoiseModel(torque=0.1).torque
        0.1
    """
    def __new__(
        cls,
        *,
        torque: ArrayLike = 0.05,
        velocity: ArrayLike = 0.0,
        relative: ArrayLike = 0.03,
        model: ArrayLike = 0.1,
    ) -> Self: ...
    @property
    def torque(self) -> float | NDArray[np.float64]:
        """White noise of the torque [Nm; N for sliding joints]: a number, or `(nv,)`, a copy."""
    @property
    def velocity(self) -> float | NDArray[np.float64]:
        """White noise of the velocity [rad/s, m/s]: a number, or `(nv,)`, a copy."""
    @property
    def relative(self) -> float | NDArray[np.float64]:
        """Share of the contact's own torque: a number, or `(nv,)`, a copy."""
    @property
    def model(self) -> float | NDArray[np.float64]:
        """Slow errors left over [Nm; N for sliding joints]: a number, or `(nv,)`, a copy."""

@final
class ContactIsolator:
    """Finds the contacts that explain an external torque and the wrenches of sensors: links, points and forces.

    One contact is isolated by Vorndamme 2017, eqs. 22-26; several with sensors by eq. 27, without by eqs. 28-31. Where
    torques do not determine two wrenches, it is used that the force of a contact has no moment, acts on the surface and
    pushes; several solutions are candidates.

    Args:
        robot: the robot.
        sensors: `ForceTorqueSensor`s, in the order of the wrenches.
        torque_threshold: scalar or `(nv,)` [Nm, N]. A joint takes part in a contact above it, and a third of it is the
            standard deviation of the torques' errors. With `noise` the default is three standard deviations at rest.
        wrench_threshold: the same for wrenches: scalar, `(6,)` or `(n_sensors, 6)` [N, Nm].
        wanted_contacts: names of sensors whose contacts are meant and not reported (Vorndamme 2017, eq. 20).
        max_contacts: number of contacts that are reported at most.
        pushing: whether forces push on the surface. If not, the point cannot be determined, and `located` is False.
        noise: a `NoiseModel` of the external torque, in place of the third of a threshold.
        locate_within: a contact is located if 90 % of the places that explain the torques are within this distance of its
            point [m].

    Raises:
        InputError: an argument cannot be used; names it.

    Example:
        >>> import contactsense as cs
        >>> robot = cs.Robot.named("iiwa14")
        >>> isolator = cs.ContactIsolator(robot)
        >>> isolator.isolate(robot.neutral(), robot.torque({})).contacts
        ()
    """
    def __new__(
        cls,
        robot: Robot,
        *,
        sensors: Iterable[ForceTorqueSensor] = (),
        torque_threshold: ArrayLike = 1e-3,
        wrench_threshold: ArrayLike = 1e-3,
        wanted_contacts: Iterable[str] = (),
        max_contacts: int = 5,
        pushing: bool = True,
        noise: NoiseModel | None = None,
        locate_within: float = 0.05,
    ) -> Self: ...
    @property
    def robot(self) -> Robot:
        """The robot whose contacts are isolated."""
    def isolate(self, q: ArrayLike, tau_ext: ArrayLike, wrenches: ArrayLike | None = None) -> Isolation:
        """The contacts that explain an external torque.

        Args:
            q: configuration, `(nq,)`.
            tau_ext: external torque, `(nv,)` [Nm, N].
            wrenches: the external wrench that each sensor measures, `(n_sensors, 6)` [N, Nm], as `LoadCompensator` gives it: force
                and moment at the sensor's origin, world axes. A NaN in a row leaves its sensor out.

        Returns:
            An `Isolation`.

        Raises:
            InputError: an argument cannot be used; names it.
        """

@final
class Isolation:
    """All contacts of one instant."""
    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts, farthest from the base first."""
    @property
    def rank_deficit(self) -> int:
        """Number of components of the contacts' wrenches that the torques do not determine (Vorndamme 2017, eq. 31)."""
    @property
    def residual(self) -> float:
        """Norm of the external torque that the contacts do not explain [Nm, N]."""
    @property
    def link_candidates(self) -> tuple[str, ...]:
        """Links that may carry a contact, likeliest first."""
    @property
    def truncated(self) -> bool:
        """Whether the answer is cut short.

        There were more contacts than `max_contacts`, more hits of a line than are kept (the nearest are), or more
        explanations to try than the bounded work of a call allows.
        """
    def to_dict(self) -> dict[str, Any]:
        """As plain Python data: numbers, strings, lists and dicts, `None` for what is undetermined."""

@final
class Contact:
    """One contact.

    Vectors that the data do not determine are NaN.
    """
    @property
    def link(self) -> str:
        """The contact link's name."""
    @property
    def point(self) -> NDArray[np.float64]:
        """The contact point, `(3,)`, world frame [m]."""
    @property
    def point_local(self) -> NDArray[np.float64]:
        """The contact point, `(3,)`, link frame [m]."""
    @property
    def force(self) -> NDArray[np.float64]:
        """Force on the robot, `(3,)`, world frame [N]."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward surface normal at the point, `(3,)`, world frame."""
    @property
    def wrench(self) -> NDArray[np.float64]:
        """Force and moment on the robot at the link's origin, `(6,)`, world axes [N, Nm]."""
    @property
    def source(self) -> str:
        """What detected it: "joint torques", or the sensor's name."""
    @property
    def located(self) -> bool:
        """Whether 90 % of the places that explain the torques lie within `locate_within` of the point.

        If not, the link may be known, but the point is not.
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
        """Places where the contact may be, best first.

        They are all places where the line of action meets a surface, points on other links that explain the torques about
        as well, or the points of several solutions.
        """
    def to_dict(self) -> dict[str, Any]:
        """As plain Python data: numbers, strings, lists and dicts, `None` for what is undetermined."""

@final
class Candidate:
    """A place where the line of action of a force meets a surface."""
    @property
    def link(self) -> str:
        """The link's name."""
    @property
    def point(self) -> NDArray[np.float64]:
        """The place, `(3,)`, world frame [m]."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward surface normal, `(3,)`, world frame."""
    @property
    def pushing(self) -> bool:
        """Whether the force enters the surface here."""
    def to_dict(self) -> dict[str, Any]:
        """As plain Python data: numbers, strings and lists."""

@final
class ContactMonitor:
    """Detects, locates and measures the contacts of one robot, called once a control tick.

    It joins the momentum observer, the compensation of sensors, the tracking of the bias, detection and isolation.

    Args:
        robot: the robot.
        dt: time between two calls [s].
        sensors: `ForceTorqueSensor`s, in the order of the readings.
        wanted_contacts: names of sensors whose contacts are meant (feet, hands): a contact behind them is no collision.
        observer_gain: gain of the momentum observer, scalar or `(nv,)` [1/s].
        torque_threshold: threshold on the external torque, scalar or `(nv,)` [Nm, N].
        wrench_threshold: threshold on the sensors' external wrenches: scalar, `(6,)` or `(n_sensors, 6)` [N, Nm].
        wrench_gain: gain of the low-pass on external wrenches [1/s], infinite for none. By default the smallest of
            `observer_gain`, and none where that is at least `0.5 / dt`.
        bias_time_constant: time constant of the tracking of the external torque that model errors cause without contact
            [s]; no tracking by default. Nothing is detected in the first time constant, and a contact that lasts less than
            half of it is not learnt.
        bias_limit: greatest bias of each joint, in thresholds.
        bias_settle_time: an external torque that stands still for so long becomes the bias [s]; never by default.
        hysteresis: share of its greatest torque in a contact that a joint's gear or sensor may keep after it, scalar or
            `(nv,)`. Such a remainder becomes the bias, up to two thresholds.
        hold_time: a signal stays on for so long after it was last over its threshold [s].
        max_contacts: number of contacts that are reported at most.
        pushing: whether forces push on the surface, as in `ContactIsolator`.
        locate_within: distance within which a contact counts as located [m], as in `ContactIsolator`.

    Raises:
        InputError: an argument cannot be used; names it.

    Example:
        >>> import contactsense as cs
        >>> robot = cs.Robot.named("iiwa14")
        >>> monitor = cs.ContactMonitor(robot, dt=1e-3, torque_threshold=1.0)
        >>> q, v = robot.neutral(), robot.velocity({})
        >>> monitor.update(q, v, robot.inverse_dynamics(q, v, v)).collision
        False
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
        locate_within: float = 0.05,
    ) -> Self: ...
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
        """One tick.

        Over a step longer than 50 ms (or five times the constructor's `dt`) the external torque is kept as it was.

        Args:
            q: configuration, `(nq,)`.
            v: velocity, `(nv,)` [rad/s, m/s].
            tau: motor torque, `(nv,)`, or `(nv - 6,)` for a floating base [Nm, N].
            wrenches: readings of the sensors, `(n_sensors, 6)`, sensor axes [N, Nm]. A NaN in a reading leaves its sensor out
                for this tick.
            dt: time since the last accepted sample [s], for clocks that jitter and samples that were lost. By default the
                constructor's, and as much again for every sample refused in between.
            friction: torque of friction, shaped as `tau`, which is subtracted from it [Nm, N].

        Returns:
            A `ContactReport`.

        Raises:
            InputError: an argument cannot be used; names it. The state is then unchanged but for the time that passed.
        """
    def reset(self) -> None:
        """Forgets all ticks, the bias too."""
    @property
    def robot(self) -> Robot:
        """The robot that is monitored."""
    @property
    def dt(self) -> float:
        """Time between two calls that is assumed where `update` is given none [s]."""
    @property
    def bias(self) -> NDArray[np.float64]:
        """The bias that is subtracted, `(nv,)` [Nm, N]; zeros without `bias_time_constant`."""
    @property
    def torque_threshold(self) -> NDArray[np.float64]:
        """Thresholds on the external torque, `(nv,)` [Nm, N]; settable between two ticks, to a scalar or `(nv,)`.

        Bias and external torque stay as they are; a contact stays on for the hold time. The greatest bias follows, as it
        is counted in thresholds.
        """
    @torque_threshold.setter
    def torque_threshold(self, value: ArrayLike) -> None: ...
    @property
    def wrench_threshold(self) -> NDArray[np.float64]:
        """Thresholds on the sensors' external wrenches, `(n_sensors, 6)` [N, Nm]; settable to a scalar, `(6,)` or
        `(n_sensors, 6)`.
        """
    @wrench_threshold.setter
    def wrench_threshold(self, value: ArrayLike) -> None: ...
    @property
    def observer_gain(self) -> NDArray[np.float64]:
        """The observer's gain, `(nv,)` [1/s]; settable to a scalar or `(nv,)`: the external torque goes on from where it is."""
    @observer_gain.setter
    def observer_gain(self, value: ArrayLike) -> None: ...

@final
class ContactReport:
    """What the monitor reports of one tick."""
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
    def remainder_learned(self) -> bool:
        """Whether a torque that stood still became the bias in this tick, which ended the contact.

        It is what `hysteresis` may have left, what outlasted `bias_settle_time`, or no torque at all where the bias before
        was wrong.
        """
    @property
    def links(self) -> tuple[str, ...]:
        """Names of the links that detection alone leaves for a contact (Vorndamme 2017, eq. 21).

        On every branch they are those between the last joint or sensor over its threshold and the next.
        """
    @property
    def external_torque(self) -> NDArray[np.float64]:
        """The external torque of all contacts, `(nv,)` [Nm, N], free of the tracked bias."""
    @property
    def collision_torque(self) -> NDArray[np.float64]:
        """`external_torque` without wanted contacts, `(nv,)` [Nm, N]; zero at joints that are left out."""
    @property
    def wrenches(self) -> NDArray[np.float64]:
        """The external wrench that each sensor measures, `(n_sensors, 6)` [N, Nm].

        Force and moment on the robot at the sensor's origin, world axes; NaN where a sensor is left out.
        """
    @property
    def sensors_left_out(self) -> tuple[str, ...]:
        """Names of the sensors without a reading in this tick."""
    @property
    def joints_left_out(self) -> tuple[str, ...]:
        """Names of the joints whose torques are not used to detect a collision, since a wanted contact loads them unmeasured.

        They are those behind its sensor, and while that gives no reading (and a little after) those between it and the
        base.
        """
    @property
    def acceleration(self) -> NDArray[np.float64]:
        """Estimated acceleration, `(nv,)` [rad/s^2, m/s^2]."""
    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts; empty while there is no collision."""
    @property
    def truncated(self) -> bool:
        """Whether the answer is cut short.

        There were more contacts than `max_contacts`, more hits of a line than are kept (the nearest are), or more
        explanations to try than the bounded work of a call allows.
        """
    def to_dict(self) -> dict[str, Any]:
        """As plain Python data: numbers, strings, lists and dicts, `None` for what is undetermined."""

@final
class ContactParticleFilter:
    """Finds one contact anywhere on a robot from joint torques, by particles on its surface (Bimbo 2019).

    Each particle is a hypothesis of link, point, obstacle, force and stiffness. Those that predict the torques while the
    robot makes small motions in contact survive. It assumes one frictionless contact with a convex obstacle that stays
    where it is.

    Args:
        robot: the robot.
        particles: number of particles.
        motion: model of how a contact moves: "curvature" (Bimbo 2019, eq. 8), or the baselines "fixed_on_link" and
            "fixed_in_world".
        measurement: "normal" (frictionless) or "friction_cone" (forces across the normal up to `friction` times the normal
            force, integrated out).
        friction: coefficient of friction of the "friction_cone".
        links: names of the links to look on; by default all that move and have a surface.
        seed: the same seed gives the same answer, for any number of `threads`.
        force_range: least and greatest force at the start [N].
        stiffness_range: least and greatest stiffness at the start [N/m].
        radius_range: least and greatest radius of the obstacle's curvature at the start [m].
        schedule: "adaptive" (or None; by what the data show), "paper", or a mapping of some of "sharpness" (alpha [1/Nm]),
            "point_noise" [m], "force_noise" and "stiffness_noise" (relative), each a number or a pair (first, last), and
            "updates", the number after which the last is reached.
        threads: number of threads.
        likelihood: "gaussian" (force and stiffness are integrated out) or "exponential" (Bimbo 2019, eq. 5; both are drawn
            at random).
        torque_noise: standard deviation of the torques at rest, scalar or `(nv,)` [Nm, N]. Greater noise is learnt.
        relative_noise: standard deviation relative to the torque.
        torque_threshold: external torque below which on every joint there is no contact, scalar or `(nv,)` [Nm, N]. The
            default is more where three standard deviations at rest are; with `noise` it is these.
        noise: a `NoiseModel` in place of `torque_noise` and `relative_noise`.

    Raises:
        InputError: an argument cannot be used; names it.
        MemoryError: the particles do not fit into memory.

    Example:
        >>> import contactsense as cs
        >>> robot = cs.Robot.named("iiwa14")
        >>> particle_filter = cs.ContactParticleFilter(robot, particles=100)
        >>> particle_filter.update(robot.neutral(), robot.torque({})).contact
        False
    """
    def __new__(
        cls,
        robot: Robot,
        *,
        particles: int = 10_000,
        motion: Literal["curvature", "fixed_on_link", "fixed_in_world"] = "curvature",
        measurement: Literal["normal", "friction_cone"] = "normal",
        friction: float = 0.5,
        links: Iterable[str] | None = None,
        seed: int = 0,
        force_range: ArrayLike = (1.0, 100.0),
        stiffness_range: ArrayLike = (3e2, 3e4),
        radius_range: ArrayLike = (5e-3, 1.0),
        schedule: Literal["adaptive", "paper"]
        | Mapping[str, float | tuple[float, float]]
        | None = "adaptive",
        threads: int = 1,
        likelihood: Literal["gaussian", "exponential"] = "gaussian",
        torque_noise: ArrayLike = 0.02,
        relative_noise: float = 0.03,
        torque_threshold: ArrayLike = 0.2,
        noise: NoiseModel | None = None,
    ) -> Self: ...
    def update(self, q: ArrayLike, tau_ext: ArrayLike, *, time: float | None = None) -> ContactEstimate:
        """Takes in a configuration and the external torque measured there.

        The first call with a contact spreads the particles over the surface. Other Python threads run meanwhile. With many
        particles Ctrl-C stops the call, and the filter has then forgotten all updates.

        Args:
            q: configuration, `(nq,)`.
            tau_ext: external torque, `(nv,)` [Nm, N]: what `MomentumObserver` gives, or `g(q) - tau` where the robot holds still.
            time: time of the measurement [s], which is handed on to the estimate.

        Returns:
            A `ContactEstimate`.

        Raises:
            InputError: an argument cannot be used; names it. The filter is then unchanged.
        """
    def reset(self) -> None:
        """Forgets all updates."""
    @property
    def robot(self) -> Robot:
        """The robot that contacts are looked for on."""
    @property
    def particles(self) -> Particles:
        """The particles after the last update."""

@final
class Particles:
    """The particles of a filter, one row each."""
    def __new__(
        cls,
        link: NDArray[np.int64],
        point: NDArray[np.float64],
        normal: NDArray[np.float64],
        force: NDArray[np.float64],
        stiffness: NDArray[np.float64],
        weight: NDArray[np.float64],
    ) -> Self: ...
    def __len__(self) -> int: ...
    @property
    def link(self) -> NDArray[np.int64]:
        """Links, `(n,)`: places in `robot.link_names`."""
    @property
    def point(self) -> NDArray[np.float64]:
        """Contact points, `(n, 3)`, world frame [m]."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward normals, `(n, 3)`, world frame."""
    @property
    def force(self) -> NDArray[np.float64]:
        """Forces along the inward normal, `(n,)` [N]."""
    @property
    def stiffness(self) -> NDArray[np.float64]:
        """Stiffnesses, `(n,)` [N/m]."""
    @property
    def weight(self) -> NDArray[np.float64]:
        """Weights, `(n,)`; their sum is one."""

@final
class ContactEstimate:
    """The contact as a filter estimates it."""
    @property
    def contact(self) -> bool:
        """Whether the torques show a contact."""
    @property
    def event(self) -> Literal["none", "started", "continued", "lost", "changed", "jumped"]:
        """What happened with this update.

        "none", "started", "continued", "lost", "changed" (the contact is elsewhere than it was estimated before) or
        "jumped" (the pose did, so the search began anew).
        """
    @property
    def link(self) -> str:
        """The most probable link's name; empty without contact."""
    @property
    def point(self) -> NDArray[np.float64]:
        """The most probable place on that link, `(3,)`, world frame [m]; NaN without contact."""
    @property
    def force(self) -> NDArray[np.float64]:
        """Force on the robot, `(3,)`, world frame [N]; NaN without contact."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward normal of the contact, `(3,)`, world frame; NaN without contact."""
    @property
    def magnitude(self) -> float:
        """Magnitude of the force [N]; NaN without contact."""
    @property
    def stiffness(self) -> float | None:
        """Stiffness of the contact [N/m]; `None` without contact, and where the motion model has none."""
    @property
    def covariance(self) -> NDArray[np.float64]:
        """Covariance of the point, `(3, 3)`, world frame [m^2]: second moment of all particles about `point`, other modes
        included.
        """
    @property
    def link_probabilities(self) -> dict[str, float]:
        """Share of the particles' weight on each link that is looked on."""
    @property
    def modes(self) -> tuple[Mode, ...]:
        """Clusters of particles, best first; at most eight."""
    @property
    def ambiguous(self) -> bool:
        """Whether the contact is not determined.

        The data do not determine which link, or where on it, or motion has not confirmed yet that it is a single push: that
        one obstacle that stays explains the torques at the last poses, is in contact with the link near `point`, and its
        force follows the motion.
        """
    @property
    def explained(self) -> bool:
        """Whether a push by one obstacle that stays explains the torques at the last poses.

        These are 24 at most, each 5 mm from the one before. What is left over is within three times the stated noise (a chi-square test at 99 %), and the force follows the
        motion no less than on the softest obstacle of `stiffness_range` (another one at 99 %). Where not, the estimate is
        ambiguous, too: two contacts, a moment, a payload, a pull, or biased torques.
        """

    @property
    def residual(self) -> float:
        """Torque that the best push does not explain at this update, in standard deviations of the stated noise.

        It is the root mean square over all joints; the noise is `torque_noise` and `relative_noise`.
        """

    @property
    def effective_samples(self) -> float:
        """Effective number of particles before resampling."""
    @property
    def time(self) -> float:
        """Time as given to `update` [s]; otherwise the number of updates since the start."""
    def to_dict(self) -> dict[str, Any]:
        """As plain Python data: numbers, strings, lists and dicts, `None` for what is undetermined."""

@final
class Mode:
    """A place where the contact may be."""
    @property
    def link(self) -> str:
        """The link's name."""
    @property
    def point(self) -> NDArray[np.float64]:
        """The place on the link's surface, `(3,)`, world frame [m]."""
    @property
    def force(self) -> NDArray[np.float64]:
        """Force on the robot, `(3,)`, world frame [N]."""
    @property
    def normal(self) -> NDArray[np.float64]:
        """Outward normal, `(3,)`, world frame."""
    @property
    def probability(self) -> float:
        """Share of the particles' weight."""
    @property
    def spread(self) -> float:
        """Root of the mean squared distance of the mode's particles from their mean [m]."""
    def to_dict(self) -> dict[str, Any]:
        """As plain Python data: numbers, strings and lists."""
