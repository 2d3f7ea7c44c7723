"""External torques over time, with contacts shaded."""

from __future__ import annotations

from collections import deque
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .._pictures import JOINTS

Rows = NDArray[np.float64]

_LEAST = 1.0  # to which the axis reaches at least [Nm]
_RECENT = 300  # instants of a control loop: ten seconds
_BETWEEN = 10  # instants until its plot is drawn anew


class TorquePlot:
    """A plot on a panel of viser; `show` draws other rows in it."""

    def __init__(self, gui: Any, robot: _core.Robot, time_name: str) -> None:
        names = robot.joint_names
        # Six variables of a floating base have one joint.
        self._labels = names if len(names) == robot.nv else [str(k) for k in range(robot.nv)]
        self._time_name = time_name
        self._bounds = (0.0, 0.0)
        self._plot: Any = None
        self._gui = gui

    def show(self, seconds: Rows, torques: Rows, contact: NDArray[np.bool_]) -> None:
        """Draws rows `(n,)`, `(n, nv)` and `(n,)`."""
        from viser import uplot

        low, high = float(torques.min(initial=0.0)), float(torques.max(initial=_LEAST))
        is_wider = low < self._bounds[0] or high > self._bounds[1]
        if is_wider:
            self._bounds = 1.1 * low, 1.1 * high
        # Bars from bottom to top where there is contact.
        bars = np.where(contact, self._bounds[1], self._bounds[0])
        data = (seconds.copy(), bars, *torques.T.copy())
        scales = {"x": uplot.Scale(time=False), "y": uplot.Scale(range=self._bounds)}
        if self._plot is None:
            self._plot = self._gui.add_uplot(
                data,
                self._series(),
                title="External torque [Nm]; contacts shaded",
                scales=scales,
                legend=uplot.Legend(show=len(self._labels) <= len(JOINTS)),
                aspect=1.5,
            )
            return
        if is_wider:
            self._plot.scales, self._plot.series = scales, self._series()
        self._plot.data = data

    def _series(self) -> tuple[Any, ...]:
        from viser import uplot

        bars = uplot.Series(label="contact", fill="rgba(213,94,0,0.2)", width=0, fillTo=self._bounds[0])
        return (
            uplot.Series(label=self._time_name),
            bars,
            *(
                uplot.Series(label=label, stroke=JOINTS[k % len(JOINTS)], width=1)
                for k, label in enumerate(self._labels)
            ),
        )


class RecentTorques:
    """The torques of the last seconds of a control loop."""

    def __init__(self, gui: Any, robot: _core.Robot) -> None:
        self._plot = TorquePlot(gui, robot, "t [s]")
        self._rows: deque[tuple[float, Rows, bool]] = deque(maxlen=_RECENT)
        self._count = 0
        self._plot.show(np.array([-1.0, 0.0]), np.zeros((2, robot.nv)), np.zeros(2, dtype=bool))

    def add(self, now: float, torque: Rows, is_contact: bool) -> None:
        """An instant at a time [s]; those before are at negative times."""
        self._rows.append((now, torque, is_contact))
        self._count += 1
        if self._count % _BETWEEN == 0:
            seconds, torques, contact = map(np.array, zip(*self._rows, strict=True))
            self._plot.show(seconds - now, torques, contact)
