"""The study as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from .judge import CLOSE, NEAR, PROBABLE, SPREADS, WRONG, score
from .study import Study


def as_data(study: Study) -> dict[str, Any]:
    """Everything for `print_json`, in SI units."""
    return {
        "study": "several_contacts",
        "complete": study.complete,
        "options": asdict(study.options),
        "settings": {"close": CLOSE, "wrong": WRONG, "probable": PROBABLE, "near": NEAR, "spreads": SPREADS},
        "scores": [
            {"contacts": contacts, **asdict(score(judged))}
            for contacts in study.options.contacts
            if (judged := study.judged(contacts))
        ],
        "trials": [
            {"contacts": trial.contacts, "number": trial.number, **asdict(trial.judged)}
            for trial in study.trials
            if trial.judged
        ],
    }
