"""The study as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from .experiments import Experiment, Filter
from .score import score
from .study import Study


def as_data(study: Study) -> dict[str, Any]:
    """Everything for `print_json`, in SI units."""
    return {
        "study": "bimbo2019",
        "complete": study.complete,
        "options": asdict(study.options),
        "links": study.links,
        "experiments": [_experiment(study, experiment) for experiment in study.options.chosen()],
    }


def _experiment(study: Study, experiment: Experiment) -> dict[str, Any]:
    about = asdict(experiment)
    about["filters"] = [_filter(study, experiment, kind) for kind in experiment.filters]
    return about


def _filter(study: Study, experiment: Experiment, kind: Filter) -> dict[str, Any]:
    return {
        **asdict(kind),
        "links": {link: asdict(score(study.outcomes(experiment, kind, link))) for link in study.links},
        "all": asdict(score(study.outcomes(experiment, kind))),
        "trials": [asdict(outcome) for outcome in study.outcomes(experiment, kind)],
    }
