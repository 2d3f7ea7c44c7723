"""Classes of the contacts of a log: those that a classifier beside a live monitor gives."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from log_files import DT, arm, named_columns, pushed, write_csv

import contactsense as cs
from contactsense.cli.app import run
from contactsense.offline.monitor_of import monitor_of

PROBABILITIES = ("clamped", "transient", "sustained", "intended")
LINK = "iiwa_link_7"


def monitor(**options: object) -> cs.ContactMonitor:
    return cs.ContactMonitor(arm(), dt=DT, torque_threshold=0.6, **options)


def classifier(**options: object) -> cs.ContactClassifier:
    return cs.ContactClassifier(arm(), dt=DT, **options)


def pushes(*spans: tuple[float, float], force: float = 25.0) -> cs.Log:
    """The log of `pushed` with pushes at other times [s]."""
    log, robot = pushed(), arm()
    assert log.tau is not None
    tau = log.tau.copy()
    for row in range(800, 1200):
        tau[row] += _push(robot, log.q[row], 25.0)
    for start, end in spans:
        for row in range(round(start / DT), round(end / DT)):
            tau[row] -= _push(robot, log.q[row], force)
    return cs.Log(log.time, log.q, log.v, tau)


def _push(robot: cs.Robot, q: np.ndarray, force: float) -> np.ndarray:
    pose = robot.link_pose(q, LINK)
    point = pose[:3, 3] + pose[:3, :3] @ [0.0, 0.0, 0.04]
    return robot.jacobian(q, LINK, point)[:3].T @ (pose[:3, :3] @ [-force, 0.0, 0.0])


Tick = tuple[cs.ContactReport, tuple[cs.ContactClass, ...]]


def live(log: cs.Log, sensing: cs.ContactMonitor, saying: cs.ContactClassifier) -> Iterator[Tick]:
    """A control loop with both, tick by tick."""
    steps = [None, *np.diff(log.time).tolist()]
    torques = log.external_torque if log.tau is None else log.tau
    assert torques is not None
    for q, v, tau, dt in zip(log.q, log.v, torques, steps, strict=True):
        report = sensing.update_external(q, tau, v=v, dt=dt) if log.tau is None else None
        report = report or sensing.update(q, v, tau, dt=dt)
        yield report, saying.update(q, v, report)


def numbers(found: Any) -> list[float]:
    return [getattr(found, name) for name in PROBABILITIES]


def assert_as_live(result: cs.Replay, ticks: Sequence[Tick]) -> None:
    """The classes of contacts that the monitor follows, found by their ids."""
    expected, last, since = [], {}, {}
    for report, classes in ticks:
        by_id = {each.id: each for each in classes}
        expected += [numbers(by_id[contact.id]) for contact in report.contacts]
        since |= {each.id: each.since for each in classes}
        # One that goes on under another id begins when the first one did.
        last |= {each.since: each for each in classes}
    told = np.column_stack([result.contact_ticks[name] for name in PROBABILITIES])
    np.testing.assert_array_equal(told, expected)
    assert len(result.contacts) > 0
    for contact in result.contacts:
        each = last[since[contact.id]]
        assert numbers(contact) == numbers(each)
        assert contact.kind == each.kind
        assert getattr(contact, contact.kind) == max(numbers(contact)[:3])


@pytest.mark.parametrize(
    ("spans", "contacts", "ended"),
    [
        (((0.8, 1.2),), 1, 1),
        (((0.4, 0.5), (1.0, 1.6)), 2, 2),
        # The robot bounces: two contacts to the monitor, and one to the classifier.
        (((0.8, 0.84), (0.93, 1.1)), 2, 1),
        # The log ends in a contact.
        (((1.4, 2.0),), 1, 0),
    ],
)
@pytest.mark.parametrize("chunk", [2048, 333])
def test_classes_are_those_of_the_live_loop(
    spans: tuple[tuple[float, float], ...],
    contacts: int,
    ended: int,
    chunk: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(import_module("contactsense.offline.replay"), "_CHUNK", chunk)
    log = pushes(*spans)
    result = cs.replay(log, monitor(), classifier=classifier())
    ticks = list(live(log, monitor(), classifier()))
    assert len(result.contacts) == contacts
    assert sum(not each.running for _, classes in ticks for each in classes) == ended
    assert_as_live(result, ticks)


def test_an_external_torque_alone_is_enough() -> None:
    log = pushed()
    torque = cs.replay(log, monitor()).ticks["external_torque"]
    external = cs.Log(log.time, log.q, log.v, external_torque=torque)
    result = cs.replay(external, monitor(), classifier=classifier())
    assert_as_live(result, list(live(external, monitor(), classifier())))


def test_another_prior_is_heard() -> None:
    prior = {"prior": [0.8, 0.1, 0.1], "intended_prior": 0.01}
    (usual,) = cs.replay(pushed(), monitor(), classifier=classifier()).contacts
    (other,) = cs.replay(pushed(), monitor(), classifier=classifier(**prior)).contacts
    assert other.clamped > usual.clamped
    assert other.intended < usual.intended


def test_contacts_that_are_not_followed_have_classes() -> None:
    result = cs.replay(pushed(), monitor(samples=0), classifier=classifier())
    ticks = list(live(pushed(), monitor(samples=0), classifier()))
    (ended,) = [each for _, classes in ticks for each in classes if not each.running]
    (contact,) = result.contacts
    assert numbers(contact) == numbers(ended)
    expected = [numbers(classes[0]) for report, classes in ticks if report.contacts]
    np.testing.assert_array_equal(
        np.column_stack([result.contact_ticks[name] for name in PROBABILITIES]), expected
    )


def humanoid() -> tuple[cs.Robot, cs.Log]:
    """A humanoid that is pushed at both hands, the second time later."""
    robot = cs.Robot.named("atlas")
    q, still = robot.neutral(), np.zeros(robot.nv)
    weight = robot.inverse_dynamics(q, still, still)
    pushes = [robot.jacobian(q, link)[:3].T @ [-40.0, 0.0, 0.0] for link in ("l_hand", "r_hand")]
    rows = np.arange(700)
    shares = [np.clip((rows - start) / 100.0, 0.0, 1.0) for start in (50, 250)]
    tau = weight - sum(np.outer(share, push) for share, push in zip(shares, pushes, strict=True))
    return robot, cs.Log(rows * DT, [q] * len(rows), np.zeros((len(rows), robot.nv)), tau[:, 6:])


def test_several_contacts_have_classes_of_their_own() -> None:
    robot, log = humanoid()
    result = cs.replay(log, cs.ContactMonitor(robot, dt=DT), classifier=cs.ContactClassifier(robot, dt=DT))
    ticks = list(live(log, cs.ContactMonitor(robot, dt=DT), cs.ContactClassifier(robot, dt=DT)))
    found, row, several = result.contact_ticks, 0, 0
    last: dict[int | None, list[float]] = {}
    for report, classes in ticks:
        by_id = {each.id: numbers(each) for each in classes}
        last |= by_id
        apart = all(np.isfinite(contact.wrench).all() for contact in report.contacts)
        several += len(report.contacts) > 1 and apart
        for place, contact in enumerate(report.contacts):
            # Where the torques of several are not known apart, the first has all of them.
            known = apart or place == 0
            expected = by_id[contact.id] if known else [np.nan] * len(PROBABILITIES)
            np.testing.assert_array_equal([found[name][row] for name in PROBABILITIES], expected)
            row += 1
    assert several > 100
    assert row == len(found["row"])
    running = {each.id for each in ticks[-1][1]}
    for contact in result.contacts:
        if contact.id in running:
            assert numbers(contact) == last[contact.id]


def test_without_a_classifier_nothing_is_said_of_classes() -> None:
    result = cs.replay(pushed(), monitor())
    (contact,) = result.contacts
    assert contact.kind == ""
    assert not {"kind", *PROBABILITIES} & ({*contact.to_dict()} | {*result.contact_ticks})
    classified = cs.replay(pushed(), monitor(), classifier=classifier())
    assert list(classified.contacts[0].to_dict()) == [*contact.to_dict(), "kind", *PROBABILITIES]
    for name, column in result.contact_ticks.items():
        np.testing.assert_array_equal(classified.contact_ticks[name], column)


def test_files_have_the_classes_with_one_schema(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    some = cs.replay(pushed(), monitor(), classifier=classifier())
    none = cs.replay(pushed()[:500], monitor(), classifier=classifier())
    without = cs.replay(pushed(), monitor())
    for name, result in (("some", some), ("none", none), ("without", without)):
        result.to_parquet(tmp_path / name)
    more = {"contacts": ["kind", *PROBABILITIES], "contact_ticks": [*PROBABILITIES], "ticks": []}
    for name, columns in more.items():
        schemas = [
            parquet.read_schema(tmp_path / each / f"{name}.parquet") for each in ("some", "none", "without")
        ]
        assert schemas[0] == schemas[1]
        assert schemas[0].names == [*schemas[2].names, *columns]
    (row,) = parquet.read_table(tmp_path / "some" / "contacts.parquet").to_pylist()
    (contact,) = some.contacts
    assert [row[name] for name in ("kind", *PROBABILITIES)] == [contact.kind, *numbers(contact)]
    some.to_json_lines(tmp_path / "contacts.jsonl")
    assert json.loads((tmp_path / "contacts.jsonl").read_text()) == contact.to_dict()


def test_a_classifier_of_another_robot_is_refused() -> None:
    atlas = cs.Robot.named("atlas")
    with pytest.raises(cs.InputError, match="classifier: is of 'atlas', the monitor of 'iiwa14'"):
        cs.replay(pushed(), monitor(), classifier=cs.ContactClassifier(atlas, dt=DT))
    with pytest.raises(cs.InputError, match=r"classifier: expected a contactsense\.ContactClassifier"):
        cs.replay(pushed(), monitor(), classifier=True)  # type: ignore[arg-type]


def test_the_command_prints_and_writes_classes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = {"position": "pos", "velocity": "vel", "torque": "effort"}
    rows = pushed()
    names = [str(number) for number in range(1, 8)]
    file = write_csv(tmp_path / "log.csv", {"time": rows.time, **named_columns(rows, names, words)})
    arguments = ["replay", str(file), "--robot", "iiwa14", "--threshold", "0.6"]
    log = cs.read_log(file, arm())
    same = monitor_of(log, arm(), torque_threshold=0.6)
    (contact,) = cs.replay(log, same, classifier=cs.ContactClassifier(arm(), dt=same.dt)).contacts
    assert run([*arguments, "--classes", "--json", "--out", str(tmp_path / "out")]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told == {"log": str(file), **contact.to_dict()}
    assert json.loads((tmp_path / "out" / "contacts.jsonl").read_text()) == contact.to_dict()
    assert run(arguments) == 0
    plain = capsys.readouterr().out
    assert "Classes" not in plain
    assert run([*arguments, "--classes"]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith(plain.rstrip())
    rows = [line.split() for line in printed[len(plain.rstrip()) :].splitlines()]
    percent = [f"{100.0 * probability:.0f}" for probability in numbers(contact)]
    assert ["0", f"{contact.start:.2f}", f"{contact.end:.2f}", contact.kind, *percent] in rows
    assert max(map(len, printed.splitlines())) <= 80
