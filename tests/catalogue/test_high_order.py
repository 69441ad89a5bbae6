"""Catalogue (k): high order stays at rounding, and why."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import solve
from tests.catalogue import cases
from tests.catalogue.checks import fine_model
from tests.reference.closed_forms import elastica

SIZES = [16, 32, 64, 128]


@pytest.mark.parametrize(
    ("modes", "nodes"), [(24, 60), (40, 128), (64, 256), pytest.param(64, 512, marks=pytest.mark.slow)]
)
def test_error_stays_at_rounding_as_the_order_grows(modes: int, nodes: int) -> None:
    """F L²/EI = 10: resolved to rounding with 24 modes; no digit is lost with 64 modes and 256 intervals."""
    found = solve(fine_model(cases.table({}, cases.tip([10.0, 0, 0])), modes, nodes))
    assert found.converged, found.message
    shortening, across, _ = elastica(10.0)
    assert_allclose(found.tip().position, [across, 0, 1 - shortening], rtol=0, atol=2e-13)


@pytest.mark.slow
def test_high_order_in_space_stays_at_rounding() -> None:
    coarse, fine = (solve(fine_model(cases.slender(1e4), *size)) for size in ((24, 60), (64, 256)))
    assert_allclose(fine.tip().position, coarse.tip().position, rtol=0, atol=1e-12)
    assert_allclose(fine.tip().rotation, coarse.tip().rotation, rtol=0, atol=1e-12)


def test_condition_of_the_differentiation_form_grows_and_of_the_volterra_form_does_not() -> None:
    """The square of the points, against a constant: why the rotation is integrated, not differentiated."""
    conditions = np.array(
        [[np.linalg.cond(matrix) for matrix in cases.quaternion_matrices(2 * np.pi, N)] for N in SIZES]
    )
    differentiation, volterra = conditions.T
    assert cases.growth_exponent(SIZES, list(differentiation)) > 1.7
    assert differentiation[-1] > 1e3
    assert abs(cases.growth_exponent(SIZES, list(volterra))) < 0.1
    assert volterra.max() < 50
