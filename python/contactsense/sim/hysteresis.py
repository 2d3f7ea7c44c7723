"""Hysteresis of gears and torque sensors."""

from __future__ import annotations

import numpy as np

from ._arrays import FloatArray

# Half widths of the play elements as shares of the rated torque. Each is twice the one before, which makes
# what stays proportional to the excursion, from the first width on to twice the last. Contacts of a person
# are 1 to 20 % of what an arm is rated for.
_WIDTHS = (0.01, 0.02, 0.04, 0.08)


def with_hysteresis(torque: FloatArray, share: FloatArray, rated: FloatArray) -> FloatArray:
    """Torques as they come through a gear with hysteresis: `torque + share sum_k (play_k(torque) - torque)`.

    A sum of play elements (Prandtl and Ishlinskii): independent of the rate, exact at the first row. When a
    torque rises by `A` and falls back, `share (A - 1 %)` stays, at most `share 15 %`, in shares of the rated
    torque. At its peak it reads low by `share A` where it is large, and by up to four times that where it is
    about 1 % of the rated torque: gears are less stiff against small torques.

    Args:
        torque: (n, nv) [Nm].
        share: (nv,) of a change of torque that stays after the change is undone.
        rated: (nv,) rated torque [Nm].
    """
    if not share.any():
        return torque.copy()
    widths = np.outer(_WIDTHS, rated)
    low, high = torque[:, None, :] - widths, torque[:, None, :] + widths
    state = np.repeat(torque[:1], len(_WIDTHS), axis=0)
    lag = np.empty_like(torque)
    for row in range(len(torque)):
        np.maximum(state, low[row], out=state)
        np.minimum(state, high[row], out=state)
        lag[row] = state.sum(axis=0)
    lag -= len(_WIDTHS) * torque
    return torque + share * lag
