"""Derivatives of CasADi functions in every mode, and independent ones to compare them with."""

import casadi as ca
import numpy as np
import pytest


def _directional(y, x, transposed):
    """Jacobian assembled from forward or from reverse directional derivatives."""
    if transposed:
        return ca.vertcat(*(ca.jtimes(y, x, seed, True).T for seed in ca.horzsplit(ca.DM.eye(y.shape[0]))))
    return ca.horzcat(*(ca.jtimes(y, x, seed) for seed in ca.horzsplit(ca.DM.eye(x.shape[0]))))


def casadi_derivatives(function, point, symbol):
    """Value (m), Jacobian (m, n) and second derivatives (m, n, n), the same in every mode, or a failure.

    The Jacobian comes from ca.jacobian, from forward and from reverse sweeps; the second derivatives from
    ca.hessian of each output and from forward over reverse.
    """
    point = np.asarray(point, dtype=float)
    x = symbol.sym("x", len(point))
    y = ca.densify(ca.vec(function(x)))
    jacobians = [ca.jacobian(y, x), _directional(y, x, False), _directional(y, x, True)]
    hessians = [
        ca.vertcat(*(ca.hessian(entry, x)[0] for entry in ca.vertsplit(y))),
        ca.vertcat(*(_directional(row.T, x, False) for row in ca.vertsplit(jacobians[2]))),
        ca.vertcat(*(_directional(row.T, x, True) for row in ca.vertsplit(jacobians[1]))),
    ]
    f = ca.Function("f", [x], [ca.densify(e) for e in (y, *jacobians, *hessians)])
    value, *rest = (entry.full() for entry in f(point))
    assert all(np.all(np.isfinite(entry)) for entry in (value, *rest))
    for other in rest[1:3]:
        np.testing.assert_allclose(other, rest[0], rtol=1e-12, atol=1e-13)
    for other in rest[4:]:
        np.testing.assert_allclose(other, rest[3], rtol=1e-11, atol=1e-11)
    return value.ravel(), rest[0], rest[3].reshape(len(value), len(point), len(point))


def complex_step_jacobian(function, point):
    """Jacobian of an analytic NumPy function, exact to rounding, without CasADi."""
    point = np.asarray(point, dtype=complex)
    steps = point + 1e-30j * np.eye(len(point))
    return np.stack([np.ravel(function(step), order="F").imag / 1e-30 for step in steps], axis=1)


def differenced_hessian(function, point):
    """Second derivatives (m, n, n): fourth-order differences of the complex-step Jacobian, good to 1e-9."""
    point = np.asarray(point, dtype=float)
    h = 2e-3

    def slope(direction):
        jacobian = {k: complex_step_jacobian(function, point + k * h * direction) for k in (-2, -1, 1, 2)}
        return (jacobian[-2] - 8 * jacobian[-1] + 8 * jacobian[1] - jacobian[2]) / (12 * h)

    return np.stack([slope(direction) for direction in np.eye(len(point))], axis=2)


def check_derivatives(function, reference, point):
    """Value, Jacobian and second derivatives in SX and in MX against an independent reference."""
    for symbol in (ca.SX, ca.MX):
        value, jacobian, hessian = casadi_derivatives(function, point, symbol)
        expected = np.ravel(reference(np.asarray(point, dtype=complex)), order="F").real
        np.testing.assert_allclose(value, expected, rtol=1e-13, atol=4e-15)
        np.testing.assert_allclose(jacobian, complex_step_jacobian(reference, point), rtol=1e-11, atol=1e-13)
        np.testing.assert_allclose(hessian, differenced_hessian(reference, point), rtol=1e-8, atol=1e-9)


@pytest.fixture(name="check_derivatives")
def check_derivatives_fixture():
    return check_derivatives


@pytest.fixture(name="casadi_derivatives")
def casadi_derivatives_fixture():
    return casadi_derivatives
