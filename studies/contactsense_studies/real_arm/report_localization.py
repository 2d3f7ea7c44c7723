"""Where contacts are, as tables."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rich.table import Table

from ..harness import scaled, sheet
from .localization import WRONG, Localization, localization, named_links
from .monitors import MONITORS, REACTION
from .reliability import BINS
from .score import contacts_of
from .study import Trial

# A table of links names this one's.
SHOWN = "calibrated"
NOTES = (
    f"Links, points, regions: from the last report with a contact, at most {REACTION:g} s after the onset",
    "and before the contact ends; of several contacts in it, the first. Shares are of the detected contacts;",
    "those without a contact in any report count as neither named, located nor right.",
    "within 1: the link or a neighbour along the arm. ECE: expected calibration error of the probability",
    f"of the named link, {BINS} bins; by chance: what right probabilities would show with as few contacts;",
    "all links: of the probability of every link. by area: every contact counts by the area of its link,",
    "as if points were uniform by area over the arm, and not on every link equally often.",
    f"error: of the points, median and 90 %. wrong: of the located, off by more than {100 * WRONG:g} cm.",
    "radius: of the region that shall hold 90 % of the posterior, median and 90 %. coverage: it holds the",
    "true point.",
)

Group = tuple[str, list[Trial]]


def localization_tables(groups: Sequence[Group], letters: dict[str, str]) -> list[Table]:
    """Of each group of trials: links with their probabilities, points with their regions."""
    return [
        _table("Links of the detected contacts", _LINKS, groups, letters, _links),
        _table("Points of the detected contacts", _POINTS, groups, letters, _points),
    ]


def _table(
    title: str,
    headers: tuple[str, ...],
    groups: Sequence[Group],
    letters: dict[str, str],
    cells: Callable[[Localization], Sequence[str]],
) -> Table:
    table = sheet(title, ("", ""), headers)
    for name, trials in groups:
        table.add_section()
        contacts = contacts_of(trials)
        for each in MONITORS:
            row = cells(localization(contacts, each))
            table.add_row(name if each == MONITORS[0] else "", letters[each], *row)
    return table


_LINKS = (
    *("\ndetected", "named\n%", "exact\n%", "within 1\n%", "exact,\nby area", "within 1,\nby area"),
    *("\nECE", "by\nchance", "all\nlinks"),
)


def _links(figures: Localization) -> list[str]:
    return [
        str(figures.detected),
        *(scaled(share, 100) for share in (figures.named, figures.exact, figures.within_one)),
        *(scaled(share, 100) for share in (figures.exact_by_area, figures.within_one_by_area)),
        scaled(figures.calibration_error, 1, 3),
        scaled(figures.calibration_error_by_chance, 1, 3),
        scaled(figures.calibration_error_all_links, 1, 3),
    ]


_POINTS = (
    *("point\n%", "error\ncm", "90 %\ncm", "located\n%", "wrong\n%"),
    *("coverage\n%", "radius\ncm", "90 %\ncm"),
)


def _points(figures: Localization) -> list[str]:
    return [
        scaled(figures.point, 100),
        *(scaled(error, 100, 1) for error in (figures.error, figures.error_90)),
        *(scaled(share, 100) for share in (figures.located, figures.located_wrong, figures.coverage)),
        *(scaled(radius, 100, 1) for radius in figures.region_radius[1:]),
    ]


def named_links_table(name: str, trials: Sequence[Trial]) -> Table:
    """Which links were named for contacts on each."""
    contacts = contacts_of(trials)
    title = f"Links named by the calibrated monitor: {name}"
    table = sheet(title, ("link", "detected", "named, how often"), ())
    table.columns[1].justify, table.columns[2].no_wrap = "right", False
    for link, names in named_links(contacts, SHOWN).items():
        here = [each for each in contacts if each.link == link]
        told = ", ".join(f"{found} {count}" for found, count in names.items())
        table.add_row(link, str(localization(here, SHOWN).detected), told or "-")
    return table
