"""Secant updates of the inverse against Broyden's formula for the matrix itself."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics import broyden
from cosserat_casadi.numerics.collocation import radau
from cosserat_casadi.numerics.stage_newton import SecantUpdates

WEIGHTS = np.array([1.0, 1e3, 20.0, 0.0])
"""Of four entries; the last one is algebraic."""

STAGES = 3
SIZE = STAGES * len(WEIGHTS)


def equations(unknowns: FloatArray) -> FloatArray:
    """Nonlinear equations of all stages, whose Jacobian at zero is the identity, shape (s, n)."""
    turned = np.roll(unknowns, 1, axis=0) * np.roll(unknowns, 2, axis=1)
    return unknowns + 0.3 * np.sin(unknowns) * unknowns + 0.4 * turned - 0.1


def test_corrections_are_those_of_the_updated_matrix() -> None:
    # Broyden: B₊ = B + (y − B s) sᵀW/(sᵀW s), with y what F changed by, and W the weighted changes of velocity squared.
    method = radau(STAGES)
    to_velocities = np.kron(method.matrix, np.eye(len(WEIGHTS)))
    squares = to_velocities.T @ np.diag(np.tile(WEIGHTS, STAGES) ** 2) @ to_velocities
    updates = SecantUpdates(method.matrix, WEIGHTS)
    matrix = np.eye(SIZE)
    unknowns = np.zeros((STAGES, len(WEIGHTS)))
    for _ in range(5):
        before = equations(unknowns)
        expected = np.linalg.solve(matrix, -before.ravel())
        corrections = updates.applied_to(-before)
        assert_allclose(corrections.ravel(), expected, rtol=1e-9, atol=1e-15)
        updates.take(corrections)
        unknowns = unknowns + corrections
        changed = (equations(unknowns) - before).ravel()
        missed = changed - matrix @ expected
        matrix = matrix + np.outer(missed, squares @ expected) / (expected @ squares @ expected)


def test_linear_equations_of_few_directions_are_solved() -> None:
    # F = (1 + u wᵀ) y − b: one direction is not known to the first inverse, and two updates learn it.
    random = np.random.default_rng(7)
    u, w, b = random.normal(size=(3, STAGES, 4))
    weights = np.ones(4)
    updates = SecantUpdates(radau(STAGES).matrix, weights)
    unknowns = np.zeros((STAGES, 4))
    lengths = []
    for _ in range(4):
        residuals = unknowns + u * np.vdot(w, unknowns) - b
        corrections = updates.applied_to(-residuals)
        lengths.append(np.abs(corrections).max())
        updates.take(corrections)
        unknowns = unknowns + corrections
    assert lengths[1] > 0.1
    assert_allclose(unknowns + u * np.vdot(w, unknowns), b, rtol=0, atol=1e-12)


def test_correction_without_effect_is_not_finite() -> None:
    # The same F before and after a correction: no secant goes through zero.
    updates = SecantUpdates(radau(STAGES).matrix, WEIGHTS)
    corrections = np.ones((STAGES, 4))
    updates.take(corrections)
    assert not np.all(np.isfinite(updates.applied_to(corrections)))


def test_a_sparse_jacobian_is_factorised_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps and a response of the same Jacobian, dense and sparse."""
    random = np.random.default_rng(3)
    matrix = np.eye(6) + 0.2 * random.normal(size=(6, 6))
    factorised = []
    of_package = broyden.sparse_factors
    monkeypatch.setattr(broyden, "sparse_factors", lambda jacobian: factorised.append(1) or of_package(jacobian))
    found = []
    for jacobian in (ca.DM(matrix), matrix):
        updated = broyden.UpdatedJacobian(jacobian)
        for residual in np.random.default_rng(4).normal(size=(3, 6)):
            step = updated.step(residual)
            assert step is not None
            updated.steps.append(step)
        found.append([*updated.steps, updated.response(np.ones(6), np.full(6, 0.1))])
    assert_allclose(found[0], found[1], rtol=1e-11, atol=0)
    assert len(factorised) == 1
