"""The study as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from .score import errors_after, score
from .study import Study, wanted
from .touched import FORCES, LEAST_FORCE, NOISE, ON_THE_WAY, STIFFNESS
from .trial import AT_REST, CLOSE, WAYS


def as_data(study: Study) -> dict[str, Any]:
    """Everything for `print_json`, in SI units."""
    methods = wanted(study.options)
    cases = [(link, each.name, way) for link in study.links for each in methods for way in WAYS]
    return {
        "study": "next_motion",
        "complete": study.complete,
        "options": asdict(study.options),
        "settings": {
            "close": CLOSE,
            "forces": FORCES,
            "stiffness": STIFFNESS,
            "least_force": LEAST_FORCE,
            "noise": NOISE,
            "on_the_way": ON_THE_WAY,
            "at_rest": AT_REST,
            "every": {each.name: each.every for each in methods},
        },
        "scores": [
            {
                "link": link,
                "method": method,
                "way": way,
                **asdict(score(found)),
                "errors": errors_after(found, study.options.motions),
            }
            for link, method, way in cases
            if (found := study.outcomes(link, method, way))
        ],
        "trials": [
            {
                "link": trial.link,
                "number": trial.number,
                "method": method,
                "way": way,
                "motions": each.motions,
                **asdict(each),
            }
            for trial in study.trials
            for (method, way), each in trial.outcomes.items()
        ],
    }
