"""Rigid motions: group laws, duality of twists and wrenches, exponential and logarithm."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm, logm
from scipy.spatial.transform import Rotation

from tests.families import mostly_slow
from tests.reference import rigid_motions

AXIS = np.array([2.0, -3.0, 6.0]) / 7.0
SHIFT = np.array([0.4, -1.1, 0.7])


def normal(*shape):
    """Normal numbers that depend on the shape alone, so that no test depends on another."""
    return np.random.default_rng((40, *shape)).normal(size=shape)


TWISTS = {
    "random": normal(6),
    "zero": np.zeros(6),
    "translation": np.concatenate([np.zeros(3), SHIFT]),
    "near_zero": 1e-9 * np.concatenate([AXIS, SHIFT]),
    "almost_translation": np.concatenate([1e-9 * AXIS, SHIFT]),
    "rotation": np.concatenate([2.0 * AXIS, np.zeros(3)]),
    "near_half_turn": np.concatenate([(np.pi - 1e-7) * AXIS, SHIFT]),
    "half_turn": np.concatenate([np.pi * AXIS, SHIFT]),
}
SHORT = [name for name in TWISTS if name != "half_turn"]


def by_name(names=tuple(TWISTS)):
    return pytest.mark.parametrize("xi", [TWISTS[name] for name in names], ids=names)


def np_twist_hat(xi):
    k, g = xi[:3], xi[3:]
    return np.array([[0, -k[2], k[1], g[0]], [k[2], 0, -k[0], g[1]], [-k[1], k[0], 0, g[2]], [0, 0, 0, 0]])


def np_vee(m):
    return np.array([m[2, 1], m[0, 2], m[1, 0], *m[:3, 3]])


def random_transform(seed):
    r = np.random.default_rng(seed).normal(size=3)
    return rigid_motions.transform(ca.DM(Rotation.random(rng=seed).as_matrix()), ca.DM(r))


def full(matrix):
    return ca.DM(matrix).full()


def test_transform_moves_points_and_inverse_moves_them_back():
    T = random_transform(1)
    R, r = full(T)[:3, :3], full(T)[:3, 3]
    p = normal(3)
    assert_allclose((full(T) @ [*p, 1])[:3], R @ p + r, rtol=1e-14, atol=1e-15)
    assert_allclose(full(T)[3], [0, 0, 0, 1], rtol=0, atol=0)
    assert_allclose(full(rigid_motions.transform_inverse(T)), np.linalg.inv(full(T)), rtol=1e-13, atol=1e-15)


def test_twist_hat_is_angular_first():
    xi = TWISTS["random"]
    assert_allclose(full(rigid_motions.twist_hat(ca.DM(xi))), np_twist_hat(xi), rtol=0, atol=0)


def test_adjoint_is_conjugation():
    T, xi = random_transform(2), normal(6)
    conjugated = full(T) @ np_twist_hat(xi) @ np.linalg.inv(full(T))
    assert_allclose(full(rigid_motions.adjoint(T)) @ xi, np_vee(conjugated), rtol=1e-13, atol=1e-14)


def test_adjoint_is_a_group_homomorphism():
    A, B = random_transform(3), random_transform(4)
    product = full(rigid_motions.adjoint(A)) @ full(rigid_motions.adjoint(B))
    assert_allclose(full(rigid_motions.adjoint(A @ B)), product, rtol=1e-13, atol=1e-14)
    inverse = np.linalg.inv(full(rigid_motions.adjoint(A)))
    found = full(rigid_motions.adjoint(rigid_motions.transform_inverse(A)))
    assert_allclose(found, inverse, rtol=1e-13, atol=1e-14)


def test_ad_is_the_commutator_and_obeys_jacobi():
    a, b, c = normal(3, 6)

    def bracket(x, y):
        return full(rigid_motions.ad(ca.DM(x))) @ y

    commutator = np_twist_hat(a) @ np_twist_hat(b) - np_twist_hat(b) @ np_twist_hat(a)
    assert_allclose(bracket(a, b), np_vee(commutator), rtol=1e-13, atol=1e-14)
    cyclic = bracket(a, bracket(b, c)) + bracket(b, bracket(c, a)) + bracket(c, bracket(a, b))
    assert_allclose(cyclic, np.zeros(6), rtol=0, atol=1e-13)


@by_name()
def test_adjoint_of_the_exponential_is_the_exponential_of_ad(xi):
    found = full(rigid_motions.adjoint(rigid_motions.rigid_exp(ca.DM(xi))))
    assert_allclose(found, expm(full(rigid_motions.ad(ca.DM(xi)))), rtol=1e-13, atol=5e-14)


def test_wrench_transform_conserves_power_and_moves_a_force():
    b_T_a = random_transform(5)
    a_twist, b_wrench = normal(2, 6)
    a_wrench = full(rigid_motions.wrench_transform(b_T_a, ca.DM(b_wrench))).ravel()
    b_twist = full(rigid_motions.adjoint(b_T_a)) @ a_twist
    assert_allclose(a_wrench @ a_twist, b_wrench @ b_twist, rtol=1e-13, atol=1e-14)
    R, p = full(b_T_a)[:3, :3], full(b_T_a)[:3, 3]
    couple, force = b_wrench[:3], b_wrench[3:]
    expected = np.concatenate([R.T @ (couple - np.cross(p, force)), R.T @ force])
    assert_allclose(a_wrench, expected, rtol=1e-13, atol=1e-14)


@by_name()
def test_rigid_exp_derivatives(xi, check_derivatives):
    check_derivatives(rigid_motions.rigid_exp, lambda x: expm(np_twist_hat(x)), xi)


@by_name()
def test_rigid_exp_of_the_opposite_twist_is_the_inverse(xi):
    there, back = (rigid_motions.rigid_exp(ca.DM(sign * xi)) for sign in (1, -1))
    assert_allclose(full(there @ back), np.eye(4), rtol=0, atol=3e-15)


@by_name(SHORT)
@pytest.mark.parametrize("symbol", mostly_slow([ca.SX, ca.MX], quick=[ca.SX]))
def test_log_of_exp_is_the_identity_to_second_order(xi, symbol, casadi_derivatives):
    value, jacobian, hessian = casadi_derivatives(
        lambda x: rigid_motions.rigid_log(rigid_motions.rigid_exp(x)), xi, symbol
    )
    assert_allclose(value, xi, rtol=1e-12, atol=1e-15)
    assert_allclose(jacobian, np.eye(6), rtol=0, atol=2e-12)
    assert_allclose(hessian, np.zeros((6, 6, 6)), rtol=0, atol=2e-11)


@pytest.mark.parametrize("seed", range(6, 10))
def test_rigid_log_vs_the_matrix_logarithm(seed):
    T = random_transform(seed)
    found = full(rigid_motions.rigid_log(T)).ravel()
    assert_allclose(found, np_vee(logm(full(T)).real), rtol=1e-11, atol=1e-12)


def test_rigid_log_of_a_half_turn_leads_back():
    T = rigid_motions.rigid_exp(ca.DM(TWISTS["half_turn"]))
    again = rigid_motions.rigid_exp(rigid_motions.rigid_log(T))
    assert_allclose(full(again), full(T), rtol=1e-14, atol=5e-15)
