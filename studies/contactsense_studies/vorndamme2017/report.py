"""The study as tables."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from rich.console import Console
from rich.table import Table

from ..harness import print_tables, scaled, sheet
from .data import series_figures
from .instruments import METHODS
from .isolation import THRESHOLD
from .noise import NONE
from .report_noise import noise_table
from .score import Score, by_deficit, score
from .study import Run, Study
from .timing import GOALS, PAPER
from .wording import NAMES, percent

BASELINE = "paper*"
SCORES = ("n", "exact", "1 cm", "25 cm", "candi-\ndate", "links", "loca-\nted", "false", "off\nm")
SERIES = ("n", "loca-\nted", "delay\nms", "at peak\nms", "correct\nby 2nd", "correct\nshare", "worst\nm")
SERIES_NOTE = (
    "(6), (10): torques and acceleration delayed accordingly; (6): the acceleration\n"
    "without delay; correct: within 1 um. Simulated: a floating robot in motion,\n"
    "with ContactMonitor; correct: within 1 cm."
)
TIMES = ("calls", "mean", "max", "plain\nmax", "goal:\nmean", "max", "paper:\nmean", "max")
TIMES_NOTE = "max: over scenes, of the fastest of three calls; plain max: of all\ncalls but the first"
SUMMARY = (
    *("deter-\nmined", "detected", "links\ncorrect"),
    *("isolated\n1 cm", "identified\n1 %", "falsely\nlocated"),
)
NOTES = (
    "Torques: of the joints; + 4: and the sensors of hands and feet; + 9: and all sensors.",
    "n: number of scenes; shares in %. Exact (1 nm), 1 cm, 25 cm: every contact has an",
    "estimate of its own within this distance: the point, or the first candidate if the",
    "point cannot be determined. Candidate: every contact has a candidate within 1 cm.",
    "Links: the estimated links are the contact links. Located: as many contacts are",
    "located as there are; false: a located point is more than 1 cm from every contact;",
    "off: the largest such distance. Rank deficit: of the true contacts, by NumPy.",
    "* The steps (28), (26), 4 of the paper in NumPy, with the true contact links given.",
)


def print_study(study: Study, console: Console) -> None:
    """All tables, and how to read them."""
    tables = [
        _scores("One contact", _by_method(study, "singles")),
        _scores("Two contacts, every pair of links", _by_rank(study, "pairs")),
        _scores("Two contacts, uniform by area", _by_rank(study, "pairs by area")),
        _scores("Five contacts: hands, feet, and torso or first shoulder link", _by_rank(study, "fives")),
        _scores(f"With {study.options.noise:.3g} relative noise, determined scenes", _untold(study)),
        noise_table(study),
        series_table(study),
        timing_table(study),
        summary_table(study),
    ]
    print_tables(console, tables, NOTES)


Row = tuple[tuple[str, str], Score]


def _by_method(study: Study, name: str) -> Iterable[Row]:
    for run in _runs(study, name):
        determined = [verdict for verdict in run.verdicts if verdict.rank_deficit == 0]
        unseen = [verdict for verdict in run.verdicts if verdict.rank_deficit > 0]
        yield (_label(run), "yes"), score(determined)
        if unseen:
            yield ("", "no"), score(unseen)


def _by_rank(study: Study, name: str) -> Iterable[Row]:
    for run in _runs(study, name):
        label = _label(run)
        groups = by_deficit(run.verdicts)
        for deficit, verdicts in groups.items():
            yield (label, f"{deficit}"), score(verdicts)
            label = ""
        if len(groups) > 1:
            yield ("", "over 0"), score([each for each in run.verdicts if each.rank_deficit])
            yield ("", "all"), score(run.verdicts)


def _untold(study: Study) -> Iterable[Row]:
    for run in study.runs:
        if run.setting.noise != NONE and run.setting.stated == "nothing":
            determined = [verdict for verdict in run.verdicts if verdict.rank_deficit == 0]
            label = f"{len(run.scenes[0].touches)}, {NAMES[run.setting.method]}"
            yield (label, f"{THRESHOLD:g}"), score(determined)


def _runs(study: Study, name: str) -> list[Run]:
    return [run for run in study.runs if run.name == name and run.setting.noise == NONE]


def _label(run: Run) -> str:
    return BASELINE if run.setting.solver == "pseudoinverse" else NAMES[run.setting.method]


def _scores(title: str, rows: Iterable[Row]) -> Table:
    second = {"One": "deter-\nmined", "Wit": "limit"}.get(title[:3], "rank\ndeficit")
    table = sheet(title, ("", second), SCORES)
    for number, (labels, figures) in enumerate(rows):
        if labels[0] and number:
            table.add_section()
        table.add_row(*labels, *_cells(figures))
    return table


def _cells(figures: Score) -> list[str]:
    points = (figures.exact, figures.near, figures.fair, figures.among_candidates)
    claims = (figures.links_right, figures.located, figures.wrong)
    worst = f"{figures.claim_error:.0e}" if figures.located or figures.wrong else "-"
    return [str(figures.scenes), *map(percent, (*points, *claims)), worst]


def series_table(study: Study) -> Table:
    """Hits over time."""
    table = sheet("An impact of 20 ms, observer gain 500/s, 1 kHz", ("impact", ""), SERIES, SERIES_NOTE)
    for hits in study.hits:
        kind = {"late": "(6), (10)", "prompt": "(6)", "simulated": "simulated"}[hits.kind]
        for number, method in enumerate(hits.series[0].signals):
            figures = series_figures(hits.series, method)
            table.add_row(
                "" if number else f"{kind}, {hits.amplitude:g} N",
                NAMES[method],
                f"{figures['hits']:.0f}",
                f"{figures['located']:.0f}",
                scaled(figures["delay"], 1e3, 1),
                scaled(figures["peak_delay"], 1e3, 1),
                percent(figures["right_from_second"]),
                percent(figures["right_share"]),
                f"{figures['point_error_max']:.0e}",
            )
    return table


def timing_table(study: Study) -> Table:
    """Time of a call."""
    table = sheet("Time of a call from Python, us", ("contacts", ""), TIMES, TIMES_NOTE)
    for timing in study.timings:
        key, none = (timing.contacts, timing.method), (np.nan, np.nan)
        others = (*GOALS.get(key, none), *PAPER.get(key, none))
        table.add_row(
            str(timing.contacts),
            NAMES[timing.method],
            str(timing.scenes),
            *(f"{1e6 * value:.1f}" for value in (timing.mean, timing.max, timing.plain_max)),
            *("" if np.isnan(value) else f"{1e6 * value:,.0f}" for value in others),
        )
    return table


def summary_table(study: Study) -> Table:
    """What can be told with which sensors, after Table II."""
    table = sheet("What each set of sensors determines, ideal measurements, %", ("", ""), SUMMARY)
    for method in METHODS:
        label = NAMES[method]
        for name in ("singles", "pairs", "fives"):
            try:
                figures = score(study.run(name, method).verdicts)
            except KeyError:
                continue
            determined = np.mean([each.rank_deficit == 0 for each in study.run(name, method).verdicts])
            shares = (figures.detected, figures.links_right, figures.near, figures.identified, figures.wrong)
            table.add_row(label, name, percent(float(determined)), *map(percent, shares))
            label = ""
        table.add_section()
    return table
