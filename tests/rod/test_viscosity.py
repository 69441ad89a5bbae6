"""Viscous stress against quadrature along the rod, and its powers and derivatives against AD."""

from dataclasses import replace
from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from numpy.polynomial import legendre
from numpy.testing import assert_allclose
from rods import KIRCHHOFF, PLANAR, REISSNER, coordinates, massive, rod, strain_basis, tapered

from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.rod_motion import StrainRates
from cosserat_casadi.rod.viscosity import Viscosity

RODS = pytest.mark.parametrize("admitted", [PLANAR, KIRCHHOFF, REISSNER, (1, 5)])
RATIOS = pytest.mark.parametrize("ratio", [None, 1.3], ids=["fixed", "drawn-out"])
BREAKS = (0.0, 0.35, 1.0)
RATIO_RATE = 0.4


def damped(admitted):
    return strain_basis(massive(rod(admitted), damped=True), modes=3, nodes=6, breaks=BREAKS)


def viscosity(basis, q, v, ratio):
    changing = [None, None] if ratio is None else [ca.DM(RATIO_RATE), ca.DM(0.0)]
    rod_shape = shape(basis, q, None if ratio is None else ca.DM(ratio))
    return Viscosity(rod_shape, StrainRates(v, ca.DM.zeros(basis.size, 1), *changing))


def strain_rate_along(basis, q, v, ratio):
    """Gauss points of all elements, their weights, and ξ̇ there by AD of the strain, 6×k."""
    points, weights = legendre.leggauss(12)
    X = np.concatenate([a + (b - a) * (points + 1) / 2 for a, b in pairwise(BREAKS)])
    dX = np.concatenate([(b - a) * weights / 2 for a, b in pairwise(BREAKS)])
    t = ca.MX.sym("t")
    length_ratio = 1.0 if ratio is None else ratio + t * RATIO_RATE
    strain = basis.at(ca.DM(q) + t * ca.DM(v), X, length_ratio)
    rate = ca.reshape(ca.jacobian(ca.vec(strain), t), *strain.shape)
    return X, dX, ca.Function("rate", [t], [ca.densify(rate)])(0.0).full()


@RATIOS
@RODS
def test_force_and_power_vs_quadrature(admitted, ratio):
    """The stress Υ ξ̇ does the work ℓ ∫ (Υ ξ̇)·δξ dX along the rod as long as it is."""
    basis = damped(admitted)
    q, v = coordinates(basis, 1), coordinates(basis, 2)
    X, dX, rate = strain_rate_along(basis, q, v, ratio)
    length = basis.length * (ratio or 1.0)
    stress = basis.properties.damping(X).T * rate
    found = viscosity(basis, ca.DM(q), ca.DM(v), ratio)
    power = length * np.sum(dX * np.sum(stress * rate, axis=0))
    assert_allclose(float(found.dissipated_power), power, rtol=1e-12, atol=0)
    assert power > 0
    expected = []
    for direction in np.eye(basis.size):
        moved = basis.at(ca.DM(direction), X, ratio or 1.0).full() - basis.at(ca.DM(basis.size, 1), X).full()
        expected.append(length * np.sum(dX * np.sum(stress * moved, axis=0)))
    assert_allclose(basis.energy_unit * found.force.full().ravel(), expected, rtol=0, atol=1e-13)


@RATIOS
@RODS
def test_derivatives_vs_ad(admitted, ratio):
    basis = damped(admitted)
    q, v = ca.MX.sym("q", basis.size), ca.MX.sym("v", basis.size)
    written = viscosity(basis, q, v, ratio)
    expected = [ca.jacobian(written.force, symbol) for symbol in (q, v)]
    found = [written.stiffness, written.damping]
    compare = ca.Function("compare", [q, v], [ca.densify(ca.MX(value)) for value in (*found, *expected)])
    values = [value.full() for value in compare(coordinates(basis, 1), coordinates(basis, 2))]
    assert_allclose(values[0], values[2], rtol=0, atol=1e-13)
    assert_allclose(values[1], values[3], rtol=0, atol=1e-13)


@RATIOS
@RODS
def test_power_of_the_stress_is_what_is_dissipated(admitted, ratio):
    """On the rates of the coordinates and on that of the length together."""
    basis = damped(admitted)
    q, v = coordinates(basis, 1), coordinates(basis, 2)
    found = viscosity(basis, ca.DM(q), ca.DM(v), ratio)
    power = basis.energy_unit * found.force.full().ravel() @ v
    if ratio is not None:
        power += float(found.shrinking_power)
    assert_allclose(power, float(found.dissipated_power), rtol=1e-12, atol=0)


@pytest.mark.parametrize("hooke", [None, tapered])
def test_retardation_time_is_a_share_of_the_stiffness(hooke):
    properties = rod(REISSNER, hooke=hooke)
    retarded = replace(properties, damping=lambda X: 0.03 * properties.hooke(X))
    basis = strain_basis(retarded, modes=3, breaks=BREAKS)
    assert_allclose(basis.viscosity, 0.03 * basis.stiffness, rtol=1e-14, atol=1e-18)
    assert not strain_basis(properties).viscosity.any()


def test_no_rate_no_stress():
    basis = damped(REISSNER)
    zero = ca.DM.zeros(basis.size, 1)
    still = viscosity(basis, ca.DM(coordinates(basis)), zero, None)
    assert_allclose(still.force.full(), 0.0, rtol=0, atol=0)
