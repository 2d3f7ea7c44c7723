"""Types of the compiled core; its docstrings say shapes, units, frames and errors."""

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
    "_robot_from_urdf",
    "build_profile",
]

__version__: Final[str]
build_profile: Final[Literal["debug", "release"]]

class ContactSenseError(Exception): ...
class ModelError(ContactSenseError): ...
class GeometryError(ContactSenseError): ...
class InputError(ContactSenseError, ValueError): ...

def _robot_from_urdf(
    path: str | PathLike[str],
    package_dirs: Sequence[str | PathLike[str]] = ...,
    floating_base: bool = False,
    locked: Sequence[tuple[str, float | None]] = ...,
    geometry: str = "collision",
    gravity: Sequence[float] = ...,
) -> Robot: ...

@disjoint_base
class Robot:
    def __new__(
        cls,
        name: str,
        joints: Iterable[tuple[Any, ...]],
        links: Iterable[tuple[Any, ...]],
        gravity: ArrayLike,
        warnings: list[str],
    ) -> Self: ...
    @property
    def name(self) -> str: ...
    @property
    def nq(self) -> int: ...
    @property
    def nv(self) -> int: ...
    @property
    def floating_base(self) -> bool: ...
    @property
    def joint_names(self) -> tuple[str, ...]: ...
    @property
    def joint_kinds(self) -> tuple[str, ...]: ...
    @property
    def link_names(self) -> tuple[str, ...]: ...
    @property
    def warnings(self) -> tuple[str, ...]: ...
    def neutral(self) -> NDArray[np.float64]: ...
    def mass_matrix(self, q: ArrayLike) -> NDArray[np.float64]: ...
    def inverse_dynamics(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> NDArray[np.float64]: ...
    def forward_dynamics(
        self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, tau_ext: ArrayLike | None = None
    ) -> NDArray[np.float64]: ...
    def link_pose(self, q: ArrayLike, link: str) -> NDArray[np.float64]: ...
    def jacobian(self, q: ArrayLike, link: str, point: ArrayLike | None = None) -> NDArray[np.float64]: ...
    def surface(self, link: str) -> Surface: ...

@final
class Surface:
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def triangles(self) -> NDArray[np.int64]: ...
    @property
    def area(self) -> float: ...
    @property
    def watertight(self) -> bool: ...
    def closest_points(self, points: ArrayLike) -> ClosestPoints: ...
    def cast_rays(self, origins: ArrayLike, directions: ArrayLike) -> RayHits: ...
    def sample(self, n: int, seed: int = 0) -> SurfaceSamples: ...

@final
class ClosestPoints:
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def normals(self) -> NDArray[np.float64]: ...
    @property
    def distances(self) -> NDArray[np.float64]: ...
    @property
    def triangles(self) -> NDArray[np.int64]: ...

@final
class RayHits:
    @property
    def ray(self) -> NDArray[np.int64]: ...
    @property
    def distance(self) -> NDArray[np.float64]: ...
    @property
    def point(self) -> NDArray[np.float64]: ...
    @property
    def normal(self) -> NDArray[np.float64]: ...
    @property
    def triangle(self) -> NDArray[np.int64]: ...

@final
class SurfaceSamples:
    @property
    def points(self) -> NDArray[np.float64]: ...
    @property
    def normals(self) -> NDArray[np.float64]: ...
    @property
    def triangles(self) -> NDArray[np.int64]: ...

@final
class MomentumObserver:
    def __new__(cls, robot: Robot, *, dt: float, gain: ArrayLike | None = None) -> Self: ...
    def update(
        self,
        q: ArrayLike,
        v: ArrayLike,
        tau: ArrayLike,
        *,
        dt: float | None = None,
        friction: ArrayLike | None = None,
    ) -> NDArray[np.float64]: ...
    def reset(self) -> None: ...
    @property
    def external_torque(self) -> NDArray[np.float64]: ...
    @property
    def acceleration(self) -> NDArray[np.float64]: ...

@final
class ForceTorqueSensor:
    def __new__(
        cls,
        name: str,
        link: str,
        *,
        pose: ArrayLike | None = None,
        convention: Literal["load", "support"] = "load",
    ) -> Self: ...
    @property
    def name(self) -> str: ...
    @property
    def link(self) -> str: ...
    @property
    def pose(self) -> NDArray[np.float64]: ...
    @property
    def convention(self) -> Literal["load", "support"]: ...
    def __hash__(self) -> int: ...

@final
class LoadCompensator:
    def __new__(cls, robot: Robot, sensors: Iterable[ForceTorqueSensor]) -> Self: ...
    def update(
        self, q: ArrayLike, v: ArrayLike, a: ArrayLike, wrenches: ArrayLike
    ) -> NDArray[np.float64]: ...

@final
class NoiseModel:
    def __new__(
        cls,
        *,
        torque: ArrayLike = 0.05,
        velocity: ArrayLike = 0.0,
        relative: ArrayLike = 0.03,
        model: ArrayLike = 0.1,
    ) -> Self: ...
    @property
    def torque(self) -> float | NDArray[np.float64]: ...
    @property
    def velocity(self) -> float | NDArray[np.float64]: ...
    @property
    def relative(self) -> float | NDArray[np.float64]: ...
    @property
    def model(self) -> float | NDArray[np.float64]: ...

@final
class ContactIsolator:
    def __new__(
        cls,
        robot: Robot,
        *,
        sensors: Iterable[ForceTorqueSensor] | None = None,
        torque_threshold: ArrayLike | None = None,
        wrench_threshold: ArrayLike | None = None,
        wanted_contacts: Iterable[str] | None = None,
        max_contacts: int | None = None,
        pushing: bool = True,
        noise: NoiseModel | None = None,
        locate_within: float | None = None,
    ) -> Self: ...
    def isolate(self, q: ArrayLike, tau_ext: ArrayLike, wrenches: ArrayLike | None = None) -> Isolation: ...

@final
class Isolation:
    @property
    def contacts(self) -> tuple[Contact, ...]: ...
    @property
    def rank_deficit(self) -> int: ...
    @property
    def residual(self) -> float: ...
    @property
    def link_candidates(self) -> tuple[str, ...]: ...
    @property
    def truncated(self) -> bool: ...

@final
class Contact:
    @property
    def link(self) -> str: ...
    @property
    def point(self) -> NDArray[np.float64]: ...
    @property
    def point_local(self) -> NDArray[np.float64]: ...
    @property
    def force(self) -> NDArray[np.float64]: ...
    @property
    def normal(self) -> NDArray[np.float64]: ...
    @property
    def wrench(self) -> NDArray[np.float64]: ...
    @property
    def source(self) -> str: ...
    @property
    def located(self) -> bool: ...
    @property
    def point_std(self) -> float: ...
    @property
    def verified(self) -> bool: ...
    @property
    def candidates(self) -> tuple[Candidate, ...]: ...

@final
class Candidate:
    @property
    def link(self) -> str: ...
    @property
    def point(self) -> NDArray[np.float64]: ...
    @property
    def normal(self) -> NDArray[np.float64]: ...
    @property
    def pushing(self) -> bool: ...

@final
class ContactMonitor:
    def __new__(
        cls,
        robot: Robot,
        *,
        dt: float,
        sensors: Iterable[ForceTorqueSensor] | None = None,
        wanted_contacts: Iterable[str] | None = None,
        observer_gain: ArrayLike | None = None,
        torque_threshold: ArrayLike | None = None,
        wrench_threshold: ArrayLike | None = None,
        wrench_gain: float | None = None,
        bias_time_constant: float | None = None,
        bias_limit: float | None = None,
        bias_settle_time: float | None = None,
        hysteresis: ArrayLike | None = None,
        hold_time: float | None = None,
        max_contacts: int | None = None,
        pushing: bool = True,
        locate_within: float | None = None,
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
    ) -> ContactReport: ...
    def reset(self) -> None: ...
    @property
    def robot(self) -> Robot: ...
    @property
    def dt(self) -> float: ...
    @property
    def bias(self) -> NDArray[np.float64]: ...

@final
class ContactReport:
    @property
    def time(self) -> float: ...
    @property
    def collision(self) -> bool: ...
    @property
    def onset(self) -> bool: ...
    @property
    def remainder_learned(self) -> bool: ...
    @property
    def links(self) -> tuple[str, ...]: ...
    @property
    def external_torque(self) -> NDArray[np.float64]: ...
    @property
    def collision_torque(self) -> NDArray[np.float64]: ...
    @property
    def wrenches(self) -> NDArray[np.float64]: ...
    @property
    def sensors_left_out(self) -> tuple[str, ...]: ...
    @property
    def joints_left_out(self) -> tuple[str, ...]: ...
    @property
    def acceleration(self) -> NDArray[np.float64]: ...
    @property
    def contacts(self) -> tuple[Contact, ...]: ...
    @property
    def truncated(self) -> bool: ...

@final
class ContactParticleFilter:
    def __new__(
        cls,
        robot: Robot,
        *,
        particles: int | None = None,
        motion: Literal["curvature", "fixed_on_link", "fixed_in_world"] = "curvature",
        measurement: Literal["normal", "friction_cone"] = "normal",
        friction: float | None = None,
        links: Iterable[str] | None = None,
        seed: int | None = None,
        force_range: ArrayLike | None = None,
        stiffness_range: ArrayLike | None = None,
        radius_range: ArrayLike | None = None,
        schedule: Literal["adaptive", "paper"] | Mapping[str, float | tuple[float, float]] | None = None,
        threads: int | None = None,
        likelihood: Literal["gaussian", "exponential"] = "gaussian",
        torque_noise: ArrayLike | None = None,
        relative_noise: float | None = None,
        torque_threshold: ArrayLike | None = None,
        noise: NoiseModel | None = None,
    ) -> Self: ...
    def update(self, q: ArrayLike, tau_ext: ArrayLike, *, time: float | None = None) -> ContactEstimate: ...
    def reset(self) -> None: ...
    @property
    def particles(self) -> Particles: ...

@final
class Particles:
    @property
    def link(self) -> NDArray[np.int64]: ...
    @property
    def point(self) -> NDArray[np.float64]: ...
    @property
    def normal(self) -> NDArray[np.float64]: ...
    @property
    def force(self) -> NDArray[np.float64]: ...
    @property
    def stiffness(self) -> NDArray[np.float64]: ...
    @property
    def weight(self) -> NDArray[np.float64]: ...

@final
class ContactEstimate:
    @property
    def contact(self) -> bool: ...
    @property
    def event(self) -> str: ...
    @property
    def link(self) -> str: ...
    @property
    def point(self) -> NDArray[np.float64]: ...
    @property
    def force(self) -> NDArray[np.float64]: ...
    @property
    def normal(self) -> NDArray[np.float64]: ...
    @property
    def magnitude(self) -> float: ...
    @property
    def stiffness(self) -> float | None: ...
    @property
    def covariance(self) -> NDArray[np.float64]: ...
    @property
    def link_probabilities(self) -> dict[str, float]: ...
    @property
    def modes(self) -> tuple[Mode, ...]: ...
    @property
    def ambiguous(self) -> bool: ...
    @property
    def explained(self) -> bool:
        """Whether a single push explains the torques at the last poses; otherwise `ambiguous` is True."""

    @property
    def residual(self) -> float:
        """Root mean square over the joints of what the best push leaves over, in standard deviations."""

    @property
    def effective_samples(self) -> float: ...
    @property
    def time(self) -> float: ...

@final
class Mode:
    @property
    def link(self) -> str: ...
    @property
    def point(self) -> NDArray[np.float64]: ...
    @property
    def force(self) -> NDArray[np.float64]: ...
    @property
    def normal(self) -> NDArray[np.float64]: ...
    @property
    def probability(self) -> float: ...
    @property
    def spread(self) -> float: ...
