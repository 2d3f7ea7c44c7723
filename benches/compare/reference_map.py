"""The posterior of one contact over the surface with Pinocchio and NumPy, beside `ContactMap.evaluate`.

All samples of all links at once: the torques of a unit force along each direction at each sample, their
Gram matrices, and the force integrated out as `ContactMap` does. It keeps to its samples: nothing is divided
where the posterior is narrower than they are apart.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import contactsense as cs

FloatArray = NDArray[np.float64]

FORCES = (2.0, 300.0)  # [N]
PASSES = 3
HELD = 0.9


class Found(NamedTuple):
    link: str
    point: FloatArray
    region_radius: float
    link_probabilities: dict[str, float]
    log_evidence: float


class ReferenceMap:
    """One contact anywhere on the links that move."""

    def __init__(
        self,
        robot: cs.Robot,
        model: Any,
        *,
        samples: int = 5_000,
        friction: float = 0.5,
        deviation: float,
        pull_probability: float = 0.05,
    ) -> None:
        self.model, self.data = model, model.createData()
        self.deviation, self.slack = deviation, 0.5 * friction
        self.log_sides = np.log([1.0 - pull_probability, pull_probability])
        rest = robot.neutral()
        surfaces = {
            link: robot.surface(link) for link in robot.link_names if robot.jacobian(rest, link).any()
        }
        surfaces = {link: surface for link, surface in surfaces.items() if surface is not None}
        roots = sum(np.sqrt(surface.area) for surface in surfaces.values())
        self.links, self.frames = list(surfaces), []
        self.points, self.directions, log_areas = [], [], []
        for link, surface in surfaces.items():
            count = max(1, round(samples * np.sqrt(surface.area) / roots))
            drawn = surface.sample(count)
            aside = np.cross(drawn.normals, np.eye(3)[np.abs(drawn.normals).argmin(axis=1)])
            aside /= np.linalg.norm(aside, axis=1, keepdims=True)
            self.points.append(drawn.points)
            self.directions.append(np.stack([-drawn.normals, aside, np.cross(drawn.normals, aside)], axis=1))
            log_areas.append(np.full(count, np.log(surface.area / count)))
            self.frames.append(model.getFrameId(link, pin.FrameType.BODY))
        self.log_area = np.concatenate(log_areas)
        self.link_of = np.repeat(np.arange(len(self.links)), [len(each) for each in self.points])

    def evaluate(self, q: FloatArray, tau_ext: FloatArray) -> Found:
        pin.computeJointJacobians(self.model, self.data, q)
        pin.updateFramePlacements(self.model, self.data)
        places, shown = [], []
        for frame, points, directions in zip(self.frames, self.points, self.directions, strict=True):
            jacobian = pin.getFrameJacobian(self.model, self.data, frame, pin.LOCAL) / self.deviation
            # The torque of a unit force: its linear part, and its moment about the link's origin.
            moments = np.cross(points[:, None], directions)
            shown.append(directions @ jacobian[:3] + moments @ jacobian[3:])
            pose = self.data.oMf[frame]
            places.append(points @ pose.rotation.T + pose.translation)
        place, effect = np.concatenate(places), np.concatenate(shown)
        target = tau_ext / self.deviation
        log = np.logaddexp(*(self._sides(effect, target)))
        log += self.log_area
        greatest = log.max()
        weights = np.exp(log - greatest)
        total = weights.sum()
        weights /= total
        on_link = np.bincount(self.link_of, weights, len(self.links))
        best = int(on_link.argmax())
        top = int(np.where(self.link_of == best, weights, -1.0).argmax())
        apart = np.linalg.norm(place - place[top], axis=1)
        order = apart.argsort()
        held = np.searchsorted(np.cumsum(weights[order]), HELD)
        return Found(
            self.links[best],
            place[top],
            float(apart[order[min(held, len(order) - 1)]]),
            dict(zip(self.links, on_link.tolist(), strict=True)),
            float(greatest + np.log(total) - np.log(np.exp(self.log_area).sum())),
        )

    def _sides(self, effect: FloatArray, target: FloatArray) -> list[FloatArray]:
        """Log-likelihoods of a contact that pushes and one that pulls at each sample, relative to none."""
        gram = effect @ effect.transpose(0, 2, 1)
        product = effect @ target
        low, high = FORCES
        gain, along = gram[:, 0, 0], product[:, 0]
        size = np.clip(np.abs(along / np.maximum(gain, 1e-30)), low, high)
        for _ in range(PASSES):
            precision = 1.0 / (self.slack * size) ** 2
            one, two, both = gram[:, 1, 1] + precision, gram[:, 2, 2] + precision, gram[:, 1, 2]
            determinant = one * two - both**2
            first, second = gram[:, 1, 0], gram[:, 2, 0]
            unit = (two * first - both * second) / determinant, (one * second - both * first) / determinant
            left = np.maximum(gain - first * unit[0] - second * unit[1], 1e-30)
            beside = product[:, 1], product[:, 2]
            seen = along - beside[0] * unit[0] - beside[1] * unit[1]
            explained = (
                beside[0] * (two * beside[0] - both * beside[1])
                + beside[1] * (one * beside[1] - both * beside[0])
            ) / determinant
            size = np.clip(np.abs(seen / left), low, high)
        sides = []
        for sign, prior in zip((1.0, -1.0), self.log_sides, strict=True):
            force = np.clip(sign * seen / left, low, high)
            volume = 2.0 * np.pi / (left * (force * np.log(high / low)) ** 2 + 2.0 * np.pi)
            volume *= precision**2 / determinant
            gained = explained + 2.0 * sign * force * seen - force**2 * left
            sides.append(0.5 * (gained + np.log(volume)) + prior)
        return sides
