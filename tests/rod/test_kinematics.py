"""Forward sweep against the exponential of SE(3), against DOP853 in R and in Q, and against chapter 3."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rods import (
    KIRCHHOFF,
    PLANAR,
    REISSNER,
    STRAIGHT,
    coordinates,
    element_strain,
    hat,
    reference_poses,
    rod,
    strain_basis,
)
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from cosserat_casadi.maths.rotation import quaternion_rate_matrix
from cosserat_casadi.rod.kinematics import shape

MAGNUS = pytest.mark.parametrize("transport", ["magnus4", "magnus6", "magnus8"])
BREAKS = pytest.mark.parametrize("breaks", [(0.0, 1.0), (0.0, 0.35, 1.0)])


def swept(basis, q):
    return shape(basis, ca.DM(q))


def rotations(pose):
    """Rotation matrices at the nodes, (M, 3, 3)."""
    return np.stack([d.full().T for d in pose.directors], axis=2)


def test_reference_strain_vs_strain_of_the_basis():
    basis = strain_basis(rod(REISSNER), modes=3, breaks=(0.0, 0.35, 1.0))
    q = coordinates(basis)
    found = np.array([element_strain(basis, q, 1)(x) for x in (0.4, 0.9, 1.0)])
    assert_allclose(found, basis.at(ca.DM(q), np.array([0.4, 0.9, 1.0])).full().T, rtol=1e-12, atol=1e-13)


@MAGNUS
@BREAKS
@pytest.mark.parametrize("seed", range(4))
def test_constant_strain_vs_exponential_of_a_twist(seed, transport, breaks):
    basis = strain_basis(rod(REISSNER, STRAIGHT), modes=1, nodes=24, breaks=breaks, transport=transport)
    xi = np.random.default_rng(seed).uniform(-3, 3, 6)
    q = np.repeat((xi - [0, 0, 0, 0, 0, 1]) / basis.scales, len(breaks) - 1)
    pose = swept(basis, q)
    twist = np.zeros((4, 4))
    twist[:3, :3], twist[:3, 3] = hat(xi[:3]), xi[3:]
    places = [1, 9, 17, basis.grid.size - 1]
    expected = np.array([expm(basis.properties.length * x * twist) for x in basis.grid.nodes[places]])
    assert_allclose(rotations(pose)[places], expected[:, :3, :3], rtol=0, atol=1e-14)
    assert_allclose(pose.position.full().T[places], expected[:, :3, 3], rtol=0, atol=1e-14)


@BREAKS
@pytest.mark.parametrize("polynomials", ["legendre", "chebyshev"])
@pytest.mark.parametrize("admitted", [KIRCHHOFF, REISSNER, (1, 5), (2, 3)])
def test_poses_vs_dop853(admitted, polynomials, breaks):
    basis = strain_basis(rod(admitted, basis=polynomials), nodes=32, breaks=breaks)
    q = coordinates(basis, 1, 1.5)
    pose, (R, r) = swept(basis, q), reference_poses(basis, q)
    assert_allclose(rotations(pose), R, rtol=0, atol=1e-12)
    assert_allclose(pose.position.full().T, r, rtol=0, atol=1e-12)


def test_quaternions_vs_dop853_of_the_rate_matrix():
    """Routes (1.9) in R, (1.10) in Q and the product of exponentials agree."""
    basis = strain_basis(rod(), nodes=32)
    q = coordinates(basis, 2, 1.5)
    strain = element_strain(basis, q, 0)

    def rate(x, Q):
        return basis.properties.length / 2 * quaternion_rate_matrix(ca.DM(strain(x)[:3])).full() @ Q

    nodes = basis.grid.nodes
    reference = solve_ivp(rate, (0, 1), [1, 0, 0, 0], "DOP853", nodes, rtol=1e-12, atol=1e-14).y
    assert_allclose(swept(basis, q).quaternion.full(), reference, rtol=0, atol=1e-11)
    matrices = Rotation.from_quat(reference[[1, 2, 3, 0]].T).as_matrix()
    assert_allclose(matrices, reference_poses(basis, q)[0], rtol=0, atol=1e-11)


def test_quaternion_rate_of_the_body_vs_rate_of_the_world():
    """Slip of (1.6): K multiplies from the right; from the left the poses differ."""
    basis = strain_basis(rod(), nodes=24)
    q = coordinates(basis, 2, 1.5)
    R, _ = reference_poses(basis, q)
    strain, length = element_strain(basis, q, 0), basis.properties.length

    def printed(x, y):
        return length * (hat(strain(x)[:3]) @ y.reshape(3, 3)).ravel()

    left = solve_ivp(printed, (0, 1), np.eye(3).ravel(), "DOP853", rtol=1e-10).y[:, -1].reshape(3, 3)
    assert_allclose(rotations(swept(basis, q))[-1], R[-1], rtol=0, atol=1e-11)
    assert np.abs(left - R[-1]).max() > 1e-3


@BREAKS
@pytest.mark.parametrize("admitted", [KIRCHHOFF, (0, 2, 3)])
def test_permuted_transport_vs_magnus8(admitted, breaks):
    q = coordinates(strain_basis(rod(admitted), breaks=breaks), 3)
    poses = [
        swept(strain_basis(rod(admitted), nodes=nodes, breaks=breaks, transport=transport), q)
        for nodes, transport in ((24, "permuted"), (24, "magnus8"))
    ]
    assert_allclose(poses[0].quaternion.full(), poses[1].quaternion.full(), rtol=0, atol=1e-12)
    assert_allclose(poses[0].position.full(), poses[1].position.full(), rtol=0, atol=1e-12)


@pytest.mark.parametrize("transport", ["magnus6", "permuted"])
@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
def test_symbolic_sweep_vs_numeric_sweep(symbol, transport):
    basis = strain_basis(rod(REISSNER), nodes=5, modes=2, transport=transport, breaks=(0.0, 0.35, 1.0))
    q = symbol.sym("q", basis.size)
    f = ca.Function("f", [q], [shape(basis, q).quaternion, shape(basis, q).position])
    values = coordinates(basis)
    expected = swept(basis, values)
    for found, reference in zip(f(values), (expected.quaternion, expected.position), strict=True):
        assert_allclose(found.full(), reference.full(), rtol=1e-11, atol=1e-12)


@MAGNUS
@pytest.mark.parametrize("size", [0.0, 1.0, 10.0])
def test_norm_of_quaternions_vs_one(transport, size):
    basis = strain_basis(rod(), nodes=24, transport=transport)
    quaternion = swept(basis, coordinates(basis, 5, size)).quaternion.full()
    assert_allclose(np.linalg.norm(quaternion, axis=0), 1.0, rtol=1e-14, atol=0)


@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
@pytest.mark.parametrize(("axis", "zeros"), [(0, (2, 3)), (1, (1, 3)), (2, (1, 2))])
def test_planar_quaternion_vs_structural_zeros(axis, zeros, symbol):
    basis = strain_basis(rod((axis,), STRAIGHT), breaks=(0.0, 0.5, 1.0))
    pose = shape(basis, symbol.sym("q", basis.size))
    rows = ca.vertsplit(pose.quaternion)
    assert [row.nnz() for row in rows] == [0 if i in zeros else basis.grid.size for i in range(4)]
    if axis < 2:
        assert pose.position[axis, :].nnz() == 0
    else:
        assert pose.position[:2, :].nnz() == 0


@pytest.mark.parametrize("curved", [False, True])
def test_planar_sweep_vs_closed_form_of_the_angle(curved):
    intrinsic = ((0.7, -0.4), *STRAIGHT[1:]) if curved else STRAIGHT
    basis = strain_basis(rod(PLANAR, intrinsic), nodes=20, transport="magnus4")
    q = coordinates(basis, 6, 2.0)
    strain = basis.at(ca.DM(q), basis.grid.nodes).full()[0]
    angle = basis.properties.length * basis.grid.integration_matrix @ strain
    pose = swept(basis, q)
    assert_allclose(pose.quaternion.full()[:2], [np.cos(angle / 2), np.sin(angle / 2)], rtol=0, atol=2e-15)
    expected = basis.properties.length * basis.grid.integration_matrix @ np.cos(angle)
    assert_allclose(pose.position.full()[2], expected, rtol=0, atol=1e-15)


def test_rod_that_cannot_turn_vs_straight_line():
    basis = strain_basis(rod((3, 5), STRAIGHT), modes=2)
    q = coordinates(basis)
    pose = swept(basis, q)
    strain = basis.at(ca.DM(q), basis.grid.nodes).full()[3:]
    assert_allclose(pose.quaternion.full()[0], 1.0, rtol=0, atol=0)
    expected = basis.properties.length * strain @ basis.grid.integration_matrix.T
    assert_allclose(pose.position.full(), expected, rtol=0, atol=1e-15)


def test_position_and_rotation_of_one_node_vs_all_nodes():
    basis = strain_basis(rod(REISSNER), breaks=(0.0, 0.35, 1.0))
    pose = swept(basis, coordinates(basis))
    for node in (0, 7, basis.grid.node_at(0.35), basis.grid.size - 1):
        assert_allclose(pose.position_at(node).full().ravel(), pose.position.full()[:, node], rtol=0, atol=1e-15)
        assert_allclose(pose.rotation_at(node).full(), rotations(pose)[node], rtol=0, atol=0)


def test_turn_to_the_body_and_back_vs_identity():
    basis = strain_basis(rod(REISSNER), breaks=(0.0, 0.35, 1.0))
    pose = swept(basis, coordinates(basis))
    vectors = np.random.default_rng(8).normal(size=(3, basis.grid.size))
    body = np.einsum("kij,ik->jk", rotations(pose), vectors)
    assert_allclose(pose.to_body(ca.DM(vectors)).full(), body, rtol=0, atol=1e-14)
    assert_allclose(pose.to_base(ca.DM(body)).full(), vectors, rtol=0, atol=1e-14)
