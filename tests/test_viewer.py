"""The page of a log: what it draws, that it is seen in a browser, and what it writes."""

from __future__ import annotations

import shutil
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from log_files import DT, arm, named_columns, pushed, write_csv

import contactsense as cs
from contactsense.cli.app import run

pytest.importorskip("viser")
from contactsense.viewer.log_page import LogPage
from contactsense.viewer.moment import ReplayMoments
from contactsense.viewer.slot import Slot

# Seconds from the start of the log: before the push, and in the middle of it.
BEFORE, PUSHED = 0.4, 1.1
# viser and what it builds on keep sockets of pages that have ended open for a while.
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")


@pytest.fixture(scope="module")
def result() -> cs.Replay:
    return cs.replay(pushed(), cs.ContactMonitor(arm(), dt=DT, torque_threshold=0.6))


@pytest.fixture(scope="module")
def moments(result: cs.Replay) -> ReplayMoments:
    return ReplayMoments(result, cs.ContactMap(arm(), samples=1000))


def free_port() -> int:
    with socket.socket() as it:
        it.bind(("127.0.0.1", 0))
        return int(it.getsockname()[1])


@pytest.fixture
def page(result: cs.Replay, moments: ReplayMoments) -> Iterator[LogPage]:
    page = LogPage("pushed", result, moments, free_port())
    yield page
    page.close()


def test_an_instant_has_what_the_monitor_said(result: cs.Replay, moments: ReplayMoments) -> None:
    assert len(moments) == 2000
    assert moments.at(round(BEFORE / DT)).touches == ()
    row = round(PUSHED / DT)
    moment = moments.at(row)
    (touch,) = moment.touches
    (k,) = np.flatnonzero(result.contact_ticks["row"] == row)
    np.testing.assert_array_equal(touch.point, result.contact_ticks["point"][k])
    np.testing.assert_array_equal(touch.force, result.contact_ticks["force"][k])
    np.testing.assert_array_equal(moment.q, pushed().q[row])
    assert moment.likelihood.max() == 1.0
    likeliest = moment.places[np.argmax(moment.likelihood)]
    assert np.linalg.norm(likeliest - touch.point) < 0.1


def test_the_scene_shows_robot_force_and_posterior(page: LogPage, moments: ReplayMoments) -> None:
    scene = page._server.scene

    def wait_for(name: str, there: bool) -> None:
        until = time.monotonic() + 20.0
        while (scene.get_handle_by_name(name) is not None) != there:
            assert time.monotonic() < until, name
            time.sleep(0.01)

    page.show(PUSHED)
    wait_for("/contact 0/force", True)
    moment = moments.at(round(PUSHED / DT))
    (touch,) = moment.touches
    arrow = scene.get_handle_by_name("/contact 0/force").points[0]
    np.testing.assert_allclose(arrow[1], touch.point, atol=1e-6)
    along = (arrow[1] - arrow[0]) / np.linalg.norm(arrow[1] - arrow[0])
    np.testing.assert_allclose(along, touch.force / np.linalg.norm(touch.force), atol=1e-5)
    for link in arm().link_names:
        handle = scene.get_handle_by_name(f"/robot/{link}")
        np.testing.assert_allclose(handle.position, arm().link_pose(moment.q, link)[:3, 3], atol=1e-9)
    assert len(scene.get_handle_by_name("/posterior").points) > 5
    page.show(BEFORE)
    wait_for("/contact 0/force", False)
    wait_for("/posterior", False)


def test_the_page_is_served_on_loopback_alone(page: LogPage) -> None:
    assert page.address.startswith("http://127.0.0.1:")
    with urllib.request.urlopen(page.address, timeout=20) as answer:
        assert b"<html" in answer.read(2000)
    port = int(page.address.rsplit(":", 1)[1])
    # A server for everyone would answer at this address of the same machine.
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", port), timeout=5.0)


def test_a_page_that_is_written_stands_alone(page: LogPage, tmp_path: Path) -> None:
    file = tmp_path / "pushed.html"
    page.to_html(file, 1.0, 1.3)
    text = file.read_text(encoding="utf-8")
    assert "<html" in text
    assert len(text) > 100_000
    with pytest.raises(cs.InputError, match="start: must be before end"):
        page.to_html(file, 5.0)
    assert file.read_text(encoding="utf-8") == text


def chromium() -> str | None:
    return next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


def screenshot(address: str, file: Path) -> np.ndarray:
    matplotlib = pytest.importorskip("matplotlib.image")
    command = [str(chromium()), "--headless", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader"]
    command += ["--enable-unsafe-swiftshader", "--window-size=1200,800", "--virtual-time-budget=15000"]
    subprocess.run(
        [*command, f"--user-data-dir={file.with_suffix('')}", f"--screenshot={file}", address],
        check=True, timeout=200, capture_output=True,
    )  # fmt: skip
    picture: np.ndarray = matplotlib.imread(file)[:, :, :3]
    return picture


def blue_and_yellow(picture: np.ndarray) -> tuple[int, int]:
    """Pixels of the link that is touched, and of the force: left of the controls, below what viser tells."""
    scene = picture[160:, :800]
    difference = scene[..., 2] - scene[..., 0]
    return int(np.count_nonzero(difference > 0.3)), int(np.count_nonzero(difference < -0.3))


def is_seen(address: str, file: Path) -> bool:
    """Whether a touched link and a force are seen; a picture may be taken before all of the page is there."""
    tries = (blue_and_yellow(screenshot(address, file)) for _ in range(6))
    return any(blue > 300 and yellow > 100 for blue, yellow in tries)


@pytest.mark.skipif(chromium() is None, reason="there is no Chromium")
def test_a_browser_shows_robot_and_contact(page: LogPage, tmp_path: Path) -> None:
    page.show(BEFORE)
    before = screenshot(page.address, tmp_path / "before.png")
    assert blue_and_yellow(before) == (0, 0)
    assert np.std(before[160:, :800]) > 0.02  # the robot, on white
    page.show(PUSHED)
    assert is_seen(page.address, tmp_path / "pushed.png")


def test_the_page_of_a_control_loop_shows_what_is_felt(tmp_path: Path) -> None:
    log = pushed()
    monitor = cs.ContactMonitor(arm(), dt=DT, torque_threshold=0.6)
    assert log.tau is not None
    with cs.view(monitor, port=free_port()) as page:
        assert page.address.startswith("http://127.0.0.1:")
        for row in range(round(PUSHED / DT)):
            report = monitor.update(log.q[row], log.v[row], log.tau[row])
            page.show(log.q[row], report)
        time.sleep(0.1)  # until the next one is due
        page.show(log.q[row], report)
        written = page._slot.read()
        assert written is not None
        _, q, torque, (touch,) = written
        np.testing.assert_array_equal(q, log.q[row])
        np.testing.assert_array_equal(torque, report.external_torque)
        np.testing.assert_array_equal(touch.force, report.contacts[0].force)
        assert touch.link == report.contacts[0].link
        with urllib.request.urlopen(page.address, timeout=20) as answer:
            assert b"<html" in answer.read(2000)
        if chromium() is not None:
            assert is_seen(page.address, tmp_path / "live.png")
        time.sleep(0.1)
        with pytest.raises(cs.InputError, match="q: must be"):
            page.show([0.0], report)
    assert page._process.returncode == 0
    page.close()


def test_an_instant_is_read_whole_or_not_at_all(tmp_path: Path) -> None:
    """Two threads: all numbers of what is read are of one writing."""

    class Report:
        contacts = ()
        external_torque = np.zeros(7)

    writing, reading = (Slot(tmp_path / "slot", arm(), creates=creates) for creates in (True, False))
    assert reading.read() is None
    done = threading.Event()

    def write() -> None:
        for k in range(3000):
            report = Report()
            report.external_torque = np.full(7, float(k))
            writing.write(np.full(7, float(k)), report)
        done.set()

    thread = threading.Thread(target=write)
    thread.start()
    whole = 0
    while not done.is_set():
        found = reading.read()
        if found is not None:
            whole += 1
            assert len({*found[1], *found[2]}) == 1
    thread.join()
    assert whole > 10
    last = reading.read()
    assert last is not None
    assert last[0] == 6000


def test_the_page_ends_with_its_program(tmp_path: Path) -> None:
    script = f"""
import contactsense as cs, os
monitor = cs.ContactMonitor(cs.Robot.named("iiwa14"), dt=0.001)
page = cs.view(monitor, port={free_port()})
print(page.address, flush=True)
os.kill(os.getpid(), 9)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=200)
    address = done.stdout.strip()
    assert address
    until = time.monotonic() + 30.0
    while True:
        try:
            urllib.request.urlopen(address, timeout=5).close()
        except OSError:
            break
        assert time.monotonic() < until
        time.sleep(0.1)


@pytest.mark.parametrize("more", [{"port": 0}, {"monitor": 3}])
def test_wrong_arguments_are_named(more: dict[str, object]) -> None:
    (name,) = more
    with pytest.raises(cs.InputError, match=f"^{name}: "):
        cs.view(**{"monitor": cs.ContactMonitor(arm(), dt=DT), **more})


def test_the_command_writes_a_page(tmp_path: Path) -> None:
    log = pushed()
    words = {"position": "pos", "velocity": "vel", "torque": "effort"}
    columns = {"time": log.time, **named_columns(log, [str(k) for k in range(1, 8)], words)}
    file = write_csv(tmp_path / "pushed.csv", columns)
    page = tmp_path / "pushed.html"
    arguments = ["view", str(file), "--robot", "iiwa14", "--threshold", "0.6", "--port", str(free_port())]
    done = subprocess.run(
        [sys.executable, "-m", "contactsense.cli", *arguments, "--html", str(page), "--end", "0.3"],
        check=True, timeout=200, capture_output=True, text=True,
    )  # fmt: skip
    assert done.stdout == ""
    assert page.stat().st_size > 100_000
    assert run([*arguments, "--html", str(tmp_path / "nosuch" / "a.html")]) == 2
