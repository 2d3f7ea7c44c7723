"""The posterior of one contact, computed with Pinocchio's Jacobians and by integration over the force.

The prior that a map states: every link equally likely, a point uniform by area over its exposed surface, a
normal force whose logarithm is uniform, a force across the normal that is Gaussian with half the friction
cone's radius as its standard deviation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import contactsense as cs

FloatArray = NDArray[np.float64]

FORCES = (2.0, 300.0)  # [N]
GRID = 400
LARGEST_SHARE = 0.1  # of the relative error of the largest torque, on every joint


@dataclass(frozen=True)
class Truth:
    """A contact drawn from the prior, world frame; its torque without noise."""

    q: FloatArray
    link: str
    point: FloatArray
    normal: FloatArray
    force: FloatArray
    torque: FloatArray


def deviations(noise: cs.NoiseModel, torque: FloatArray) -> FloatArray:
    """Standard deviation of each torque (Nm), as `NoiseModel` states it."""
    grown = noise.relative * np.hypot(torque, LARGEST_SHARE * np.abs(torque).max())
    result: FloatArray = np.sqrt(noise.torque**2 + noise.model**2 + grown**2)
    return np.broadcast_to(result, torque.shape)


def jacobians(model: Any, q: FloatArray, link: str, points: FloatArray) -> FloatArray:
    """Of points on a link, world frame, `(n, 3, nv)`, by Pinocchio."""
    data = model.createData()
    frame = model.getFrameId(link, pin.FrameType.BODY)
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    at_origin = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)
    arms = points - data.oMf[frame].translation
    return np.stack([at_origin[:3] - pin.skew(arm) @ at_origin[3:] for arm in arms])


def log_likelihoods(
    jacobian: FloatArray,
    inward: FloatArray,
    torque: FloatArray,
    deviation: FloatArray,
    friction: float,
    pull_probability: float,
) -> FloatArray:
    """Of a contact at each point relative to none, `(n,)`.

    `jacobian` `(n, 3, nv)`, `inward` normals `(n, 3)`. The normal force is integrated over; the force
    across it adds to the torque's covariance.
    """
    result = np.empty(len(jacobian))
    for k, (rows, normal) in enumerate(zip(jacobian, inward, strict=True)):
        white = rows / deviation
        target = torque / deviation
        along = normal @ white
        across = (np.eye(3) - np.outer(normal, normal)) @ white
        # Along these axes, what the force across the normal adds to the covariance is diagonal.
        _, size, axes = np.linalg.svd(across, full_matrices=False)

        def log_density(side: FloatArray) -> FloatArray:
            variances = 1.0 + np.outer((0.5 * friction * side) ** 2, size**2)  # noqa: B023
            # |target - side along|^2, with less weight along the axes.
            gained = 2.0 * side * (target @ along) - side**2 * (along @ along)  # noqa: B023
            shown = axes @ target - np.outer(side, axes @ along)  # noqa: B023
            log: FloatArray = gained + (shown**2 * (1.0 - 1.0 / variances) - np.log(variances)).sum(axis=1)
            return 0.5 * log

        push = integral(log_density) + np.log(1.0 - pull_probability)
        pull = integral(lambda force: log_density(-force)) + np.log(max(pull_probability, 1e-300))
        result[k] = np.logaddexp(push, pull)
    return result


def integral(log_density: Callable[[FloatArray], FloatArray]) -> float:
    """Log of a density's mean over the log of the force, on a grid that is dense about its greatest value."""
    low, high = np.log(FORCES)
    logs = np.linspace(low, high, GRID)
    for _ in range(4):
        best = int(np.argmax(log_density(np.exp(logs))))
        about = logs[[max(best - 2, 0), min(best + 2, len(logs) - 1)]]
        logs = np.union1d(logs, np.linspace(*about, GRID // 4))
    values = log_density(np.exp(logs))
    greatest = values.max()
    return float(greatest + np.log(np.trapezoid(np.exp(values - greatest), logs) / (high - low)))


@dataclass(frozen=True)
class Patch:
    """The samples of a map of one link: outward normals, world frame, and log areas but for a constant."""

    points: FloatArray
    normals: FloatArray
    log_areas: FloatArray


def patches(robot: cs.Robot, q: FloatArray, link: str, points: FloatArray, drawn: int) -> Patch:
    """Of a map's points `(n, 3)`, world frame, that were chosen from so many points of the surface."""
    sample = robot.surface(link).sample(drawn, seed=0)
    pose = robot.link_pose(q, link)
    surface = sample.points @ pose[:3, :3].T + pose[:3, 3]
    apart = (surface**2).sum(axis=1)[:, None] + (points**2).sum(axis=1) - 2.0 * surface @ points.T
    itself = apart.argmin(axis=0)
    np.testing.assert_allclose(surface[itself], points, rtol=0.0, atol=1e-9)
    counts = np.bincount(apart.argmin(axis=1), minlength=len(points))
    return Patch(points, sample.normals[itself] @ pose[:3, :3].T, np.log(counts))


def area_shares(robot: cs.Robot) -> dict[str, float]:
    """Share of each link that can move in their surface."""
    areas = {link: robot.surface(link).area for link in prior_shares(robot)}
    return {link: area / sum(areas.values()) for link, area in areas.items()}


def prior_shares(robot: cs.Robot) -> dict[str, float]:
    """Prior probability of each link: what is believed where the torques say nothing."""
    deaf = cs.ContactMap(robot, samples=2000, noise=cs.NoiseModel(torque=1e6))
    return deaf.evaluate(robot.neutral(), np.zeros(robot.nv)).link_probabilities


def draw(
    robot: cs.Robot,
    rng: np.random.Generator,
    shares: dict[str, float],
    *,
    friction: float = 0.5,
    forces: tuple[float, float] = FORCES,
    pull_probability: float = 0.05,
    q: FloatArray | None = None,
) -> Truth:
    """A contact from the prior, at a random configuration."""
    if q is None:
        q = robot.random_configuration(int(rng.integers(2**31)))
    link = str(rng.choice(list(shares), p=np.array(list(shares.values())) / sum(shares.values())))
    sample = robot.surface(link).sample(1, seed=int(rng.integers(2**31)))
    pose = robot.link_pose(q, link)
    point = pose[:3, :3] @ sample.points[0] + pose[:3, 3]
    normal = pose[:3, :3] @ sample.normals[0]
    size = np.exp(rng.uniform(*np.log(forces)))
    across = rng.normal(size=3) * 0.5 * friction * size
    across -= (across @ normal) * normal
    force = across + (size if rng.random() < pull_probability else -size) * normal
    return Truth(q, link, point, normal, force, robot.jacobian(q, link, point)[:3].T @ force)


def calibration_error(probabilities: FloatArray, right: NDArray[np.bool_], bins: int = 10) -> float:
    """Expected calibration error over bins of equal count."""
    order = np.argsort(probabilities)
    parts = np.array_split(order, bins)
    gaps = [len(part) * abs(probabilities[part].mean() - right[part].mean()) for part in parts]
    return float(sum(gaps) / len(order))
