"""Many logs into one data set: the same on any engine, also where it was killed, and what of it failed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.dataset as ds
import pytest
from ctrl_c import HEARS_CTRL_C
from log_files import DT, arm, named_columns, pushed, write_csv

import contactsense as cs
from contactsense.cli.app import run
from contactsense.fleet.one_log import Outcome
from contactsense.fleet.settings import Settings
from contactsense.fleet.summary import links_of, places_of, robots_of

MONITOR = {"torque_threshold": 0.6}
LOGS = 4
needs_ray = pytest.mark.skipif(find_spec("ray") is None, reason="Ray has no build for this machine")


def write_log(path: Path, log: cs.Log) -> Path:
    names = [str(number) for number in range(1, 8)]
    words = {"position": "pos", "velocity": "vel", "torque": "effort"}
    return write_csv(path, {"time": log.time, **named_columns(log, names, words)})


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("logs")
    return [write_log(folder / f"log{k}.csv", pushed()[: 2000 - 100 * k]) for k in range(LOGS)]


@pytest.fixture(scope="module")
def whole(logs: list[Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The data set of a run that was not disturbed."""
    folder = tmp_path_factory.mktemp("whole") / "found"
    result = cs.replay_fleet(logs, arm(), folder, monitor=MONITOR, ticks=True)
    assert list(result.replayed) == logs
    return folder


def content(folder: Path) -> dict[str, bytes]:
    """Every file, hidden ones as well, and folders by a name that ends in a slash."""
    found = {str(path.relative_to(folder)): path for path in folder.rglob("*")}
    return {
        name + "/" * path.is_dir(): b"" if path.is_dir() else path.read_bytes()
        for name, path in found.items()
    }


def table(folder: Path, name: str) -> pa.Table:
    return ds.dataset(folder / name, partitioning="hive").to_table()


def test_the_data_set_has_what_replay_says_of_each_log(logs: list[Path], whole: Path) -> None:
    for number, path in enumerate(logs):
        result = cs.replay(cs.read_log(path, arm()), cs.ContactMonitor(arm(), dt=DT, **MONITOR))
        own = {
            name: table(whole, name).filter(pa.compute.field("log") == str(path))
            for name in ("logs", "contacts", "contact_ticks", "ticks")
        }
        assert [own["contacts"][name].to_pylist() for name in ("start", "end", "link", "point_local")] == [
            [contact.start for contact in result.contacts],
            [contact.end for contact in result.contacts],
            [contact.link for contact in result.contacts],
            [contact.point_local.tolist() for contact in result.contacts],
        ]
        assert own["ticks"]["external_torque"].to_pylist() == result.ticks["external_torque"].tolist()
        np.testing.assert_array_equal(
            own["contact_ticks"]["force"].to_pylist(), result.contact_ticks["force"]
        )
        (row,) = own["logs"].to_pylist()
        assert (row["rows"], row["contacts"], row["damage"]) == (2000 - 100 * number, 1, "")
        assert row["robot"] == arm().name
        assert row["seconds"] == pytest.approx((1999 - 100 * number) * DT)
        assert row["contact_seconds"] == pytest.approx(
            np.count_nonzero(result.ticks["collision"]) * DT, rel=0.01
        )


def test_logs_that_are_there_are_not_replayed_again(logs: list[Path], tmp_path: Path) -> None:
    def replayed(**more: Any) -> list[str]:
        result = cs.replay_fleet(own, arm(), tmp_path / "found", **{"monitor": MONITOR, **more})
        assert len(result.replayed) + len(result.unchanged) == 2
        return [path.name for path in result.replayed]

    own = [write_log(tmp_path / f"{k}.csv", pushed()[: 1500 + k]) for k in range(2)]
    assert replayed() == ["0.csv", "1.csv"]
    assert replayed() == []
    assert replayed(ticks=True) == ["0.csv", "1.csv"]
    assert replayed() == ["0.csv", "1.csv"]
    assert not list((tmp_path / "found" / "ticks").rglob("*.parquet"))  # of settings that hold no more
    assert replayed(monitor={"torque_threshold": 0.7}) == ["0.csv", "1.csv"]
    assert replayed(monitor={"torque_threshold": np.full(7, 0.7)}) == ["0.csv", "1.csv"]
    assert replayed(monitor={"torque_threshold": [0.7] * 7}) == []
    calibration = cs.Calibration.of_description(arm())
    assert replayed(monitor={**MONITOR, "calibration": calibration}) == ["0.csv", "1.csv"]
    assert replayed(monitor={**MONITOR, "calibration": calibration}, workers=1) == []
    write_log(own[1], pushed()[:1400])
    assert replayed(monitor={**MONITOR, "calibration": calibration}) == ["1.csv"]


def test_classes_are_those_of_replay(logs: list[Path], tmp_path: Path) -> None:
    log, folder = logs[1], tmp_path / "found"
    names = ("clamped", "transient", "sustained", "intended")
    for classifier in ({}, {"intended_prior": 0.9}):
        replayed = cs.replay_fleet([log], arm(), folder, monitor=MONITOR, classifier=classifier).replayed
        assert list(replayed) == [log]
        monitor = cs.ContactMonitor(arm(), dt=DT, **MONITOR)
        classes = cs.ContactClassifier(arm(), dt=DT, **classifier)
        result = cs.replay(cs.read_log(log, arm()), monitor, classifier=classes)
        found = table(folder, "contacts")
        for name in ("kind", *names):
            assert found[name].to_pylist() == [getattr(contact, name) for contact in result.contacts]
        ticks = table(folder, "contact_ticks")
        for name in names:
            np.testing.assert_array_equal(ticks[name].to_numpy(), result.contact_ticks[name])
    again = cs.replay_fleet([log], arm(), folder, monitor=MONITOR, classifier={"intended_prior": 0.9})
    assert list(again.unchanged) == [log]
    assert list(cs.replay_fleet([log], arm(), folder, monitor=MONITOR).replayed) == [log]
    assert not {"kind", *names} & {*table(folder, "contacts").column_names}


def test_robots_are_told_apart_whatever_their_names(logs: list[Path], tmp_path: Path) -> None:
    names = ["7", "cell 3/arm", "../b", "größe=1"]
    for name in names:
        cs.replay_fleet(logs[:1], arm(), tmp_path / "found", name=name, monitor=MONITOR)
    assert {path.name for path in tmp_path.iterdir()} == {"found"}
    assert [row.robot for row in robots_of(tmp_path / "found")] == sorted(names)
    (link,) = [row for row in links_of(tmp_path / "found") if row.robot == "7"]
    assert (link.link, link.contacts, link.located) == ("iiwa_link_7", 1, 1.0)
    assert link.an_hour == pytest.approx(3600.0 / 1.999)
    assert 20.0 < link.peak_force < 30.0


def test_a_log_that_fails_is_tried_once_more_after_all_others(logs: list[Path], tmp_path: Path) -> None:
    late, wrong = tmp_path / "late.csv", tmp_path / "wrong.csv"
    wrong.write_text("a,b\n1,2\n")
    reports = []

    def on_progress(done: int, every: int) -> None:
        reports.append((done, every))
        if done == 4:  # all have been tried
            write_log(late, pushed()[:1300])

    result = cs.replay_fleet(
        [late, wrong, *logs[:2], logs[0]], arm(), tmp_path / "found", monitor=MONITOR, on_progress=on_progress
    )
    assert list(result.replayed) == [late, *logs[:2]]
    assert "nothing holds positions" in result.failed[wrong]
    assert list(result.failed) == [wrong]
    assert reports == [*((done, 4) for done in range(5)), (4, 4), (4, 4)]
    assert sorted(table(tmp_path / "found", "logs")["log"].to_pylist()) == sorted(map(str, [late, *logs[:2]]))


def test_nothing_is_left_of_a_log_that_fails_since_it_changed(logs: list[Path], tmp_path: Path) -> None:
    changed, gone = (write_log(tmp_path / f"{name}.csv", pushed()[:1300]) for name in ("changed", "gone"))
    found = tmp_path / "found"
    cs.replay_fleet([changed, gone], arm(), found, monitor=MONITOR)
    changed.write_text("a,b\n1,2\n")
    gone.unlink()
    result = cs.replay_fleet([changed, gone], arm(), found, monitor=MONITOR)
    assert list(result.failed) == [changed, gone]
    # A log that is elsewhere now is still what it was.
    assert [table(found, name)["log"].unique().to_pylist() for name in ("logs", "contacts")] == [
        [str(gone)]
    ] * 2


def test_damage_is_told_also_of_logs_that_are_there(logs: list[Path], tmp_path: Path) -> None:
    cut = tmp_path / "cut.csv"
    cut.write_bytes(logs[0].read_bytes()[:-1000])
    for name in ("replayed", "unchanged"):
        result = cs.replay_fleet([cut, logs[1]], arm(), tmp_path / "found", monitor=MONITOR)
        assert list(getattr(result, name)) == [cut, logs[1]]
        assert list(result.damaged) == [cut]
        assert "line" in result.damaged[cut]


def ends(settings: Settings, log: Path) -> Outcome:
    """Work on which the process of one log ends as where memory runs out, and that of another does not."""
    del settings
    if log.name == "a":
        os.kill(os.getpid(), signal.SIGKILL)
    return Outcome()


@pytest.mark.parametrize("engine", ["local", pytest.param("ray", marks=needs_ray)])
def test_a_process_that_is_killed_takes_no_other_along(engine: str, tmp_path: Path) -> None:
    module = {"local": "local", "ray": "on_ray"}[engine]
    script = f"""
import json, pathlib, test_fleet
from contactsense.fleet.{module} import {engine}_engine as opened
if __name__ == "__main__":
    folder = pathlib.Path({str(tmp_path)!r})
    with opened(test_fleet.ends, None, 2{", None" * (engine == "ray")}) as run:
        pairs = list(run([pathlib.Path(name) for name in "bac"]))
    outcomes = {{str(log): outcome.failure for log, outcome in pairs}}
    (folder / "outcomes.json").write_text(json.dumps(outcomes))
"""
    file = tmp_path / "script.py"
    file.write_text(script)
    subprocess.run([sys.executable, str(file)], env=with_tests_on_path(), check=True, timeout=300)
    outcomes = json.loads((tmp_path / "outcomes.json").read_text())
    assert outcomes.pop("a") != ""
    assert outcomes == {"b": "", "c": ""}


def with_tests_on_path() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}


def command(logs: list[Path], folder: Path, *more: str) -> list[str]:
    options = ["--robot", "iiwa14", "--threshold", "0.6", "--gain", "50", "--ticks", "--out", str(folder)]
    return ["replay", *map(str, logs), *options, *more]


@needs_ray
@pytest.mark.parametrize("more", [[], ["--classes"]])
def test_both_engines_give_the_same_data_set(more: list[str], logs: list[Path], tmp_path: Path) -> None:
    for engine in ("local", "ray"):
        arguments = command(logs, tmp_path / engine, "--engine", engine, *more)
        subprocess.run([sys.executable, "-m", "contactsense", *arguments], check=True, timeout=300)
    assert content(tmp_path / "local") == content(tmp_path / "ray")


def stopped(arguments: list[str], when: Callable[[], bool], how: int) -> int:
    """The exit code of a command that gets a signal."""
    process = subprocess.Popen(
        [sys.executable, "-c", HEARS_CTRL_C, *arguments],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    until = time.monotonic() + 120.0
    while process.poll() is None and not when():
        assert time.monotonic() < until
        time.sleep(0.002)
    process.send_signal(how)
    return process.wait(timeout=120)


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_a_run_that_was_stopped_goes_on_to_the_same_data_set(
    how: signal.Signals, logs: list[Path], tmp_path: Path
) -> None:
    once, again = tmp_path / "once", tmp_path / "again"
    assert run(command(logs, once, "--engine", "local")) == 0
    parts = again / "logs"
    arguments = command(logs, again, "--engine", "local", "--workers", "1")
    code = stopped(arguments, lambda: bool(list(parts.rglob("*.parquet"))), how)
    assert code == (130 if how == signal.SIGINT else -signal.SIGKILL)
    assert 1 <= len(list(parts.rglob("*.parquet"))) < LOGS
    # What a process that is killed while it writes leaves behind.
    left = again / ".unfinished" / "robot=iiwa14" / "abc"
    left.mkdir(parents=True, exist_ok=True)
    (left / "ticks").write_bytes(b"PAR1")
    assert run(command(logs, again, "--engine", "local")) == 0
    assert content(again) == content(once)


def test_the_command_sums_up_the_whole_data_set(
    logs: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "found"
    assert run(command(logs[:1], folder, "--engine", "local", "--name", "left")) == 0
    capsys.readouterr()
    assert (
        run([*command([*logs, tmp_path / "nosuch.mcap"], folder, "--engine", "local"), "--name", "right"])
        == 4
    )
    told = capsys.readouterr()
    assert "left" in told.out
    assert "right" in told.out
    assert "logs: 4 replayed, 0 unchanged, 1 failed" in told.err
    assert "failed: " in told.err
    assert run(command(logs[:1], folder, "--engine", "local", "--name", "left", "--json")) == 0
    rows = json.loads(capsys.readouterr().out)
    assert [(row["robot"], row["logs"], row["contacts"]) for row in rows["robots"]] == [
        ("left", 1, 1),
        ("right", 4, 4),
    ]
    assert [row["link"] for row in rows["links"]] == ["iiwa_link_7"] * 2


def test_a_damaged_log_gives_its_exit_code(logs: list[Path], tmp_path: Path) -> None:
    cut = tmp_path / "cut.csv"
    cut.write_bytes(logs[0].read_bytes()[:-1000])
    for _ in range(2):
        assert run(command([cut], tmp_path / "found", "--engine", "local")) == 3


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"engine": "dask"}, "engine: must be local or ray"),
        ({"workers": 0}, "workers: must be at least 1"),
        ({"address": "auto"}, "address: "),
        ({"monitor": {"torque_threshold": -1.0}}, "torque_threshold"),
        ({"classifier": {"prior": [0.5, 0.5]}}, "prior: expected 3"),
        ({"robot": 3}, "robot: expected"),
        ({"name": 3}, "^name: expected a string, got 3"),
        ({"workers": "2"}, "^workers: expected a whole number"),
        ({"reading": 3}, "^reading: expected a mapping"),
        ({"monitor": [1]}, "^monitor: expected a mapping"),
        ({"classifier": 3}, "^classifier: expected a mapping"),
        ({"logs": "pushed.csv"}, "^logs: expected a sequence of paths"),
        ({"logs": [3]}, "^logs: expected a path"),
        ({"folder": 3}, "^folder: expected a path"),
    ],
)
def test_wrong_arguments_are_named(more: dict[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(cs.InputError, match=message):
        cs.replay_fleet(**{"logs": [], "robot": arm(), "folder": tmp_path / "found", **more})
    assert not (tmp_path / "found").exists()


def test_a_file_is_no_folder_for_a_data_set(logs: list[Path], tmp_path: Path) -> None:
    (tmp_path / "found").write_text("mine")
    with pytest.raises(cs.InputError, match="folder: cannot write to"):
        cs.replay_fleet(logs[:1], arm(), tmp_path / "found", monitor=MONITOR)
    assert (tmp_path / "found").read_text() == "mine"


@pytest.mark.parametrize(
    ("more", "message"),
    [(["--engine", "local"], "out: --engine needs"), (["--workers", "2"], "engine: ")],
)
def test_options_that_belong_together(
    more: list[str], message: str, logs: list[Path], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["replay", str(logs[0]), "--robot", "iiwa14", *more]) == 2
    assert message in capsys.readouterr().err


def test_a_folder_is_one_log(logs: list[Path], tmp_path: Path) -> None:
    """A folder of tables; it is replayed again when one of its files changes."""
    rows = pushed()[:300]
    names = [str(number) for number in range(1, 8)]
    folder = tmp_path / "bag"
    folder.mkdir()
    for word in ("position", "velocity", "torque"):
        write_csv(folder / f"{word}.csv", {"time": rows.time, **named_columns(rows, names, {word: word})})
    found = tmp_path / "found"
    assert cs.replay_fleet([folder], arm(), found, monitor=MONITOR).replayed == (folder,)
    assert cs.replay_fleet([folder], arm(), found, monitor=MONITOR).unchanged == (folder,)
    os.utime(folder / "torque.csv", (1.0, 1.0))
    assert cs.replay_fleet([folder], arm(), found, monitor=MONITOR).replayed == (folder,)


def test_pictures_are_drawn(logs: list[Path], tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    one, every = tmp_path / "one.png", tmp_path / "every.png"
    assert run(["replay", str(logs[0]), "--robot", "iiwa14", "--threshold", "0.6", "--png", str(one)]) == 0
    assert run(command(logs[:2], tmp_path / "found", "--engine", "local", "--png", str(every))) == 0
    for picture in (one, every):
        assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
        assert picture.stat().st_size > 10_000


def test_places_are_those_of_the_contacts(whole: Path) -> None:
    links, points, forces = places_of(whole, arm().name)
    contacts = table(whole, "contacts").to_pylist()
    found = sorted((row["link"], *row["point_local"], row["peak_force"]) for row in contacts)
    assert sorted(zip(links, *points.T.tolist(), forces.tolist(), strict=True)) == found
    assert len(links) == LOGS
    assert places_of(whole, "another")[0] == []


def test_logs_with_sensors(tmp_path: Path) -> None:
    """Sensors are settings, too: given by a topic, which is part of the fingerprint."""
    rows = pushed()[:300]
    names = [str(number) for number in range(1, 8)]
    words = {"position": "pos", "velocity": "vel", "torque": "effort"}
    wrench = {f"ft_{name}": np.full(len(rows), 0.1) for name in ("fx", "fy", "fz", "tx", "ty", "tz")}
    log = write_csv(tmp_path / "log.csv", {"time": rows.time, **named_columns(rows, names, words), **wrench})
    sensors = ["--sensor", "wrist=iiwa_link_7@ft_*"]
    folder = tmp_path / "found"
    assert run(command([log], folder, "--engine", "local", *sensors)) == 0
    before = content(folder)
    assert run(command([log], folder, "--engine", "local", *sensors)) == 0
    assert content(folder) == before
    assert run(command([log], folder, "--engine", "local")) == 0
    assert content(folder).keys() == before.keys()
    assert content(folder) != before
