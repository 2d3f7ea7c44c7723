"""The study as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from ..bimbo2019.score import score
from .methods import METHODS, NEAR, PROBABLE
from .study import EXPERIMENT, Study


def as_data(study: Study) -> dict[str, Any]:
    """Everything for `print_json`, in SI units."""
    cases = [
        (link, each.name, noise)
        for link in study.links
        for each in METHODS
        for noise in study.options.noises()
    ]
    return {
        "study": "memory",
        "complete": study.complete,
        "options": asdict(study.options),
        "settings": {
            "experiment": EXPERIMENT,
            "every": {each.name: each.every for each in METHODS},
            "probable": PROBABLE,
            "near": NEAR,
        },
        "scores": [
            {
                "link": link,
                "method": method,
                "noise": noise,
                **asdict(score([each.outcome for each in found])),
                "near": sum(each.near for each in found) / len(found),
            }
            for link, method, noise in cases
            if (found := study.found(method, noise, link))
        ],
        "trials": [
            {"link": trial.link, "number": trial.number, "method": method, "noise": noise, **asdict(each)}
            for trial in study.trials
            for (method, noise), each in trial.found.items()
        ],
    }
