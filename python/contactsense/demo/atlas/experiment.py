"""The control loop: stand, be pushed, and ask the monitor once a tick."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

import numpy as np

from ... import ContactMonitor, ContactReport, Robot
from ...sim import (
    FLOOR_TYPE,
    Floor,
    Measurement,
    Push,
    SimulatedRobot,
    TorqueNoise,
    WrenchNoise,
    named_geoms,
    named_model,
)
from ...sim.atlas import FEET, controller, posture
from ..result import DemoResult, HitResult, Progress, Signals, Standing, Timing
from ..score import HitScorer, strongest
from ..settings import FloatArray, Noise, Settings
from .plan import END, plan_pushes
from .settings import SENSORS, SensorNoise, StandingSettings, choose

DT = 0.001  # [s]
# Before the run the robot settles on its soles; the monitor watches the last part, in which it starts up [s].
_SETTLING, _WATCHED = 1.0, 0.2
_PROGRESS_TICKS = 50
# The chest is 0.6 m wide, and thresholds are six standard deviations of the torques or more.
LOCATE_WITHIN = 0.1  # [m]


def run_experiment(
    seed: int,
    noise: Noise,
    sensor_noise: SensorNoise,
    gain: float | None,
    on_progress: Callable[[Progress], None] | None,
) -> DemoResult:
    """See `contactsense.demo.run`."""
    robot, model = Robot.named("atlas"), named_model("atlas")
    q = posture(model, seed)
    control = controller(model, q)
    settings = choose(robot, q, control.torque(q, np.zeros(model.nv)), noise, sensor_noise, DT, gain)
    shown = Settings(settings.observer_gain, settings.torque_threshold)
    pushes = plan_pushes(robot, q, seed)
    atlas = SimulatedRobot(
        model,
        dt=DT,
        geoms=named_geoms("atlas", conaffinity=FLOOR_TYPE),
        floor=Floor(),
        sensors=SENSORS,
        noise=TorqueNoise(percent=noise.percent, newton_metres=noise.newton_metres, seed=seed),
        wrench_noise=WrenchNoise(
            newtons=sensor_noise.newtons, newton_metres=sensor_noise.newton_metres, seed=seed
        ),
    )
    monitor = ContactMonitor(
        robot,
        dt=DT,
        sensors=SENSORS,
        wanted_contacts=FEET,
        observer_gain=settings.observer_gain,
        torque_threshold=settings.torque_threshold,
        wrench_threshold=settings.wrench_threshold,
        locate_within=LOCATE_WITHIN,
    )
    atlas.reset(q)
    for tick in range(round(_SETTLING / DT)):
        measured = atlas.step(control.torque(atlas.q, atlas.v))
        if tick >= round((_SETTLING - _WATCHED) / DT):
            monitor.update(measured.q, measured.v, measured.tau_mean, measured.wrenches)

    waiting = [
        HitScorer(robot, push, number, settings.torque_threshold, q)
        for number, push in enumerate(pushes, start=1)
    ]
    scored: list[HitResult] = []
    false_alarms = 0
    recorder = _Recorder(robot, pushes, atlas.q)
    for tick in range(round(END / DT)):
        time = tick * DT
        torque = control.torque(atlas.q, atlas.v)
        atlas.clear_forces()
        for push in pushes:
            point, force = push.force_at(time + 0.5 * DT, atlas.link_pose(push.link))
            if force.any():
                atlas.apply_force(push.link, point, force)
        measured = atlas.step(torque)

        before = perf_counter()
        report = monitor.update(measured.q, measured.v, measured.tau_mean, measured.wrenches)
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
            on_progress(Progress(time, END, tuple(scored), len(pushes), shown, sensed))
    return DemoResult(
        robot_name="atlas",
        robot=robot,
        seed=seed,
        noise=noise,
        settings=shown,
        planned_speed=0.0,
        hits=tuple(scored),
        false_alarms=false_alarms,
        signals=recorder.signals(),
        timing=recorder.timing(),
        standing=recorder.standing(settings, sensor_noise),
    )


class _Recorder:
    """Collects truth and estimate of every tick."""

    def __init__(self, robot: Robot, pushes: tuple[Push, ...], start: FloatArray) -> None:
        self._robot, self._pushes, self._start = robot, pushes, start
        self._feet = [index for index, sensor in enumerate(SENSORS) if sensor.name in FEET]
        self._rows: list[tuple[float, FloatArray, FloatArray, float, float, bool]] = []
        self._ground: list[FloatArray] = []
        self._took: list[float] = []
        self._moved = self._turned = 0.0

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
        self._ground.append(np.linalg.norm(measured.wrenches[self._feet, :3], axis=1))
        self._took.append(took)
        self._moved = max(self._moved, float(np.linalg.norm(measured.q[:3] - self._start[:3])))
        # The scalar product of quaternions is the cosine of half the angle between them.
        cosine = min(1.0, abs(float(measured.q[3:7] @ self._start[3:7])))
        self._turned = max(self._turned, 2.0 * float(np.arccos(cosine)))

    def signals(self) -> Signals:
        time, true_torque, torque, true_force, force, collision = (
            np.array(column) for column in zip(*self._rows, strict=True)
        )
        return Signals(time, true_torque, torque, true_force, force, collision)

    def timing(self) -> Timing:
        return Timing(
            len(self._took), float(np.mean(self._took)), float(np.median(self._took)), max(self._took)
        )

    def standing(self, settings: StandingSettings, noise: SensorNoise) -> Standing:
        return Standing(
            feet=FEET,
            ground=np.array(self._ground),
            moved=self._moved,
            turned=self._turned,
            sensor_noise=(noise.newtons, noise.newton_metres),
            wrench_threshold=settings.wrench_threshold,
        )
