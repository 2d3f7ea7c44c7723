"""The monitor in a control loop at 1 kHz, on two kinds of drivers.

One calls back with a state and the period since the last call, as Franka's does. One sends positions and
torques over a network, as KUKA's FRI does: messages come late, in the wrong order or not at all. Both are
stand-ins here that play a simulated arm with the errors of a real one.

Requires MuJoCo: pip install '.[sim]'
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

import contactsense as cs
from contactsense import sim

DT = 0.001  # [s]
VELOCITY_FILTER = 0.005  # [s]
# 1.4 times the largest external torques of this motion without contact; a calibration allows lower ones.
THRESHOLD = [5.0, 6.0, 2.0, 2.8, 0.7, 0.5, 0.5]  # [Nm]
PUSH = sim.PersonContact(
    "iiwa_link_6", [0.0, 0.0, -0.08], [0.0, 5.0, 40.0], start=7.0, duration=0.5, rise=0.05
)

robot = cs.Robot.named("iiwa14")


@dataclass
class State:
    q: np.ndarray
    tau_J: np.ndarray  # the driver's name
    time: float  # of the measurement, by the robot's clock [s]
    dq: np.ndarray | None = None


def recorded() -> cs.Log:
    """10 s of a motion to and fro with a push; 2 % of the rows are lost, some 5 ms at a time."""
    time, pace = DT * np.arange(10_000), 2.5  # [s], [rad/s]
    middle = np.array([0.4, 0.6, 0.2, -1.1, 0.3, 0.7, 0.2])
    reach = np.array([0.5, 0.2, 0.3, 0.3, 0.3, -0.2, 0.3])
    q = middle - np.outer(np.cos(pace * time), reach)
    v, a = pace * np.outer(np.sin(pace * time), reach), pace**2 * (middle - q)
    arm = replace(sim.ImperfectArm.typical(robot, seed=1), dropped_ticks=0.02, drop_length=0.005, jitter=0.0)
    return sim.record_imperfect(robot, arm, sim.JointMotion(time, q, v, a), [PUSH], seed=2).log


def franka_like(log: cs.Log, callback: Callable[[State, float], None]) -> None:
    before = log.time[0] - DT
    for time, q, dq, tau in zip(log.time, log.q, log.v, log.tau, strict=True):
        callback(State(q, tau, time, dq), time - before)
        before = time


def fri_like(log: cs.Log) -> Iterator[State]:
    arrival = log.time + np.random.default_rng(0).exponential(0.0004, len(log))  # [s]
    for row in np.argsort(arrival):
        yield State(log.q[row], log.tau[row], log.time[row])


class Touch:
    """What the loops have in common, and the bookkeeping for the summary."""

    def __init__(self) -> None:
        self.monitor = cs.ContactMonitor(robot, dt=DT, torque_threshold=THRESHOLD, bias_time_constant=1.0)
        self.onsets: list[float] = []
        self.steps: list[float] = []
        self.seconds: list[float] = []

    def tick(self, state: State, v: np.ndarray, dt: float) -> None:
        begin = perf_counter()
        # Without `dt`, the lost steps of this motion would cause false contacts.
        report = self.monitor.update(state.q, v, state.tau_J, dt=dt)
        self.seconds.append(perf_counter() - begin)
        self.steps.append(dt)
        if report.onset:
            self.onsets.append(state.time)  # stop the robot here

    def summary(self, name: str) -> None:
        hits = [time for time in self.onsets if PUSH.start < time < PUSH.end]
        low, high = 1e3 * min(self.steps), 1e3 * max(self.steps)
        median, slowest = 1e6 * np.percentile(self.seconds, [50, 99.9])
        print(f"{name}: steps of {low:.0f} to {high:.0f} ms, {len(self.onsets) - len(hits)} false contacts")
        print(f"  onset {1e3 * (min(hits) - PUSH.start):.0f} ms after the start of the push")
        print(f"  a tick took {median:.0f} us, 99.9 % of all less than {slowest:.0f} us")


log = recorded()
touch = Touch()
franka_like(log, lambda state, period: touch.tick(state, state.dq, period))
touch.summary("franka-like")

touch, last, v = Touch(), None, np.zeros(robot.nv)
for state in fri_like(log):
    if last is not None:
        # The time between measurements, not between arrivals, which depends on the network.
        dt = state.time - last.time
        if dt <= 0.0:
            continue  # overtaken by a newer message
        v = v + (1.0 - np.exp(-dt / VELOCITY_FILTER)) * ((state.q - last.q) / dt - v)
        touch.tick(state, v, dt)
    last = state
touch.summary("fri-like")
