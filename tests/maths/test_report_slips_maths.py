"""Where the report must not be followed to the letter: each printed formula fails, its correction holds.

The names of the tests carry the numbers of the equations. The report orders points from tip to base on
[−1, 1]; ``report_points`` and ``report_matrix`` do so too.
"""

import casadi as ca
import numpy as np
import pytest
from numpy.polynomial import chebyshev as npc
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from cosserat_casadi.maths import chebyshev, rotation
from cosserat_casadi.maths.permuted import permuted_system

PRINTED_P = np.eye(6)[[2, 5, 0, 3, 4, 1]]


def differ(a, b):
    """Whether two arrays of one shape differ by more than any rounding."""
    return np.abs(np.asarray(a) - np.asarray(b)).max() > 1e-3


def full(matrix):
    return ca.DM(matrix).full()


def report_points(N):
    return np.cos(np.pi * np.arange(N + 1) / N)


def report_matrix(N):
    return chebyshev.differentiation_matrix(N)[::-1, ::-1] / 2


def normal(*shape):
    return np.random.default_rng((80, *shape)).normal(size=shape)


def linear_problem(N):
    """A system with varying coefficients, solved from the base; its points and its solution."""
    X = chebyshev.nodes(N)
    A = [ca.DM([[np.sin(x), 1.0], [-2.0, x]]) for x in X]
    b = [ca.DM([x, 1.0]) for x in X]
    x_known = ca.DM([1.0, -0.5])
    system = permuted_system(A, b)
    return A, b, x_known, system, system.solve(x_known)


# --- chapters 1 and 2 ------------------------------------------------------------


def test_1_6_directors_turn_with_the_curvature_in_the_world_frame():
    q, K = Rotation.random(rng=1).as_quat(scalar_first=True), normal(3)
    Q = ca.SX.sym("Q", 4)
    rate = rotation.quaternion_rate_matrix(ca.DM(K)) @ Q / 2
    R = rotation.quaternion_to_matrix(Q)
    R, R_rate = (value.full() for value in ca.Function("f", [Q], [R, ca.jtimes(R, Q, rate)])(q))
    assert differ(R_rate, np.cross(K, R.T).T)
    assert_allclose(R_rate, np.cross(R @ K, R.T).T, rtol=1e-13, atol=1e-14)


def test_2_4_argument_of_the_polynomials_grows_from_base_to_tip():
    X = chebyshev.nodes(6)
    a, b = 0.0, 1.0
    printed, ours = (2 * X - (a + b)) / (a - b), chebyshev.chebyshev_polynomials(2, X)[:, 1]
    assert printed[0] > printed[-1]
    assert_allclose(ours, 2 * X - 1, rtol=0, atol=0)
    slope_in_x = report_matrix(6)[::-1, ::-1] @ X**3
    assert differ(slope_in_x, 3 * X**2)
    assert_allclose(chebyshev.differentiation_matrix(6) @ X**3, 3 * X**2, rtol=1e-13, atol=1e-13)


# --- chapter 3 -------------------------------------------------------------------


def test_3_1_coefficients_vary_along_the_rod():
    """x' = 2X x, x(0) = 1 ends at e; one constant coefficient, the mean, misses the points between."""
    X = chebyshev.nodes(16)
    exact = np.exp(X**2)
    varying = permuted_system([ca.DM(2 * x) for x in X], [ca.DM(0)] * 17).solve(ca.DM(1))
    constant = permuted_system([ca.DM(1.0)] * 17, [ca.DM(0)] * 17).solve(ca.DM(1))
    assert differ(full(constant)[0], exact)
    assert_allclose(full(varying)[0], exact, rtol=1e-13, atol=1e-13)


def test_3_9_rows_five_and_six_exchange_the_components_of_one_point():
    """The exchange makes the printed P its own transpose; the permutation in point order is not."""
    chi = np.array([1.0, 11.0, 21.0, 2.0, 12.0, 22.0])
    assert_allclose(PRINTED_P @ chi, [21, 22, 1, 2, 12, 11], rtol=0, atol=0)
    assert_allclose(PRINTED_P, PRINTED_P.T, rtol=0, atol=0)
    P = permuted_system([ca.DM(2, 2)] * 3, [ca.DM(2, 1)] * 3, known_at="tip").P.full()
    assert differ(P, P.T)
    assert_allclose(P @ chi, [21, 22, 1, 2, 11, 12], rtol=0, atol=0)


def test_3_15_and_3_16_hold_as_printed_only_for_the_symmetric_P_of_3_9():
    """The matrix of (3.16) is Pᵀ D P and P D Pᵀ alike; with rows 5 and 6 in point order only the second."""
    d = np.arange(9.0).reshape(3, 3) + 1
    D = np.kron(np.eye(2), d)
    printed_matrix = np.array(
        [
            [d[2, 2], 0, d[2, 0], 0, 0, d[2, 1]],
            [0, d[2, 2], 0, d[2, 0], d[2, 1], 0],
            [d[0, 2], 0, d[0, 0], 0, 0, d[0, 1]],
            [0, d[0, 2], 0, d[0, 0], d[0, 1], 0],
            [0, d[1, 2], 0, d[1, 0], d[1, 1], 0],
            [d[1, 2], 0, d[1, 0], 0, 0, d[1, 1]],
        ]
    )
    assert_allclose(PRINTED_P.T @ D @ PRINTED_P, printed_matrix, rtol=0, atol=0)
    assert_allclose(PRINTED_P @ D @ PRINTED_P.T, printed_matrix, rtol=0, atol=0)
    exchange = [0, 1, 2, 3, 5, 4]
    in_point_order = PRINTED_P[exchange]
    ours = printed_matrix[np.ix_(exchange, exchange)]
    assert differ(in_point_order.T @ D @ in_point_order, ours)
    assert_allclose(in_point_order @ D @ in_point_order.T, ours, rtol=0, atol=0)


@pytest.mark.parametrize("known_at", ["base", "tip"])
def test_3_10_to_3_16_only_P_D_Pt_differentiates_the_permuted_vector(known_at):
    N = 5
    X = chebyshev.nodes(N)
    system = permuted_system([ca.DM(2, 2)] * (N + 1), [ca.DM(2, 1)] * (N + 1), known_at=known_at)
    P, D = system.P.full(), np.kron(np.eye(2), chebyshev.differentiation_matrix(N))
    chi, chi_slope = np.concatenate([X**3, X**2]), np.concatenate([3 * X**2, 2 * X])
    assert differ(P.T @ D @ P @ (P @ chi), P @ chi_slope)
    ours = np.block([[full(system.D_II), full(system.D_NI)], [full(system.D_IN), full(system.D_NN)]])
    assert_allclose(ours @ (P @ chi), P @ chi_slope, rtol=1e-12, atol=1e-12)


def test_3_13_and_3_17_the_right_side_is_a_product_plus_a_vector():
    _, _, x_known, system, x = linear_problem(12)
    unknown = full(x)[:, 1:].ravel(order="F")
    slopes = full(system.D_IN @ x_known).ravel() + full(system.D_NN) @ unknown
    assert differ(slopes, full(system.A_NN @ system.beta).ravel())
    assert_allclose(slopes, full(system.A_NN) @ unknown + full(system.beta).ravel(), rtol=1e-12, atol=1e-12)


def test_3_19_and_3_20_the_known_point_obeys_no_equation_without_the_others():
    """(D_II − A_2) x_2 is not b_2: the row of the known point needs D_NI χ̄, and is then its slope."""
    A, b, x_known, system, x = linear_problem(16)
    unknown = full(x)[:, 1:].ravel(order="F")
    assert differ(full((system.D_II - A[0]) @ x_known), full(b[0]))
    slope = full(system.D_II @ x_known).ravel() + full(system.D_NI) @ unknown
    assert_allclose(slope, full(A[0] @ x_known + b[0]).ravel(), rtol=0, atol=1e-11)
    assert_allclose(full(system.ivp(x_known)), full(system.D_IN @ x_known), rtol=0, atol=0)


def test_3_21_and_3_22_the_unknowns_alone_are_solved_for():
    _, b, x_known, system, x = linear_problem(12)
    matrix = full(system.D_NN - system.A_NN)
    all_points = np.concatenate([full(x_known).ravel(), full(x)[:, 1:].ravel(order="F")])
    all_sources = np.concatenate([full(b_j).ravel() for b_j in b])
    with pytest.raises(ValueError, match="mismatch"):
        matrix @ all_points
    with pytest.raises(ValueError, match="broadcast"):
        all_sources - full(system.ivp(x_known)).ravel()
    rhs = full(system.beta - system.ivp(x_known)).ravel()
    assert_allclose(matrix @ all_points[2:], rhs, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("known_at", ["base", "tip"])
def test_3_23_the_transpose_leads_back(known_at):
    N = 3
    system = permuted_system([ca.DM(2, 2)] * (N + 1), [ca.DM([1, 2])] * (N + 1), known_at=known_at)
    P = system.P.full()
    chi = normal(2 * (N + 1))
    assert differ(P @ (P @ chi), chi)
    assert_allclose(P.T @ (P @ chi), chi, rtol=0, atol=0)
    X = chebyshev.nodes(N) - (0.0 if known_at == "base" else 1.0)
    assert_allclose(full(system.solve(ca.DM(2, 1))), [X, 2 * X], rtol=1e-13, atol=1e-13)


# --- appendix A ------------------------------------------------------------------


def test_a_3_hat_lands_in_the_algebra_not_in_the_group():
    skew = full(rotation.hat(ca.DM(normal(3))))
    assert differ(skew @ skew.T, np.eye(3))
    assert_allclose(skew, -skew.T, rtol=0, atol=0)


def test_a_8_a_reflection_is_no_rotation():
    """diag(1, 1, −1) passes (A.7) and the printed (A.8), yet its columns are left-handed."""
    mirror = np.diag([1.0, 1.0, -1.0])
    assert_allclose(mirror @ mirror.T, np.eye(3), rtol=0, atol=0)
    assert abs(np.linalg.det(mirror)) == 1.0
    assert differ(np.cross(mirror[:, 0], mirror[:, 1]), mirror[:, 2])
    with pytest.raises(ValueError, match="not a rotation"):
        rotation.matrix_to_quaternion(mirror)
    R = full(rotation.quaternion_to_matrix(ca.DM(Rotation.random(rng=1).as_quat(scalar_first=True))))
    assert_allclose(np.linalg.det(R), 1.0, rtol=1e-14, atol=0)
    assert_allclose(np.cross(R[:, 0], R[:, 1]), R[:, 2], rtol=1e-13, atol=1e-14)


def random_transform(seed):
    """The homogeneous matrix of (A.5), which takes coordinates of a point in the second frame to those in the first."""
    transform = np.eye(4)
    transform[:3, :3] = Rotation.random(rng=seed).as_matrix()
    transform[:3, 3] = np.random.default_rng(seed).normal(size=3)
    return transform


def test_a_12_the_inverse_goes_on_the_right():
    w_T_a, a_T_b = random_transform(2), random_transform(3)
    inverse = np.linalg.inv(a_T_b)
    assert differ(inverse @ (w_T_a @ a_T_b), w_T_a)
    assert_allclose(w_T_a @ a_T_b @ inverse, w_T_a, rtol=1e-13, atol=1e-14)


def test_a_14_the_norm_takes_the_conjugate():
    q = ca.DM([0.5, 1.0, -2.0, 0.25])
    norm = np.linalg.norm(full(q))
    assert differ(full(rotation.quaternion_product(q, q)), norm**2 * np.eye(4)[:, :1])
    ours = rotation.quaternion_product(q, rotation.quaternion_conjugate(q))
    assert_allclose(full(ours), norm**2 * np.eye(4)[:, :1], rtol=1e-15, atol=1e-15)


def twist_hat(xi):
    """The matrix of (A.19) of a twist, angular part first."""
    return np.block([[rotation.cross_matrix(xi[:3]), xi[3:, None]], [np.zeros((1, 4))]])


def printed_adjoint(T):
    """The matrix of (A.23)."""
    R, p_hat = T[:3, :3], rotation.cross_matrix(T[:3, 3])
    return np.block([[R, p_hat @ R], [np.zeros((3, 3)), R]])


def adjoint(T):
    """Angular part first, as (A.29) has it."""
    R, p_hat = T[:3, :3], rotation.cross_matrix(T[:3, 3])
    return np.block([[R, np.zeros((3, 3))], [p_hat @ R, R]])


def test_a_23_and_a_24_the_adjoint_is_angular_first_like_ad():
    a_T_b, b_twist = random_transform(4), normal(6)
    conjugated = a_T_b @ twist_hat(b_twist) @ np.linalg.inv(a_T_b)
    assert differ(twist_hat(printed_adjoint(a_T_b) @ b_twist), conjugated)
    assert_allclose(twist_hat(adjoint(a_T_b) @ b_twist), conjugated, rtol=1e-13, atol=1e-14)


def test_a_26_wrenches_go_with_the_transpose():
    """Equal power in every motion; (A.27), written force first, says the same as the transpose."""
    b_T_a, (a_twist, b_wrench) = random_transform(5), normal(2, 6)
    b_twist = adjoint(b_T_a) @ a_twist
    for printed in (printed_adjoint(b_T_a), adjoint(b_T_a)):
        assert abs((printed @ b_wrench) @ a_twist - b_wrench @ b_twist) > 1e-2
    ours = adjoint(b_T_a).T @ b_wrench
    assert_allclose(ours @ a_twist, b_wrench @ b_twist, rtol=1e-13, atol=1e-13)
    R, p_hat = b_T_a[:3, :3], rotation.cross_matrix(b_T_a[:3, 3])
    force_first = np.block([[R.T, np.zeros((3, 3))], [-R.T @ p_hat, R.T]])
    assert_allclose(np.roll(force_first @ np.roll(b_wrench, 3), 3), ours, rtol=1e-13, atol=1e-14)


# --- appendix B ------------------------------------------------------------------


def test_b_1_both_ends_are_points_and_the_first_is_plus_one():
    """The printed points stop before the second end; the examples after (B.5) and (B.8) are right."""
    N = 2
    printed = -np.cos(np.pi * np.arange(N) / N)
    assert len(printed) == N
    assert not np.any(np.isclose(printed, 1.0, rtol=0, atol=1e-6))
    assert_allclose(report_points(1), [1, -1], rtol=0, atol=1e-16)
    assert_allclose(report_points(2), [1, 0, -1], rtol=0, atol=1e-16)
    for N in (1, 2, 9):
        assert_allclose(2 * chebyshev.nodes(N)[::-1] - 1, report_points(N), rtol=0, atol=1e-15)


def test_b_2_the_recurrence_multiplies_by_x():
    """T₂ … T₉ as (B.3) prints them, correctly."""
    X = np.linspace(0, 1, 7)
    x = 2 * X - 1
    T = chebyshev.chebyshev_polynomials(10, X).T
    assert differ(2 * T[2] - T[1], T[3])
    b_3 = {
        2: [2, 0, -1],
        3: [4, 0, -3, 0],
        4: [8, 0, -8, 0, 1],
        5: [16, 0, -20, 0, 5, 0],
        6: [32, 0, -48, 0, 18, 0, -1],
        7: [64, 0, -112, 0, 56, 0, -7, 0],
        8: [128, 0, -256, 0, 160, 0, -32, 0, 1],
        9: [256, 0, -576, 0, 432, 0, -120, 0, 9, 0],
    }
    for degree, powers in b_3.items():
        assert_allclose(T[degree], np.polyval(powers, x), rtol=1e-12, atol=1e-13)


def test_b_4_the_interpolant_through_n_plus_1_points_has_degree_n():
    """The text before (B.4) says degree < N: then the values of x^N could not be taken."""
    N = 4
    X = chebyshev.nodes(N)
    coefficients = chebyshev.chebyshev_coefficients(X**N)
    assert abs(coefficients[N]) > 1e-3
    assert differ(npc.chebval(2 * X - 1, [*coefficients[:N], 0.0]), X**N)
    assert_allclose(npc.chebval(2 * X - 1, coefficients), X**N, rtol=1e-14, atol=1e-15)


def test_b_5_both_terms_carry_one_half():
    v0, v1 = 3.0, -2.0
    assert differ(0.5 * (1 - 1) * v0 + (1 + 1) * v1, v1)
    X = np.linspace(0, 1, 5)
    x = 2 * X - 1
    ours = chebyshev.interpolation_matrix(1, X) @ [v1, v0]
    assert_allclose(ours, 0.5 * (1 + x) * v0 + 0.5 * (1 - x) * v1, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("N", [1, 2, 3, 8])
def test_b_13_and_b_19_the_last_index_is_n(N):
    """An (N, N) matrix, indices 0 … N − 1, could not act on the values v₀ … v_N of (B.17)."""
    with pytest.raises(ValueError, match="mismatch"):
        np.zeros((N, N)) @ report_points(N)
    assert report_matrix(N).shape == (N + 1, N + 1)
    assert_allclose(report_matrix(N) @ report_points(N), np.ones(N + 1), rtol=1e-13, atol=1e-13)


def test_b_12_is_right():
    printed = [[1.5, -2, 0.5], [0.5, 0, -0.5], [-0.5, 2, -1.5]]
    assert_allclose(report_matrix(2), printed, rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize("N", [2, 3, 8])
def test_b_14_corners_count_intervals(N):
    D = report_matrix(N)
    points = N + 1
    assert differ(D[0, 0], 1 / 6)
    assert differ(D[0, 0], (2 * points**2 + 1) / 6)
    assert_allclose(D[0, 0], (2 * N**2 + 1) / 6, rtol=1e-13, atol=0)
    assert_allclose(D[N, N], -(2 * N**2 + 1) / 6, rtol=1e-13, atol=0)


@pytest.mark.parametrize("N", [3, 8])
def test_b_15_holds_up_to_the_last_inner_point(N):
    """The printed range 1 … N − 2 leaves out one inner point, where the diagonal is not zero."""
    x, D = report_points(N), report_matrix(N)
    inner = np.arange(1, N)
    assert inner[-1] not in range(1, N - 1)
    assert differ(D[N - 1, N - 1], 0.0)
    assert_allclose(np.diag(D)[inner], (-x / 2)[inner] / (1 - x[inner] ** 2), rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("N", [2, 3, 8])
def test_b_16_holds_for_all_pairs_with_c_two_at_the_ends(N):
    """With the printed range the border is left open; with c = 1 everywhere constants have a slope."""
    x, j = report_points(N), np.arange(N + 1)
    gaps = x[:, None] - x + np.eye(N + 1)
    off_diagonal = ~np.eye(N + 1, dtype=bool)

    def formula(c):
        return np.where(off_diagonal, c[:, None] / c * (-1.0) ** (j[:, None] + j) / gaps, 0.0)

    c = np.where((j == 0) | (j == N), 2.0, 1.0)
    D = report_matrix(N)
    assert differ(formula(np.ones(N + 1)), np.where(off_diagonal, D, 0.0))
    border = (j[:, None] % N == 0) | (j % N == 0)
    assert np.abs(D[border & off_diagonal]).min() > 1e-3
    assert_allclose(np.where(off_diagonal, D, 0.0), formula(c), rtol=1e-13, atol=1e-13)
    assert_allclose(D @ np.ones(N + 1), np.zeros(N + 1), rtol=0, atol=1e-13)
