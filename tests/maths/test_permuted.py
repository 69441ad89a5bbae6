"""The permuted linear system against closed forms, from both ends and for every CasADi type."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from cosserat_casadi.maths import rotation
from cosserat_casadi.maths.chebyshev import differentiation_matrix, nodes
from cosserat_casadi.maths.permuted import permuted_system

ENDS = pytest.mark.parametrize("known_at", ["base", "tip"])
CONSTANT = np.array([[0.3, 1.0, 0.0], [-2.0, -0.1, 0.5], [0.4, 0.0, -1.0]])
SOURCE = np.array([0.7, -0.2, 1.1])


def closed_form(X, x_base):
    """x(X) of x' = CONSTANT x + SOURCE, through the exponential of the bordered matrix."""
    bordered = np.zeros((4, 4))
    bordered[:3, :3], bordered[:3, 3] = CONSTANT, SOURCE
    return (expm(X * bordered) @ [*x_base, 1.0])[:3]


def constant_system(N, known_at):
    return permuted_system([ca.DM(CONSTANT)] * (N + 1), [ca.DM(SOURCE)] * (N + 1), known_at=known_at)


def at_end(values, known_at):
    return values[:, 0 if known_at == "base" else -1]


def varying(X):
    return [ca.DM([[np.sin(3 * x), 1 + x], [-x * x, np.cos(x)]]) for x in X], [ca.DM([x, 1 - x]) for x in X]


@ENDS
def test_constant_coefficients_vs_the_matrix_exponential(known_at):
    N = 18
    expected = np.stack([closed_form(X, [1.0, -0.5, 0.25]) for X in nodes(N)], axis=1)
    found = constant_system(N, known_at).solve(ca.DM(at_end(expected, known_at)))
    assert_allclose(found.full(), expected, rtol=1e-13, atol=1e-13)


@ENDS
def test_varying_scalar_vs_the_exponential_of_an_integral(known_at):
    """x' = cos(4X) x: x = exp(sin(4X)/4)."""
    X = nodes(24)
    expected = np.exp(np.sin(4 * X) / 4)[None, :]
    A = [ca.DM(np.cos(4 * x)) for x in X]
    found = permuted_system(A, [ca.DM(0)] * 25, known_at=known_at).solve(ca.DM(at_end(expected, known_at)))
    assert_allclose(found.full(), expected, rtol=1e-13, atol=1e-13)


@ENDS
def test_source_alone_is_integrated(known_at):
    X = nodes(6)
    found = permuted_system([ca.DM(1, 1)] * 7, [ca.DM(5 * x**4) for x in X], known_at=known_at)
    expected = X**5 + (2.0 if known_at == "base" else 1.0)
    assert_allclose(found.solve(ca.DM(2.0)).full()[0], expected, rtol=1e-13, atol=1e-14)


@ENDS
def test_convergence_is_geometric(known_at):
    """Two more intervals divide the error by more each time, as for every entire function."""

    def error(N):
        expected = np.stack([closed_form(X, [1.0, -0.5, 0.25]) for X in nodes(N)], axis=1)
        found = constant_system(N, known_at).solve(ca.DM(at_end(expected, known_at)))
        return np.abs(found.full() - expected).max()

    errors = np.array([error(N) for N in (2, 4, 6, 8, 10)])
    assert np.all(errors[1:] / errors[:-1] < [0.05, 0.03, 0.02, 0.01])
    assert errors[-1] < 1e-9


@ENDS
def test_quaternion_block_vs_the_quaternion_exponential(known_at):
    """Q' = ½ A(K) Q with constant K turns by K X: Q(X) = Q(0) ⊗ exp(K X)."""
    X, K = nodes(20), np.array([1.2, -2.0, 0.7])
    Q0 = ca.repmat(ca.DM([0.5, -0.5, 0.5, 0.5]), 1, 21)
    turns = Rotation.from_rotvec(np.outer(X, K)).as_quat(scalar_first=True)
    expected = rotation.quaternion_product(Q0, ca.DM(turns.T)).full()
    A = [rotation.quaternion_rate_matrix(ca.DM(K)) / 2] * 21
    found = permuted_system(A, [ca.DM(4, 1)] * 21, known_at=known_at).solve(ca.DM(at_end(expected, known_at)))
    assert_allclose(found.full(), expected, rtol=1e-13, atol=1e-13)
    assert_allclose(np.linalg.norm(found.full(), axis=0), np.ones(21), rtol=0, atol=1e-13)


@ENDS
def test_blocks_are_those_of_the_permuted_matrices(known_at):
    N, m = 4, 2
    A, b = varying(nodes(N))
    system = permuted_system(A, b, known_at=known_at)
    P = system.P.full()
    assert_allclose(P @ P.T, np.eye(m * (N + 1)), rtol=0, atol=0)
    D_p = P @ np.kron(np.eye(m), differentiation_matrix(N)) @ P.T
    blocks = np.block([[system.D_II.full(), system.D_NI.full()], [system.D_IN.full(), system.D_NN.full()]])
    assert_allclose(blocks, D_p, rtol=0, atol=0)
    stacked_A = np.zeros((m * (N + 1), m * (N + 1)))
    for j in range(N + 1):
        stacked_A[j :: N + 1, j :: N + 1] = A[j].full()
    assert_allclose((P @ stacked_A @ P.T)[m:, m:], system.A_NN.full(), rtol=0, atol=0)
    stacked_b = np.hstack([b_j.full() for b_j in b]).ravel()
    assert_allclose((P @ stacked_b)[m:], system.beta.full().ravel(), rtol=0, atol=0)


@ENDS
def test_permutation_takes_the_known_point_first_then_base_to_tip(known_at):
    N, m = 3, 2
    A, b = varying(nodes(N))
    labels = np.array([10 * component + point for component in range(m) for point in range(N + 1)])
    order = permuted_system(A, b, known_at=known_at).P.full() @ labels
    points = [0, 1, 2, 3] if known_at == "base" else [3, 0, 1, 2]
    assert_allclose(order, [10 * c + p for p in points for c in range(m)], rtol=0, atol=0)


@ENDS
def test_solution_satisfies_the_equation_at_every_unknown_point(known_at):
    N = 9
    A, b = varying(nodes(N))
    x_known = ca.DM([0.3, -1.2])
    x = permuted_system(A, b, known_at=known_at).solve(x_known).full()
    slopes = x @ differentiation_matrix(N).T
    expected = np.hstack([(A_j @ x_j + b_j).full() for A_j, x_j, b_j in zip(A, x.T, b, strict=True)])
    unknown = slice(1, None) if known_at == "base" else slice(None, -1)
    assert_allclose(slopes[:, unknown], expected[:, unknown], rtol=1e-12, atol=1e-12)
    assert_allclose(at_end(x, known_at), x_known.full().ravel(), rtol=0, atol=0)


@ENDS
def test_known_value_enters_through_ivp_alone(known_at):
    system = constant_system(5, known_at)
    x_known = ca.DM([1.0, 2.0, 3.0])
    assert_allclose(system.ivp(x_known).full(), system.D_IN.full() @ x_known.full(), rtol=0, atol=0)
    assert_allclose(system.ivp(ca.DM(3, 1)).full(), np.zeros((15, 1)), rtol=0, atol=0)


@ENDS
@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
def test_symbolic_solution_and_its_derivative(symbol, known_at):
    """x' = a x + c: value and derivatives with respect to a, c and the known value, at all points."""
    N, (a, c, x0) = 12, (0.8, 0.3, 1.5)
    p = symbol.sym("p", 3)
    solved = permuted_system([p[0]] * (N + 1), [p[1]] * (N + 1), known_at=known_at).solve(p[2])
    f = ca.Function("f", [p], [solved.T, ca.jacobian(solved.T, p)])
    value, jacobian = (entry.full() for entry in f([a, c, x0]))
    Y = nodes(N) - (0.0 if known_at == "base" else 1.0)
    growth = np.exp(a * Y)
    by_a = x0 * Y * growth + c * (Y * growth / a - (growth - 1) / a**2)
    assert_allclose(value[:, 0], growth * x0 + c * (growth - 1) / a, rtol=1e-12, atol=1e-12)
    assert_allclose(jacobian, np.stack([by_a, (growth - 1) / a, growth], axis=1), rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
def test_only_the_known_value_may_be_symbolic(symbol):
    x = symbol.sym("x", 3)
    system = constant_system(6, "base")
    f = ca.Function("f", [x], [system.solve(x)])
    point = ca.DM([1.0, -0.5, 0.25])
    assert_allclose(f(point).full(), system.solve(point).full(), rtol=1e-12, atol=1e-13)


def test_the_system_is_frozen():
    with pytest.raises(AttributeError):
        constant_system(3, "base").known_at = "tip"


@pytest.mark.parametrize(
    ("A", "b", "known_at", "problem"),
    [
        ([ca.DM.eye(2)] * 3, [ca.DM(2, 1)] * 2, "base", "same two points or more"),
        ([ca.DM.eye(2)], [ca.DM(2, 1)], "base", "same two points or more"),
        ([ca.DM.eye(2), ca.DM.eye(3)], [ca.DM(2, 1)] * 2, "base", r"A\[1\] is 2×2"),
        ([ca.DM.eye(2)] * 2, [ca.DM(2, 1), ca.DM(1, 1)], "base", r"b\[1\] is 2×1"),
        ([ca.DM.eye(2)] * 2, [ca.DM(2, 1)] * 2, "middle", "'base' or 'tip'"),
    ],
)
def test_mismatched_coefficients_are_refused(A, b, known_at, problem):
    with pytest.raises(ValueError, match=problem):
        permuted_system(A, b, known_at=known_at)


def test_a_scalar_known_value_is_not_broadcast():
    with pytest.raises(ValueError, match="x_known is 3×1"):
        constant_system(3, "base").solve(ca.DM(1.0))
