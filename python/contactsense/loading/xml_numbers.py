"""Numbers and placements as URDF attributes write them."""

from __future__ import annotations

import math
import re
from xml.etree.ElementTree import Element

import numpy as np

from ..errors import ContactSenseError
from .description import FloatArray

# Narrower than float(): no "nan", "inf", "1_000" or digits of other scripts.
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)

# Far beyond any robot, and small enough that products stay finite.
_LARGEST = 1e12


def parse_numbers(
    text: str, count: int, what: str, error: type[ContactSenseError], largest: float = _LARGEST
) -> list[float]:
    """`count` finite numbers separated by white space, or `error` with `what` in its message."""
    words = text.split()
    values = [float(word) if _NUMBER.fullmatch(word) else math.nan for word in words]
    # A comparison with nan is false.
    if len(words) != count or not all(abs(value) <= largest for value in values):
        wanted = "a finite number" if count == 1 else f"{count} finite numbers"
        if largest == _LARGEST:
            wanted += f" of magnitude up to {largest:g}"
        raise error(f"{what} must be {wanted}, not '{text[:80]}'")
    return values


def number_attribute(
    element: Element,
    name: str,
    owner: str,
    error: type[ContactSenseError],
    default: float | None = None,
    largest: float = _LARGEST,
) -> float:
    """One number of an element; `owner` opens the error message."""
    text = element.get(name)
    if text is None:
        if default is None:
            raise error(f"{owner}: <{element.tag}> needs the attribute '{name}'")
        return default
    return parse_numbers(text, 1, f"{owner}: '{name}' of <{element.tag}>", error, largest)[0]


def origin(element: Element, owner: str, error: type[ContactSenseError]) -> tuple[list[float], list[float]]:
    """`xyz` [m] and `rpy` [rad] of the element's <origin>, zero where left out."""
    found = element.find("origin")
    if found is None:
        return [0.0] * 3, [0.0] * 3
    xyz, rpy = (
        parse_numbers(found.get(name, "0 0 0"), 3, f"{owner}: '{name}' of <origin>", error)
        for name in ("xyz", "rpy")
    )
    return xyz, rpy


def placement(xyz: list[float], rpy: list[float]) -> FloatArray:
    """(4, 4) pose of a URDF origin: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    pose = np.eye(4)
    pose[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    pose[:3, 3] = xyz
    return pose
