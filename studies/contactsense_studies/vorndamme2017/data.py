"""The study as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from ..harness import mean
from .instruments import Method
from .noisy_score import noisy_score
from .score import by_deficit, score
from .study import Run, Study
from .time_series import Series


def as_data(study: Study) -> dict[str, Any]:
    """Everything for `print_json`, in SI units but for the cone [deg]."""
    return {
        "study": "vorndamme2017",
        "complete": study.complete,
        "options": asdict(study.options),
        "runs": [_run_data(run) for run in study.runs],
        "hits": [
            {
                "amplitude": hits.amplitude,
                "kind": hits.kind,
                "method": method,
                **series_figures(hits.series, method),
            }
            for hits in study.hits
            for method in hits.series[0].signals
        ],
        "timings": [asdict(timing) for timing in study.timings],
    }


def _run_data(run: Run) -> dict[str, Any]:
    groups = by_deficit(run.verdicts)
    open_ones = [verdict for deficit, group in groups.items() if deficit for verdict in group]
    return {
        "scenes": run.name,
        **asdict(run.setting),
        "all": asdict(score(run.verdicts)),
        "by_rank_deficit": {str(deficit): asdict(score(group)) for deficit, group in groups.items()},
        "rank_deficient": asdict(score(open_ones)) if open_ones else None,
        **(_noisy_data(run) if run.setting.stated != "nothing" else {}),
    }


def _noisy_data(run: Run) -> dict[str, Any]:
    determined = [verdict for verdict in run.verdicts if verdict.rank_deficit == 0]
    return {
        "determined_claims": asdict(noisy_score(determined)),
        "all_claims": asdict(noisy_score(run.verdicts)),
    }


def series_figures(series: Sequence[Series], method: Method) -> dict[str, float]:
    """Figures of many hits with one method, of those that it locates at all."""
    felt = [hit for hit in series if np.isfinite(hit.delay(method))]
    firsts = [hit.first_right(method) for hit in felt]
    return {
        "hits": len(series),
        "located": len(felt),
        "delay": mean([hit.delay(method) for hit in felt]),
        "peak_delay": mean([hit.peak_delay(method) for hit in felt]),
        "peak_delay_max": max((hit.peak_delay(method) for hit in felt), default=np.nan),
        "right_from_second": mean([first is not None and first <= 2 for first in firsts]),
        "right_share": mean([hit.right_share(method) for hit in felt]),
        "point_error_max": max((hit.point_error(method) for hit in felt), default=np.nan),
    }
