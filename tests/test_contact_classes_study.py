"""The study of classes of contacts: scenes of an arm that no weight is from, and what its figures count."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

import contactsense as cs
from contactsense_studies.contact_classes.arms import JUDGED
from contactsense_studies.contact_classes.fit import fit
from contactsense_studies.contact_classes.judge import Answer, Judged
from contactsense_studies.contact_classes.options import Options
from contactsense_studies.contact_classes.report import print_study
from contactsense_studies.contact_classes.score import score
from contactsense_studies.contact_classes.study import Study, contacts_of
from contactsense_studies.contact_classes.truth import Truth


def six_joints(folder: Path) -> cs.Robot:
    """A URDF made here: six revolute joints, cylinders for links, 1.2 m long."""
    lengths, masses = (0.1, 0.35, 0.3, 0.12, 0.12, 0.15), (5.0, 6.0, 4.0, 2.0, 1.5, 1.0)
    axes, efforts = ("0 0 1", "0 1 0", "0 1 0", "0 0 1", "0 1 0", "0 0 1"), (200, 200, 120, 60, 60, 40)
    text = '<robot name="six"><link name="base"/>'
    below, parent = 0.2, "base"
    for k, (length, mass) in enumerate(zip(lengths, masses, strict=True)):
        inertia = mass * (length**2 / 12.0 + 0.05**2 / 4.0)
        half = f'<origin xyz="0 0 {0.5 * length}"/>'
        text += (
            f'<link name="part_{k}"><inertial>{half}<mass value="{mass}"/><inertia ixx="{inertia}" '
            f'iyy="{inertia}" izz="{0.5 * mass * 0.05**2}" ixy="0" ixz="0" iyz="0"/></inertial>'
            f'<collision>{half}<geometry><cylinder radius="0.05" length="{length}"/></geometry></collision>'
            f'</link><joint name="turn_{k}" type="revolute"><parent link="{parent}"/>'
            f'<child link="part_{k}"/><origin xyz="0 0 {below}"/><axis xyz="{axes[k]}"/>'
            f'<limit lower="-2.5" upper="2.5" effort="{efforts[k]}" velocity="2.5"/></joint>'
        )
        below, parent = length, f"part_{k}"
    path = folder / "six.urdf"
    path.write_text(text + "</robot>", encoding="utf-8")
    return cs.Robot.from_urdf(path)


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> list:
    robot = six_joints(tmp_path_factory.mktemp("six"))
    return contacts_of("six", robot, np.random.default_rng(21), 26, motion_seconds=30.0)


def test_contacts_of_another_arm_are_told_apart(judged: list) -> None:
    found = score(judged)
    assert found.contacts >= 20
    assert found.missed <= 0.3 * found.contacts
    assert found.clamped_or_transient >= 8
    # A few contacts only: what the study shows of many is at least 95 % and 85 %.
    assert found.right_kind >= 0.85
    assert found.right_intention >= 0.8
    assert sum(map(sum, found.confusion)) == found.contacts - found.missed - found.open


def test_a_figure_counts_what_is_right() -> None:
    def contact(kind: str, said: tuple[float, float, float], intended: float, wanted: bool) -> Judged:
        truth = Truth("held", kind, wanted, 0.6, 0.9, 20.0)
        return Judged("arm", truth, (Answer(None, said, intended, ()),))

    found = score(
        [
            contact("clamped", (0.8, 0.1, 0.1), 0.1, False),
            contact("clamped", (0.3, 0.6, 0.1), 0.9, False),
            contact("transient", (0.3, 0.6, 0.1), 0.9, True),
            contact("sustained", (0.2, 0.2, 0.6), 0.9, True),
            Judged("arm", Truth("held", "clamped", False, 0.6, 0.9, 3.0), ()),
        ]
    )
    assert (found.contacts, found.missed, found.clamped_or_transient) == (5, 1, 3)
    assert found.right_kind == pytest.approx(2 / 3)
    assert found.right_of_three == found.right_intention == pytest.approx(3 / 4)
    assert found.confusion == ((1, 1, 0), (0, 1, 0), (0, 0, 1))
    assert found.intention_error == pytest.approx((0.1 + 3 * abs(0.9 - 2 / 3)) / 4)


def test_the_tables_fit_a_terminal() -> None:
    answer = Answer(None, (0.8, 0.1, 0.1), 0.1, ())
    truth = Truth("held", "clamped", False, 0.6, 0.9, 20.0)
    judged = [Judged(arm, truth, (answer,)) for arm in JUDGED for _ in range(1000)]
    console = Console(width=80, record=True)
    print_study(Study(Options(), JUDGED, {}, judged), console)
    printed = console.export_text()
    assert "…" not in printed
    for header in ("missed", "either", "of three", "intended", "1000", "100.0"):
        assert header in printed


def test_the_weights_of_a_softmax_regression_are_found() -> None:
    rng = np.random.default_rng(3)
    features = rng.normal(size=(20_000, 2))
    logits = features @ np.array([1.5, -0.5]) - 0.3
    classes = (rng.random(len(logits)) < 1.0 / (1.0 + np.exp(-logits))).astype(int)
    weights = fit(features, classes, 2, ridge=1e-7)
    np.testing.assert_allclose(weights[1] - weights[0], [1.5, -0.5, -0.3], atol=0.08)
