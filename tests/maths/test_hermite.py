"""Monotone cubic curves against SciPy's, and their integrals as expressions."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import PchipInterpolator

from cosserat_casadi.maths.splines import HermiteCurve, monotone_curve

TABLES = {
    "two points": ([-1.0, 2.0], [-0.5, 1.0]),
    "three points": ([-1.0, 0.0, 4.0], [-2.0, 0.0, 1.0]),
    "level in the middle": ([-2.0, -1.0, 0.0, 1.0, 3.0], [-1.0, 0.0, 0.0, 0.0, 2.0]),
    "steep end": ([-1.0, 0.0, 0.1, 5.0], [-1.0, 0.0, 3.0, 3.1]),
    "uneven": ([-3.0, -1.0, 0.0, 0.5, 2.0, 2.2], [-7.0, -1.0, 0.0, 0.1, 4.0, 9.0]),
}


def functions(curve: HermiteCurve) -> tuple[ca.Function, ca.Function, ca.Function]:
    """Integral, its derivative and its second derivative."""
    at = ca.SX.sym("at")
    integral = curve.integral(at)
    first = ca.jacobian(integral, at)
    return tuple(ca.Function("f", [at], [e]) for e in (integral, first, ca.jacobian(first, at)))


@pytest.mark.parametrize("name", TABLES)
def test_curve_vs_scipy(name: str) -> None:
    abscissae, values = map(np.array, TABLES[name])
    reference = PchipInterpolator(abscissae, values)
    primitive = reference.antiderivative()
    integral, curve, slope = functions(monotone_curve(abscissae, values))
    # The points themselves are among them: derivatives there are those of one side, and not their sum.
    at = np.sort(np.concatenate([np.linspace(abscissae[0], abscissae[-1], 40), abscissae]))
    for function, wanted in (
        (integral, primitive(at) - primitive(0.0)),
        (curve, reference(at)),
    ):
        assert_allclose(function.map(len(at))(at).full()[0], wanted, rtol=1e-12, atol=1e-13)
    # The slope is continuous too; its derivative is not, so that either side will do.
    inside = at[~np.isin(at, abscissae)]
    assert_allclose(slope.map(len(inside))(inside).full()[0], reference(inside, 1), rtol=1e-11, atol=1e-12)
    assert_allclose(slope.map(len(abscissae))(abscissae).full()[0], reference(abscissae, 1), rtol=1e-10, atol=1e-11)


@pytest.mark.parametrize("name", TABLES)
def test_curve_goes_on_straight_beyond_its_ends(name: str) -> None:
    abscissae, values = map(np.array, TABLES[name])
    reference = PchipInterpolator(abscissae, values)
    _, curve, slope = functions(monotone_curve(abscissae, values))
    for end, beyond in ((abscissae[0], abscissae[0] - 2.0), (abscissae[-1], abscissae[-1] + 3.0)):
        rise = reference(end, 1)
        assert_allclose(float(slope(beyond)), rise, rtol=1e-12, atol=1e-12)
        assert_allclose(float(curve(beyond)), reference(end) + rise * (beyond - end), rtol=1e-12, atol=1e-12)


def test_points_that_rise_give_a_curve_that_never_falls() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        abscissae = np.cumsum(rng.uniform(0.01, 1.0, 9))
        values = np.cumsum(rng.exponential(1.0, 9) ** 3)
        _, _, slope = functions(monotone_curve(abscissae, values))
        at = np.linspace(abscissae[0], abscissae[-1], 300)
        assert slope.map(len(at))(at).full().min() >= -1e-10 * values[-1]
