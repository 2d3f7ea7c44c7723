"""The study as tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.table import Table

from contactsense.sim import ImperfectArm

from ..harness import print_tables, scaled, sheet
from .arms import ARMS, described
from .judge import JudgedContact
from .monitors import MARGIN, MONITORS, TITLES
from .records import FORCE
from .report_localization import NOTES as LOCALIZATION_NOTES
from .report_localization import localization_tables, named_links_table
from .score import (
    BANDS,
    IN_TORQUES,
    contacts_of,
    detection,
    false_onsets,
    in_band,
    links_of,
    rms,
)
from .study import Study, Trial

LETTERS = {"default": "A", "thresholds": "B", "calibrated": "C"}
NOTES = (
    *(f"{LETTERS[name]}: {TITLES[name]}." for name in MONITORS),
    *(f"{name}: {kind.about}." for name, kind in ARMS.items()),
    f"Thresholds of this arm: {MARGIN:g} times the largest external torque of other free motion.",
    "detected: an onset while the contact lasts. chance: share of the contacts that would count as",
    "detected if they were not there. delay: from the start of the force, which takes up to 0.15 s to rise,",
    "to the onset: median, and 90 % of the detected.",
    f"in torques: contacts whose largest torque at a joint is {IN_TORQUES:g} standard deviations or more",
    "of the noise of its sensor; and the share of these that is detected.",
    "Nm by joint: root mean square over trials; free motion: of the external torque.",
    "before: a contact was reported already when this one began, so that it gives no onset.",
    "free: motion without contact. between: from 0.1 s after a contact to the next. Hysteresis keeps torque",
    "after a contact, which may be over a threshold.",
    *LOCALIZATION_NOTES,
)


def print_study(study: Study, console: Console) -> None:
    """All tables, and how to read them."""
    arms = [name for name in study.arms if study.of(name)]
    tables = [
        _detection(study, arms),
        *localization_tables(_groups(study, arms), LETTERS),
        _free(study, arms),
        _forces(study, arms),
        *(_links(name, contacts_of(study.of(name))) for name in arms),
        *(named_links_table(name, study.of(name)) for name in arms),
        *(_torques(name, study.of(name)) for name in arms),
    ]
    print_tables(console, tables, NOTES)
    for name, missing in study.skipped.items():
        console.print(f"{name} was skipped: {missing}", highlight=False, soft_wrap=True)


def _detection(study: Study, arms: Sequence[str]) -> Table:
    low, high = FORCE
    table = sheet(
        f"Contacts of {low:g} to {high:g} N",
        ("", ""),
        (
            *("\nn", "detected\n%", "chance\n%", "before\n%"),
            *("in\ntorques", "of these\n%", "delay\nms", "90 %\nms"),
        ),
    )
    for name, trials in _groups(study, arms):
        table.add_section()
        contacts = contacts_of(trials)
        for each in MONITORS:
            figures = detection(contacts, each)
            table.add_row(
                name if each == MONITORS[0] else "",
                LETTERS[each],
                str(figures.contacts),
                scaled(figures.detected, 100),
                scaled(false_onsets(trials, each).chance, 100),
                scaled(figures.reported_before, 100),
                str(figures.in_torques),
                scaled(figures.detected_in_torques, 100),
                scaled(figures.delay, 1e3),
                scaled(figures.delay_90, 1e3),
            )
    return table


def _free(study: Study, arms: Sequence[str]) -> Table:
    headers = (
        *("free\nmin", "false\nonsets", "\nper h", "reported\n% of time"),
        *("between:\nonsets", "per\ncontact", "reported\n% of time"),
    )
    table = sheet("Motion without contact", ("", ""), headers)
    for name, trials in _groups(study, arms):
        table.add_section()
        for each in MONITORS:
            false = false_onsets(trials, each)
            table.add_row(
                name if each == MONITORS[0] else "",
                LETTERS[each],
                scaled(false.seconds, 1.0 / 60.0, 1),
                str(false.onsets),
                scaled(false.per_hour, 1),
                scaled(false.collision, 100, 1),
                str(false.between),
                scaled(false.per_contact, 1, 1),
                scaled(false.between_share, 100, 1),
            )
    return table


def _groups(study: Study, arms: Sequence[str]) -> list[tuple[str, list[Trial]]]:
    """Each arm, and all where there are several."""
    return [(name, study.of(name)) for name in arms] + ([("all", study.trials)] if len(arms) > 1 else [])


def _forces(study: Study, arms: Sequence[str]) -> Table:
    headers = []
    for low, high in BANDS:
        headers += [f"{low:g}-{high:g} N\nn", *(f"\n{letter}" for letter in LETTERS.values())]
    table = sheet("Detected by force, %", ("",), tuple(headers))
    for name, trials in _groups(study, arms):
        contacts = contacts_of(trials)
        cells = []
        for band in BANDS:
            cells += _shares(in_band(contacts, band))
        table.add_row(name, *cells)
    return table


def _links(name: str, contacts: Sequence[JudgedContact]) -> Table:
    headers = ("n", "in torques", *LETTERS.values())
    table = sheet(f"Detected by link, %: {name}", ("link",), headers)
    for link in links_of(contacts):
        here = [each for each in contacts if each.link == link]
        count, *shares = _shares(here)
        table.add_row(link, count, str(detection(here, MONITORS[0]).in_torques), *shares)
    return table


def _shares(contacts: Sequence[JudgedContact]) -> list[str]:
    return [str(len(contacts)), *(scaled(detection(contacts, each).detected, 100) for each in MONITORS)]


def _torques(name: str, trials: Sequence[Trial]) -> Table:
    """Errors that the arm has, and what they leave of the external torque."""
    nv = described(name).nv
    table = sheet(
        f"Nm by joint: {name}",
        ("",),
        tuple(str(joint + 1) for joint in range(nv)),
    )
    for label, values in (
        ("torque noise", _errors(trials, "torque_noise", nv)),
        ("torque bias", _errors(trials, "torque_bias", nv)),
        ("Coulomb friction it sees", _friction(trials, nv)),
        ("free motion, uncalibrated", rms(trials, "thresholds")),
        ("free motion, calibrated", rms(trials, "calibrated")),
        ("thresholds of B", _square_mean([trial.thresholds for trial in trials])),
    ):
        table.add_row(label, *(f"{value:.2f}" for value in values))
    return table


def _errors(trials: Sequence[Trial], name: str, nv: int) -> list[float]:
    return _square_mean([trial.errors.per_joint(name, nv) for trial in trials])


def _friction(trials: Sequence[Trial], nv: int) -> list[float]:
    def seen(arm: ImperfectArm) -> np.ndarray:
        return np.broadcast_to(np.array(arm.friction.coulomb), nv) * arm.friction.share_seen(nv)

    return _square_mean([seen(trial.errors) for trial in trials])


def _square_mean(rows: Sequence[object]) -> list[float]:
    return np.sqrt(np.mean(np.square(np.array(rows, dtype=float)), axis=0)).tolist()  # type: ignore[no-any-return]
