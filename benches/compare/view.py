"""A control loop with a page in the browser, and without: the tick, and what reaches the page.

Ticks are those of a loop at 1 kHz, which sleeps in between: what the sleep and the other processes leave of
the caches counts. While there is no page, its process and the browser stand still.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import numpy as np
from tools.browser import Browser, chromium

import contactsense as cs

from .machine import other_cores
from .timing import Comparison, Pace, Timing

DT = 1e-3  # [s]
NOISE = 0.1  # of each torque in each tick, standard deviation [Nm]
THRESHOLD = 0.6  # [Nm]
FORCE = np.array([-25.0, 5.0, 0.0])  # on the last link [N]
BLOCK = 1000  # ticks with a page, or without
SHORT = 50  # where the figures are not meant
SETTLING = 50  # ticks after a change that do not count: processes go on, and the caches with them
SIZE = (700, 450)  # of the browser's page [pixels]
PORT = 8095
MAX_TAIL_RATIO = 1.1
PARTICLES = 10_000
MAX_BETWEEN = 33.4  # [ms]: thirty a second
# Counts the instants whose particles reach the page's script, and those that are drawn.
COUNTS = f"const bytes = {12 * PARTICLES}, number = {PARTICLES};"
COUNTS += """
window.counts = { reached: 0, drawn: 0 };
const holds = it => it && it.points && it.points.byteLength === bytes;
window.Worker = class extends Worker {
  constructor(...given) {
    super(...given);
    this.addEventListener("message", ({ data }) => {
      for (const message of data.messages || [])
        if (holds(message.props) || holds(message.updates)) counts.reached++;
    });
  }
};
const prototype = WebGL2RenderingContext.prototype;
let isNew = false;
const wrap = (name, see) => {
  const own = prototype[name];
  prototype[name] = function (...given) { see(given); return own.apply(this, given); };
};
for (const name of ["bufferData", "bufferSubData"])
  wrap(name, given => { isNew ||= given.some(it => it && it.byteLength === bytes); });
for (const name of ["drawArrays", "drawArraysInstanced"])
  wrap(name, given => { if (isNew && given.includes(number)) { counts.drawn++; isNew = false; } });
"""
NOW = "({ ...counts, time: performance.now() })"


def compare(pace: Pace) -> list[Comparison]:
    """With a headless Chromium that shows the page, if there is one."""
    robot = cs.Robot.named("iiwa14")
    monitor = cs.ContactMonitor(robot, dt=DT, torque_threshold=THRESHOLD)
    block = BLOCK if pace.rounds > 10 else SHORT
    with ExitStack() as stack:
        with other_cores():
            page = stack.enter_context(cs.view(monitor, port=PORT))
            processes = [page._process.pid]
            browser = None
            if chromium() is not None:
                browser = stack.enter_context(Browser(*SIZE, script=COUNTS))
                browser.open(page.address)
                processes.append(-browser.process.pid)  # with all of its own
        loop = _Loop(robot, monitor, page)
        comparisons = [loop.ticks(processes, block, pace)]
        if browser is not None:
            comparisons.append(loop.instants(browser, block, pace))
    return comparisons


class _Loop:
    """An arm at rest that is pushed at its last link."""

    def __init__(self, robot: cs.Robot, monitor: cs.ContactMonitor, page: cs.View) -> None:
        self._monitor, self._page = monitor, page
        self._q, self._rest = np.array([0.3, 0.8, -0.4, -1.1, 0.5, 0.7, 0.0]), np.zeros(robot.nv)
        link = robot.link_names[-1]
        samples = robot.surface(link).sample(PARTICLES, seed=1)
        pose = robot.link_pose(self._q, link)
        self._points = samples.points @ pose[:3, :3].T + pose[:3, 3]
        pushed = robot.jacobian(self._q, link, self._points[0])[:3].T @ FORCE
        self._held = robot.inverse_dynamics(self._q, self._rest, self._rest) - pushed
        self._rng = np.random.default_rng(0)

    def ticks(self, processes: list[int], block: int, pace: Pace) -> Comparison:
        """Times of single ticks, in blocks in turns."""
        times: dict[bool, list[float]] = {True: [], False: []}
        for index in range(pace.rounds):
            for is_shown in (True, False) if index % 2 == 0 else (False, True):
                if is_shown:
                    times[True] += self._block(True, block, pace)
                else:
                    with _standing_still(processes):
                        times[False] += self._block(False, block, pace)
        timings = [
            Timing("contactsense, with a page", np.array(times[True])),
            Timing("contactsense, no page", np.array(times[False])),
        ]
        return Comparison("view, iiwa14, a tick at 1 kHz", timings, max_tail_ratio=MAX_TAIL_RATIO)

    def _block(self, is_shown: bool, block: int, pace: Pace) -> list[float]:
        noise = self._rng.normal(0.0, NOISE, (SETTLING + block, len(self._rest)))
        taken = []
        due = time.monotonic()
        for row in noise:
            due += DT
            time.sleep(max(0.0, due - time.monotonic()))
            tau = self._held + row
            start = pace.clock()
            report = self._monitor.update(self._q, self._rest, tau)
            if is_shown:
                self._page.show(self._q, report)
            taken.append(1e6 * (pace.clock() - start))
        assert report.collision
        return taken[SETTLING:]

    def instants(self, browser: Browser, block: int, pace: Pace) -> Comparison:
        """Time between two instants with particles that reach the page, and that it draws, by block."""
        report = self._monitor.update(self._q, self._rest, self._held)
        self._show_particles(report, 1.0)
        browser.wait_for("counts.drawn > 0")
        samples: dict[str, list[float]] = {"reached": [], "drawn": []}
        for _ in range(pace.rounds):
            before = browser.evaluate(NOW)
            self._show_particles(report, block * DT)
            after = browser.evaluate(NOW)
            for name, found in samples.items():
                found.append((after["time"] - before["time"]) / max(1, after[name] - before[name]))
        names = {"reached": "contactsense, reaches the page", "drawn": "drawn without a graphics card"}
        timings = [Timing(names[name], np.array(found)) for name, found in samples.items()]
        task = f"view, {PARTICLES:,} particles, between two instants"
        return Comparison(task, timings, max_us=MAX_BETWEEN, unit="ms")

    def _show_particles(self, report: cs.ContactReport, seconds: float) -> None:
        begun = time.monotonic()
        while (passed := time.monotonic() - begun) < seconds:
            self._page.show(self._q, report, self._points + 0.01 * np.sin(10.0 * passed))
            time.sleep(DT)


@contextmanager
def _standing_still(processes: list[int]) -> Iterator[None]:
    """Stops processes, or groups of them where the number is negative, meanwhile."""
    for process in processes:
        os.kill(process, signal.SIGSTOP)
    try:
        yield
    finally:
        for process in processes:
            os.kill(process, signal.SIGCONT)
