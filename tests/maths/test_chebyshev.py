"""Chebyshev matrices: exact on polynomials, accurate on many points, and converging as they should."""

from decimal import Decimal, getcontext
from fractions import Fraction

import numpy as np
import pytest
from numpy.polynomial import chebyshev as npc
from numpy.polynomial import legendre as npl
from numpy.testing import assert_allclose

from cosserat_casadi.maths import chebyshev as cheb

SIZES = [1, 2, 3, 4, 7, 8, 16, 33, 64, 128]
EPS = np.finfo(float).eps


def normal(*shape):
    """Normal numbers that depend on the shape alone, so that no test depends on another."""
    return np.random.default_rng((60, *shape)).normal(size=shape)


def shifted(coefficients):
    """The polynomial Σ c_k T_k(2X − 1) and its derivatives and integral with respect to X, on [0, 1]."""
    return npc.Chebyshev(coefficients, domain=[0, 1])


def random_polynomial(degree):
    return shifted(normal(degree + 1) / (1.0 + np.arange(degree + 1)) ** 2)


# --- nodes ------------------------------------------------------------


@pytest.mark.parametrize("N", [*SIZES, 512])
def test_nodes_run_from_base_to_tip(N):
    X = cheb.nodes(N)
    assert X[0] == 0.0
    assert X[-1] == 1.0
    assert np.all(np.diff(X) > 0)
    assert_allclose(X, (1 - np.cos(np.pi * np.arange(N + 1) / N)) / 2, rtol=0, atol=2 * EPS)
    assert_allclose(X + X[::-1], np.ones(N + 1), rtol=0, atol=0)


def test_first_node_has_all_its_digits():
    """sin²(π/1024) from its series: the form (1 − cos)/2 loses five digits here."""
    x = np.pi / 1024
    assert_allclose(cheb.nodes(512)[1], (x - x**3 / 6 + x**5 / 120) ** 2, rtol=4 * EPS, atol=0)


@pytest.mark.parametrize(
    "build",
    [
        cheb.nodes,
        cheb.barycentric_weights,
        cheb.differentiation_matrix,
        cheb.quadrature_weights,
        cheb.integration_matrix,
    ],
)
def test_no_interval_is_refused(build):
    with pytest.raises(ValueError, match="at least one interval"):
        build(0)


# --- differentiation ------------------------------------------------------------


def test_known_matrices():
    """Report (B.7) and (B.12), from base to tip and with dx/dX = 2."""
    assert_allclose(cheb.differentiation_matrix(1), [[-1, 1], [-1, 1]], rtol=EPS, atol=0)
    known = 2 * np.array([[-1.5, 2, -0.5], [-0.5, 0, 0.5], [0.5, -2, 1.5]])
    assert_allclose(cheb.differentiation_matrix(2), known, rtol=4 * EPS, atol=4 * EPS)


@pytest.mark.parametrize("N", SIZES)
def test_differentiation_of_polynomials(N):
    p = random_polynomial(N)
    X = cheb.nodes(N)
    slope = p.deriv()(X)
    # The value at a node is rounded, and N² is the norm of D: the error grows like it.
    assert_allclose(cheb.differentiation_matrix(N) @ p(X), slope, rtol=1e-13, atol=8 * N**2 * EPS + 8 * EPS)


@pytest.mark.parametrize("N", SIZES)
def test_second_differentiation_of_polynomials(N):
    p = random_polynomial(N)
    X = cheb.nodes(N)
    found = cheb.differentiation_matrix(N, order=2) @ p(X)
    assert_allclose(found, p.deriv(2)(X), rtol=1e-13, atol=4 * N**4 * EPS + 16 * EPS)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
@pytest.mark.parametrize("N", [4, 8, 16])
def test_higher_orders_are_powers_and_vanish_on_lower_degrees(N, order):
    D = cheb.differentiation_matrix(N, order)
    power = np.linalg.matrix_power(cheb.differentiation_matrix(N), order)
    scale = np.abs(power).max()
    assert_allclose(D, power, rtol=0, atol=1e-13 * scale)
    X = cheb.nodes(N)
    for degree in range(order):
        assert_allclose(D @ X**degree, np.zeros(N + 1), rtol=0, atol=1e-15 * scale)
    factorial = np.prod(np.arange(1, order + 1))
    assert_allclose(D @ X**order, np.full(N + 1, float(factorial)), rtol=0, atol=1e-15 * scale)


def exact_nodes_and_matrix(N):
    """Points and differentiation matrix in 50 digits, from the definition, rounded at the end."""
    getcontext().prec = 50
    pi = Decimal("3.14159265358979323846264338327950288419716939937510582097494")

    def cosine(angle):
        term, total, k = Decimal(1), Decimal(1), 0
        while abs(term) > Decimal(10) ** -48:
            k += 2
            term *= -angle * angle / (k * (k - 1))
            total += term
        return total

    X = [(1 - cosine(pi * j / N)) / 2 for j in range(N + 1)]
    c = [Decimal(2) if j in (0, N) else Decimal(1) for j in range(N + 1)]
    D = [
        [Decimal(0) if i == j else c[i] / c[j] * (-1) ** (i + j) / (X[i] - X[j]) for j in range(N + 1)]
        for i in range(N + 1)
    ]
    for i, row in enumerate(D):
        row[i] = -sum(row)
    return np.array(X, dtype=float), np.array(D, dtype=float)


@pytest.mark.parametrize("N", [5, 32, 64])
def test_entries_vs_fifty_digits(N):
    X, D = exact_nodes_and_matrix(N)
    found = cheb.differentiation_matrix(N)
    off_diagonal = ~np.eye(N + 1, dtype=bool)
    assert_allclose(cheb.nodes(N), X, rtol=2 * EPS, atol=0)
    assert_allclose(found[off_diagonal], D[off_diagonal], rtol=8 * EPS, atol=0)
    # A diagonal entry is a sum of others; its error is a rounding of the largest of them.
    assert_allclose(np.diag(found), np.diag(D), rtol=0, atol=8 * EPS * np.abs(D).max())


def test_order_zero_is_refused():
    with pytest.raises(ValueError, match="order"):
        cheb.differentiation_matrix(4, order=0)


@pytest.mark.parametrize(("N", "bound"), [(16, 3e-8), (24, 1e-12), (128, 5e-11), (512, 1e-9)])
def test_derivative_of_a_sine(N, bound):
    X = cheb.nodes(N)
    found = cheb.differentiation_matrix(N) @ np.sin(6 * X)
    assert_allclose(found, 6 * np.cos(6 * X), rtol=0, atol=bound)


# --- interpolation ------------------------------------------------------------


@pytest.mark.parametrize("N", SIZES)
def test_interpolation_of_polynomials(N):
    p = random_polynomial(N)
    X = np.concatenate([np.linspace(0, 1, 31), cheb.nodes(N), [1e-310, 1e-17, 1 - EPS / 2]])
    found = cheb.interpolation_matrix(N, X) @ p(cheb.nodes(N))
    assert_allclose(found, p(X), rtol=1e-13, atol=3e-15 * N + 1e-15)


@pytest.mark.parametrize("N", SIZES)
def test_interpolation_is_exact_at_the_nodes(N):
    assert_allclose(cheb.interpolation_matrix(N, cheb.nodes(N)), np.eye(N + 1), rtol=0, atol=0)


@pytest.mark.parametrize("X", [-0.1, 1.1, np.nan])
def test_extrapolation_is_refused(X):
    with pytest.raises(ValueError, match="between 0 and 1"):
        cheb.interpolation_matrix(4, [0.5, X])


def test_barycentric_weights_are_those_of_lagrange():
    X = cheb.nodes(6)
    lagrange = 1 / np.array([np.prod(X[j] - np.delete(X, j)) for j in range(7)])
    weights = cheb.barycentric_weights(6)
    assert_allclose(weights / weights[0], lagrange / lagrange[0], rtol=1e-13, atol=1e-15)


# --- integration ------------------------------------------------------------


def test_known_clenshaw_curtis_weights():
    known = {
        1: [Fraction(1, 2)] * 2,
        2: [Fraction(1, 6), Fraction(4, 6), Fraction(1, 6)],
        3: [Fraction(1, 18), Fraction(8, 18), Fraction(8, 18), Fraction(1, 18)],
        4: [Fraction(1, 30), Fraction(8, 30), Fraction(12, 30), Fraction(8, 30), Fraction(1, 30)],
    }
    for N, weights in known.items():
        assert_allclose(cheb.quadrature_weights(N), [float(w) for w in weights], rtol=4 * EPS, atol=0)


@pytest.mark.parametrize("N", [*SIZES, 512])
def test_quadrature_weights_are_positive_and_of_unit_sum(N):
    weights = cheb.quadrature_weights(N)
    assert np.all(weights > 0)
    assert_allclose(weights.sum(), 1.0, rtol=4 * EPS, atol=0)


@pytest.mark.parametrize("N", SIZES)
def test_quadrature_of_polynomials(N):
    p = random_polynomial(N)
    whole = p.integ()(1.0) - p.integ()(0.0)
    assert_allclose(cheb.quadrature_weights(N) @ p(cheb.nodes(N)), whole, rtol=1e-13, atol=2e-15)


def test_quadrature_of_the_exponential_converges_spectrally():
    errors = [abs(cheb.quadrature_weights(N) @ np.exp(4 * cheb.nodes(N)) - np.expm1(4) / 4) for N in (4, 6, 8, 10, 12)]
    ratios = np.array(errors[1:]) / errors[:-1]
    assert np.all(ratios < 0.004)
    assert errors[-1] < 1e-10


@pytest.mark.parametrize("N", SIZES)
def test_integration_of_polynomials(N):
    p = random_polynomial(N)
    X = cheb.nodes(N)
    P = p.integ()
    assert_allclose(cheb.integration_matrix(N) @ p(X), P(X) - P(0.0), rtol=1e-13, atol=2e-15)


@pytest.mark.parametrize("N", [*SIZES, 512])
def test_integration_matrix_and_weights_agree(N):
    S, weights = cheb.integration_matrix(N), cheb.quadrature_weights(N)
    assert_allclose(S[0], np.zeros(N + 1), rtol=0, atol=0)
    assert_allclose(S[-1], weights, rtol=1e-12, atol=2 * EPS)


@pytest.mark.parametrize("N", [16, 128, 512])
def test_short_integrals_near_the_base_keep_their_digits(N):
    """∫₀^{X₁} of 1 and of X: one rounding of 1 would be 1e-11 of X₁ and 1e-5 of X₁²/2 at N = 512."""
    X = cheb.nodes(N)
    S = cheb.integration_matrix(N)
    assert_allclose(S[1] @ np.ones(N + 1), X[1], rtol=1e-13, atol=0)
    assert_allclose(S[1] @ X, X[1] ** 2 / 2, rtol=1e-9, atol=0)


# --- polynomials ------------------------------------------------------------


@pytest.mark.parametrize("n", [1, 2, 3, 10, 40])
def test_polynomials_vs_numpy(n):
    X = np.linspace(0, 1, 23)
    assert_allclose(cheb.chebyshev_polynomials(n, X), npc.chebvander(2 * X - 1, n - 1), rtol=1e-12, atol=1e-13)
    assert_allclose(cheb.legendre_polynomials(n, X), npl.legvander(2 * X - 1, n - 1), rtol=1e-12, atol=1e-13)


def test_polynomials_end_values_follow_the_direction_of_x():
    ends = cheb.chebyshev_polynomials(6, [0.0, 1.0])
    assert_allclose(ends, [[1, -1, 1, -1, 1, -1], [1] * 6], rtol=0, atol=0)
    assert_allclose(cheb.legendre_polynomials(6, [0.0, 1.0]), ends, rtol=0, atol=4 * EPS)


def test_legendre_polynomials_are_orthogonal():
    N = 24
    P = cheb.legendre_polynomials(8, cheb.nodes(N))
    gram = P.T @ np.diag(cheb.quadrature_weights(N)) @ P
    assert_allclose(gram, np.diag(1 / (2 * np.arange(8) + 1)), rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("build", [cheb.chebyshev_polynomials, cheb.legendre_polynomials])
def test_no_polynomial_is_refused(build):
    with pytest.raises(ValueError, match="at least one polynomial"):
        build(0, [0.5])


@pytest.mark.parametrize("N", [*SIZES, 512])
def test_coefficients_and_values_are_inverse(N):
    coefficients = normal(N + 1, 2)
    # T_k(2X_j − 1) = (−1)^k cos(πjk/N), with the angle taken modulo a turn.
    k = np.arange(N + 1)
    values = np.where(k % 2, -1.0, 1.0) * np.cos(np.pi / N * (np.outer(k, k) % (2 * N))) @ coefficients
    assert_allclose(cheb.chebyshev_coefficients(values), coefficients, rtol=0, atol=1e-15 * (N + 10))


def test_coefficients_of_one_column():
    X = cheb.nodes(5)
    assert_allclose(cheb.chebyshev_coefficients(X), [0.5, 0.5, 0, 0, 0, 0], rtol=0, atol=2 * EPS)
