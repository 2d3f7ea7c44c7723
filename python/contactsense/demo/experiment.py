"""The control loop: simulate, hit, and ask the monitor once a tick."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

import numpy as np

from .. import ContactMonitor, ContactReport, Robot
from ..sim import ComputedTorqueController, Push, SimulatedRobot, TorqueNoise, named_model
from .plan import END, motion_figures, plan_hits, plan_motion
from .result import DemoResult, HitResult, Progress, Signals, Timing
from .score import HitScorer
from .settings import FloatArray, Noise, choose

DT = 0.001  # [s]
# A stiff position control, critically damped.
_KP, _KD = 2500.0, 100.0
_PROGRESS_TICKS = 50


def run_experiment(
    name: str, seed: int, noise: Noise, gain: float | None, on_progress: Callable[[Progress], None] | None
) -> DemoResult:
    """See `contactsense.demo.run`."""
    robot, model = Robot.named(name), named_model(name)
    motion = plan_motion(model, seed)
    speed, largest_torque = motion_figures(robot, motion)
    settings = choose(noise, largest_torque, DT, gain)
    hits = plan_hits(robot, motion, seed)
    torque_noise = TorqueNoise(percent=noise.percent, newton_metres=noise.newton_metres, seed=seed)
    arm = SimulatedRobot(model, dt=DT, noise=torque_noise)
    arm.reset(motion.at(0.0).q)
    controller = ComputedTorqueController(model, kp=_KP, kd=_KD)
    monitor = ContactMonitor(
        robot, dt=DT, observer_gain=settings.observer_gain, torque_threshold=settings.torque_threshold
    )

    waiting = [
        HitScorer(robot, hit, number, settings.torque_threshold, motion.at(hit.start + 0.5 * hit.duration).q)
        for number, hit in enumerate(hits, start=1)
    ]
    scored: list[HitResult] = []
    false_alarms = 0
    recorder = _Recorder(robot, hits)
    for tick in range(round(END / DT)):
        torque = controller.torque(arm.q, arm.v, motion.at(arm.time))
        arm.clear_forces()
        for hit in hits:
            hit.apply(arm)
        measured = arm.step(torque)

        before = perf_counter()
        report = monitor.update(measured.q, measured.v, measured.tau_mean)
        took = perf_counter() - before

        recorder.add(measured.time, measured.q, report, took)
        if waiting and waiting[0].covers(measured.time):
            waiting[0].update(measured.time, measured.q, report)
        else:
            false_alarms += report.onset
        done = bool(waiting) and measured.time > waiting[0].end
        if done:
            scored.append(waiting.pop(0).result())
        if on_progress is not None and (done or tick % _PROGRESS_TICKS == 0):
            sensed = report.contacts[0].link if report.contacts else ""
            on_progress(Progress(measured.time, END, tuple(scored), len(hits), settings, sensed))
    return DemoResult(
        robot_name=name,
        robot=robot,
        seed=seed,
        noise=noise,
        settings=settings,
        planned_speed=speed,
        hits=tuple(scored),
        false_alarms=false_alarms,
        signals=recorder.signals(),
        timing=recorder.timing(),
    )


class _Recorder:
    """Collects truth and estimate of every tick."""

    def __init__(self, robot: Robot, hits: tuple[Push, ...]) -> None:
        self._robot, self._hits = robot, hits
        self._rows: list[tuple[float, FloatArray, FloatArray, float, float, bool]] = []
        self._took: list[float] = []

    def add(self, time: float, q: FloatArray, report: ContactReport, took: float) -> None:
        true_torque, true_force = np.zeros(self._robot.nv), 0.0
        for hit in self._hits:
            if magnitude := hit.magnitude(time):
                point, force = hit.force_at(time, self._robot.link_pose(q, hit.link))
                true_torque += self._robot.jacobian(q, hit.link, point)[:3].T @ force
                true_force += magnitude
        located = [contact for contact in report.contacts if contact.located]
        force_now = float(np.linalg.norm(located[0].force)) if located else np.nan
        row = (time, true_torque, report.external_torque, true_force, force_now, report.collision)
        self._rows.append(row)
        self._took.append(took)

    def signals(self) -> Signals:
        time, true_torque, torque, true_force, force, collision = (
            np.array(column) for column in zip(*self._rows, strict=True)
        )
        return Signals(time, true_torque, torque, true_force, force, collision)

    def timing(self) -> Timing:
        return Timing(
            len(self._took), float(np.mean(self._took)), float(np.median(self._took)), max(self._took)
        )
