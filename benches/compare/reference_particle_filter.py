"""The particle filter of Bimbo 2019 as one would write it with Pinocchio, NumPy and SciPy's k-d trees."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray
from scipy.spatial import cKDTree

import contactsense as cs

FloatArray = NDArray[np.float64]


class ReferenceEstimate(NamedTuple):
    """Of the link with most particles; world frame."""

    link: str
    point: FloatArray
    force: FloatArray
    covariance: FloatArray
    link_probabilities: dict[str, float]


class _Link(NamedTuple):
    name: str
    frame: int
    joint: int
    points: FloatArray  # link frame
    normals: FloatArray
    tree: Any


class ReferenceParticleFilter:
    """10,000 particles as arrays, sorted by link, one step a call.

    A step: motion (8), likelihood (5)-(7), estimate, systematic resampling. Sharpness and noise go
    geometrically from the first to the last value of their pairs over `narrowing` steps. The
    noise of the points moves the centres, too: so one search of the nearest point serves both.
    """

    def __init__(
        self,
        model: Any,
        robot: cs.Robot,
        *,
        particles: int = 10_000,
        seed: int = 0,
        force_range: tuple[float, float] = (1.0, 100.0),  # [N]
        stiffness_range: tuple[float, float] = (3e2, 3e4),  # [N/m]
        radius_range: tuple[float, float] = (5e-3, 1.0),  # [m]
        sharpness: tuple[float, float] = (1.0, 30.0),  # [1/Nm]
        point_noise: tuple[float, float] = (10e-3, 0.5e-3),  # [m]
        relative_noise: tuple[float, float] = (0.1, 0.01),  # of force and stiffness
        narrowing: int = 15,
        spacing: float = 2e-3,  # of the points that stand for a surface [m]
    ) -> None:
        self.model, self.data = model, model.createData()
        self.count, self.seed = particles, seed
        self.force_range, self.stiffness_range = force_range, stiffness_range
        self.log_radii = np.log(radius_range)
        self.sharpness, self.point_noise, self.relative_noise = sharpness, point_noise, relative_noise
        self.narrowing = narrowing
        self.links = [
            link for name in robot.link_names if (link := self._link(robot, name, spacing)).joint > 0
        ]
        # Which joints move a link.
        self.moves = np.zeros((len(self.links), model.nv))
        for k, link in enumerate(self.links):
            for joint in list(model.supports[link.joint])[1:]:
                start = model.joints[joint].idx_v
                self.moves[k, start : start + model.joints[joint].nv] = 1.0
        self.areas = np.array([robot.surface(link.name).area for link in self.links])
        self.reset()

    def _link(self, robot: cs.Robot, name: str, spacing: float) -> _Link:
        surface = robot.surface(name)
        samples = surface.sample(max(64, int(surface.area / spacing**2)), seed=1)
        frame = self.model.getFrameId(name, pin.FrameType.BODY)
        joint = self.model.frames[frame].parentJoint
        return _Link(name, frame, joint, samples.points, samples.normals, cKDTree(samples.points))

    def reset(self) -> None:
        """Forgets all particles; the same numbers are drawn again."""
        self.rng = np.random.default_rng(self.seed)
        self.steps = -1

    def update(self, q: FloatArray, tau_ext: FloatArray) -> ReferenceEstimate:
        """One pose with its external torques `(nv,)`; the first call spreads the particles."""
        pin.computeJointJacobians(self.model, self.data, q)
        poses = [pin.updateFramePlacement(self.model, self.data, link.frame) for link in self.links]
        self.steps += 1
        progress = min(self.steps / self.narrowing, 1.0)
        alpha = _between(self.sharpness, progress)
        if self.steps == 0:
            self._spread(poses)
        else:
            self._move(poses, _between(self.point_noise, progress), _between(self.relative_noise, progress))
        log_weights = -alpha * self._misfit(tau_ext)
        weights = np.exp(log_weights - log_weights.max())
        weights /= weights.sum()
        estimate = self._estimate(weights)
        self._resample(weights)
        return estimate

    def _spread(self, poses: list[Any]) -> None:
        """Uniform by area; force and stiffness log-uniform."""
        n, rng = self.count, self.rng
        per_link = rng.multinomial(n, self.areas / self.areas.sum())
        self.ends = np.concatenate([[0], np.cumsum(per_link)])
        self.point, self.normal = np.empty((n, 3)), np.empty((n, 3))
        for link, pose, part in zip(self.links, poses, self._parts(), strict=True):
            chosen = rng.integers(len(link.points), size=part.stop - part.start)
            self._place(part, link, pose, chosen)
        self.force = np.exp(rng.uniform(*np.log(self.force_range), n))
        self.stiffness = np.exp(rng.uniform(*np.log(self.stiffness_range), n))

    def _move(self, poses: list[Any], point_noise: float, relative_noise: float) -> None:
        """Equation (8), a radius drawn anew for every particle, and noise."""
        n, rng = self.count, self.rng
        radius = np.exp(rng.uniform(*self.log_radii, n))
        centre = self.point + radius[:, None] * self.normal
        centre += point_noise * rng.standard_normal((n, 3))
        distance = np.empty(n)
        for link, pose, part in zip(self.links, poses, self._parts(), strict=True):
            local = (centre[part] - pose.translation) @ pose.rotation
            distance[part], nearest = link.tree.query(local)
            self._place(part, link, pose, nearest)
        self.force += (radius - distance) * self.stiffness
        noise = relative_noise * rng.standard_normal((2, n))
        self.force *= 1.0 + noise[0]
        self.stiffness *= np.exp(noise[1])
        # A contact pushes.
        np.maximum(self.force, 0.0, out=self.force)
        np.clip(self.stiffness, *self.stiffness_range, out=self.stiffness)

    def _misfit(self, tau_ext: FloatArray) -> FloatArray:
        """The norm in (5): torques (6) of the forces (7) from the joints' axes, once a step."""
        push = -self.force[:, None] * self.normal
        torque = np.hstack([push, np.cross(self.point, push)]) @ self.data.J
        for k, part in enumerate(self._parts()):
            torque[part] *= self.moves[k]
        torque -= tau_ext
        misfit: FloatArray = np.sqrt(np.einsum("ij,ij->i", torque, torque))
        return misfit

    def _estimate(self, weights: FloatArray) -> ReferenceEstimate:
        shares = [float(weights[part].sum()) for part in self._parts()]
        best = int(np.argmax(shares))
        part = self._parts()[best]
        own = weights[part] / max(shares[best], np.finfo(float).tiny)
        point = own @ self.point[part]
        force = -(own * self.force[part]) @ self.normal[part]
        off = self.point[part] - point
        names = [link.name for link in self.links]
        return ReferenceEstimate(
            names[best], point, force, (own * off.T) @ off, dict(zip(names, shares, strict=True))
        )

    def _resample(self, weights: FloatArray) -> None:
        """Systematic; keeps the order, so that the particles stay sorted by link."""
        n = self.count
        total = np.cumsum(weights)
        places = (self.rng.random() + np.arange(n)) / n * total[-1]
        chosen = np.minimum(np.searchsorted(total, places, side="right"), n - 1)
        self.ends = np.searchsorted(chosen, self.ends)
        self.point, self.normal = self.point[chosen], self.normal[chosen]
        self.force, self.stiffness = self.force[chosen], self.stiffness[chosen]

    def _parts(self) -> list[slice]:
        return [slice(int(a), int(b)) for a, b in zip(self.ends, self.ends[1:], strict=False)]

    def _place(self, part: slice, link: _Link, pose: Any, chosen: NDArray[np.int64]) -> None:
        self.point[part] = link.points[chosen] @ pose.rotation.T + pose.translation
        self.normal[part] = link.normals[chosen] @ pose.rotation.T


def _between(ends: tuple[float, float], share: float) -> float:
    """Geometrically."""
    return float(ends[0] * (ends[1] / ends[0]) ** share)
