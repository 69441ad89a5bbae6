"""Block operators on stacked fields against dense NumPy products, for every CasADi type."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import block_diag

from cosserat_casadi.maths import block_operators

KINDS = pytest.mark.parametrize("kind", [ca.DM, ca.SX, ca.MX])
PATTERNS = {
    "dense": np.ones((3, 2)),
    "sparse": np.array([[1, 0, 0], [0, 1, 1], [0, 0, 0]]),
    "column": np.ones((3, 1)),
    "corner": np.eye(2)[[1, 0]] * np.array([[1, 0]]),
    "empty": np.zeros((2, 3)),
}


def normal(*shape):
    return np.random.default_rng((5, *shape)).normal(size=shape)


def evaluated(kind, function, value):
    """Value of ``function`` at a sparse DM, through symbols of the given kind."""
    value = ca.DM(value)
    if kind is ca.DM:
        return ca.DM(function(value)).full()
    x = kind.sym("x", value.sparsity())
    return ca.Function("f", [x], [function(x)])(value).full()


def place_by_place(components, places):
    """Permutation from component-by-component stacking to place-by-place stacking."""
    order = np.arange(components * places).reshape(components, places).T.ravel()
    return np.eye(components * places)[order]


@KINDS
@pytest.mark.parametrize("places", [1, 4])
@pytest.mark.parametrize("name", PATTERNS)
def test_block_diagonal_vs_numpy_block_diag(kind, places, name):
    mask = PATTERNS[name]
    m, n = mask.shape
    dense = [mask * normal(m, n, i + 1)[..., i] for i in range(places)]
    pattern = ca.DM(mask).sparsity() if mask.all() else ca.sparsify(ca.DM(mask)).sparsity()
    sparse = ca.horzcat(*[ca.project(ca.DM(d), pattern) for d in dense])
    found = evaluated(kind, lambda x: block_operators.block_diagonal(x, pattern), sparse)
    expected = place_by_place(m, places).T @ block_diag(*dense) @ place_by_place(n, places)
    assert_allclose(found, expected, rtol=0, atol=0)


@KINDS
@pytest.mark.parametrize("columns", [1, 2])
def test_block_diagonal_of_one_row_vs_numpy_block_diag(kind, columns):
    dense = normal(3, 1, columns)
    pattern = ca.Sparsity.dense(1, columns)
    found = evaluated(kind, lambda x: block_operators.block_diagonal(x, pattern), np.hstack(list(dense)))
    expected = block_diag(*dense) @ place_by_place(columns, 3)
    assert_allclose(found, expected, rtol=0, atol=0)


@KINDS
def test_block_diagonal_sparsity_vs_entries_of_the_blocks(kind):
    pattern = ca.Sparsity.lower(3)
    symbol = ca.DM(ca.Sparsity.lower(3), 1.0) if kind is ca.DM else kind.sym("x", pattern)
    assert block_operators.block_diagonal(ca.horzcat(symbol, symbol), pattern).nnz() == 2 * pattern.nnz()


@KINDS
def test_hat_operator_vs_numpy_cross(kind):
    field, vectors = normal(3, 6), normal(3, 6, 2)[..., 1]
    operator = evaluated(kind, block_operators.hat_operator, field)
    expected = np.cross(field, vectors, axis=0).ravel()
    assert_allclose(operator @ vectors.ravel(), expected, rtol=1e-15, atol=1e-15)


@KINDS
@pytest.mark.parametrize("components", [1, 3])
@pytest.mark.parametrize("full", [True, False])
def test_cumulative_sum_vs_numpy_cumsum(kind, components, full):
    places = 5
    values = normal(components * places, 4)
    mask = np.ones_like(values) if full else np.random.default_rng(2).integers(0, 2, values.shape)
    sparse = ca.sparsify(ca.DM(values * mask))
    found = evaluated(kind, lambda x: block_operators.cumulative_sum(x, places), sparse)
    expected = np.cumsum((values * mask).reshape(components, places, 4), axis=1).reshape(-1, 4)
    assert_allclose(found, expected, rtol=1e-15, atol=1e-15)


@KINDS
def test_reversed_places_vs_numpy_flip(kind):
    values = normal(12, 3)
    found = evaluated(kind, lambda x: block_operators.reversed_places(x, 4), values)
    assert_allclose(found, values.reshape(3, 4, 3)[:, ::-1].reshape(12, 3), rtol=0, atol=0)


@KINDS
def test_stack_vs_numpy_ravel(kind):
    field = normal(3, 5)
    assert_allclose(evaluated(kind, block_operators.stack, field).ravel(), field.ravel(), rtol=0, atol=0)
    assert_allclose(
        evaluated(kind, lambda x: block_operators.unstack(block_operators.stack(x), 3), field), field, rtol=0, atol=0
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("count", [1, 2, 5, 6])
def test_mirror_factors_vs_even_and_odd_columns(count, sign):
    x = np.linspace(-1, 1, count) if count > 1 else np.zeros(1)
    columns = np.stack([np.ones(count), x, x**2, x**3], axis=1)
    parities = sign * np.array([1.0, -1.0, 1.0, -1.0])
    fold, half = block_operators.mirror_factors(columns, np.arange(count)[::-1], np.full(count, sign), parities)
    assert_allclose((fold.T @ half).full(), columns, rtol=0, atol=1e-15)
    assert half.nnz() == 4 * (count // 2) + count % 2
    assert fold.nnz() == 4 * (count // 2) + count % 2


def test_mirror_factors_vs_rounding_of_the_entries():
    """What breaks the mirror by rounding is left out."""
    columns = np.array([[1.0, 0.5], [0.0, 1e-16], [1.0 + 2e-16, -0.5]])
    fold, half = block_operators.mirror_factors(columns, np.array([2, 1, 0]), np.ones(3), np.array([1.0, -1.0]))
    assert half.nnz() == 2
    assert_allclose((fold.T @ half).full(), columns, rtol=0, atol=3e-16)


def test_block_diagonal_of_blocks_that_are_known_to_be_zero():
    pattern = ca.Sparsity.dense(2, 2)
    found = block_operators.block_diagonal(ca.MX(2, 6), pattern)
    np.testing.assert_allclose(ca.evalf(found).full(), np.zeros((6, 6)), rtol=0, atol=0)
