"""The study as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from .score import NEAR, links
from .study import Study


def as_data(study: Study) -> dict[str, Any]:
    """Everything for `print_json`, in SI units."""
    return {
        "study": "identifiability",
        "complete": study.complete,
        "options": asdict(study.options),
        "settings": {"near": NEAR},
        "robots": {
            name: {
                "poses": len(study.of(name)),
                "links": [asdict(score) for score in links(study.of(name))],
            }
            for name in study.robots
        },
    }
