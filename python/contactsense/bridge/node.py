"""The bridge proper, which knows no transport: joint states in, torques, contacts and markers out."""

from __future__ import annotations

import time

import numpy as np

from ..errors import InputError
from ..robot import Robot
from .assemble import monitor_of
from .configuration import Configuration
from .counts import Counts, HealthReport
from .drawn import Drawn
from .joint_order import JointOrder, MissingJointsError, OtherJointsError
from .stamps import LateError, Stamps
from .values import ExternalTorque, Health, JointReading, LinkWrench, Published, Row

# Between two diagnostics, of every transport [s].
PERIOD = 1.0
# Steps longer than so many configured ones leave a gap.
_GAP = 5.0
# Characters of a reason that are kept: it may tell of what was received.
_LONGEST_REASON = 200


class ContactNode:
    """Finds contacts in joint states. One thread at a time may use it.

    Nothing that arrives raises: what cannot be used is counted, and the diagnostics say why.

    Args:
        configuration: what to do.
        robot: the robot of the configuration.

    Attributes:
        counts: what came and what became of it.
    """

    def __init__(self, configuration: Configuration, robot: Robot) -> None:
        self._monitor = monitor_of(configuration, robot)
        self._robot = robot
        self._joints = JointOrder(robot)
        self._constants = self._joints.one_each("torque_constants", configuration.torque_constants)
        self._is_external = configuration.effort == "external"
        self._torques_to = configuration.external_torque_topic
        self._located_to, self._others_to = configuration.contacts_topic, configuration.not_located_topic
        self._markers_to, self._health_to = configuration.markers_topic, configuration.diagnostics
        self._stamps = Stamps(_GAP / configuration.rate)
        frame = configuration.frame or robot.all_link_names[0]
        self._drawn = Drawn(frame, configuration.marker_rate)
        self._row_of = {sensor.topic: k for k, sensor in enumerate(configuration.sensors.values())}
        self._wrenches = np.full((len(self._row_of), 6), np.nan)
        self._wrench_times = np.full(len(self._row_of), -np.inf)
        self._timeout = configuration.wrench_timeout
        self._health = HealthReport(robot.name, configuration.rate)
        self._links: tuple[str, ...] = ()
        self._left_out: tuple[str, ...] = ()
        self._collision = False
        self.counts = Counts()

    def start(self, now: float) -> None:
        """Messages may come from now on [s, of a clock that is never set]."""
        self._health.start(now)

    def take(self, message: JointReading, now: float) -> list[Published]:
        """Takes in a joint state.

        Args:
            message: as it came.
            now: [s], of a clock that is never set.

        Returns:
            What is to be published, in the order of its haste.
        """
        self.counts.received += 1
        begun = time.perf_counter()
        try:
            published = self._tick(message, now)
        except OtherJointsError:
            self.counts.other_joints += 1
            return []
        except LateError as error:
            self.counts.late += 1
            self._refused(str(error))
            return []
        except MissingJointsError as error:
            self._health.missing = error.missing
            self._refused(str(error))
            return []
        except InputError as error:
            self._refused(str(error))
            return []
        except Exception as error:  # of a message that no one thought of; the next one counts
            self._refused(f"{type(error).__name__}: {error}")
            return []
        taken = time.perf_counter() - begun
        self.counts.taken += 1
        self.counts.tick_time += taken
        self._health.longest_tick = max(self._health.longest_tick, taken)
        return published

    def take_wrench(self, topic: str, reading: Row, now: float) -> None:
        """Keeps the newest reading `(6,)` of the sensor of a topic [N, Nm]; what is not finite is none."""
        row = self._row_of.get(topic)
        if row is not None:
            self._wrenches[row] = reading if np.isfinite(reading).all() else np.nan
            self._wrench_times[row] = now

    def refuse(self, reason: str) -> None:
        """Counts a joint state that is none."""
        self.counts.received += 1
        self._refused(reason)

    def refuse_wrench(self, reason: str) -> None:
        """Counts a reading of a sensor that is none."""
        self._refused(reason)

    def lose(self, number: int) -> None:
        """Counts messages that did not arrive."""
        self.counts.lost += number

    def health(self, stamp: int, now: float) -> Published:
        """The diagnostics, with their topic."""
        stamps = self._stamps
        state = {
            "collision": str(self._collision).lower(),
            "links": ", ".join(self._links),
            "gaps": str(stamps.gaps),
            "longest gap [s]": f"{stamps.longest_gap:.3f}",
            "clock set back": str(stamps.restarts),
            "sensors without reading": ", ".join(self._left_out),
        }
        silent = self._left_out and f"no reading of {', '.join(self._left_out)}"
        report: Health = self._health.report(stamp, now, self.counts, state, silent or "")
        return self._health_to, report

    def summary(self) -> str:
        """One line for people."""
        counts = self.counts
        refused = f" (last: {self._health.reason})" if counts.refused else ""
        return (
            f"{counts.received} joint states, {counts.taken} taken in, {counts.refused} refused{refused}, "
            f"{counts.lost} lost; {counts.contacts} contacts"
        )

    def _tick(self, message: JointReading, now: float) -> list[Published]:
        q, v, effort = self._joints.vectors(message)
        effort *= self._constants
        if self._stamps.is_restart(message.stamp):
            self._monitor.reset()
        step = self._stamps.step(message.stamp)
        if self._is_external:
            report = self._monitor.update_external(q, effort, self._readings(now), v=v, dt=step)
        else:
            report = self._monitor.update(q, v, effort, self._readings(now), dt=step)
        self._stamps.accept(message.stamp, step)
        self._collision, self._links = report.collision, report.links
        self._left_out = report.sensors_left_out
        self.counts.contacts += report.onset
        torque = self._joints.torques(report.external_torque)
        published: list[Published] = [
            (self._torques_to, ExternalTorque(message.stamp, self._joints.names, torque))
        ]
        for contact in report.contacts:
            wrench = contact.wrench
            if np.isfinite(wrench).all():
                to_world = self._robot.link_pose(q, contact.link)[:3, :3]
                turned = (wrench.reshape(2, 3) @ to_world).ravel()
                topic = self._located_to if contact.located else self._others_to
                published.append((topic, LinkWrench(message.stamp, contact.link, turned)))
        drawings = self._drawn.update(
            message.stamp, now, report.contacts, lambda link: self._robot.link_pose(q, link)
        )
        if drawings is not None:
            published.append((self._markers_to, drawings))
        return published

    def _readings(self, now: float) -> Row | None:
        """Of the sensors; old ones are none."""
        if not len(self._wrenches):
            return None
        self._wrenches[now - self._wrench_times > self._timeout] = np.nan
        return self._wrenches

    def _refused(self, reason: str) -> None:
        self.counts.refused += 1
        self._health.reason = reason[:_LONGEST_REASON]
