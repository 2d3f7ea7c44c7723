"""Single contacts, ideal measurements: what the torques determine, how exactly (Vorndamme 2017, VI-B)."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from rich.table import Table

from contactsense import ContactIsolator, Robot
from contactsense.sim.sampling import Touch, touches

from .harness import check_counts, sheet
from .vorndamme2017.information import rank_deficit

TOLERANCE = 1e-9  # [m], and relative for the force
ENTERS_TWICE = "exact, line enters twice"
UNCERTAIN = "exact, uncertain"
UNCERTAIN_STD = 0.03  # [m]; with 90 % within 0.05 m, the default of `locate_within`


@dataclass(frozen=True)
class LinkResult:
    """Counts of one link's contacts by outcome, and the worst errors of those located."""

    link: str
    outcomes: Counter[str]
    point_error: float  # [m]
    force_error: float  # relative


def judge(
    robot: Robot, isolator: ContactIsolator, touch: Touch, threshold: float
) -> tuple[str, float, float]:
    """Outcome of one touch, and the errors of point [m] and force (relative; NaN where not located).

    "located"; "exact, line enters twice": the point is exact but not located, since the line of action
    enters the robot's surface elsewhere, too, and a push there causes the same torques; "exact, uncertain":
    the same, since noise as large as the thresholds say could move the point by centimetres; "not felt" by
    any joint; the link alone is right, or another is named, because the wrench has "rank < 6" or the "own
    joint" of the touched link is "silent" (under its threshold). "WRONG": reported as
    located, but is not within the tolerance; "MISSED": determined, but not located.
    """
    jacobian = robot.jacobian(touch.q, touch.link, touch.point)
    tau_ext = jacobian[:3].T @ touch.force
    columns = np.flatnonzero(np.any(jacobian != 0.0, axis=0))
    determined = rank_deficit(robot, touch.q, [touch.link]) == 0
    own_joint_feels = columns.size > 0 and abs(tau_ext[columns[-1]]) > threshold
    contacts = isolator.isolate(touch.q, tau_ext).contacts
    if not contacts:
        return ("not felt", np.nan, np.nan)
    contact = contacts[0]
    point_error = float(np.linalg.norm(contact.point - touch.point))
    force_error = float(np.linalg.norm(contact.force - touch.force) / np.linalg.norm(touch.force))
    exact = point_error <= TOLERANCE and force_error <= TOLERANCE and contact.link == touch.link
    if contact.located:
        return ("located" if exact else "WRONG", point_error, force_error)
    if exact and sum(candidate.pushing for candidate in contact.candidates) > 1:
        return (ENTERS_TWICE, point_error, force_error)
    if exact and contact.point_std > UNCERTAIN_STD:
        return (UNCERTAIN, point_error, force_error)
    if determined and own_joint_feels:
        return ("MISSED", np.nan, np.nan)
    named = "link only" if contact.link == touch.link else "other link"
    return (f"{named}, {'rank < 6' if own_joint_feels else 'own joint silent'}", np.nan, np.nan)


def run(robot: Robot, points: int = 100, seed: int = 0, threshold: float = 1e-3) -> list[LinkResult]:
    """Judges `points` random touches of every link (those on the fixed base too: no joint feels them).

    Raises:
        InputError: `points` is not positive, or `seed` is negative.
    """
    check_counts(seed, points=points)
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


def in_words(outcome: str) -> str:
    """An outcome as tables state it."""
    words = outcome.replace("not felt", "not detected")
    return words.replace("own joint silent", "own joint below threshold")


def table(results: list[LinkResult]) -> Table:
    """The results as a table of counts, one column an outcome."""
    total: Counter[str] = sum((result.outcomes for result in results), Counter())
    kinds = [kind for kind, _ in total.most_common()]
    figures = (*map(in_words, kinds), "point error [m]", "force error")
    counted = sheet("Single contacts, ideal measurements", ("link",), figures)
    for result in results:
        counts = [str(result.outcomes[kind] or "") for kind in kinds]
        counted.add_row(result.link, *counts, f"{result.point_error:.1e}", f"{result.force_error:.1e}")
    worst = [max(result.point_error for result in results), max(result.force_error for result in results)]
    counted.add_section()
    counted.add_row("all", *(str(total[kind]) for kind in kinds), *(f"{value:.1e}" for value in worst))
    return counted
