"""Finds the weights: `python -m contactsense_studies.contact_classes.fit` prints them as Rust."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .arms import FITTED
from .judge import KINDS, Judged
from .options import Options
from .study import run

# Other scenes than those of any study with a small seed.
SEED, SCENES = 100, 195
# Penalty on the square of each weight but the constants, against more confidence than the scenes give.
RIDGE = 0.003
# Until this age [s], a contact has the weights of young ones; as in the core.
YOUNG = 0.15


def fit(features: np.ndarray, classes: np.ndarray, count: int, ridge: float = RIDGE) -> np.ndarray:
    """(count, n + 1) weights of softmax regression, the constant last, by Newton's method."""
    inputs = np.hstack([features, np.ones((len(features), 1))])
    rows, width = inputs.shape
    wanted = np.eye(count)[classes]
    penalty = np.full(width, 2.0 * ridge)
    # The constants' mean is free; a little of it keeps the matrix regular.
    penalty[-1] = 1e-9
    weights = np.zeros((count, width))
    for _ in range(50):
        logits = inputs @ weights.T
        shares = np.exp(logits - logits.max(axis=1, keepdims=True))
        shares /= shares.sum(axis=1, keepdims=True)
        slope = (shares - wanted).T @ inputs / rows + penalty * weights
        curve = np.diag(np.tile(penalty, count)).astype(float)
        for one in range(count):
            for two in range(count):
                factor = shares[:, one] * ((one == two) - shares[:, two])
                block = (inputs * factor[:, None]).T @ inputs / rows
                curve[one * width : (one + 1) * width, two * width : (two + 1) * width] += block
        step = np.linalg.lstsq(curve, slope.ravel(), rcond=None)[0].reshape(count, width)
        weights -= step
        if float(np.abs(step).max()) < 1e-8:
            break
    return weights


def weights_of(judged: Sequence[Judged]) -> dict[str, np.ndarray]:
    """(4, n + 1) by age: clamped, transient, sustained, intended."""
    found = {}
    for name in ("OF_YOUNG", "OF_LASTING", "OF_ENDED"):
        rows = [
            (answer, each.truth) for each in judged for answer in each.answers if _stage(answer.age) == name
        ]
        features = np.array([answer.scaled for answer, _ in rows])
        kinds = fit(features, np.array([KINDS.index(truth.kind) for _, truth in rows]), 3)
        intended = fit(features, np.array([int(truth.intended) for _, truth in rows]), 2)
        found[name] = np.vstack([kinds, intended[1] - intended[0]])
    return found


def _stage(age: float | None) -> str:
    if age is None:
        return "OF_ENDED"
    return "OF_YOUNG" if age < YOUNG else "OF_LASTING"


def main() -> None:
    """Prints the weights, and the shares of the scenes that they were found on."""
    judged = [each for each in run(Options(FITTED, SCENES, SEED)).judged if each.answers]
    shares = [float(np.mean([each.truth.kind == kind for each in judged])) for kind in KINDS]
    print(f"SHARES: {np.round(shares, 3).tolist()}")
    print(f"INTENDED: {np.mean([each.truth.intended for each in judged]):.3f}")
    for name, weights in weights_of(judged).items():
        print(f"pub(super) const {name}: Weights = {np.round(weights, 2).tolist()};")


if __name__ == "__main__":
    main()
