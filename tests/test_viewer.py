"""The page of a log: what it draws, that it is seen in a browser, and what it writes."""

from __future__ import annotations

import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from log_files import DT, arm, named_columns, pushed, write_csv
from tools.browser import Browser
from viewer_pages import BEFORE, PUSHED, blue, free_port, pixels, yellow

import contactsense as cs
from contactsense.cli.app import run

pytest.importorskip("viser")
from contactsense.viewer.replay_moments import ReplayMoments
from contactsense.viewer.replay_view import ReplayView

# viser and what it builds on keep sockets of pages that have ended open for a while.
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")


@pytest.fixture(scope="module")
def result() -> cs.Replay:
    return cs.replay(pushed(), cs.ContactMonitor(arm(), dt=DT, torque_threshold=0.6))


@pytest.fixture(scope="module")
def moments(result: cs.Replay) -> ReplayMoments:
    return ReplayMoments(result, cs.ContactMap(arm(), samples=1000))


@pytest.fixture
def page(result: cs.Replay) -> Iterator[ReplayView]:
    with cs.view(result, port=free_port()) as page:
        yield page


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
    assert moment.posterior.shares.max() == 1.0
    likeliest = moment.posterior.points[np.argmax(moment.posterior.shares)]
    assert np.linalg.norm(likeliest - touch.point) < 0.1


def test_the_scene_shows_robot_force_and_posterior(page: ReplayView, moments: ReplayMoments) -> None:
    scene = page._page.server.scene

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


def test_the_page_is_served_on_loopback_alone(page: ReplayView) -> None:
    assert page.address.startswith("http://127.0.0.1:")
    with urllib.request.urlopen(page.address, timeout=20) as answer:
        assert b"<html" in answer.read(2000)
    port = int(page.address.rsplit(":", 1)[1])
    # A server for everyone would answer at this address of the same machine.
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", port), timeout=5.0)


def test_a_page_that_is_written_stands_alone(page: ReplayView, tmp_path: Path) -> None:
    file = tmp_path / "pushed.html"
    page.to_html(file, 1.0, 1.3)
    text = file.read_text(encoding="utf-8")
    assert "<html" in text
    assert len(text) > 100_000
    with pytest.raises(cs.InputError, match="start: must be before end"):
        page.to_html(file, 5.0)
    assert file.read_text(encoding="utf-8") == text


def test_a_browser_shows_robot_and_contact(page: ReplayView, browser: Browser) -> None:
    page.show(BEFORE)
    browser.open(page.address)
    browser.wait_for(lambda: float(np.std(pixels(browser))) > 0.02)  # the robot, on white
    assert blue(browser) == yellow(browser) == 0
    page.show(PUSHED)
    browser.wait_for(lambda: blue(browser) > 100 and yellow(browser) > 50)
    page.show(BEFORE)
    browser.wait_for(lambda: blue(browser) == yellow(browser) == 0)


def test_the_time_line_of_the_page_moves_the_robot(page: ReplayView, browser: Browser) -> None:
    page.show(BEFORE)
    browser.open(page.address)
    browser.wait_for("document.querySelector('[role=slider]')")
    browser.wait_for(lambda: float(np.std(pixels(browser))) > 0.02)
    # Half of the log is in the push.
    where = browser.evaluate(
        "(() => { const it = document.querySelector('[role=slider]').parentElement.getBoundingClientRect();"
        " return [it.x + 0.55 * it.width, it.y + it.height / 2]; })()"
    )
    browser.click(*where)
    browser.wait_for(lambda: blue(browser) > 100 and yellow(browser) > 50)
    assert abs(float(page._slider.value) - PUSHED) < 0.1


def test_play_goes_on_to_the_end_of_the_log(page: ReplayView, browser: Browser) -> None:
    page.show(1.5)
    browser.open(page.address)
    button = "[...document.querySelectorAll('button')].find(it => it.innerText.includes('Play'))"
    browser.wait_for(button)
    browser.evaluate(f"{button}.click()")
    end = float(page._time[-1])
    browser.wait_for(lambda: float(page._slider.value) == pytest.approx(end) and not page._playing.is_set())


@pytest.mark.parametrize(
    "more",
    [
        *({"port": 0}, {"port": True}, {"source": 3}, {"host": ""}, {"host": 3}, {"host": "nosuch.invalid"}),
        *({"token": "short"}, {"token": 20 * "/"}),
    ],
)
def test_wrong_arguments_are_named(more: dict[str, object], result: cs.Replay) -> None:
    (name,) = more
    for source in (cs.ContactMonitor(arm(), dt=DT), result):
        with pytest.raises(cs.InputError, match=f"^{name}: "):
            cs.view(**{"source": source, "port": free_port(), **more})


def test_the_command_writes_a_page(tmp_path: Path) -> None:
    log = pushed()
    words = {"position": "pos", "velocity": "vel", "torque": "effort"}
    columns = {"time": log.time, **named_columns(log, [str(k) for k in range(1, 8)], words)}
    file = write_csv(tmp_path / "pushed.csv", columns)
    page = tmp_path / "pushed.html"
    arguments = ["view", str(file), "--robot", "iiwa14", "--threshold", "0.6", "--port", str(free_port())]
    done = subprocess.run(
        [sys.executable, "-m", "contactsense", *arguments, "--html", str(page), "--end", "0.3"],
        check=True, timeout=200, capture_output=True, text=True,
    )  # fmt: skip
    assert done.stdout == ""
    assert page.stat().st_size > 100_000
    assert run([*arguments, "--html", str(tmp_path / "nosuch" / "a.html")]) == 2
