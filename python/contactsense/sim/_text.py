"""Numbers as MJCF attributes, without loss."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pinocchio as pin

from ._arrays import FloatArray


def text(values: Iterable[float]) -> str:
    """Numbers with all their digits, separated by blanks."""
    return " ".join(repr(float(value)) for value in values)


def pose_attributes(pose: FloatArray) -> dict[str, str]:
    """`pos` and `quat` (w, x, y, z) of a (4, 4) pose."""
    x, y, z, w = pin.Quaternion(np.ascontiguousarray(pose[:3, :3])).coeffs()
    return {"pos": text(pose[:3, 3]), "quat": text((w, x, y, z))}
