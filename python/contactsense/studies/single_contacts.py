"""Single contacts, ideal measurements: what the torques determine, how exactly (Vorndamme 2017, VI-B)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .. import ContactIsolator, InputError, Robot

if TYPE_CHECKING:
    from rich.table import Table

FloatArray = NDArray[np.float64]

TOLERANCE = 1e-9  # [m], and relative for the force
RANK_TOLERANCE = 1e-7  # of the largest singular value
CONE = np.deg2rad(30.0)
TRIES = 300
POINTS_PER_POSE = 10


@dataclass(frozen=True)
class Touch:
    """A true contact, world frame."""

    link: str
    q: FloatArray
    point: FloatArray  # [m]
    force: FloatArray  # [N]


@dataclass(frozen=True)
class LinkResult:
    """Counts of one link's contacts by outcome, and the worst errors of those located."""

    link: str
    outcomes: Counter[str]
    point_error: float  # [m]
    force_error: float  # relative


def random_configuration(robot: Robot, rng: np.random.Generator) -> FloatArray:
    """A pose with every joint turned by up to half a turn, or moved by up to 0.1 m; the base anywhere."""
    q = robot.neutral()
    step = rng.uniform(-1.0, 1.0, robot.nv)
    return integrate(robot, q, step * (np.pi / 2))


def integrate(robot: Robot, q: FloatArray, step: FloatArray) -> FloatArray:
    """`q` moved by `step` `(nv,)`, joint by joint; the base's orientation by its rotation vector."""
    q, position = q.copy(), 0
    index = 0
    if robot.floating_base:
        q[:3] += step[:3]
        angle = float(np.linalg.norm(step[3:6]))
        axis = step[3:6] / max(angle, 1e-12)
        q[3:7] = [*(np.sin(angle / 2) * axis), np.cos(angle / 2)]
        position, index = 7, 6
    for kind in robot.joint_kinds[int(robot.floating_base) :]:
        if kind == "continuous":
            angle = float(np.arctan2(q[position + 1], q[position])) + step[index]
            q[position : position + 2] = np.cos(angle), np.sin(angle)
            position += 2
        else:
            q[position] += step[index] * (0.05 if kind == "prismatic" else 1.0)
            position += 1
        index += 1
    return q


def touches(robot: Robot, link: str, count: int, rng: np.random.Generator) -> Iterator[Touch]:
    """Random touches of a link, their lines of action free of all surfaces before the contact.

    Fewer than `count` where the link can hardly be reached. A new pose after every few.
    """
    surface = robot.surface(link)
    found = 0
    for _ in range(TRIES):
        q = random_configuration(robot, rng)
        samples = surface.sample(POINTS_PER_POSE, seed=int(rng.integers(2**63)))
        pose = robot.link_pose(q, link)
        points = samples.points @ pose[:3, :3].T + pose[:3, 3]
        directions = np.array([_tilt(-n, rng) for n in samples.normals @ pose[:3, :3].T])
        free = ~blocked(robot, q, link, points, directions)
        for point, direction in zip(points[free], directions[free], strict=True):
            yield Touch(link, q, point, direction * rng.uniform(1.0, 50.0))
            found += 1
            if found == count:
                return


def blocked(
    robot: Robot, q: FloatArray, link: str, points: FloatArray, directions: FloatArray
) -> NDArray[np.bool_]:
    """Whether the lines meet a surface before the points, coming along `directions`."""
    hit = np.zeros(len(points), dtype=bool)
    for name in robot.link_names:
        pose = robot.link_pose(q, name)
        local = (points - pose[:3, 3]) @ pose[:3, :3]
        back = -directions @ pose[:3, :3]
        hits = robot.surface(name).cast_rays(local, back)
        near = 1e-9 if name == link else -1.0  # a surface that coincides with another is neither's
        hit[hits.ray[hits.distance > near]] = True
    return hit


def _tilt(direction: FloatArray, rng: np.random.Generator) -> FloatArray:
    """A direction uniform in the cone of 30 degrees about `direction`."""
    cos = rng.uniform(np.cos(CONE), 1.0)
    turn = rng.uniform(0.0, 2 * np.pi)
    other = np.cross(direction, [1.0, 0, 0] if abs(direction[0]) < 0.8 else [0, 1.0, 0])
    other /= np.linalg.norm(other)
    across = np.cos(turn) * other + np.sin(turn) * np.cross(direction, other)
    tilted: FloatArray = cos * direction + np.sqrt(1 - cos * cos) * across
    return tilted


def judge(
    robot: Robot, isolator: ContactIsolator, touch: Touch, threshold: float
) -> tuple[str, float, float]:
    """Outcome of one touch, and the errors of point [m] and force (relative; NaN where not located).

    "located"; "not felt" by any joint; the link alone is right, or another is named, because the wrench has
    "rank < 6" or the "own joint" of the touched link is "silent" (under its threshold). "WRONG": said to be
    located, but is not within the tolerance; "MISSED": determined, but not located.
    """
    jacobian = robot.jacobian(touch.q, touch.link, touch.point)
    tau_ext = jacobian[:3].T @ touch.force
    columns = np.flatnonzero(np.any(jacobian != 0.0, axis=0))
    determined = wrench_rank(jacobian[:, columns]) == 6
    own_joint_feels = columns.size > 0 and abs(tau_ext[columns[-1]]) > threshold
    contacts = isolator.isolate(touch.q, tau_ext).contacts
    if not contacts:
        return ("not felt", np.nan, np.nan)
    contact = contacts[0]
    if contact.located:
        point_error = float(np.linalg.norm(contact.point - touch.point))
        force_error = float(np.linalg.norm(contact.force - touch.force) / np.linalg.norm(touch.force))
        if point_error > TOLERANCE or force_error > TOLERANCE or contact.link != touch.link:
            return ("WRONG", point_error, force_error)
        return ("located", point_error, force_error)
    if determined and own_joint_feels:
        return ("MISSED", np.nan, np.nan)
    named = "link only" if contact.link == touch.link else "other link"
    return (f"{named}, {'rank < 6' if own_joint_feels else 'own joint silent'}", np.nan, np.nan)


def wrench_rank(jacobian: FloatArray) -> int:
    """Rank of a `(6, n)` Jacobian, moments balanced against forces by a lever of 0.3 m."""
    if jacobian.shape[1] == 0:
        return 0
    balance = np.array([[1.0]] * 3 + [[1.0 / 0.3]] * 3)
    values = np.linalg.svd(jacobian * balance, compute_uv=False)
    return int(np.sum(values > RANK_TOLERANCE * values[0]))


def run(robot: Robot, points: int = 100, seed: int = 0, threshold: float = 1e-3) -> list[LinkResult]:
    """Judges `points` random touches of every link (those on the fixed base too: no joint feels them).

    Raises:
        InputError: `points` is not positive.
    """
    if points < 1:
        raise InputError(f"points: must be at least 1, not {points}")
    isolator = ContactIsolator(robot, torque_threshold=threshold)
    results = []
    for index, link in enumerate(robot.link_names):
        rng = np.random.default_rng([seed, index])
        judged = [judge(robot, isolator, touch, threshold) for touch in touches(robot, link, points, rng)]
        outcomes = Counter(outcome for outcome, _, _ in judged)
        if len(judged) < points:
            outcomes["out of reach"] = points - len(judged)
        errors = np.array([(p, f) for _, p, f in judged if not np.isnan(p)]).reshape(-1, 2)
        worst = errors.max(axis=0, initial=0.0)
        results.append(LinkResult(link, outcomes, float(worst[0]), float(worst[1])))
    return results


def as_data(results: list[LinkResult]) -> list[dict[str, object]]:
    """The results as plain data."""
    return [
        {
            "link": result.link,
            "outcomes": dict(result.outcomes),
            "point_error_m": result.point_error,
            "force_error_relative": result.force_error,
        }
        for result in results
    ]


def table(results: list[LinkResult]) -> Table:
    """The results as a table of counts, one column an outcome."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    total: Counter[str] = sum((result.outcomes for result in results), Counter())
    kinds = [kind for kind, _ in total.most_common()]
    sheet = Table(title="Single contacts, ideal measurements", box=SIMPLE_HEAD)
    sheet.add_column("link", min_width=max(len(result.link) for result in results))
    for column in (*kinds, "point error [m]", "force error"):
        sheet.add_column(column, justify="right")
    for result in results:
        counts = [str(result.outcomes[kind] or "") for kind in kinds]
        sheet.add_row(result.link, *counts, f"{result.point_error:.1e}", f"{result.force_error:.1e}")
    worst = [max(result.point_error for result in results), max(result.force_error for result in results)]
    sheet.add_section()
    sheet.add_row("all", *(str(total[kind]) for kind in kinds), *(f"{value:.1e}" for value in worst))
    return sheet
