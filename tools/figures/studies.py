"""Figures of the short studies."""

from __future__ import annotations

from collections import Counter
from typing import Any

from contactsense_studies.single_contacts import in_words

from .entry import Raw
from .markdown import percent, table

SOURCES = {
    "measured": "the observer, from measured torques",
    "vendor": "the manufacturer's estimate",
    "calibrated": "the manufacturer's estimate, calibrated",
}


def franka_touch(raw: Raw) -> dict[str, Any]:
    """All sources of the external torque: the logs held out, and all."""
    (study,) = raw[""]
    return {
        source: {part: study[source][part] for part in ("settings", "held_out", "overall")}
        for source in SOURCES
    }


def franka_touch_table(result: Any) -> str:
    """One row a source."""
    header = (
        *("External torque from", "Detected", "False alarms", "Onset delay, median / maximum"),
        *("Correct link", "Correct link or a neighbour"),
    )
    rows = []
    for source, name in SOURCES.items():
        figures = result[source]["held_out"]
        rows.append(
            [
                name,
                f"{figures['detected']} / {figures['touches']}",
                str(figures["false_alarms"]),
                f"{1e3 * figures['delay_median']:.0f} / {1e3 * figures['delay_max']:.0f} ms",
                percent(figures["exact"]),
                percent(figures["within_one"]),
            ]
        )
    return table(header, rows)


def franka_replay(raw: Raw) -> list[dict[str, Any]]:
    """Each log with the calibration of the others."""
    (study,) = raw[""]
    kept = ("touches", "detected", "false_alarms", "delay_median", "delay_max", "exact")
    return [
        {"name": file["name"], "link": file["link"], **{name: file["summary"][name] for name in kept}}
        for file in study["calibrated"]["files"]
    ]


def franka_replay_table(result: Any) -> str:
    """One row a log."""
    header = (
        *("Log", "Link", "Contacts by hand", "Detected", "False alarms"),
        *("Onset delay, median / maximum", "Correct link"),
    )
    rows = [
        [
            *(log["name"], str(log["link"]), str(log["touches"]), str(log["detected"])),
            str(log["false_alarms"]),
            f"{1e3 * log['delay_median']:.0f} / {1e3 * log['delay_max']:.0f} ms",
            f"{round(log['exact'] * log['touches'])} / {log['touches']}",
        ]
        for log in result
    ]
    return table(header, rows)


def single_contacts(raw: Raw) -> dict[str, Any]:
    """Counts of every outcome, and the worst errors of the exact points, by robot."""
    result = {}
    for robot, (links,) in raw.items():
        outcomes: Counter[str] = sum((Counter(link["outcomes"]) for link in links), Counter())
        result[robot] = {
            "links": len(links),
            "outcomes": dict(outcomes.most_common()),
            "point_error_m": max(link["point_error_m"] for link in links),
            "force_error_relative": max(link["force_error_relative"] for link in links),
            "of_each_link": {link["link"]: link["outcomes"] for link in links},
        }
    return result


def single_contacts_table(result: Any) -> str:
    """One row a robot and outcome."""
    rows = []
    for robot, figures in result.items():
        worst = f"{figures['point_error_m']:.0e} m"
        for outcome, count in figures["outcomes"].items():
            exact = outcome == "located" or outcome.startswith("exact")
            rows.append([robot, in_words(outcome), str(count), worst if exact else ""])
    return table(("robot", "outcome", "contacts", "worst error of the points"), rows)


def noisy_isolation(raw: Raw) -> Any:
    """The counts as they are."""
    return raw[""][0]


def noisy_isolation_table(result: Any) -> str:
    """One row a robot."""
    header = ("robot", "located, line is free", "of these wrong", "located, any line", "of these wrong")
    rows = []
    for robot, kinds in result.items():
        cells: list[str] = []
        for kind in ("free", "any"):
            figures = kinds.get(kind)
            shown = (
                ("", "")
                if figures is None
                else (percent(figures["located"] / figures["pushes"]), str(figures["wrong"]))
            )
            cells += shown
        rows.append([robot, *cells])
    return table(header, rows)
