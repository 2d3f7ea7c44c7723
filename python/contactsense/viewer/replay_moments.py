"""The instants of a replay."""

from __future__ import annotations

import numpy as np

from .. import _core
from ..offline import Replay
from .moment import NO_WRENCHES, NOWHERE, Cloud, Moment, Rows, Touch, posterior_of

# Acceleration is the change of the velocity over so long [s]: noise of single rows passes less.
_SPAN = 0.02


class ReplayMoments:
    """The instants of a replay, by row."""

    def __init__(self, result: Replay, contact_map: _core.ContactMap | None) -> None:
        self._result, self._map = result, contact_map
        rows = np.arange(len(result.ticks["time"]) + 1)
        # Contacts of row k are those from first[k] to first[k + 1].
        self._first = np.searchsorted(result.contact_ticks["row"], rows)
        has_readings = result.sensors and result.log.wrenches is not None
        self._loads = _core.LoadCompensator(result.robot, result.sensors) if has_readings else None

    def __len__(self) -> int:
        return len(self._result.ticks["time"])

    def at(self, row: int) -> Moment:
        """The instant of a row."""
        ticks = self._result.contact_ticks
        touches = tuple(
            Touch(
                str(ticks["link"][k]),
                float(ticks["link_probability"][k]),
                bool(ticks["located"][k]),
                ticks["point"][k],
                ticks["force"][k],
                float(ticks["region_radius"][k]),
            )
            for k in range(self._first[row], self._first[row + 1])
        )
        posterior = self._posterior(row) if len(touches) == 1 else NOWHERE
        return Moment(self._result.log.q[row], touches, posterior, wrenches=self._wrenches(row))

    def _posterior(self, row: int) -> Cloud:
        if self._map is None:
            return NOWHERE
        torque = self._result.ticks["external_torque"][row]
        return posterior_of(self._map.evaluate(self._result.log.q[row], torque))

    def _wrenches(self, row: int) -> Rows:
        log = self._result.log
        if self._loads is None or log.wrenches is None:
            return NO_WRENCHES
        near = [log.time[row] - _SPAN / 2, log.time[row] + _SPAN / 2]
        before, after = np.clip(np.searchsorted(log.time, near), 0, len(log) - 1)
        passed = log.time[after] - log.time[before]
        acceleration = (log.v[after] - log.v[before]) / passed if passed > 0.0 else np.zeros_like(log.v[row])
        return self._loads.update(log.q[row], log.v[row], acceleration, log.wrenches[row])
