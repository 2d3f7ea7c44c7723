"""The best force inside a friction cone, beside that of Clarabel, a solver of second-order cone programs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import contactsense as cs
from contactsense import _core

clarabel = pytest.importorskip("clarabel", reason="of the dependency group `test`")
sparse = pytest.importorskip("scipy.sparse", reason="Clarabel takes its matrices")

PROBLEMS, JOINTS = 10_000, 5
# Of Clarabel, whose torques are about one.
TOLERANCE = 1e-12
FRICTIONS = (0.0, 1e-6, 0.1, 0.5, 2.0)
KINDS = (
    "regular",
    "rank 2",
    "rank 1",
    "rank 0",
    "one not shown",
    "ill-conditioned",
    "pull",
    "whole numbers",
    "polar cone",
)


def random_torques(kind, rng):
    """Torques of unit forces along the normal and across it, by columns, and measured ones."""
    torques, measured = rng.normal(size=(JOINTS, 3)), rng.normal(size=JOINTS)
    if kind == "rank 2":
        torques[:, rng.integers(3)] = torques[:, :2] @ rng.normal(size=2)
    elif kind == "rank 1":
        torques = np.outer(torques[:, 0], rng.normal(size=3))
    elif kind == "rank 0":
        torques = np.zeros((JOINTS, 3))
    elif kind == "one not shown":
        torques[:, rng.integers(3)] = 0.0
    elif kind == "ill-conditioned":
        left, _, right = np.linalg.svd(torques, full_matrices=False)
        torques = left * 10.0 ** (-np.array([0.0, 2.5, 5.0]) * rng.random(3)) @ right
    elif kind == "pull":
        measured = torques @ np.array([-1.0, *rng.normal(scale=0.3, size=2)])
    elif kind == "whole numbers":
        torques, measured = torques.round(), measured.round()
    elif kind == "polar cone":
        measured -= torques[:, 0] * 3.0
    return torques, measured


def solve(torques, measured, friction):
    """Force, half the squared norm of the torques left over, and part of the cone."""
    gram = np.reshape(torques.T @ torques, (1, 9))
    forces, objectives, parts = _core._best_cone_forces(gram, torques.T @ measured, [friction])
    assert objectives[0] <= 0.0
    return forces[0], objectives[0] + 0.5 * measured @ measured, parts[0]


def solve_by_clarabel(torques, measured, friction):
    """The same force and half of the square, with the torques left over as unknowns beside the force."""
    joints = len(measured)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
    square = sparse.csc_matrix(np.diag([0.0] * 3 + [1.0] * joints))
    # Torques of the force and those left over are the measured ones; then the cone, a ray without friction.
    limits = np.diag([-friction or -1.0, -1.0, -1.0])
    rows = [np.hstack([torques, np.eye(joints)]), np.hstack([limits, np.zeros((3, joints))])]
    cone = (
        [clarabel.SecondOrderConeT(3)] if friction else [clarabel.NonnegativeConeT(1), clarabel.ZeroConeT(2)]
    )
    solution = clarabel.DefaultSolver(
        square,
        np.zeros(3 + joints),
        sparse.csc_matrix(np.vstack(rows)),
        np.concatenate([measured, np.zeros(3)]),
        [clarabel.ZeroConeT(joints), *cone],
        settings,
    ).solve()
    return np.array(solution.x[:3]), solution.obj_val, str(solution.status)


def rounding(torques, measured, force):
    """Size of the terms of the objective, to which rounding errors compare."""
    parts = np.linalg.norm(torques * force, axis=0).sum()
    return parts**2 + measured @ measured


def test_forces_are_those_of_clarabel():
    rng = np.random.default_rng(14)
    parts, solved = set(), 0
    for number in range(PROBLEMS):
        kind, friction = KINDS[number % len(KINDS)], FRICTIONS[rng.integers(len(FRICTIONS))]
        torques, measured = random_torques(kind, rng)
        force, left, part = solve(torques, measured, friction)
        _, best, status = solve_by_clarabel(torques, measured, friction)
        case = f"{number}, {kind}, friction {friction}: {part} {force}, {left} beside {best}, {status}"
        assert np.hypot(*force[1:]) <= friction * force[0] * (1.0 + 1e-12), case
        # What it leaves over is that of this force, and no more than that of Clarabel's.
        limit = 1e-9 * rounding(torques, measured, force) + TOLERANCE
        residual = measured - torques @ force
        assert abs(left - 0.5 * residual @ residual) <= limit, case
        assert left <= best + limit, case
        if status == "Solved":
            solved += 1
            assert abs(left - best) <= limit, case
        parts.add(part)
    assert parts == {"apex", "interior", "boundary"}
    assert solved > 0.95 * PROBLEMS


# The solver is given products of torques, in which the smaller of two that differ by 1e8 in size is lost.
SMALLEST = 1e-4


def between(low, high):
    return st.integers(round(low / SMALLEST), round(high / SMALLEST)).map(lambda count: count * SMALLEST)


@given(
    arrays(float, (JOINTS, 3), elements=between(-3.0, 3.0)),
    arrays(float, JOINTS, elements=between(-3.0, 3.0)),
    between(0.0, 2.0),
)
def test_no_other_force_in_the_cone_is_better(torques, measured, friction):
    force, left, _ = solve(torques, measured, friction)
    limit = 1e-9 * rounding(torques, measured, force)
    assert force[0] >= 0.0
    assert np.hypot(*force[1:]) <= friction * force[0] * (1.0 + 1e-12)
    rng = np.random.default_rng(1)
    angles, shares = rng.uniform(0.0, 2.0 * np.pi, 200), rng.uniform(0.0, 1.0, 200) ** 0.1
    rays = np.stack([np.ones(200), friction * shares * np.cos(angles), friction * shares * np.sin(angles)])
    steps = rng.uniform(-1.0, 1.0, 200) * max(force[0], 1e-3)
    for others in (
        rays * np.abs(steps),
        force[:, None] * rng.uniform(0.9, 1.1, 200),
        force[:, None] + rays * 1e-4,
    ):
        residuals = measured[:, None] - torques @ others
        assert left <= 0.5 * (residuals**2).sum(axis=0).min() + limit


def test_counts_of_problems_are_checked():
    with pytest.raises(cs.InputError, match="expected as many as grams, 2"):
        _core._best_cone_forces(np.zeros((2, 9)), np.zeros((1, 3)), np.zeros(2))
