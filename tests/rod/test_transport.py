"""Functions of one interval against automatic differentiation and finite differences."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rods import CURVED, KIRCHHOFF, PLANAR, REISSNER, hat, rod, strain_basis
from scipy.linalg import expm

from cosserat_casadi.maths import magnus
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.rod.transport import IntervalKernels, interval_turns

MOMENT = np.array([0.7, -1.2, 0.4])
CASES = [((0, 1, 2), 2), ((0, 1, 2), 3), ((0, 1, 2), 4), ((1,), 1), ((0, 2), 3), ((0, 1, 2), 1)]
every_kernel = pytest.mark.parametrize(("axes", "count"), CASES)
every_size = pytest.mark.parametrize("size", [0.0, 0.6])


def kernels_at(axes, count, size):
    """Kernels, a turn, and the rotation at which the interval begins: about the axis where there is but one."""
    kernels = IntervalKernels(axes, count)
    turn = size * np.random.default_rng(count).uniform(-1, 1, kernels.size)
    axis = np.array([0.4, -0.8, 0.5]) if len(axes) > 1 else np.eye(3)[axes[0]]
    return kernels, turn, expm(hat(axis))


def at(kernels, turn, R):
    """Arguments of the kernels of derivatives."""
    _, omega, factors = kernels.increment(turn)
    return turn, omega, factors, R, MOMENT


@every_size
@every_kernel
def test_turning_vs_central_differences_of_the_increment(axes, count, size):
    kernels, turn, R = kernels_at(axes, count, size)
    turning = kernels.variation(*at(kernels, turn, R))[0].full()
    here, step = quaternion_to_matrix(kernels.increment(turn)[0]).full(), 1e-5
    for column, d in zip(turning.T, step * np.eye(kernels.size), strict=True):
        ahead, behind = (quaternion_to_matrix(kernels.increment(turn + s * d)[0]).full() for s in (1, -1))
        spin = R @ (ahead - behind) @ here.T @ R.T / (2 * step)
        assert_allclose(hat(column), spin, rtol=0, atol=1e-9)


@every_size
@every_kernel
def test_pull_vs_work_on_the_turning(axes, count, size):
    kernels, turn, R = kernels_at(axes, count, size)
    turning = kernels.variation(*at(kernels, turn, R))[0].full()
    assert_allclose(kernels.pull(*at(kernels, turn, R)).full().ravel(), turning.T @ MOMENT, rtol=0, atol=1e-15)


@every_size
@every_kernel
def test_variation_of_the_pull_vs_ad(axes, count, size):
    kernels, turn, R = kernels_at(axes, count, size)
    x = ca.MX.sym("x", kernels.size)
    derivative = ca.Function("f", [x], [ca.jacobian(kernels.pull(*at(kernels, x, R)), x)])(turn).full()
    turning, stiffness, second = (v.full() for v in kernels.variation(*at(kernels, turn, R)))
    assert_allclose(turning.T @ stiffness @ turning + second, derivative, rtol=0, atol=1e-14)
    assert_allclose(second, second.T, rtol=0, atol=0)


@pytest.mark.parametrize("transport", ["magnus4", "magnus6", "magnus8"])
@pytest.mark.parametrize("nodes", [4, 5])
@pytest.mark.parametrize("breaks", [(0.0, 1.0), (0.0, 0.3, 1.0)])
@pytest.mark.parametrize("admitted", [PLANAR, KIRCHHOFF, REISSNER, (2, 4)])
def test_turn_matrix_vs_taylor_matrices(admitted, breaks, nodes, transport):
    basis = strain_basis(rod(admitted, CURVED), modes=4, nodes=nodes, breaks=breaks, transport=transport)
    matrix = basis.turn_matrix
    q = np.random.default_rng(0).uniform(-1, 1, basis.size)
    rows = [
        intrinsic[:, axis] + (matrices[axis] @ q[basis.columns[axis]] if axis in matrices else 0.0)
        for intrinsic, matrices in zip(basis.intrinsic_taylor, basis.taylor_matrices, strict=True)
        for axis in basis.properties.turning_axes
    ]
    assert_allclose(interval_turns(basis, ca.DM(q)).full(), np.array(rows), rtol=0, atol=1e-15)
    derivative = matrix.unfolded.full()
    field = np.random.default_rng(1).uniform(-1, 1, len(derivative))
    pulled = basis.turn_axes.transposed_times(ca.DM(field)).full().ravel()
    assert_allclose(pulled, (derivative.T @ field)[: pulled.size], rtol=0, atol=1e-14)
    assert not np.any(derivative[:, pulled.size :])
    assert derivative.shape == (np.size(rows), basis.size)
    modes = [max(0, 4 - order) for order in range(basis.taylor_count) for c in basis.columns if c < 3]
    assert matrix.half.nnz() <= (0.5 if nodes % 2 == 0 else 0.55) * nodes * basis.grid.elements * sum(modes)


@pytest.mark.parametrize("breaks", [(0.0, 1.0), (0.0, 0.3, 1.0)])
def test_node_matrix_vs_shape_functions_at_the_nodes(breaks):
    basis = strain_basis(rod(REISSNER), modes=4, nodes=6, breaks=breaks)
    for c in basis.columns:
        matrix = basis.node_matrices[c]
        assert_allclose(matrix.unfolded.full(), basis.at_nodes[c], rtol=0, atol=1e-14)
        assert matrix.half.nnz() <= 4 * (len(breaks) - 1) * 4


def test_increment_vs_expm_of_its_rotation_vector():
    kernels, turn, _ = kernels_at((0, 1, 2), 3, 0.6)
    omega = magnus.rotation_increment([ca.DM(a) for a in turn.reshape(3, 3)]).full().ravel()
    assert_allclose(quaternion_to_matrix(kernels.increment(turn)[0]).full(), expm(hat(omega)), rtol=0, atol=1e-15)
