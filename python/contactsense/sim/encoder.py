"""Positions and velocities as drives report them."""

from __future__ import annotations

import numpy as np

from ._arrays import FloatArray


def quantised(angles: FloatArray, bits: int | None, sliding: FloatArray) -> FloatArray:
    """(n, nv) positions as an encoder counts them: `2^bits` steps a turn, or a metre of a sliding joint."""
    if bits is None:
        return angles.copy()
    step = np.where(sliding, 1.0, 2.0 * np.pi) / 2.0**bits
    return step * np.round(angles / step)


def differenced(time: FloatArray, angles: FloatArray) -> FloatArray:
    """(n, nv) backward differences, half a tick late; the first row takes the second's."""
    v = np.diff(angles, axis=0) / np.diff(time)[:, None]
    return np.concatenate([v[:1], v])


def low_pass(time: FloatArray, signal: FloatArray, cutoff: float, order: int) -> FloatArray:
    """(n, nv) `signal` through `order` equal first-order stages of corner frequency `cutoff` [Hz].

    Each stage is late by `1 / (2 pi cutoff)` [s]. It starts settled at the first row.
    """
    share = 1.0 - np.exp(-2.0 * np.pi * cutoff * np.diff(time, prepend=time[0]))
    for _ in range(order):
        passed = signal.copy()
        for row in range(1, len(signal)):
            passed[row] = passed[row - 1] + share[row] * (signal[row] - passed[row - 1])
        signal = passed
    return signal


def delayed(time: FloatArray, signal: FloatArray, delay: FloatArray) -> FloatArray:
    """(n, nv) `signal` as it was `delay` (nv,) [s] ago, linear between rows, at rest before the first."""
    late = signal.copy()
    for joint in np.flatnonzero(delay):
        late[:, joint] = np.interp(time - delay[joint], time, signal[:, joint])
    return late
