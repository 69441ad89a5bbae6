"""Areas and second moments against quadrature, torsion constants against published values and a Poisson solve."""

from decimal import Decimal, getcontext

import numpy as np
import pytest
from numpy.polynomial import legendre
from numpy.testing import assert_allclose

from cosserat_casadi.maths import chebyshev
from cosserat_casadi.rod import section

PUBLISHED = {
    1.0: 0.1406,
    1.2: 0.166,
    1.5: 0.196,
    2.0: 0.229,
    2.5: 0.249,
    3.0: 0.263,
    4.0: 0.281,
    5.0: 0.291,
    10.0: 0.312,
}


def integrals(points, weights):
    """(A, ∫y², ∫x²) of weighted points of a section."""
    x, y = points
    return weights.sum(), weights @ y**2, weights @ x**2


def polar_points(outer, inner):
    u, w = legendre.leggauss(8)
    r, dr = inner + (outer - inner) * (u + 1) / 2, w * (outer - inner) / 2
    angle = 2 * np.pi * np.arange(16) / 16
    R, A = np.meshgrid(r, angle)
    return ((R * np.cos(A)).ravel(), (R * np.sin(A)).ravel()), np.tile(dr * r, 16) * 2 * np.pi / 16


def cartesian_points(width, height):
    u, w = legendre.leggauss(4)
    X, Y = np.meshgrid(u * width / 2, u * height / 2)
    return (X.ravel(), Y.ravel()), np.outer(w, w).ravel() * width * height / 4


def moments(shape):
    return [float(np.squeeze(v)) for v in (shape.area, shape.second_moment_x, shape.second_moment_y)]


def torsion(width, height):
    return float(section.rectangle(np.array([width]), np.array([height])).torsion_constant[0])


def decimal_series(ratio, terms=150):
    """J / (a b³) for a = ratio · b by Saint-Venant's series with 40 digits, the rest of the series by ζ(5)."""
    getcontext().prec = 40
    pi = Decimal("3.141592653589793238462643383279502884197")
    zeta_five = Decimal("1.036927755143369926331365486457034168057")
    total = zeta_five * 31 / 32
    for n in range(1, 2 * terms, 2):
        decay = (-n * pi * ratio).exp()
        total -= 2 * decay / (1 + decay) / Decimal(n) ** 5
    return Decimal(1) / 3 - 64 / pi**5 / ratio * total


def poisson_torsion(width, height, N=36):
    """J = 2∫φ of Prandtl's problem ∇²φ = −2, φ = 0 on the boundary, by collocation."""
    D2 = chebyshev.differentiation_matrix(N, 2)[1:-1, 1:-1]
    one = np.eye(N - 1)
    operator = np.kron(D2 / width**2, one) + np.kron(one, D2 / height**2)
    phi = np.linalg.solve(operator, np.full((N - 1) ** 2, -2.0))
    w = chebyshev.quadrature_weights(N)[1:-1]
    return 2 * width * height * np.kron(w, w) @ phi


@pytest.mark.parametrize(("outer", "inner"), [(1.0, 0.0), (2e-3, 0.0), (1.5, 1.0), (3e-3, 2.9e-3)])
def test_annulus_vs_quadrature(outer, inner):
    shape = section.annulus(np.array([outer]), np.array([inner]))
    points, weights = polar_points(outer, inner)
    assert_allclose(moments(shape), integrals(points, weights), rtol=1e-12, atol=0)
    polar = weights @ (points[0] ** 2 + points[1] ** 2)
    assert_allclose(shape.torsion_constant, polar, rtol=1e-12, atol=0)


def test_circle_vs_annulus_without_a_hole():
    radius = np.array([0.5, 1.0, 2.0])
    found, expected = section.circle(radius), section.annulus(radius, 0 * radius)
    for name in ("area", "second_moment_x", "second_moment_y", "torsion_constant"):
        assert_allclose(getattr(found, name), getattr(expected, name), rtol=1e-15, atol=0)


@pytest.mark.parametrize(("width", "height"), [(1.0, 1.0), (2.0, 0.5), (1e-3, 4e-3)])
def test_rectangle_vs_quadrature(width, height):
    shape = section.rectangle(np.array([width]), np.array([height]))
    assert_allclose(moments(shape), integrals(*cartesian_points(width, height)), rtol=1e-13, atol=0)


@pytest.mark.parametrize("ratio", [1.0, 1.0625, 1.5, 2.0, 8.0, 128.0])
def test_saint_venant_constant_vs_series_with_forty_digits(ratio):
    assert_allclose(torsion(ratio, 1.0), ratio * float(decimal_series(Decimal(ratio))), rtol=4e-15, atol=0)


@pytest.mark.parametrize("ratio", [1.5, 2.0, 3.0])
def test_series_along_the_long_side_vs_series_along_the_short_side(ratio):
    crossed = decimal_series(1 / Decimal(ratio)) * Decimal(ratio) ** 3
    assert_allclose(torsion(ratio, 1.0), float(crossed), rtol=4e-15, atol=0)


def test_square_and_two_to_one_vs_known_digits():
    assert_allclose(torsion(1.0, 1.0), 0.1405770, rtol=0, atol=5e-8)
    assert_allclose(torsion(2.0, 1.0) / 2, 0.22868, rtol=0, atol=5e-6)


@pytest.mark.parametrize("ratio", PUBLISHED)
def test_saint_venant_constant_vs_published_table(ratio):
    assert_allclose(torsion(ratio, 1.0) / ratio, PUBLISHED[ratio], rtol=0, atol=6e-4)


@pytest.mark.parametrize(("width", "height"), [(1.0, 1.0), (2.0, 1.0), (0.7, 2.1)])
def test_saint_venant_constant_vs_poisson_solve(width, height):
    assert_allclose(torsion(width, height), poisson_torsion(width, height), rtol=5e-7, atol=0)


def test_saint_venant_constant_vs_thin_limit():
    ratio = 1e6
    assert_allclose(torsion(ratio, 1.0) / ratio, (1 - 0.6302 / ratio) / 3, rtol=1e-9, atol=0)


def test_saint_venant_constant_vs_turned_section():
    assert_allclose(torsion(0.3, 1.7), torsion(1.7, 0.3), rtol=1e-15, atol=0)


@pytest.mark.parametrize("ratio", [1.0, 2.0, 10.0])
def test_torsion_constant_vs_polar_moment_of_a_rectangle(ratio):
    """Slip of (1.21): J is I_xx + I_yy for circles only, and smaller elsewhere."""
    shape = section.rectangle(np.array([ratio]), np.array([1.0]))
    polar = (shape.second_moment_x + shape.second_moment_y)[0]
    assert shape.torsion_constant[0] < 0.85 * polar


def test_array_of_sections_vs_one_by_one():
    widths, heights = np.array([1.0, 2.0, 0.4]), np.array([1.0, 0.5, 3.0])
    found = section.rectangle(widths, heights).torsion_constant
    assert_allclose(found, [torsion(w, h) for w, h in zip(widths, heights, strict=True)], rtol=1e-15, atol=0)


def test_hooke_tensor_vs_definition():
    E, G, k = 200.0, 80.0, 0.8
    shape = section.rectangle(np.array([2.0]), np.array([1.0]))
    A, J = 2.0, 2 * float(decimal_series(Decimal(2)))
    expected = [E * 2 / 12, E * 8 / 12, G * J, k * G * A, k * G * A, E * A]
    assert_allclose(section.hooke(shape, E, G, k), [expected], rtol=1e-14, atol=0)
