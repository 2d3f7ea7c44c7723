"""Rows of quaternions, by the rotations of Pinocchio."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from numpy.typing import NDArray

from contactsense.log import quaternions as rows

Rows = NDArray[np.float64]


@pytest.fixture
def turns() -> Rows:
    """Random ones, none at all, tiny ones and half turns."""
    random = np.random.default_rng(4).normal(size=(60, 4))
    special = [[0, 0, 0, 1], [1e-9, 0, 0, 1], [0, 1e-4, 0, 1], [1, 0, 0, 0], [0, 0.6, 0.8, 1e-12]]
    found = np.concatenate([random, special])
    return np.asarray(found / np.linalg.norm(found, axis=1)[:, None])


def matrices(quaternions: Rows) -> Rows:
    return np.array([pin.Quaternion(row).matrix() for row in quaternions])


def test_products_and_rotated_vectors(turns: Rows) -> None:
    others, vectors = turns[::-1], np.random.default_rng(5).normal(size=(len(turns), 3))
    products = matrices(rows.product(turns, others))
    np.testing.assert_allclose(products, matrices(turns) @ matrices(others), atol=1e-14)
    expected = np.einsum("nij,nj->ni", matrices(turns), vectors)
    np.testing.assert_allclose(rows.rotated(turns, vectors), expected, atol=1e-14)
    np.testing.assert_allclose(rows.rotated(rows.inverse(turns), expected), vectors, atol=1e-13)


def test_rotation_vectors_are_logarithms(turns: Rows) -> None:
    vectors = rows.rotation_vectors(turns)
    assert np.linalg.norm(vectors, axis=1).max() <= np.pi + 1e-12
    np.testing.assert_allclose([pin.exp3(vector) for vector in vectors], matrices(turns), atol=1e-12)
    # Tiny ones keep all their digits.
    np.testing.assert_allclose(vectors[61], [2e-9, 0.0, 0.0], rtol=1e-12)


def test_matrices_give_their_quaternions(turns: Rows) -> None:
    found = np.array([rows.of_matrix(matrix) for matrix in matrices(turns)])
    np.testing.assert_allclose(matrices(found), matrices(turns), atol=1e-13)


def test_signs_and_lengths_are_made_continuous(turns: Rows) -> None:
    signs = np.random.default_rng(6).choice([-1.0, 1.0], len(turns)) * np.linspace(0.5, 3.0, len(turns))
    found = rows.continuous(turns * signs[:, None])
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, atol=1e-15)
    assert np.all(np.sum(found[1:] * found[:-1], axis=1) >= 0.0)
    np.testing.assert_allclose(matrices(found), matrices(turns), atol=1e-14)


def test_interpolation_is_at_constant_speed_on_the_shortest_arc() -> None:
    time = np.array([0.0, 1.0, 1.5])
    vectors = np.array([[0.1, 0.2, 0.3], [2.0, -1.0, 0.5], [2.0, -1.0, 0.5]])
    keys = np.array([pin.Quaternion(pin.exp3(vector)).coeffs() for vector in vectors])
    keys[1] *= -1.0
    even = np.linspace(-0.1, 1.6, 35)  # before the first and after the last it stays
    found = matrices(rows.slerp(time, keys, even))
    first, last = pin.exp3(vectors[0]), pin.exp3(vectors[1])
    turn = pin.log3(first.T @ last)
    expected = [first @ pin.exp3(np.clip(share, 0.0, 1.0) * turn) for share in even]
    np.testing.assert_allclose(found, expected, atol=1e-13)
