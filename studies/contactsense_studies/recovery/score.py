"""Errors of many calibrations in a few figures."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from contactsense.sim._arrays import FloatArray

from .recover import Recovery

# Two-sided 90 % of a normal distribution, in standard deviations.
COVERED = 1.645


def covered(errors: Iterable[FloatArray], deviations: Iterable[FloatArray]) -> float:
    """The share of errors within the stated 90 %."""
    pairs = zip(errors, deviations, strict=True)
    return float(np.mean(np.concatenate([np.abs(e) <= COVERED * d for e, d in pairs])))


def table(runs: list[Recovery]) -> dict[str, float]:
    """Medians and 90th percentiles of the errors, and the shares that the stated uncertainty covers."""

    def both(name: str, errors: list[FloatArray]) -> dict[str, float]:
        sizes = np.abs(np.concatenate(errors))
        return {name: float(np.median(sizes)), f"{name}_90": float(np.quantile(sizes, 0.9))}

    mass, mass_std = [np.atleast_1d(r.mass) for r in runs], [np.atleast_1d(r.mass_std) for r in runs]
    return {
        **both("bias", [r.bias for r in runs]),
        "bias_covered": covered([r.bias for r in runs], [r.bias_std for r in runs]),
        **both("coulomb", [r.coulomb / r.coulomb_true for r in runs]),
        "coulomb_covered": covered([r.coulomb for r in runs], [r.coulomb_std for r in runs]),
        **both("noise", [r.noise - 1.0 for r in runs]),
        **both("mass", mass),
        "mass_covered": covered(mass, mass_std),
        **both("com", [np.atleast_1d(np.linalg.norm(r.com)) for r in runs]),
        "com_covered": covered([r.com for r in runs], [r.com_std for r in runs]),
    }
