"""Tables over time, and how near to zero they come: against SciPy's splines at many times."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline, interp1d

from cosserat_casadi.maths.splines import Interpolation, least_norm, table_values
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


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
@pytest.mark.parametrize("seed", range(8))
def test_the_least_norm_is_that_of_many_times(interpolation: Interpolation, seed: int) -> None:
    values = drawn(seed)
    for start, end in pairwise(KNOTS.tolist()):
        norm, time = least_norm(table_values(KNOTS, values, interpolation), start, end)
        times = np.linspace(start, end, 20001)
        norms = np.linalg.norm(of_scipy(values, interpolation, times), axis=1)
        assert_allclose(norm, norms.min(), rtol=1e-6, atol=1e-12)
        # Where the norm is least it hardly changes: the time is known to the square root of that.
        assert_allclose(time, times[norms.argmin()], rtol=0.0, atol=1e-3 * (end - start))


def test_a_path_that_turns_back_in_zero_is_found() -> None:
    """All roots of the derivative fall together there."""
    norm, time = least_norm(lambda t: (t[:, None] - 0.3) ** 3 * np.array([1.0, -2.0]), 0.0, 1.0)
    assert_allclose(norm, 0.0, atol=1e-7)
    assert_allclose(time, 0.3, atol=1e-2)
