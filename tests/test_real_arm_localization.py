"""Where contacts are, in the study of imperfect arms: which report counts, and how it is judged."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from robots import example

pytest.importorskip("mujoco", reason="the simulation needs MuJoCo: pip install contactsense[sim]")

import contactsense as cs
from contactsense import sim
from contactsense.log import Log
from contactsense_studies.real_arm import monitors
from contactsense_studies.real_arm.chain import Chain
from contactsense_studies.real_arm.estimate import JudgedEstimate, judge_estimate
from contactsense_studies.real_arm.judge import JudgedContact
from contactsense_studies.real_arm.localization import localization, named_links, reliability_of_links
from contactsense_studies.real_arm.monitors import Latest, hear
from contactsense_studies.real_arm.reliability import (
    calibration_error,
    calibration_error_by_chance,
    reliability,
)

IIWA = cs.Robot.named("iiwa14")
DT = 0.1  # of the scripted log [s]


class Scripted:
    """A monitor whose reports are known: "o" an onset, "c" a contact, "." neither."""

    script: tuple[str, ...] = ()

    def __init__(self, robot: cs.Robot, **arguments: Any) -> None:
        self.rows = iter(enumerate(self.script))

    def update(self, *measured: Any, dt: float) -> Any:
        row, told = next(self.rows)
        return SimpleNamespace(
            onset="o" in told,
            collision=told != ".",
            external_torque=np.zeros(7),
            contacts=(row,) if "c" in told else (),
        )


@pytest.mark.parametrize(
    ("script", "onset", "row"),
    [
        # The last with a contact, though the contact goes on being detected.
        (". . o c c o . . . . . .", 2, 4),
        # Nothing after the end of the stretch (rows 2 to 9), nor 0.5 s after the first onset.
        (". . . . . o c c c c c c", 5, 9),
        (". . oc c c c c c c c . .", 2, 7),
        # A contact that was there before is none of its own; an onset makes it one.
        (". c c c oc c . . . . . .", 4, 5),
        (". oc c c c c c c c c . .", None, None),
        (". . o . . . . . c c c c", None, None),
    ],
)
def test_the_last_report_within_the_contact_counts(
    script: str, onset: int | None, row: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(monitors, "ContactMonitor", Scripted)
    monkeypatch.setattr(Scripted, "script", tuple(script.split()))
    rows = np.zeros((12, 7))
    # The step is not a binary fraction: row 7 is 0.5 s after row 2 but for rounding.
    log = Log(np.round(DT * np.arange(12), 9) - 1e-9 * np.arange(12), rows, rows, rows)
    latest = hear(IIWA, log, [slice(2, 10)]).latest.get(0)
    assert (latest and latest.onset, latest and latest.row) == (onset, row)
    assert latest is None or latest.contacts == (row,)


def test_points_are_judged_in_the_pose_of_their_tick() -> None:
    motion = sim.random_moves(IIWA, 6.0, seed=1)
    push = sim.PersonContact("iiwa_link_6", [0.01, 0.02, 0.03], [30.0, 0.0, 0.0], 2.0, 0.8, 0.1)
    run = sim.record_imperfect(IIWA, sim.ImperfectArm(), motion, [push])
    rows = run.truth.contacts[0].rows
    pose = IIWA.link_pose(run.truth.q[rows.stop - 1], "iiwa_link_6")
    true = pose[:3, :3] @ push.point_local + pose[:3, 3]
    told: dict[str, Any] = {
        "link": "iiwa_link_5",
        "point": true + np.array([0.0, 0.03, 0.04]),
        "located": True,
    }

    def judged(**more: Any) -> JudgedEstimate:
        contact = SimpleNamespace(**{"link_probabilities": {}, "region_radius": np.nan, **told, **more})
        latest = Latest(rows.start + 100, rows.stop - 1, (contact,))  # type: ignore[arg-type]
        return judge_estimate(run, Chain(IIWA), run.truth.contacts[0], latest)

    plain = judged()
    assert (plain.link, plain.steps, plain.located, plain.contacts) == ("iiwa_link_5", 1, True, 1)
    assert plain.error == pytest.approx(0.05)
    assert plain.age == pytest.approx(run.truth.time[rows.stop - 1] - run.truth.time[rows.start + 100])
    assert plain.covered is None
    assert np.isnan(plain.probability)
    full = judged(link_probabilities={"iiwa_link_5": 0.7, "iiwa_link_6": 0.3}, region_radius=0.06)
    assert (full.probability, full.covered) == (0.7, True)
    assert judged(region_radius=0.04).covered is False
    told["point"] = np.full(3, np.nan)
    assert judged(region_radius=0.04).covered is None


def test_steps_along_the_chain() -> None:
    chain = Chain(IIWA)
    assert chain.steps("iiwa_link_3", "iiwa_link_3") == 0
    assert chain.steps("iiwa_link_3", "iiwa_link_4") == chain.steps("iiwa_link_4", "iiwa_link_3") == 1
    assert chain.steps("iiwa_link_0", "iiwa_link_7") == 7


def test_fingers_are_next_to_their_hand() -> None:
    """Also where Pinocchio forgets what a locked joint hangs from."""
    path = example("panda_description/urdf/panda.urdf")
    share = path.parents[4]
    fingers = ("panda_finger_joint1", "panda_finger_joint2")
    for locked in ((), fingers):
        chain = Chain(cs.Robot.from_urdf(path, package_dirs=share, locked_joints=locked))
        assert chain.steps("panda_hand", "panda_leftfinger") == 1
        assert chain.steps("panda_rightfinger", "panda_leftfinger") == 2
        # The flange between them has no surface.
        assert chain.steps("panda_hand", "panda_link7") == 1
        assert chain.steps("panda_link8", "panda_link7") == 1


def test_reliability_in_bins() -> None:
    statements = [(0.95, True), (0.85, True), (0.85, False), (0.81, True), (1.0, True)]
    lower, upper = reliability(statements)
    assert (lower.count, upper.count) == (3, 2)
    assert (lower.probability, lower.right) == (pytest.approx(2.51 / 3), pytest.approx(2 / 3))
    assert (upper.probability, upper.right) == (pytest.approx(0.975), 1.0)
    assert calibration_error([lower, upper]) == pytest.approx((3 * (2.51 - 2) / 3 + 2 * 0.025) / 5)
    assert np.isnan(calibration_error(reliability([])))


def test_right_probabilities_err_by_chance_alone() -> None:
    rng = np.random.default_rng(0)
    errors, expected = [], []
    for _ in range(200):
        probabilities = rng.beta(4.0, 1.5, 300)
        bins = reliability(list(zip(probabilities, rng.random(300) < probabilities, strict=True)))
        errors.append(calibration_error(bins))
        expected.append(calibration_error_by_chance(bins))
    assert np.mean(errors) == pytest.approx(np.mean(expected), rel=0.1)
    overconfident = [(0.95, each % 4 > 0) for each in range(400)]
    assert calibration_error(reliability(overconfident)) == pytest.approx(0.2)


def contact(
    link: str, estimate: JudgedEstimate | None, *, detected: bool = True, weight: float = 1.0
) -> JudgedContact:
    delay = 0.05 if detected else None
    return JudgedContact(link, 20.0, 0.5, 10.0, weight, {"it": delay}, {"it": False}, {"it": estimate})


def estimate(link: str, steps: int, error: float, radius: float, p: float, **more: Any) -> JudgedEstimate:
    given = {"located": radius <= 0.05, "age": 0.3, "contacts": 1, **more}
    return JudgedEstimate(
        link, steps, error, link_probabilities={link: p, "other": 1 - p}, region_radius=radius, **given
    )


def test_figures_are_shares_of_the_detected() -> None:
    contacts = [
        contact("a", estimate("a", 0, 0.01, 0.03, 0.9), weight=3.0),
        contact("a", estimate("b", 1, 0.08, 0.04, 0.6)),
        contact("a", estimate("c", 2, 0.10, 0.20, 0.6, contacts=2)),
        contact("b", estimate("b", 0, np.nan, np.nan, 0.8, located=False)),
        contact("b", None),
        contact("b", None, detected=False),
    ]
    figures = localization(contacts, "it")
    assert (figures.detected, figures.named, figures.exact, figures.within_one) == (5, 0.8, 0.4, 0.6)
    assert (figures.exact_by_area, figures.within_one_by_area) == pytest.approx((4 / 7, 5 / 7))
    assert (figures.point, figures.error) == (0.6, pytest.approx(0.08))
    assert (figures.located, figures.located_wrong) == (0.4, 0.5)
    assert (figures.regions, figures.coverage) == (3, pytest.approx(2 / 3))
    assert figures.region_radius[1] == pytest.approx(0.04)
    assert (figures.probabilities, figures.several) == (4, 0.2)
    assert [each.count for each in reliability_of_links(contacts, "it")] == [2, 1, 1]
    assert figures.calibration_error == pytest.approx((2 * 0.6 + 0.2 + 0.1) / 4)
    assert named_links(contacts, "it") == {"a": {"a": 1, "b": 1, "c": 1}, "b": {"b": 1}}
    empty = localization([], "it")
    assert empty.detected == 0
    assert np.isnan([empty.exact, empty.error, empty.coverage, empty.calibration_error]).all()
