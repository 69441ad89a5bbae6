"""How fast the forward sweep converges with the number of nodes, and where it stops."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rods import CURVED, KIRCHHOFF, REISSNER, coordinates, reference_poses, rod, strain_basis

from cosserat_casadi.rod.kinematics import shape

PROPERTIES = rod(KIRCHHOFF, length=1.0)


def basis_of(nodes, transport, properties=PROPERTIES, breaks=(0.0, 1.0)):
    return strain_basis(properties, modes=4, nodes=nodes, transport=transport, breaks=breaks)


Q = coordinates(basis_of(2, "magnus8"), 11, 2.5)


def tip(basis, q=Q):
    return shape(basis, ca.DM(q)).position_at(basis.grid.size - 1).full().ravel()


@pytest.fixture(scope="module")
def reference():
    return reference_poses(basis_of(2, "magnus8"), Q)[1][-1]


def errors_of(transport, sizes, reference):
    return np.array([np.abs(tip(basis_of(n, transport)) - reference).max() for n in sizes])


@pytest.mark.parametrize(("transport", "order"), [("magnus4", 4), ("magnus6", 6), ("magnus8", 8)])
def test_slope_of_the_tip_error_vs_order_of_the_transport(transport, order, reference):
    errors = errors_of(transport, [8, 16, 24, 32], reference)
    slope = np.log(errors[2] / errors[3]) / np.log(32 / 24)
    assert abs(slope - order) < 0.3, (errors, slope)
    assert np.all(np.diff(errors) < 0)


def test_tip_error_of_the_permuted_system_vs_geometric_decay(reference):
    """Spectral: every four nodes more divide the error by 25 at least."""
    errors = errors_of("permuted", [8, 12, 16, 20], reference)
    assert np.all(errors[1:] < errors[:-1] / 25), errors


@pytest.mark.parametrize("transport", ["magnus8", "permuted"])
def test_tip_on_a_fine_grid_vs_dop853(transport, reference):
    nodes = 64 if transport == "magnus8" else 36
    assert_allclose(tip(basis_of(nodes, transport)), reference, rtol=0, atol=1e-12)


def test_tip_on_four_elements_vs_dop853():
    basis = basis_of(24, "magnus8", rod(REISSNER, CURVED, length=1.0), (0.0, 0.2, 0.5, 0.75, 1.0))
    q = coordinates(basis, 12, 1.5)
    assert_allclose(tip(basis, q), reference_poses(basis, q)[1][-1], rtol=0, atol=1e-12)


def test_planar_tip_error_vs_geometric_decay():
    """One axis: the rotation is exact whatever the grid, only the quadrature of the tangent is left."""
    basis = basis_of(4, "magnus4", rod((1,), length=1.0, intrinsic=((0.0,),) * 5 + ((1.0,),)))
    q = coordinates(basis, 13, 3.0)
    exact = reference_poses(basis, q)[1][-1]
    errors = [np.abs(tip(basis_of(n, "magnus4", basis.properties), q) - exact).max() for n in (4, 8, 12, 16, 24)]
    assert np.all(np.array(errors[1:4]) < np.array(errors[:3]) / 50), errors
    assert errors[-1] < 1e-13
