"""Results of the commands as Markdown."""

from __future__ import annotations

from collections import Counter
from typing import Any

Run = dict[str, Any]

# Outcomes of the study in the words of the README.
OUTCOMES = {
    "exact, line enters twice": "exact, but the line of action enters the surface twice",
    "link only, rank < 6": "link only",
    "not felt": "not detected",
    "other link, own joint silent": "another link",
}


def table(header: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A Markdown table."""
    lines = [header, ("---",) * len(header), *rows]
    return "\n".join(
        f"| {' | '.join(cells)} |" if cells[0] != "---" else "|---" * len(cells) + "|" for cells in lines
    )


def franka_touch(runs: list[Run]) -> str:
    """One row for each source of the external torque."""
    (run,) = runs
    rows = []
    for key, source in (
        ("measured", "the observer, on measured torques"),
        ("vendor", "the vendor's estimate"),
    ):
        pooled = run["result"][key]["held_out"]
        rows.append(
            (
                source,
                f"{pooled['detected']} / {pooled['touches']}",
                str(pooled["false_alarms"]),
                f"{1e3 * pooled['delay_median']:.0f} / {1e3 * pooled['delay_max']:.0f} ms",
                f"{pooled['exact']:.0%}".replace("%", " %"),
                f"{pooled['within_one']:.0%}".replace("%", " %"),
            )
        )
    header = ("External torque from", "detected", "false alarms", "onset, median / maximum", "correct link")
    return table((*header, "correct or adjacent link"), rows)


def single_contacts(runs: list[Run]) -> str:
    """One row for each robot, then one line on the outcomes of the others."""
    rows = []
    for run in runs:
        outcomes: Counter[str] = Counter()
        for link in run["result"]:
            outcomes.update(link["outcomes"])
        others = ", ".join(
            f"{OUTCOMES.get(kind, kind)}: {n}" for kind, n in outcomes.most_common() if kind != "located"
        )
        worst = max(link["point_error_m"] for link in run["result"])
        robot = "iiwa14" if "iiwa14" in run["command"] else "Atlas"
        rows.append((robot, str(outcomes.total()), str(outcomes["located"]), others, f"{worst:.0e} m"))
    return table(("Robot", "contacts", "located", "other outcomes", "greatest point error"), rows)


def demo(runs: list[Run]) -> str:
    """One row without noise and one with noise."""
    groups: dict[str, list[Run]] = {}
    for run in runs:
        groups.setdefault("with noise" if "--noise" in run["command"] else "without noise", []).append(run)
    rows = []
    for name, group in groups.items():
        pushes = [push for run in group for push in run["result"]["hits"]]
        found = [push for push in pushes if push["delay_ms"] is not None]
        located = [push for push in found if push["located"]]
        delays = [push["delay_ms"] for push in found]
        rows.append(
            (
                f"{name}, seeds {min(run['seed'] for run in group)} to {max(run['seed'] for run in group)}",
                f"{len(found)} / {len(pushes)}",
                f"{min(delays):.1f} to {max(delays):.1f} ms",
                str(sum(run["result"]["summary"]["false_alarms"] for run in group)),
                str(sum(push["link_right"] for push in found)),
                str(len(located)),
                f"{max(push['point_error_mm'] for push in located):.1f} mm",
            )
        )
    header = (
        "",
        "detected",
        "delay",
        "false alarms",
        "correct link",
        "located",
        "greatest error of a located point",
    )
    return table(header, rows)
