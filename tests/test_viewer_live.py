"""The page of a control loop: contacts, particles and sensors as they are, and its process."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
import urllib.request
from pathlib import Path

import numpy as np
import pytest
from log_files import DT, arm, pushed
from tools.browser import chromium
from viewer_pages import PUSHED, blue, free_port, green, purple, yellow

import contactsense as cs

pytest.importorskip("viser")
from contactsense.viewer.moment import Cloud, Moment
from contactsense.viewer.replay_moments import ReplayMoments
from contactsense.viewer.slot import MOST_PARTICLES, Slot

# viser and what it builds on keep sockets of pages that have ended open for a while.
pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")


def shown(page: cs.View, q: object, report: cs.ContactReport, *more: object) -> tuple[np.ndarray, Moment]:
    """External torque and instant that the page gets."""
    time.sleep(0.1)  # until the next one is due
    before = page._slot.count
    page.show(q, report, *more)  # type: ignore[arg-type]
    until = time.monotonic() + 20.0
    while (found := page._slot.read()) is None or found[0] == before:
        assert time.monotonic() < until
        time.sleep(0.001)
    return found[1:]


def test_the_page_of_a_control_loop_shows_what_is_felt(request: pytest.FixtureRequest) -> None:
    log = pushed()
    monitor = cs.ContactMonitor(arm(), dt=DT, torque_threshold=0.6)
    assert log.tau is not None
    with cs.view(monitor, port=free_port()) as page:
        assert page.address.startswith("http://127.0.0.1:")
        for row in range(round(PUSHED / DT)):
            report = monitor.update(log.q[row], log.v[row], log.tau[row])
            page.show(log.q[row], report)
        torque, moment = shown(page, log.q[row], report)
        (touch,) = moment.touches
        np.testing.assert_array_equal(moment.q, log.q[row])
        assert not len(moment.particles.points)
        np.testing.assert_array_equal(torque, report.external_torque)
        np.testing.assert_array_equal(touch.force, report.contacts[0].force)
        assert touch.link == report.contacts[0].link
        with urllib.request.urlopen(page.address, timeout=20) as answer:
            assert b"<html" in answer.read(2000)
        if chromium() is not None:
            browser = request.getfixturevalue("browser")
            browser.open(page.address)
            browser.wait_for(lambda: blue(browser) > 100 and yellow(browser) > 50)
        time.sleep(0.1)
        with pytest.raises(cs.InputError, match="q: must be"):
            page.show([0.0], report)
    assert page._process.returncode == 0
    page.close()


def test_a_report_of_another_robot_is_named_at_the_next_instant() -> None:
    other = cs.Robot.named("atlas")
    report = cs.ContactMonitor(other, dt=DT).update(
        other.neutral(), np.zeros(other.nv), np.zeros(other.nv - 6)
    )
    q = arm().neutral()
    with cs.view(cs.ContactMonitor(arm(), dt=DT), port=free_port()) as page:
        page.show(q, report)
        until = time.monotonic() + 20.0
        while page._failure is None:
            assert time.monotonic() < until
            time.sleep(0.01)
        time.sleep(0.1)
        with pytest.raises(cs.InputError, match=r"^report: is not of the robot"):
            page.show(q, report)


def test_an_instant_is_read_whole_or_not_at_all(tmp_path: Path) -> None:
    """Two threads: all numbers of what is read are of one writing."""

    class Report:
        contacts = ()
        external_torque = np.zeros(7)

    writing, reading = (Slot(tmp_path / "slot", arm(), creates=creates) for creates in (True, False))
    assert reading.read() is None
    enough, written = threading.Event(), 0

    def write() -> None:
        nonlocal written
        while not enough.is_set():
            k = written
            report = Report()
            report.external_torque = np.full(7, float(k))
            particles = Cloud(np.full((500, 3), float(k)), np.full(500, float(k)))
            writing.write(np.full(7, float(k)), report, particles)
            written += 1

    # Until both have done enough, however the processor is shared with other programs.
    thread = threading.Thread(target=write)
    thread.start()
    whole = 0
    try:
        while whole < 100 or written < 1000:
            found = reading.read()
            if found is not None:
                whole += 1
                _, torque, moment = found
                cloud = moment.particles
                assert len({*moment.q, *torque, *cloud.points.flat, *cloud.shares}) == 1
    finally:
        enough.set()
        thread.join()
    last = reading.read()
    assert last is not None
    assert last[0] == 2 * written


def test_particles_of_a_filter_are_shown(request: pytest.FixtureRequest) -> None:
    robot = arm()
    q = np.array([0.3, 0.8, -0.4, -1.1, 0.5, 0.7, 0.0])
    report = cs.ContactMonitor(robot, dt=DT).update(q, np.zeros(7), np.zeros(7))
    particles = cs.ContactParticleFilter(robot, particles=500, seed=1)
    particles.update(q, [1.0, 2.0, 0.5, 1.0, 0.1, 0.2, 0.0])
    with cs.view(cs.ContactMonitor(robot, dt=DT), port=free_port()) as page:

        def written(given: object) -> Cloud:
            return shown(page, q, report, given)[1].particles

        # More than there is room for: so many, from the first to the last.
        many = np.arange(3.0 * 25_000).reshape(-1, 3)
        cloud = written(many)
        assert len(cloud.points) == MOST_PARTICLES
        np.testing.assert_array_equal(cloud.points[[0, -1]], many[[0, -1]])
        assert np.all(np.abs(np.diff(cloud.points[:, 0]) - 7.5) <= 1.5)
        np.testing.assert_array_equal(cloud.shares, 1.0)
        np.testing.assert_array_equal(written([[1.0, 2.0, 3.0]]).points, [[1.0, 2.0, 3.0]])
        assert len(written(np.zeros((0, 3))).points) == 0
        for wrong in (np.zeros((3, 2)), [[0.0, 0.0, np.nan]], "all", 3.0):
            with pytest.raises(cs.InputError, match=r"^particles: "):
                written(wrong)
        for given in (particles, particles.particles):
            cloud = written(given)
            np.testing.assert_array_equal(cloud.points, particles.particles.point.astype(np.float32))
            weights = particles.particles.weight
            np.testing.assert_allclose(cloud.shares, weights / weights.max(), rtol=1e-6)
        if chromium() is not None:
            browser = request.getfixturevalue("browser")
            browser.open(page.address)
            browser.wait_for(lambda: purple(browser) > 100)
            assert written(None).shares.size == 0
            browser.wait_for(lambda: purple(browser) == 0)


def with_sensor() -> tuple[cs.ForceTorqueSensor, cs.Log]:
    """A sensor at the last link, which sees the push and the weight of the link."""
    sensor = cs.ForceTorqueSensor("wrist", "iiwa_link_7", convention="support")
    log = pushed()
    readings = np.zeros((len(log), 1, 6))
    free = cs.LoadCompensator(arm(), [sensor])
    for row in range(len(log)):
        pose = arm().link_pose(log.q[row], sensor.link)
        seen = -free.update(log.q[row], np.zeros(7), np.zeros(7), np.zeros((1, 6)))[0]
        if 800 <= row < 1200:
            seen[:3] += pose[:3, :3] @ [-25.0, 0.0, 0.0]
            seen[3:] += np.cross(pose[:3, :3] @ [0.0, 0.0, 0.04], pose[:3, :3] @ [-25.0, 0.0, 0.0])
        readings[row, 0] = -np.concatenate([pose[:3, :3].T @ seen[:3], pose[:3, :3].T @ seen[3:]])
    return sensor, cs.Log(log.time, log.q, log.v, log.tau, wrenches=readings)


def test_sensors_of_a_log_and_of_a_control_loop_are_shown(request: pytest.FixtureRequest) -> None:
    sensor, log = with_sensor()
    monitor = cs.ContactMonitor(arm(), dt=DT, sensors=[sensor], torque_threshold=0.6, samples=0)
    row = round(PUSHED / DT)
    assert log.tau is not None
    assert log.wrenches is not None
    with cs.view(monitor, port=free_port()) as page:
        for k in range(row):
            report = monitor.update(log.q[k], log.v[k], log.tau[k], log.wrenches[k])
        _, moment = shown(page, log.q[row - 1], report)
        np.testing.assert_array_equal(moment.wrenches, report.wrenches)
        assert "sensor wrist: 25." in moment.told([sensor])
        if chromium() is not None:
            browser = request.getfixturevalue("browser")
            browser.open(page.address)
            browser.wait_for(lambda: green(browser) > 50)
            browser.wait_for("document.body.innerText.includes('sensor wrist: 25.')")
    monitor.reset()
    result = cs.replay(log, monitor)
    np.testing.assert_allclose(ReplayMoments(result, None).at(row).wrenches, report.wrenches, atol=1.5)
    with cs.view(result, port=free_port()) as view:
        view.show(PUSHED)
        scene = view._page.server.scene
        until = time.monotonic() + 20.0
        while scene.get_handle_by_name("/sensor force 0") is None:
            assert time.monotonic() < until
            time.sleep(0.01)
        pose = arm().link_pose(log.q[row], sensor.link)
        arrow = scene.get_handle_by_name("/sensor force 0").points[0]
        np.testing.assert_allclose(arrow[1], pose[:3, 3], atol=1e-6)
        ring = scene.get_handle_by_name("/sensor wrist/ring")
        np.testing.assert_allclose(ring.position, pose[:3, 3], atol=1e-9)
        if chromium() is not None:
            browser.open(view.address)
            browser.wait_for(lambda: green(browser) > 50)


def test_a_sensor_without_a_reading_has_a_ring_and_no_arrow() -> None:
    sensor, log = with_sensor()
    monitor = cs.ContactMonitor(arm(), dt=DT, sensors=[sensor], torque_threshold=0.6, samples=0)
    with cs.view(cs.replay(log[:10], monitor), port=free_port()) as view:
        scene = view._page.server.scene
        for wrenches, there in ((np.full((1, 6), 2.0), True), (np.full((1, 6), np.nan), False)):
            moment = Moment(log.q[0], (), wrenches=wrenches)
            view._page.stage.show(moment)
            assert (scene.get_handle_by_name("/sensor force 0") is not None) == there
            assert moment.told([sensor]).endswith("wrist: 3.5 N, 3.5 Nm" if there else "wrist: no reading")
        assert scene.get_handle_by_name("/sensor wrist/ring") is not None


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
