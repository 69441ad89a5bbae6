"""Rotations: group laws, known values, and derivatives at the places where formulas usually break."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from cosserat_casadi.maths import rotation
from tests.reference.rods import hat

AXIS = np.array([2.0, -3.0, 6.0]) / 7.0


def normal(*shape):
    """Normal numbers that depend on the shape alone, so that no test depends on another."""
    return np.random.default_rng((20, *shape)).normal(size=shape)


VECTORS = {
    "random": normal(3),
    "random_small": 0.3 * normal(1, 3)[0],
    "zero": np.zeros(3),
    "tiny": 1e-160 * AXIS,
    "near_zero": 1e-9 * AXIS,
    "below_switch": (1 - 1e-9) * AXIS,
    "above_switch": (1 + 1e-9) * AXIS,
    "near_half_turn": (np.pi - 1e-7) * AXIS,
    "half_turn": np.pi * AXIS,
    "half_turn_about_x": np.array([np.pi, 0.0, 0.0]),
    "beyond_half_turn": 4.5 * AXIS,
}
BY_NAME = pytest.mark.parametrize("v", VECTORS.values(), ids=VECTORS)


def scipy_quaternion(v):
    return Rotation.from_rotvec(v).as_quat(scalar_first=True)


def full(matrix):
    return ca.DM(matrix).full()


# --- vectors ------------------------------------------------------------


def test_cross_and_dot_work_on_columns():
    a, b = normal(2, 3, 5)
    assert_allclose(full(rotation.cross(ca.DM(a), ca.DM(b))), np.cross(a.T, b.T).T, rtol=1e-14, atol=1e-15)
    assert_allclose(full(rotation.dot(ca.DM(a), ca.DM(b)))[0], np.sum(a * b, 0), rtol=1e-14, atol=1e-15)
    square = normal(2, 3, 3)
    expected = np.cross(square[0].T, square[1].T).T
    assert_allclose(full(rotation.cross(*map(ca.DM, square))), expected, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("operation", [rotation.cross, rotation.dot])
def test_a_single_column_is_not_broadcast(operation):
    with pytest.raises(ValueError, match="differ"):
        operation(ca.DM.ones(3, 1), ca.DM.ones(3, 4))


def test_wrong_number_of_rows_is_refused():
    with pytest.raises(ValueError, match="expected 4 rows"):
        rotation.directors(ca.DM.ones(3, 1))


def test_hat_is_the_cross_product():
    v, u = normal(2, 3)
    assert_allclose(full(rotation.hat(ca.DM(v))) @ u, np.cross(v, u), rtol=1e-14, atol=1e-15)
    assert_allclose(rotation.cross_matrix(v) @ u, np.cross(v, u), rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
def test_structural_zeros_stay_structural(symbol):
    """A rod bent in one plane: quaternions (w, 0, y, 0)."""
    planar = ca.vertcat(symbol.sym("w", 1, 3), symbol(1, 3), symbol.sym("y", 1, 3), symbol(1, 3))
    in_plane = ca.vertcat(symbol.sym("a", 1, 3), symbol(1, 3), symbol.sym("b", 1, 3))

    def filled_rows(matrix):
        return [row.nnz() // 3 for row in ca.vertsplit(matrix)]

    assert filled_rows(rotation.quaternion_product(planar, planar)) == [1, 0, 1, 0]
    assert filled_rows(rotation.quaternion_conjugate(planar)) == [1, 0, 1, 0]
    assert [filled_rows(d) for d in rotation.directors(planar)] == [[1, 0, 1], [0, 1, 0], [1, 0, 1]]
    assert filled_rows(rotation.rotate(planar, in_plane)) == [1, 0, 1]
    assert filled_rows(rotation.cross(in_plane, in_plane)) == [0, 1, 0]


# --- quaternions ------------------------------------------------------------


def test_quaternion_product_composes_rotations():
    a, b = Rotation.random(6, rng=1), Rotation.random(6, rng=2)
    p, q = (ca.DM(r.as_quat(scalar_first=True).T) for r in (a, b))
    product = full(rotation.quaternion_product(p, q))
    for column, expected in zip(product.T, (a * b).as_matrix(), strict=True):
        assert_allclose(full(rotation.quaternion_to_matrix(ca.DM(column))), expected, rtol=1e-14, atol=2e-15)


def test_quaternion_group_laws():
    p, q, r = (ca.DM(Rotation.random(4, rng=k).as_quat(scalar_first=True).T) for k in (3, 4, 5))
    mul, conj = rotation.quaternion_product, rotation.quaternion_conjugate
    one = ca.repmat(ca.DM([1, 0, 0, 0]), 1, 4)
    assert_allclose(full(mul(mul(p, q), r)), full(mul(p, mul(q, r))), rtol=1e-14, atol=1e-15)
    assert_allclose(full(mul(p, conj(p))), full(one), rtol=1e-14, atol=1e-15)
    assert_allclose(full(mul(conj(p), p)), full(one), rtol=1e-14, atol=1e-15)
    assert_allclose(full(mul(one, p)), full(p), rtol=1e-15, atol=1e-16)
    assert_allclose(full(conj(mul(p, q))), full(mul(conj(q), conj(p))), rtol=1e-14, atol=1e-15)


def test_directors_are_the_columns_of_the_matrix():
    rotations = Rotation.random(5, rng=6)
    q = ca.DM(rotations.as_quat(scalar_first=True).T)
    for k, d in enumerate(rotation.directors(q)):
        assert_allclose(full(d), rotations.as_matrix()[:, :, k].T, rtol=1e-14, atol=2e-15)


def test_rotate_is_the_matrix_product():
    rotations = Rotation.random(5, rng=7)
    v = normal(5, 3)
    rotated = rotation.rotate(ca.DM(rotations.as_quat(scalar_first=True).T), ca.DM(v.T))
    assert_allclose(full(rotated), rotations.apply(v).T, rtol=1e-14, atol=2e-15)


def test_rate_matrix_is_right_multiplication_by_the_body_rate():
    q, k = normal(4), normal(3)
    pure = ca.DM(np.concatenate([[0.0], k]))
    expected = full(rotation.quaternion_product(ca.DM(q), pure))
    assert_allclose(full(rotation.quaternion_rate_matrix(ca.DM(k)) @ q), expected, rtol=1e-14, atol=1e-15)


def test_rate_matrix_turns_directors_with_the_rate_in_the_world_frame():
    """Q' = ½ A(K) Q makes R' = R K̂, that is d_k' = (R K) × d_k: report (1.9), (1.6) corrected."""
    q = Rotation.random(rng=8).as_quat(scalar_first=True)
    k = normal(3)
    Q = ca.SX.sym("Q", 4)
    slope = 0.5 * rotation.quaternion_rate_matrix(ca.DM(k)) @ q
    R = ca.Function("R", [Q], [rotation.quaternion_to_matrix(Q)])(q).full()
    R_slope = ca.Function("S", [Q], [ca.jtimes(rotation.quaternion_to_matrix(Q), Q, slope)])(q).full()
    assert_allclose(R_slope, R @ hat(k), rtol=1e-13, atol=1e-14)
    assert_allclose(R_slope, np.cross(R @ k, R.T).T, rtol=1e-13, atol=1e-14)


# --- rotation vectors ------------------------------------------------------------


def rotation_vector(q):
    return full(ca.evalf(rotation.rotation_vector(ca.DM(q)))).ravel()


@BY_NAME
def test_rotation_vector_vs_scipy(v):
    """The short way round, whatever the sign and the length of the quaternion."""
    q = scipy_quaternion(v)
    expected = Rotation.from_rotvec(v).as_rotvec()
    for factor in (1.0, -1.0, 3.5):
        found = rotation_vector(factor * q)
        assert_allclose(found * np.sign(found @ expected), expected, rtol=1e-13, atol=1e-22)


def complex_step(function, point):
    """Jacobian of an analytic function, exact to rounding."""
    steps = np.asarray(point, dtype=complex) + 1e-30j * np.eye(len(point))
    return np.stack([function(step).imag / 1e-30 for step in steps], axis=1)


def np_rotation_vector(q):
    """Rotation vector for w ≥ 0 and a vector part that is not zero, analytic."""
    s = np.sqrt(q[1:] @ q[1:])
    return 2 * (np.pi / 2 - np.arctan(q[0] / s)) / s * q[1:]


def derivatives_of_vector(q):
    """First derivatives, 3×4, and second ones, 3×4×4."""
    symbol = ca.MX.sym("q", 4)
    jacobian = ca.jacobian(rotation.rotation_vector(symbol), symbol)
    found = ca.Function("found", [symbol], [jacobian, ca.jacobian(ca.vec(jacobian), symbol)])
    first, second = (entry.full() for entry in found(q))
    return first, second.reshape(4, 3, 4).swapaxes(0, 1)


@pytest.mark.parametrize("angle", [0.05, 0.08, 2.0, np.pi - 1e-7, np.pi])
def test_derivatives_of_rotation_vector(angle):
    """On both sides of the switch to the series, and up to the half turn."""
    q = np.array([max(np.cos(angle / 2), 1e-12), *(np.sin(angle / 2) * AXIS)])
    first, second = derivatives_of_vector(q)
    assert_allclose(first, complex_step(np_rotation_vector, q), rtol=1e-9, atol=1e-10)
    step = 1e-4 * np.sin(angle / 2)
    for k, direction in enumerate(step * np.eye(4)):
        if q[0] > direction[0]:
            there, back = (complex_step(np_rotation_vector, q + sign * direction) for sign in (1, -1))
            size = np.abs(second).max()
            assert_allclose(second[:, :, k], (there - back) / (2 * step), rtol=0, atol=1e-5 * size)


def test_derivatives_of_rotation_vector_without_a_turn_vs_its_series():
    """2 v/w (1 − |v|²/3w² + …): the first and second derivatives at (1, 0, 0, 0)."""
    first, second = derivatives_of_vector([1, 0, 0, 0])
    expected = np.zeros((3, 4, 4))
    for i in range(3):
        expected[i, 0, i + 1] = expected[i, i + 1, 0] = -2.0
    assert_allclose(first, np.hstack([np.zeros((3, 1)), 2 * np.eye(3)]), rtol=0, atol=1e-15)
    assert_allclose(second, expected, rtol=0, atol=1e-14)


# --- quaternions of directions and matrices ------------------------------------------------------------


@pytest.mark.parametrize(
    "tangent",
    [
        (0, 0, 1),
        (0, 0, 5.0),
        (1, 0, 0),
        (0, -2, 0),
        (0.3, -0.4, 1.2),
        (1, 1, -1),
        (1e-9, 0, -1),
        (0, 1e-200, 1),
    ],
)
def test_quaternion_from_tangent_is_the_shortest_rotation(tangent):
    q = rotation.quaternion_from_tangent(tangent)
    direction = np.array(tangent) / np.linalg.norm(tangent)
    found = Rotation.from_quat(q, scalar_first=True)
    assert_allclose(found.apply([0, 0, 1]), direction, rtol=0, atol=1e-15)
    angle = np.arctan2(np.hypot(*direction[:2]), direction[2])
    assert_allclose(found.magnitude(), angle, rtol=1e-14, atol=1e-15)
    assert q[3] == 0.0


def test_quaternion_from_tangent_at_the_antipode():
    assert_allclose(rotation.quaternion_from_tangent([0, 0, -3]), [0, 1, 0, 0], rtol=0, atol=0)


@pytest.mark.parametrize("tangent", [(0, 0, 0), (np.nan, 0, 1), (0, 1), (np.inf, 0, 0)])
def test_quaternion_from_tangent_refuses(tangent):
    with pytest.raises(ValueError, match="tangent"):
        rotation.quaternion_from_tangent(tangent)


@BY_NAME
def test_matrix_to_quaternion_undoes_quaternion_to_matrix(v):
    q = rotation.matrix_to_quaternion(Rotation.from_rotvec(v).as_matrix())
    expected = scipy_quaternion(v)
    assert q[0] >= 0
    assert_allclose(q * np.sign(q @ expected), expected, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("matrix", [np.eye(2), np.diag([1.0, 1, -1]), 2 * np.eye(3), np.full((3, 3), np.nan)])
def test_matrix_to_quaternion_refuses_what_is_no_rotation(matrix):
    with pytest.raises(ValueError, match="rotation matrix"):
        rotation.matrix_to_quaternion(matrix)


# --- numbers ------------------------------------------------------------


def arrays(shape):
    """Unit quaternions and vectors, one a column or a single one."""
    q = normal(2, 4, *shape)
    v = normal(2, 3, *shape)
    return q / np.linalg.norm(q, axis=1, keepdims=True), v


@pytest.mark.parametrize("shape", [(), (1,), (5,)])
def test_numpy_vs_casadi(shape):
    """One formula serves both: arrays give arrays of their own shape, and the same numbers."""
    (p, q), (u, v) = arrays(shape)
    results = {
        "product": (rotation.quaternion_product(p, q), rotation.quaternion_product(ca.DM(p), ca.DM(q))),
        "conjugate": (rotation.quaternion_conjugate(q), rotation.quaternion_conjugate(ca.DM(q))),
        "rotate": (rotation.rotate(q, v), rotation.rotate(ca.DM(q), ca.DM(v))),
        "cross": (rotation.cross(u, v), rotation.cross(ca.DM(u), ca.DM(v))),
    }
    for name, (array, matrix) in results.items():
        assert isinstance(array, np.ndarray), name
        assert array.shape == (len(array), *shape), name
        assert_allclose(array.reshape(len(array), -1), full(matrix), rtol=1e-15, atol=1e-15, err_msg=name)


@pytest.mark.parametrize("shape", [(), (1,), (5,)])
def test_matrices_of_arrays_vs_scipy(shape):
    (q, _), _ = arrays(shape)
    matrices = rotation.quaternion_to_matrix(q)
    assert matrices.shape == (3, 3, *shape)
    expected = Rotation.from_quat(q.T, scalar_first=True).as_matrix()
    assert_allclose(np.moveaxis(matrices.reshape(3, 3, -1), -1, 0), expected.reshape(-1, 3, 3), rtol=1e-14, atol=4e-16)


def test_rotate_of_arrays_is_the_matrix_product():
    (q, _), (v, _) = arrays(())
    assert_allclose(rotation.rotate(q, v), rotation.quaternion_to_matrix(q) @ v, rtol=1e-14, atol=1e-15)


def test_arrays_of_different_shapes_are_refused():
    with pytest.raises(ValueError, match="differ"):
        rotation.quaternion_product(np.ones(4), np.ones((4, 2)))
    with pytest.raises(ValueError, match="expected 4 rows"):
        rotation.directors(np.ones(3))
