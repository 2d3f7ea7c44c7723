"""The momentum observer as one would write it with Pinocchio and NumPy: the fastest form found."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class ReferenceObserver:
    """The same step as `MomentumObserver`: exponential decay, known rate by the trapezoidal rule.

    The mass matrix, the Coriolis matrix and gravity are asked for one by one: `computeAllTerms` and the
    derivatives of the inverse dynamics take longer.
    """

    def __init__(self, model: Any, *, dt: float, gain: float = 50.0) -> None:
        self.model = model
        self.data = model.createData()
        self.decay = float(np.exp(-gain * dt))
        self.rise = 1.0 - self.decay
        self.per_dt = 1.0 / dt
        self.base = 6 if model.njoints > 1 and model.joints[1].nv == 6 else 0
        self.torque = np.zeros(model.nv)
        self.momentum = np.zeros(model.nv)
        self.rate = np.zeros(model.nv)
        self.work = np.zeros(model.nv)
        self.started = False

    def update(self, q: FloatArray, v: FloatArray, tau: FloatArray) -> FloatArray:
        """External torque `(nv,)`, a fresh array; `tau` is `(nv,)`, or without the base's six."""
        model, data = self.model, self.data
        momentum = v.dot(pin.crba(model, data, q))  # symmetric, so from either side
        rate = v.dot(pin.computeCoriolisMatrix(model, data, q, v))  # C^T v
        rate -= pin.computeGeneralizedGravity(model, data, q)
        if len(tau) == len(rate):
            rate += tau
        else:
            rate[self.base :] += tau
        if self.started:
            work = self.work
            np.subtract(momentum, self.momentum, out=work)
            work *= self.per_dt
            self.rate += rate
            self.rate *= 0.5
            work -= self.rate
            work *= self.rise
            self.torque *= self.decay
            self.torque += work
        self.momentum, self.rate = momentum, rate
        self.started = True
        return self.torque.copy()
