"""Tables over time, and how near to zero they come: against SciPy's splines at many times."""

from __future__ import annotations

from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline, interp1d

from cosserat_casadi.maths.splines import Interpolation, cubic_coefficients, least_norm, spline_basis, table_values
from cosserat_casadi.maths.typing import FloatArray

KNOTS = np.array([0.1, 0.4, 0.5, 1.3])


def drawn(seed: int) -> FloatArray:
    return np.random.default_rng(seed).normal(size=(KNOTS.size, 4))


def of_scipy(values: FloatArray, interpolation: Interpolation, times: FloatArray) -> FloatArray:
    inside = np.clip(times, KNOTS[0], KNOTS[-1])
    if interpolation == "cubic":
        return np.asarray(CubicSpline(KNOTS, values, bc_type="clamped")(inside))
    kind = "previous" if interpolation == "step" else interpolation
    return np.asarray(interp1d(KNOTS, values, kind=kind, axis=0)(inside))


@pytest.mark.parametrize("interpolation", ["linear", "cubic", "step"])
def test_values_are_those_of_scipy(interpolation: Interpolation) -> None:
    values = drawn(1)
    times = np.linspace(-0.2, 1.6, 181)
    found = table_values(KNOTS, values, interpolation)(times)
    assert_allclose(found, of_scipy(values, interpolation, times), rtol=1e-12, atol=1e-12)


def test_weights_of_values_at_knots_are_those_of_scipy() -> None:
    """At numbers and at an expression, with its slope, which is one at knots too."""
    values = drawn(2)[:, 0]
    places = np.concatenate([np.linspace(0.0, 1.4, 29), KNOTS])
    wanted = of_scipy(values, "cubic", places)
    assert_allclose(values @ spline_basis(KNOTS, places), wanted, rtol=0, atol=1e-13)
    X = ca.MX.sym("X")
    along = ca.DM(values).T @ spline_basis(KNOTS, X)
    function = ca.Function("along", [X], [along, ca.jacobian(along, X)])
    value, slope = function.map(len(places))(ca.DM(places).T)
    assert_allclose(value.full()[0], wanted, rtol=0, atol=1e-13)
    inside = CubicSpline(KNOTS, values, bc_type="clamped")(places, 1)
    wanted = np.where((places > KNOTS[0]) & (places < KNOTS[-1]), inside, 0.0)
    assert_allclose(slope.full()[0], wanted, rtol=0, atol=1e-13)


def test_a_spline_may_have_no_curvature_at_its_ends() -> None:
    values = drawn(3)
    wanted = np.moveaxis(CubicSpline(KNOTS, values, bc_type="natural").c[::-1], 0, 1)
    assert_allclose(cubic_coefficients(KNOTS, values, natural=True), wanted, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
@pytest.mark.parametrize("seed", range(8))
def test_the_least_norm_is_that_of_many_times(interpolation: Interpolation, seed: int) -> None:
    values = drawn(seed)
    for start, end in pairwise(KNOTS.tolist()):
        norm, time = least_norm(table_values(KNOTS, values, interpolation), np.array([start, end]))
        times = np.linspace(start, end, 20001)
        norms = np.linalg.norm(of_scipy(values, interpolation, times), axis=1)
        assert_allclose(norm, norms.min(), rtol=1e-6, atol=1e-12)
        # Where the norm is least it hardly changes: the time is known to the square root of that.
        assert_allclose(time, times[norms.argmin()], rtol=0.0, atol=1e-3 * (end - start))


def test_a_path_that_turns_back_in_zero_is_found() -> None:
    """All derivatives but the third are zero there."""
    norm, time = least_norm(lambda t: (t[:, None] - 0.3) ** 3 * np.array([1.0, -2.0]), np.array([0.0, 1.0]))
    assert_allclose(norm, 0.0, rtol=0, atol=1e-14)
    assert_allclose(time, 0.3, rtol=0, atol=2e-5)


@pytest.mark.parametrize("size", [1e-300, 1e-150, 1.0, 1e150, 1e300])
@pytest.mark.parametrize("degree", [1, 2, 3])
def test_a_path_through_zero_is_found_at_any_size(size: float, degree: int) -> None:
    """What rounding leaves of higher degrees decides nothing: it is drawn anew each time."""
    random = np.random.default_rng(degree)
    for _ in range(10):
        zero = random.uniform(0.01, 0.99)
        direction = size * random.normal(size=4)

        def path(t: FloatArray, zero: float = zero, direction: FloatArray = direction) -> FloatArray:
            scalar = (t - zero) * (t + 1) ** (degree - 1)
            return scalar[:, None] * direction * (1 + 1e-16 * random.integers(-2, 3, (t.size, 4)))

        norm, time = least_norm(path, np.array([0.0, 1.0]))
        assert norm <= 1e-14 * 2**degree * np.abs(direction).max()
        assert_allclose(time, zero, rtol=0, atol=1e-13)


def test_a_size_changes_no_digit() -> None:
    values = drawn(3)
    found = [least_norm(table_values(KNOTS, values * size, "cubic"), KNOTS) for size in (2.0**-500, 1.0, 2.0**500)]
    assert [norm / size for (norm, _), size in zip(found, (2.0**-500, 1.0, 2.0**500), strict=True)] == [found[1][0]] * 3
    assert [time for _, time in found] == [found[1][1]] * 3


def test_the_least_of_many_pieces_is_that_of_the_least_one() -> None:
    """Of three thousand pieces one comes near to zero; norms that are no numbers are left aside."""
    times = np.linspace(0.0, 1.0, 3001)
    values = np.stack([np.cos(0.5 * times), np.sin(0.5 * times)], axis=1)
    values[1234] = [1e-3, 0.0]
    path = table_values(times, values, "linear")
    norm, time = least_norm(path, times)
    assert_allclose(norm, 1e-3, rtol=1e-12, atol=0)
    assert_allclose(time, times[1234], rtol=0, atol=1e-9)
    nowhere = least_norm(lambda t: np.full((t.size, 2), np.nan), times)
    assert nowhere == (np.inf, 0.0)
    beyond = least_norm(lambda t: np.where(t[:, None] < 0.5, np.inf, path(t)), times)
    middle_of_a_chord = np.cos(0.25 / 3000)
    assert_allclose(beyond[0], middle_of_a_chord, rtol=1e-12, atol=0)
