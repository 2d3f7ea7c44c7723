"""The study as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from .arms import FITTED
from .judge import KINDS, VERDICT
from .score import score
from .study import Study


def as_data(study: Study) -> dict[str, Any]:
    """Everything for `print_json`, in SI units."""
    return {
        "study": "contact_classes",
        "complete": study.complete,
        "options": asdict(study.options),
        "settings": {"verdict": VERDICT, "kinds": KINDS, "fitted_on": FITTED},
        "skipped": study.skipped,
        "arms": {name: asdict(score(study.of(name))) for name in study.arms},
        "all": asdict(score(study.judged)),
        "contacts": [asdict(each) for each in study.judged],
    }
