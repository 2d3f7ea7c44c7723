"""The study as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from .arms import ARMS
from .judge import JudgedContact
from .localization import QUANTILES, WRONG, localization, named_links, reliability_of_links
from .monitors import MARGIN, MONITORS, REACTION, TITLES
from .records import DT, DURATION, FORCE, FRICTION, REST, SPEED
from .score import BANDS, IN_TORQUES, contacts_of, detection, false_onsets, in_band, links_of, rms
from .study import Study, Trial


def as_data(study: Study) -> dict[str, Any]:
    """Everything for `print_json`, in SI units."""
    return {
        "study": "real_arm",
        "complete": study.complete,
        "options": asdict(study.options),
        "settings": {
            "dt": DT,
            "force": FORCE,
            "duration": DURATION,
            "friction": FRICTION,
            "speed": SPEED,
            "rest": REST,
            "threshold_margin": MARGIN,
            "in_torques": IN_TORQUES,
            "reaction": REACTION,
            "wrong": WRONG,
            "region_quantiles": QUANTILES,
        },
        "monitors": TITLES,
        "skipped": study.skipped,
        "arms": {name: _arm(name, study.of(name)) for name in study.arms},
        "all": _figures(study.trials),
    }


def _arm(name: str, trials: Sequence[Trial]) -> dict[str, Any]:
    contacts = contacts_of(trials)
    return {
        "about": ARMS[name].about,
        **_figures(trials),
        "links": {
            link: _detection([each for each in contacts if each.link == link]) for link in links_of(contacts)
        },
        "named_links": {each: named_links(contacts, each) for each in MONITORS},
        "external_torque_rms": {each: rms(trials, each) for each in MONITORS} if trials else {},
        "trials": [_trial(trial) for trial in trials],
    }


def _figures(trials: Sequence[Trial]) -> dict[str, Any]:
    contacts = contacts_of(trials)
    return {
        "contacts": _detection(contacts),
        "false_onsets": {each: asdict(false_onsets(trials, each)) for each in MONITORS},
        "forces": {
            f"{low:g} to {high:g} N": _detection(in_band(contacts, (low, high))) for low, high in BANDS
        },
        "localization": _localization(contacts),
        "localization_by_force": {
            f"{low:g} to {high:g} N": _localization(in_band(contacts, (low, high))) for low, high in BANDS
        },
        "reliability": {
            each: [asdict(found) for found in reliability_of_links(contacts, each)] for each in MONITORS
        },
    }


def _detection(contacts: Sequence[JudgedContact]) -> dict[str, Any]:
    return {each: asdict(detection(contacts, each)) for each in MONITORS}


def _localization(contacts: Sequence[JudgedContact]) -> dict[str, Any]:
    return {each: asdict(localization(contacts, each)) for each in MONITORS}


def _trial(trial: Trial) -> dict[str, Any]:
    return {
        "errors": asdict(trial.errors),
        "thresholds": trial.thresholds,
        "free": {each: asdict(free) for each, free in trial.free.items()},
        "contacts": [asdict(contact) for contact in trial.contacts],
    }
