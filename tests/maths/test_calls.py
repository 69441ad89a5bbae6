"""Functions called at many arguments at once, as one call after the other gives them, and what makes one call often."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from cosserat_casadi.maths.calls import evaluated, with_shared_terms


def mixed() -> ca.Function:
    """(x, u) ↦ a dense vector, a matrix of which half is stored, and a matrix of zeros."""
    x, u = ca.MX.sym("x", 3), ca.MX.sym("u", 2)
    return ca.Function("mixed", [x, u], [x * u[0], ca.diag(x**2) + ca.tril(x @ x.T), ca.MX(2, 2)])


@pytest.mark.parametrize("transposed", [False, True])
def test_rows_are_those_of_one_call_after_the_other(transposed: bool) -> None:
    draw = np.random.default_rng(7)
    x = draw.normal(size=(3, 5)).T if transposed else draw.normal(size=(5, 3))
    u = draw.normal(size=(5, 2))
    vector, matrix, zeros = evaluated(mixed(), x, u)
    for row in range(5):
        outer = np.tril(np.outer(x[row], x[row]))
        np.testing.assert_allclose(vector[row, :, 0], x[row] * u[row, 0], rtol=1e-15, atol=0.0)
        np.testing.assert_allclose(matrix[row], outer + np.diag(x[row] ** 2), rtol=1e-15, atol=0.0)
    np.testing.assert_array_equal(zeros, np.zeros((5, 2, 2)))


def test_an_argument_may_be_empty_and_there_may_be_no_row() -> None:
    x, nothing = ca.MX.sym("x", 2), ca.MX.sym("nothing", 0)
    function = ca.Function("doubled", [x, nothing], [2.0 * x])
    (doubled,) = evaluated(function, np.ones((3, 2)), np.zeros((3, 0)))
    np.testing.assert_array_equal(doubled, np.full((3, 2, 1), 2.0))
    (none,) = evaluated(function, np.zeros((0, 2)), np.zeros((0, 0)))
    assert none.shape == (0, 2, 1)


def test_a_call_that_results_make_often_is_made_once() -> None:
    """CasADi 3.7 refuses a function whose calls are merged at once."""
    x, factors = ca.SX.sym("x", 2), np.array([2.0, 3.0, 4.0])
    kernel = ca.Function("kernel", [x], [ca.sin(x), ca.dot(x, x)], {"never_inline": True})
    upper, lower = (ca.horzcat(*(kernel(x)[0][row] * factor for factor in factors)) for row in range(2))
    function = with_shared_terms("both", [x], [upper, ca.SX(1, 0), lower + kernel(x)[1]], ["x"], ["a", "none", "b"])
    codes = [function.instruction_id(k) for k in range(function.n_instructions())]
    assert codes.count(ca.OP_CALL) == 1
    a, none, b = (np.asarray(result)[0] for result in function([0.3, -0.2]))
    np.testing.assert_allclose(a, factors * np.sin(0.3), rtol=1e-15)
    assert none.shape == (0,)
    np.testing.assert_allclose(b, 0.13 - factors * np.sin(0.2), rtol=1e-15)
