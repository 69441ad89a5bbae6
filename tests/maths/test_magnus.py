"""Magnus increments against DOP853, matrix exponentials and Fréchet derivatives."""

import casadi as ca
import numpy as np
import pytest
from numpy.polynomial import polynomial
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.linalg import expm, expm_frechet
from scipy.spatial.transform import Rotation

from cosserat_casadi.maths import magnus
from tests.derivatives import central_differences
from tests.reference.rods import hat

COUNTS = [1, 2, 3, 4]
OMEGAS = [[0.0, 0.0, 0.0], [1e-9, -2e-9, 0.0], [0.3, -0.2, 0.5], [0.0, 2.0, 0.0], [-1.1, 1.2, 1.0]]


def curvature(X):
    """A rate of rotation whose direction changes along the way, 3×k."""
    X = np.asarray(X)
    return np.stack([2 * np.cos(3 * X), 0.5 + 1.5 * np.sin(2 * X), 1 + X * X])


@pytest.fixture(scope="module")
def rotation_reference():
    def rate(x, y):
        return (y.reshape(3, 3) @ hat(curvature(x))).ravel()

    solution = solve_ivp(rate, (0, 1), np.eye(3).ravel(), method="DOP853", rtol=1e-13, atol=1e-15)
    return solution.y[:, -1].reshape(3, 3)


def product_of_increments(field, intervals, count, points):
    """Product of exponentials over equal intervals of [0, 1]; the exponentials are SciPy's."""
    tau, to_taylor = magnus.taylor_from_samples(count, points)
    h = 1 / intervals
    total = np.eye(3)
    for i in range(intervals):
        samples = h * field((i + 0.5 + tau) * h)
        alphas = [ca.DM(samples @ row) for row in to_taylor]
        total = total @ expm(hat(magnus.rotation_increment(alphas).full().ravel()))
    return total


@pytest.mark.parametrize(("order", "coarsest"), [(4, 8), (6, 4), (8, 3)])
def test_measured_slope_vs_order_of_the_method(order, coarsest, rotation_reference):
    count = magnus.coefficient_count(order)
    sizes = coarsest * np.array([1, 2, 4])
    errors = [np.abs(product_of_increments(curvature, n, count, count) - rotation_reference).max() for n in sizes]
    slopes = -np.diff(np.log(errors)) / np.log(2)
    assert np.all(np.abs(slopes - order) < 0.5), (errors, slopes)
    assert errors[-1] > 1e-13


def test_product_of_increments_vs_dop853_on_a_fine_grid(rotation_reference):
    assert_allclose(product_of_increments(curvature, 32, 4, 5), rotation_reference, rtol=0, atol=1e-12)


@pytest.mark.parametrize("count", COUNTS)
def test_constant_direction_vs_exponential_of_the_integral(count):
    axis = np.array([0.6, -0.48, 0.64])
    coefficients = [1.5, -4.0, 3.0, 2.0, -1.0]

    def field(X):
        return axis[:, None] * polynomial.polyval(X, coefficients)

    angle = polynomial.polyval(1.0, polynomial.polyint(coefficients))
    expected = Rotation.from_rotvec(angle * axis).as_matrix()
    assert_allclose(product_of_increments(field, 2, count, 4), expected, rtol=0, atol=2e-15)


@pytest.mark.parametrize("count", COUNTS)
def test_reversed_interval_vs_inverse_increment(count):
    alphas = list(np.random.default_rng(count).uniform(-1, 1, (count, 3)))
    forward = magnus.rotation_increment([ca.DM(a) for a in alphas])
    backward = magnus.rotation_increment([ca.DM(-((-1) ** i) * a) for i, a in enumerate(alphas)])
    assert_allclose(backward.full(), -forward.full(), rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("count", COUNTS)
def test_columns_together_vs_one_by_one(count):
    alphas = [ca.DM(a) for a in np.random.default_rng(7).uniform(-1, 1, (count, 3, 5))]
    together = magnus.rotation_increment(alphas).full()
    singly = np.hstack([magnus.rotation_increment([a[:, i] for a in alphas]).full() for i in range(5)])
    assert_allclose(together, singly, rtol=1e-15, atol=1e-16)


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
def test_symbolic_increment_vs_numeric_increment(symbol, count):
    values = np.random.default_rng(3).uniform(-1, 1, (count, 3))
    symbols = [symbol.sym(f"a{i}", 3) for i in range(count)]
    f = ca.Function("f", symbols, [magnus.rotation_increment(symbols)])
    expected = magnus.rotation_increment([ca.DM(a) for a in values])
    assert_allclose(f(*values).full(), expected.full(), rtol=1e-15, atol=1e-16)


@pytest.mark.parametrize("omega", OMEGAS)
def test_increment_quaternion_vs_expm(omega):
    w, x, y, z = magnus.increment(ca.DM(omega)).quaternion.full().ravel()
    assert_allclose(np.linalg.norm([w, x, y, z]), 1.0, rtol=4e-16, atol=0)
    assert_allclose(Rotation.from_quat([x, y, z, w]).as_matrix(), expm(hat(omega)), rtol=0, atol=2e-15)


@pytest.mark.parametrize("omega", OMEGAS)
def test_increment_tangent_vs_frechet_derivative_of_expm(omega):
    tangent = magnus.increment(ca.DM(omega)).tangent.full()
    for i, direction in enumerate(np.eye(3)):
        value, derivative = expm_frechet(hat(omega), hat(direction))
        assert_allclose(hat(tangent[:, i]), derivative @ value.T, rtol=0, atol=5e-14)


@pytest.mark.parametrize("omega", OMEGAS)
def test_increment_tangent_vs_finite_differences(omega):
    step = 1e-5
    for i, d in enumerate(step * np.eye(3)):
        difference = (expm(hat(omega + d)) - expm(hat(omega - d))) / (2 * step) @ expm(hat(omega)).T
        column = magnus.increment(ca.DM(omega)).tangent.full()[:, i]
        assert_allclose(hat(column), difference, rtol=0, atol=1e-10)


@pytest.mark.parametrize("omega", OMEGAS)
def test_pulled_moment_vs_transpose_of_the_frechet_derivative(omega):
    moment = np.array([0.7, -1.2, 0.4])
    pulled = magnus.increment(ca.DM(omega)).pulled(ca.DM(moment)).full().ravel()
    assert_allclose(pulled, pulled_by_expm(np.array(omega), moment), rtol=0, atol=1e-14)


@pytest.mark.parametrize("omega", OMEGAS)
def test_increment_stiffness_vs_differences_of_the_frechet_derivative(omega):
    moment = np.array([0.7, -1.2, 0.4])
    form = magnus.increment(ca.DM(omega)).stiffness(ca.DM(moment)).full()
    tangent = magnus.increment(ca.DM(omega)).tangent.full()
    differences = central_differences(lambda omega: pulled_by_expm(omega, moment), omega, 1e-5)
    assert_allclose(tangent.T @ form @ tangent, differences, rtol=0, atol=1e-9)


@pytest.mark.parametrize("omega", OMEGAS)
def test_increment_stiffness_vs_ad(omega):
    v, moment = ca.SX.sym("v", 3), ca.DM([0.7, -1.2, 0.4])
    tangent = magnus.increment(v).tangent
    difference = ca.jacobian(tangent.T @ moment, v) - tangent.T @ magnus.increment(v).stiffness(moment) @ tangent
    assert_allclose(ca.Function("f", [v], [difference])(omega).full(), 0.0, rtol=0, atol=2e-15)


def test_increment_stiffness_vs_its_turned_arguments():
    omega, moment = np.array([0.3, -0.2, 0.5]), np.array([0.7, -1.2, 0.4])
    R = expm(hat([1.0, 0.4, -0.6]))
    turned = magnus.increment(ca.DM(R @ omega)).stiffness(ca.DM(R @ moment)).full()
    assert_allclose(turned, R @ magnus.increment(ca.DM(omega)).stiffness(ca.DM(moment)).full() @ R.T, atol=1e-15)


def pulled_by_expm(omega, moment):
    """Tᵀ moment from Fréchet derivatives of the matrix exponential."""
    derivatives = [expm_frechet(hat(omega), hat(d)) for d in np.eye(3)]
    spins = [derivative @ value.T for value, derivative in derivatives]
    return np.array([np.array([s[2, 1], s[0, 2], s[1, 0]]) @ moment for s in spins])


def test_order_six_vs_its_nested_commutators():
    """The series of Blanes, Casas and Ros as matrices, with [a, b] the commutator."""

    def bracket(a, b):
        return a @ b - b @ a

    alphas = np.random.default_rng(11).uniform(-1, 1, (3, 3))
    a1, a2, a3 = (-hat(a) for a in alphas)
    c12 = bracket(a1, a2)
    first = -20 * a1 - a3 + c12
    expected = a1 + a3 / 12 + bracket(first, a2 - bracket(a1, 2 * a3 + c12) / 60) / 240
    omega = magnus.rotation_increment([ca.DM(a) for a in alphas]).full().ravel()
    # The published form closes with a nested bracket of order h⁷, which the series cut at order six leaves out.
    dropped = bracket(-a3 + c12, bracket(a1, 2 * a3 + c12)) / -60 / 240
    assert_allclose(-hat(omega), expected - dropped, rtol=0, atol=1e-15)


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("extra", [0, 1, 3])
def test_taylor_from_samples_vs_polynomial_coefficients(count, extra):
    coefficients = np.random.default_rng(count).normal(size=count)
    tau, to_taylor = magnus.taylor_from_samples(count, count + extra)
    assert_allclose(to_taylor @ polynomial.polyval(tau, coefficients), coefficients, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("count", COUNTS)
def test_moments_of_taylor_polynomial_vs_moments_of_the_function(count):
    points = count + 2
    coefficients = np.random.default_rng(count).normal(size=2 * points - count + 1)
    tau, to_taylor = magnus.taylor_from_samples(count, points)
    alpha = to_taylor @ polynomial.polyval(tau, coefficients)
    for i in range(count):
        expected, found = (
            np.diff(polynomial.polyval([-0.5, 0.5], polynomial.polyint([0.0] * i + list(c))))
            for c in (coefficients, alpha)
        )
        assert_allclose(found, expected, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("order", [0, 2, 5, 10])
def test_order_that_is_not_there_vs_refusal(order):
    with pytest.raises(ValueError, match="order of a Magnus method"):
        magnus.coefficient_count(order)
