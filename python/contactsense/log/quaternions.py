"""Rows of unit quaternions (x, y, z, w), which turn vectors of a body into those of the world."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

Rows = NDArray[np.float64]

# Sine of half an angle up to which an arc is straight: the error of its length is a sixth of its square.
_STRAIGHT = 1e-8


def continuous(quaternions: Rows) -> Rows:
    """The same rotations at length one, each with the sign that is nearer to the row before."""
    unit = quaternions / np.linalg.norm(quaternions, axis=1)[:, None]
    flips = np.einsum("nk,nk->n", unit[1:], unit[:-1]) < 0.0
    signs = np.where(np.cumsum(flips) % 2 == 1, -1.0, 1.0)
    return np.concatenate([unit[:1], unit[1:] * signs[:, None]])


def product(a: Rows, b: Rows) -> Rows:
    """First `b`, then `a`."""
    va, wa, vb, wb = a[..., :3], a[..., 3:], b[..., :3], b[..., 3:]
    vector = wa * vb + wb * va + np.cross(va, vb)
    scalar = wa * wb - np.sum(va * vb, axis=-1, keepdims=True)
    return np.concatenate([vector, scalar], axis=-1)


def inverse(quaternions: Rows) -> Rows:
    """The rotation back."""
    return quaternions * [-1.0, -1.0, -1.0, 1.0]


def rotated(quaternions: Rows, vectors: Rows) -> Rows:
    """Vectors of the body in the axes of the world."""
    axis, w = quaternions[..., :3], quaternions[..., 3:]
    twice = 2.0 * np.cross(axis, vectors)
    return np.asarray(vectors + w * twice + np.cross(axis, twice))


def rotation_vectors(quaternions: Rows) -> Rows:
    """Axis times angle, up to half a turn [rad]."""
    near = np.where(quaternions[:, 3:] < 0.0, -quaternions, quaternions)
    sine = np.linalg.norm(near[:, :3], axis=1)
    angle = 2.0 * np.arctan2(sine, near[:, 3])
    factor = np.where(sine > _STRAIGHT, angle / np.maximum(sine, _STRAIGHT), 2.0)
    return np.asarray(near[:, :3] * factor[:, None])


def of_matrix(rotation: Rows) -> Rows:
    """`(4,)` of a rotation matrix `(3, 3)`, with a `w` that is not negative."""
    found: Rows = np.array(pin.Quaternion(np.asarray(rotation)).normalized().coeffs())
    return found if found[3] >= 0.0 else -found


def slerp(time: Rows, quaternions: Rows, even: Rows) -> Rows:
    """Rotations at other times, each on the shortest arc between the rows around it."""
    after = np.clip(np.searchsorted(time, even, side="right"), 1, len(time) - 1)
    first, second = quaternions[after - 1], quaternions[after]
    share = np.clip((even - time[after - 1]) / (time[after] - time[after - 1]), 0.0, 1.0)
    arc = share[:, None] * rotation_vectors(product(inverse(first), second))
    half = 0.5 * np.linalg.norm(arc, axis=1)[:, None]
    step = np.concatenate([0.5 * arc * np.sinc(half / np.pi), np.cos(half)], axis=1)
    return continuous(product(first, step))
