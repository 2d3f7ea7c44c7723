"""External torque of motion without contact: what the model leaves unexplained."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..log import Log

Rows = NDArray[np.float64]

# Of the observer that low-passes it [1/s]: noise of the sensors hardly passes.
GAIN = 8.0
# The observer's first rows are still settling [s].
SETTLING = 3.0 / GAIN


def residuals(robot: _core.Robot, log: Log, calibration: _core.Calibration | None = None) -> Rows:
    """What a momentum observer sees `(n, nv)` [Nm]; of a log of external torque, that torque itself.

    Args:
        robot: of the log.
        log: motion without contact.
        calibration: what corrects the measurements, if any.
    """
    if log.tau is None:
        assert log.external_torque is not None  # a log has one of them
        bias = 0.0 if calibration is None else calibration.torque_bias
        return log.external_torque - bias
    given: dict[str, Any] = {} if calibration is None else {"calibration": calibration}
    steps = np.diff(log.time)
    observer = _core.MomentumObserver(robot, dt=float(np.median(steps)), gain=GAIN, **given)
    rows = zip(log.q, log.v, log.tau, [None, *steps.tolist()], strict=True)
    return np.array([observer.update(q, v, tau, dt=dt) for q, v, tau, dt in rows])


def settled(log: Log) -> NDArray[np.bool_]:
    """Rows after the observer has settled, `(n,)`; all of a short log."""
    late: NDArray[np.bool_] = log.time - log.time[0] > SETTLING
    return late if late.any() else np.ones(len(log), dtype=bool)
