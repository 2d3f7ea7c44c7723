"""What a control loop gets from the simulated robot."""

from __future__ import annotations

from dataclasses import dataclass

from ._arrays import FloatArray


@dataclass(frozen=True)
class Measurement:
    """What the sensors give at one control tick.

    The motors hold `tau` from this tick to the next, so it jumps at every tick, and with it the loads of
    force/torque sensors. Feed `tau_mean` to whatever integrates torque over ticks by the trapezoidal rule: it
    is what a sensor reads that samples across the jump, and keeps the impulse right to second order. With
    `tau` itself such a rule is half a tick early. `wrenches` are such means, too.
    """

    time: float  # [s]
    q: FloatArray  # (nq,) Pinocchio's order
    v: FloatArray  # (nv,)
    tau: FloatArray  # (actuated,) motor torque from this tick on, with noise if any [Nm]
    tau_mean: FloatArray  # (actuated,) mean of the torques before and after this tick, same noise [Nm]
    wrenches: FloatArray  # (n_sensors, 6) mean of those before and after this tick, sensor frames [N, Nm]
