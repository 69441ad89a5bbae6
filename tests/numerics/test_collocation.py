"""The tables of collocation methods against published coefficients, and against the conditions they are made for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi.numerics.collocation import Collocation, gauss, radau

ROOT6 = np.sqrt(6.0)
ROOT15 = np.sqrt(15.0)

# Hairer, Wanner, Solving ODEs II, tables IV.5.1, IV.5.2, IV.5.5, IV.5.6.
PUBLISHED = [
    (radau(1), [[1.0]]),
    (radau(2), [[5 / 12, -1 / 12], [3 / 4, 1 / 4]]),
    (
        radau(3),
        [
            [(88 - 7 * ROOT6) / 360, (296 - 169 * ROOT6) / 1800, (-2 + 3 * ROOT6) / 225],
            [(296 + 169 * ROOT6) / 1800, (88 + 7 * ROOT6) / 360, (-2 - 3 * ROOT6) / 225],
            [(16 - ROOT6) / 36, (16 + ROOT6) / 36, 1 / 9],
        ],
    ),
    (gauss(1), [[0.5]]),
    (gauss(2), [[1 / 4, 1 / 4 - np.sqrt(3) / 6], [1 / 4 + np.sqrt(3) / 6, 1 / 4]]),
    (
        gauss(3),
        [
            [5 / 36, 2 / 9 - ROOT15 / 15, 5 / 36 - ROOT15 / 30],
            [5 / 36 + ROOT15 / 24, 2 / 9, 5 / 36 - ROOT15 / 24],
            [5 / 36 + ROOT15 / 30, 2 / 9 + ROOT15 / 15, 5 / 36],
        ],
    ),
]

METHODS = pytest.mark.parametrize("method", [method for method, _ in PUBLISHED], ids=lambda method: method.name)


@pytest.mark.parametrize(("method", "published"), PUBLISHED, ids=[method.name for method, _ in PUBLISHED])
def test_matrix_is_the_published_one(method: Collocation, published: list[list[float]]) -> None:
    assert_allclose(method.matrix, published, rtol=0, atol=2e-15)
    assert_allclose(method.matrix.sum(axis=1), method.nodes, rtol=0, atol=2e-15)


@METHODS
def test_weights_integrate_polynomials_up_to_the_order(method: Collocation) -> None:
    for power in range(method.order):
        assert_allclose(method.weights @ method.nodes**power, 1 / (power + 1), rtol=0, atol=2e-15)
    beyond = method.weights @ method.nodes**method.order
    assert abs(beyond - 1 / (method.order + 1)) > 1e-4


@METHODS
def test_position_weights_integrate_twice(method: Collocation) -> None:
    # ∫₀¹ (1 − τ) τ^k dτ = 1/((k + 1)(k + 2)); bᵀA has one order less than b.
    for power in range(method.order - 1):
        exact = 1 / ((power + 1) * (power + 2))
        assert_allclose(method.position_weights @ method.nodes**power, exact, rtol=0, atol=2e-15)


@METHODS
def test_eigenvectors_take_the_matrix_apart(method: Collocation) -> None:
    values = np.cos(np.arange(method.stages) + 1.0)
    along = method.to_eigenvectors @ values
    back = method.from_eigenvectors @ along
    product = method.from_eigenvectors @ (method.eigenvalues * along)
    assert_allclose(back.real, values, rtol=0, atol=1e-14)
    assert_allclose(product.real, method.matrix @ values, rtol=0, atol=1e-14)
    assert len(method.eigenvalues) == (method.stages + 1) // 2


@METHODS
@pytest.mark.parametrize(
    ("polynomials", "exact"),
    [
        (Collocation.values_at, lambda p, t: t**p),
        (Collocation.integrals_at, lambda p, t: t ** (p + 1) / (p + 1)),
        (Collocation.double_integrals_at, lambda p, t: t ** (p + 2) / ((p + 1) * (p + 2))),
    ],
)
def test_lagrange_polynomials_and_their_integrals(
    method: Collocation,
    polynomials: Callable[[Collocation, float], np.ndarray],
    exact: Callable[[int, float], float],
) -> None:
    for power in range(method.stages):
        for share in (0.0, 0.3, 1.0, 1.7):
            interpolated = polynomials(method, share) @ method.nodes**power
            assert_allclose(interpolated, exact(power, share), rtol=0, atol=5e-14)


@METHODS
def test_no_row_sums_above_one(method: Collocation) -> None:
    # Newton's method measures velocities alone for that reason.
    assert np.abs(method.matrix).sum(axis=1).max() <= 1.0 + 1e-15


def test_last_stage_of_radau_is_the_end() -> None:
    for stages in (1, 2, 3):
        method = radau(stages)
        assert method.stiffly_accurate
        assert_allclose(method.matrix[-1], method.weights, rtol=0, atol=1e-15)
        assert not gauss(stages).stiffly_accurate


@pytest.mark.parametrize("family", [radau, gauss])
@pytest.mark.parametrize("stages", [0, 4])
def test_other_numbers_of_stages_are_refused(family: Callable[[int], Collocation], stages: int) -> None:
    with pytest.raises(ValueError, match=f"{stages} is not one of 1 to 3"):
        family(stages)
