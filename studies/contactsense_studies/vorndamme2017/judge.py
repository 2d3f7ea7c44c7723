"""How well an isolation answers: distances from true points to estimates, and claims that are wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from contactsense import Contact, Isolation, Robot
from contactsense.sim._arrays import FloatArray

from .information import rank_deficit
from .scenes import Scene

NEAR = 0.01  # [m], a point counts as the true one


@dataclass(frozen=True)
class Claim:
    """A located contact beside the true one nearest to its point."""

    error: float  # [m]
    point_std: float  # [m], as the contact states it
    force_error: float  # relative


@dataclass(frozen=True)
class Verdict:
    """One scene judged. A contact's estimate is its point, or its first candidate's where that is open."""

    links: tuple[str, ...]  # truly touched
    named: tuple[str, ...]  # links of the contacts reported
    rank_deficit: int  # of the true contacts
    errors: tuple[float, ...]  # [m] of each true contact: to the estimate assigned to it; inf: there is none
    force_errors: tuple[float, ...]  # relative, of each true contact; NaN: the force assigned to it is open
    claims: tuple[Claim, ...]  # of the contacts said to be located
    among_candidates: bool  # every true point is within 1 cm of some candidate

    @property
    def error(self) -> float:
        """Worst of `errors` [m]."""
        return max(self.errors)

    @property
    def located_error(self) -> float:
        """Greatest error of a claim [m]; 0: there is none."""
        return max((claim.error for claim in self.claims), default=0.0)

    @property
    def links_right(self) -> bool:
        """Just the links touched are named."""
        return sorted(self.named) == sorted(self.links)

    @property
    def all_located(self) -> bool:
        """As many contacts are said to be located as there are."""
        return len(self.claims) == len(self.links)

    @property
    def wrong(self) -> bool:
        """A contact is said to be located, and is more than 1 cm from every true one."""
        return self.located_error > NEAR


@dataclass(frozen=True)
class Answer:
    """One contact as reported."""

    link: str
    estimate: FloatArray  # (3,), NaN where there is none
    force: FloatArray  # (3,), NaN where it is open
    located: bool
    candidates: list[FloatArray]  # each (3,), the estimate among them
    point_std: float = 0.0  # [m]


def judge(robot: Robot, scene: Scene, isolation: Isolation, deficit: int | None = None) -> Verdict:
    """Compares an isolation with the truth; `deficit` where the scene's rank deficit is known already."""
    if deficit is None:
        deficit = rank_deficit(robot, scene.q, scene.links)
    return judge_answers(scene, [answer(contact) for contact in isolation.contacts], deficit)


def judge_answers(scene: Scene, contacts: Sequence[Answer], deficit: int) -> Verdict:
    """Compares answers with the truth.

    Estimates are assigned one to one, so that the worst distance is least, then their sum.
    """
    true = np.array([touch.point for touch in scene.touches])
    estimates = np.array([contact.estimate for contact in contacts]).reshape(-1, 3)
    distances = np.linalg.norm(true[:, None] - estimates[None], axis=2)
    distances[np.isnan(distances)] = np.inf
    assigned = assign(distances)
    errors = [np.inf if j is None else float(distances[i, j]) for i, j in enumerate(assigned)]
    forces = [
        np.nan if j is None else _force_error(touch.force, contacts[j].force)
        for touch, j in zip(scene.touches, assigned, strict=True)
    ]
    claims = []
    for column, contact in enumerate(contacts):
        if contact.located:
            nearest = int(distances[:, column].argmin())
            force_error = _force_error(scene.touches[nearest].force, contact.force)
            claims.append(Claim(float(distances[nearest, column]), contact.point_std, force_error))
    offered = [point for contact in contacts for point in contact.candidates]
    return Verdict(
        links=scene.links,
        named=tuple(contact.link for contact in contacts),
        rank_deficit=deficit,
        errors=tuple(errors),
        force_errors=tuple(forces),
        claims=tuple(claims),
        among_candidates=all(_near(point, offered) for point in true),
    )


def answer(contact: Contact) -> Answer:
    """A contact's point, or its first candidate's where that is open, as the estimate."""
    candidates = [candidate.point for candidate in contact.candidates]
    if np.isfinite(contact.point).all():
        candidates.insert(0, contact.point)
    estimate = candidates[0] if candidates else np.full(3, np.nan)
    return Answer(contact.link, estimate, contact.force, contact.located, candidates, contact.point_std)


def assign(distances: FloatArray) -> list[int | None]:
    """For each row of `(n, m)` a column of its own, None where columns run out."""
    rows, columns = distances.shape
    padded = np.full((rows, max(rows, columns)), np.inf)
    padded[:, :columns] = distances

    def cost(choice: tuple[int, ...]) -> tuple[int, float, float]:
        picked = padded[range(rows), choice]
        finite = picked[np.isfinite(picked)]
        return rows - len(finite), float(finite.max(initial=0.0)), float(finite.sum())

    best = min(permutations(range(padded.shape[1]), rows), key=cost)
    return [j if j < columns else None for j in best]


def _force_error(true: FloatArray, found: FloatArray) -> float:
    return float(np.linalg.norm(found - true) / np.linalg.norm(true))


def _near(point: FloatArray, offered: list[FloatArray]) -> bool:
    return bool(offered) and bool(np.min(np.linalg.norm(np.array(offered) - point, axis=1)) < NEAR)
