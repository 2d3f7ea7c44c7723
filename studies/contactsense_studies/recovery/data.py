"""The study as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from .score import table
from .study import DT, SECONDS, Study


def as_data(study: Study) -> dict[str, Any]:
    """Everything for `print_json`, in SI units."""
    return {
        "study": "recovery",
        "complete": study.complete,
        "options": asdict(study.options),
        "settings": {"seconds": SECONDS, "dt": DT},
        "skipped": study.skipped,
        "scores": [
            {"robot": robot, "kind": kind, "runs": len(runs), **table(runs)}
            for (robot, kind), runs in study.found.items()
        ],
        "arms": [
            {"robot": robot, "kind": kind, **asdict(each)}
            for (robot, kind), runs in study.found.items()
            for each in runs
        ],
    }
