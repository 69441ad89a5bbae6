"""Numbers that differ by rounding alone."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.numbers import sparse_known, without_rounding


def test_entries_of_one_size_become_the_same_and_others_stay() -> None:
    entries = np.array([[0.25, -0.25 - 1e-16, 0.25 - 5e-17], [1 + 2e-16, 0.3, -0.3 - 1e-12], [3e-17, -3e-17, -0.0]])
    made = without_rounding(entries)
    assert_array_equal(made, [[0.25, -0.25, 0.25], [1.0, 0.3, -0.3 - 1e-12], [0.0, 0.0, 0.0]])
    assert not np.signbit(made[2]).any()
    assert_array_equal(without_rounding(made), made)
    assert without_rounding(np.zeros((0, 3))).shape == (0, 3)


@pytest.mark.parametrize("N", [6, 9, 16])
def test_weights_mirror_each_other_to_the_last_digit(N: int) -> None:
    weights, matrix = chebyshev.quadrature_weights(N), chebyshev.integration_matrix(N)
    assert_array_equal(weights, weights[::-1])
    assert_array_equal(matrix[-1], weights)
    assert_allclose(weights - matrix, matrix[::-1, ::-1], rtol=0, atol=1e-15)


def test_a_quarter_turn_that_is_known_keeps_its_ones_alone() -> None:
    turn = ca.DM([[2.2e-16, -1 + 1e-16, 0], [1 + 2e-16, 2.2e-16, 0], [0, 0, 1]])
    assert sparse_known(turn).nnz() == 3
    assert_array_equal(sparse_known(turn).full(), [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    symbol = ca.MX.sym("turn", 3, 3)
    assert sparse_known(symbol) is symbol


def test_what_is_no_finite_number_is_neither_hidden_nor_spread() -> None:
    entries = np.array([5.0, 5.0 * (1 + 1e-15), np.nan, np.inf, -np.inf, 2.0])
    left = without_rounding(entries)
    assert_allclose(left[[0, 1, 5]], [5.0, 5.0, 2.0], rtol=0, atol=0)
    assert np.isnan(left[2])
    assert_allclose(left[3:5], [np.inf, -np.inf], rtol=0, atol=0)
