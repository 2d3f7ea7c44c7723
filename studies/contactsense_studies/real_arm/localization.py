"""Links, points and regions in figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..harness import mean, median
from .estimate import JudgedEstimate
from .judge import JudgedContact
from .reliability import Bin, calibration_error, calibration_error_by_chance, reliability

# A located point that is further off is wrong [m].
WRONG = 0.05
# Of the sizes of the regions.
QUANTILES = (0.1, 0.5, 0.9)


@dataclass(frozen=True)
class Localization:
    """Of some contacts, by one monitor: shares of the detected unless stated; NaN where there are none."""

    detected: int
    named: float  # share with a contact in a report
    exact: float  # share whose link is right
    within_one: float  # share whose link is right or next to the right one
    exact_by_area: float  # the same two if points were uniform by area over the arm
    within_one_by_area: float
    point: float  # share with a point
    error: float  # median of the points [m]
    error_90: float  # 90 % of the points are at least so close [m]
    located: float  # share
    located_wrong: float  # share of the located that are off by more than `WRONG`
    regions: int  # contacts with a point and a region
    coverage: float  # share of those whose region holds the true point
    region_radius: tuple[float, ...]  # `QUANTILES` of those [m]
    probabilities: int  # contacts with a probability of the named link
    calibration_error: float  # expected, of that probability
    calibration_error_by_chance: float  # what right probabilities would show with as few contacts
    calibration_error_all_links: float  # of the probabilities of all links, named or not
    several: float  # share with more than one contact in the report


def localization(contacts: Sequence[JudgedContact], monitor: str) -> Localization:
    """Figures of a monitor."""
    detected = [each for each in contacts if each.delays[monitor] is not None]
    found = estimates(contacts, monitor)
    errors = [each.error for each in found if not np.isnan(each.error)]
    located = [each for each in found if each.located]
    regions = [each for each in found if each.covered is not None]
    bins = reliability_of_links(contacts, monitor)

    def share(count: int) -> float:
        return count / len(detected) if detected else np.nan

    def by_area(most: int) -> float:
        weights = sum(each.weight_by_area for each in detected)
        right = [
            each.weight_by_area
            for each in detected
            if (told := each.estimates[monitor]) and told.steps <= most
        ]
        return sum(right) / weights if detected else np.nan

    return Localization(
        detected=len(detected),
        named=share(len(found)),
        exact=share(sum(each.steps == 0 for each in found)),
        within_one=share(sum(each.steps <= 1 for each in found)),
        exact_by_area=by_area(0),
        within_one_by_area=by_area(1),
        point=share(len(errors)),
        error=median(errors),
        error_90=float(np.quantile(errors, 0.9)) if errors else np.nan,
        located=share(len(located)),
        located_wrong=mean([each.error > WRONG for each in located]),
        regions=len(regions),
        coverage=mean([bool(each.covered) for each in regions]),
        region_radius=_quantiles([each.region_radius for each in regions]),
        probabilities=sum(each.count for each in bins),
        calibration_error=calibration_error(bins),
        calibration_error_by_chance=calibration_error_by_chance(bins),
        calibration_error_all_links=calibration_error(reliability(_all_links(contacts, monitor))),
        several=share(sum(each.contacts > 1 for each in found)),
    )


def _quantiles(radii: Sequence[float]) -> tuple[float, ...]:
    return tuple(np.quantile(radii, QUANTILES).tolist()) if radii else (np.nan,) * len(QUANTILES)


def estimates(contacts: Sequence[JudgedContact], monitor: str) -> list[JudgedEstimate]:
    """Those of the detected contacts that a report had a contact for."""
    found = [each.estimates[monitor] for each in contacts]
    return [each for each in found if each is not None]


def reliability_of_links(contacts: Sequence[JudgedContact], monitor: str) -> list[Bin]:
    """Of the probability of the named link."""
    found = [each for each in estimates(contacts, monitor) if each.link_probabilities]
    return reliability([(each.probability, each.steps == 0) for each in found])


def _all_links(contacts: Sequence[JudgedContact], monitor: str) -> list[tuple[float, bool]]:
    return [
        (probability, link == contact.link)
        for contact in contacts
        if (estimate := contact.estimates[monitor]) is not None
        for link, probability in estimate.link_probabilities.items()
    ]


def named_links(contacts: Sequence[JudgedContact], monitor: str) -> dict[str, dict[str, int]]:
    """By true link, how often each link was named for a detected contact, the most frequent first."""
    found: dict[str, Counter[str]] = {}
    for each in contacts:
        names = found.setdefault(each.link, Counter())
        if (estimate := each.estimates[monitor]) is not None:
            names[estimate.link] += 1
    return {link: dict(found[link].most_common()) for link in sorted(found)}
