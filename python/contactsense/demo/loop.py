"""The control loop: simulate, push, and ask the monitor once a tick."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from .. import ContactMonitor, ContactReport, Robot
from ..errors import ContactSenseError
from ..sim import Measurement, Push, SimulatedRobot, TorqueNoise, WrenchNoise, random_push
from ..sim.sampling import blocked
from .result import DemoResult, HitResult, Progress, Signals, Standing, Timing
from .score import HitScorer, strongest
from .settings import DT, FloatArray, Settings

_PROGRESS_TICKS = 50
_TRIES = 1000


@dataclass(frozen=True)
class Setup:
    """A robot that is ready to be pushed."""

    name: str
    robot: Robot
    simulated: SimulatedRobot
    monitor: ContactMonitor
    settings: Settings
    pushes: tuple[Push, ...]
    end: float  # of the run [s]
    control: Callable[[float], FloatArray]  # torque of the motors at a time
    planned: Callable[[float], FloatArray]  # posture at a time
    speed: float = 0.0  # fastest joint of the planned motion [rad/s]
    standing: Callable[[list[Measurement]], Standing] | None = None  # how it stood, if it did


def run_loop(
    setup: Setup,
    seed: int,
    noise: TorqueNoise,
    sensor_noise: WrenchNoise,
    on_progress: Callable[[Progress], None] | None,
) -> DemoResult:
    """Runs the robot to the end, pushes it, and scores what its monitor says."""
    robot, simulated, settings = setup.robot, setup.simulated, setup.settings
    waiting = [
        HitScorer(
            robot, push, number, settings.torque_threshold, setup.planned(push.start + 0.5 * push.duration)
        )
        for number, push in enumerate(setup.pushes, start=1)
    ]
    scored: list[HitResult] = []
    false_alarms = 0
    recorder = _Recorder(robot, setup.pushes)
    for tick in range(round(setup.end / DT)):
        time = tick * DT
        torque = setup.control(time)
        simulated.clear_forces()
        for push in setup.pushes:
            point, force = push.force_at(time + 0.5 * DT, simulated.link_pose(push.link))
            if force.any():
                simulated.apply_force(push.link, point, force)
        measured = simulated.step(torque)

        before = perf_counter()
        report = observe(setup.monitor, measured)
        took = perf_counter() - before

        recorder.add(time, measured, report, took)
        if waiting and waiting[0].covers(time):
            waiting[0].update(time, measured.q, report)
        else:
            false_alarms += report.onset
        done = bool(waiting) and time > waiting[0].end
        if done:
            scored.append(waiting.pop(0).result())
        if on_progress is not None and (done or tick % _PROGRESS_TICKS == 0):
            contact = strongest(report)
            sensed = "" if contact is None else contact.link
            on_progress(Progress(time, setup.end, tuple(scored), len(setup.pushes), settings, sensed))
    return DemoResult(
        robot_name=setup.name,
        robot=robot,
        seed=seed,
        noise=noise,
        sensor_noise=sensor_noise,
        settings=settings,
        planned_speed=setup.speed,
        hits=tuple(scored),
        false_alarms=false_alarms,
        signals=recorder.signals(),
        timing=recorder.timing(),
        standing=None if setup.standing is None else setup.standing(recorder.measured),
    )


def observe(monitor: ContactMonitor, measured: Measurement) -> ContactReport:
    """What the monitor says of one tick."""
    readings = [measured.wrenches] if len(measured.wrenches) else []
    return monitor.update(measured.q, measured.v, measured.tau_mean, *readings)


def free_push(
    robot: Robot,
    q: FloatArray,
    link: str,
    *,
    start: float,
    duration: float,
    force: float,
    generator: np.random.Generator,
) -> Push:
    """A half-sine at a random point of `link`, within 30 degrees of the inward normal.

    What pushes comes along a straight line: points whose line of force is barred by the robot in the posture
    `q` are redrawn.

    Raises:
        ContactSenseError: no line to the link is free.
    """
    surface, pose = robot.surface(link), robot.link_pose(q, link)
    for _ in range(_TRIES):
        seed = int(generator.integers(2**31))
        push = random_push(link, surface, peak_force=force, start=start, duration=duration, seed=seed)
        point, along = push.force_at(start + 0.5 * duration, pose)
        if not blocked(robot, q, link, point[None], along[None] / np.linalg.norm(along))[0]:
            return push
    raise ContactSenseError(f"seed: no straight line to '{link}' is free at {start:.1f} s; try another seed")


class _Recorder:
    """Collects truth and estimate of every tick."""

    def __init__(self, robot: Robot, pushes: tuple[Push, ...]) -> None:
        self._robot, self._pushes = robot, pushes
        self._rows: list[tuple[float, FloatArray, FloatArray, float, float, bool]] = []
        self._took: list[float] = []
        self.measured: list[Measurement] = []

    def add(self, time: float, measured: Measurement, report: ContactReport, took: float) -> None:
        true_torque, true_force = np.zeros(self._robot.nv), 0.0
        for push in self._pushes:
            if magnitude := push.magnitude(time):
                point, force = push.force_at(time, self._robot.link_pose(measured.q, push.link))
                true_torque += self._robot.jacobian(measured.q, push.link, point)[:3].T @ force
                true_force += magnitude
        contact = strongest(report)
        located = contact is not None and contact.located
        force_now = float(np.linalg.norm(contact.force)) if contact is not None and located else np.nan
        row = (time, true_torque, report.external_torque, true_force, force_now, report.collision)
        self._rows.append(row)
        self._took.append(took)
        self.measured.append(measured)

    def signals(self) -> Signals:
        return Signals(*(np.array(column) for column in zip(*self._rows, strict=True)))

    def timing(self) -> Timing:
        took = self._took
        return Timing(len(took), float(np.mean(took)), float(np.median(took)), max(took))
