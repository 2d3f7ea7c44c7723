"""Figures of the studies that take long."""

from __future__ import annotations

import math
from typing import Any

from .entry import Raw
from .markdown import table

# Rows of the table: experiment, filter, and what the row is called.
BIMBO_ROWS = (
    ("random", "curvature", "random, curvature"),
    ("random", "on link", "on link"),
    ("random", "in world", "in world"),
    ("random", "printed", "printed"),
    ("random", "10 % noise", "random, 10 % noise"),
    ("deliberate", "curvature", "deliberate, curvature"),
    ("deliberate", "10 % noise", "deliberate, 10 % noise"),
    ("cube", "curvature", "cube"),
    ("smooth pole", "curvature", "smooth pole"),
    ("pole", "curvature", "pole, curvature"),
    ("pole", "friction cone", "pole, friction cone"),
)


def bimbo2019(raw: Raw) -> dict[str, Any]:
    """The scores of every experiment, filter and link."""
    (study,) = raw[""]
    return {
        each["name"]: {one["name"]: one["links"] for one in each["filters"]} for each in study["experiments"]
    }


def bimbo2019_table(result: Any) -> str:
    """A row an experiment and filter, a column a link."""
    links = list(next(iter(next(iter(result.values())).values())))
    header = ("", *(f"link {name[-1]}" if not number else name[-1] for number, name in enumerate(links)))
    rows = [
        [label, *(errors(result[experiment][kind][link]) for link in links)]
        for experiment, kind, label in BIMBO_ROWS
    ]
    return table(header, rows)


def errors(score: Any) -> str:
    """Mean and median error in cm, and the share of right links where it is not all."""
    errors = f"{_centimetres(score['mean'])}/{_centimetres(score['median'])}"
    right = score["right_link"]
    return errors if right in (1.0, None) else f"{errors} {100 * right:.0f} %"


def _centimetres(length: float | None) -> str:
    if length is None:
        return "-"
    return f"{100 * length:.0f}" if 100 * length >= 9.95 else f"{100 * length:.1f}"


def vorndamme2017(raw: Raw) -> dict[str, Any]:
    """The scores behind the table: with torques, with nine sensors too, and of the paper's steps."""
    (study,) = raw[""]
    columns = (("torques", "contactsense"), ("both", "contactsense"), ("torques", "pseudoinverse"))
    kept: dict[str, Any] = {}
    for run in study["runs"]:
        # With noise, those whose thresholds are left as they are.
        if (run["method"], run["solver"]) in columns and run["stated"] == "nothing":
            column = "paper" if run["solver"] == "pseudoinverse" else run["method"]
            scores = {key: run[key] for key in ("all", "by_rank_deficit", "rank_deficient")}
            noisy = " with noise" if any(run["noise"].values()) else ""
            kept.setdefault(run["scenes"] + noisy, {})[column] = scores
    strongest = max(hit["amplitude"] for hit in study["hits"])
    delays = {
        hit["method"]: hit["peak_delay"]
        for hit in study["hits"]
        if hit["kind"] == "prompt" and hit["amplitude"] == strongest
    }
    return {"runs": kept, "peak_delay": delays, "timings": study["timings"]}


def vorndamme2017_table(result: Any) -> str:
    """One row a kind of scene."""
    runs, delays = result["runs"], result["peak_delay"]

    def row(label: str, scenes: str, part: str, figure: str, deficit: str = "") -> list[str]:
        cells = [label]
        for column in ("torques", "both", "paper"):
            score = runs[scenes].get(column, {}).get(part)
            score = score.get(deficit) if score and deficit else score
            cells.append("" if score is None else _cell(score, figure))
        return cells

    claims = ["located contacts that are wrong by more than 1 cm, of all pairs"]
    for column in ("torques", "both", "paper"):
        scores = [runs[scenes][column]["all"] for scenes in ("pairs", "pairs by area")]
        wrong = sum(round(score["wrong"] * score["scenes"]) for score in scores)
        claims.append(f"{wrong} / {sum(score['scenes'] for score in scores)}")
    rows = [
        row("one contact, exact (1 nm)", "singles", "all", "exact"),
        row("two contacts, determined (rank deficit 0), exact", "pairs", "by_rank_deficit", "exact", "0"),
        row("two contacts, deficit 1: within 1 cm", "pairs", "by_rank_deficit", "near", "1"),
        row("deficit 2: within 1 cm", "pairs", "by_rank_deficit", "near", "2"),
        row("deficit 2: a candidate within 1 cm", "pairs", "by_rank_deficit", "among_candidates", "2"),
        row("deficits 1 to 5: within 25 cm", "pairs", "rank_deficient", "fair"),
        row("the same, uniform by area: within 25 cm", "pairs by area", "rank_deficient", "fair"),
        claims,
        row("five contacts, exact", "fives", "all", "exact"),
        row("one contact, 1 % noise: links correct", "singles with noise", "all", "links_right"),
        row(
            "two contacts, deficit 0, 1 % noise: links correct",
            "pairs with noise",
            *("by_rank_deficit", "links_right", "0"),
        ),
        [
            "force of an impact: delay of the peak (acceleration without delay)",
            *(f"{1e3 * delays[key]:.1f} ms" for key in ("torques", "both")),
            "",
        ],
    ]
    return table(("", "Torques", "and nine sensors", "Steps of the paper, with the true links"), rows)


def _cell(score: Any, figure: str) -> str:
    """Exact ones are counted; other shares are in percent, and only all is 100."""
    if figure == "exact":
        return f"{round(score['exact'] * score['scenes'])} / {score['scenes']}"
    share = 100 * score[figure]
    return "100 %" if share == 100 else f"{min(share, 99.9):.1f} %"


def vorndamme2017_time_table(result: Any) -> str:
    """Mean and greatest time of a call [us]."""
    times = {(one["contacts"], one["method"]): one for one in result["timings"]}
    rows = [
        [
            word,
            *(
                " / ".join(f"{1e6 * times[contacts, method][key]:.0f}" for key in ("mean", "max"))
                for method in ("torques", "both")
            ),
        ]
        for contacts, word in ((1, "one contact"), (2, "two"), (5, "five"))
    ]
    return table(("us per call, mean / max", "Torques", "and nine sensors"), rows)


def speed(raw: Raw) -> Any:
    """The comparisons as the benches give them."""
    return raw[""][0]


# Of the comparisons, those that README shows, by what their names begin with and hold, and the name there.
SPEED_ROWS = (
    ("observer, iiwa14", "", "observer, iiwa14, 7 joints"),
    ("observer, talos", "", "observer, Talos, floating, nv 38"),
    ("compensation, talos", "", "load compensation, Talos, 4 sensors"),
    ("monitor, iiwa14, no contact", "", "monitor, iiwa14, no contact"),
    ("monitor, iiwa14", ", median of ", "monitor, iiwa14, one contact, ideal torques"),
    ("monitor, atlas, no contact", "", "monitor, Atlas, floating, no contact"),
    ("monitor, atlas", ", median of ", "monitor, Atlas, one contact, ideal torques"),
    ("noisy tick, xarm7, one contact", "", "monitor, xarm7, one contact, noisy torques (*)"),
    ("noisy tick, talos, one contact", "", "monitor, Talos, one contact, noisy torques (*)"),
    ("contact map, iiwa14", "one contact", "contact map, iiwa14, 5,000 samples, noisy torques"),
    ("contact map, atlas", "one contact", "contact map, Atlas, 5,000 samples, noisy torques"),
    ("closest point, icosphere", "", "closest point, 5,120 triangles, per query of 10,000"),
    ("all hits of a ray, icosphere", "", "all intersections of a ray, 5,120 triangles, per ray of 10,000"),
)


def speed_table(result: Any) -> str:
    """One row a task of `SPEED_ROWS`: ours, the peers, and how many times as long they take."""
    rows = []
    for comparison in result["comparisons"]:
        task = comparison["task"]
        names = [name for begin, part, name in SPEED_ROWS if task.startswith(begin) and part in task]
        if not names:
            continue
        ours, *others = comparison["timings"]
        peers = [timing for timing in others if not timing["name"].startswith("contactsense")]
        shown = _time(ours["median_us"])
        if ours["tail_us"] is not None:
            shown += ", 99.9 % in {}, max {}".format(*map(_time, ours["tail_us"]))
        rows.append(
            [
                names[0],
                shown,
                "; ".join(f"{timing['name']}: {_time(timing['median_us'])}" for timing in peers),
                "; ".join(f"{timing['ratio']:.{1 if timing['ratio'] < 5 else 0}f}" for timing in peers),
            ]
        )
    return table(("Task", "contactsense", "Other library", "Ratio"), rows)


def _time(microseconds: float) -> str:
    """Two significant digits."""
    unit, value = ("ms", microseconds / 1e3) if microseconds >= 1e3 else ("us", microseconds)
    digits = max(0, 1 - math.floor(math.log10(value)))
    return f"{value:.{digits}f} {unit}"
