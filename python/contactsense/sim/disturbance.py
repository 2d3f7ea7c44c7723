"""What stands between a true external torque and the one that is measured."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from ._arrays import FloatArray, not_negative
from .noise import TorqueNoise


@dataclass(frozen=True)
class TorqueError:
    """Errors of the external torque, as a filter gets it.

    `measured_i = tau_i + percent/100 |tau_i| e + newton_metres e' + bias_i`, with `e`, `e'` standard normal
    and new in every sample and joint. So `percent` is of each joint's present external torque (Bimbo 2019,
    Fig. 5: "standard deviation of noise is 10% of the measured signal"), not of the motor torque, most of
    which is gravity.
    """

    percent: float = 0.0
    newton_metres: float = 0.0  # [Nm]
    bias: float = 0.0  # standard deviation of each joint's constant error, drawn once a run [Nm]
    seed: int = 0

    def __post_init__(self) -> None:
        for name in ("percent", "newton_metres", "bias"):
            not_negative(name, getattr(self, name))

    def measure(self, torques: ArrayLike) -> FloatArray:
        """(T, nv) external torques of one run as they would be measured; the same for the same seed."""
        true = np.array(torques, dtype=np.float64)
        noise = TorqueNoise(percent=self.percent, newton_metres=self.newton_metres, seed=self.seed)
        bias = self.bias * np.random.default_rng([self.seed, 1]).standard_normal(true.shape[1])
        return np.array([noise.measure(row) for row in true]).reshape(true.shape) + bias

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return asdict(self)


def perturbed_model(
    model: pin.Model,
    *,
    mass: float = 0.0,
    centre: float = 0.0,
    inertia: float = 0.0,
    seed: int = 0,
) -> pin.Model:
    """A copy of `model` with other masses: the true robot, where a nominal model is all that is known.

    Args:
        model: what is known of the robot; it is left as it is.
        mass: standard deviation of each body's mass, as a share of it (0.05: 5 %); rotational inertia
            follows.
        centre: of each coordinate of its centre of mass [m].
        inertia: of its rotational inertia as a whole, as a share, besides what follows from the mass.
        seed: same seed, same robot.

    Factors stay between a half and double.
    """
    for name, value in (("mass", mass), ("centre", centre), ("inertia", inertia)):
        not_negative(name, value)
    rng = np.random.default_rng(seed)
    changed = pin.Model(model)
    for index in range(1, model.njoints):
        body = model.inertias[index]
        heavier, rounder = np.clip(1.0 + np.array([mass, inertia]) * rng.standard_normal(2), 0.5, 2.0)
        shift = centre * rng.standard_normal(3)
        changed.inertias[index] = pin.Inertia(
            float(body.mass * heavier),
            body.lever + shift,
            body.inertia * heavier * rounder,
        )
    return changed
