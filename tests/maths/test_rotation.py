"""Rotations: group laws, known values, and derivatives at the places where formulas usually break."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from cosserat_casadi.maths import rotation
from tests.reference import rotations

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
SHORT = [name for name in VECTORS if name not in ("half_turn", "half_turn_about_x", "beyond_half_turn")]


def by_name(names=tuple(VECTORS)):
    return pytest.mark.parametrize("v", [VECTORS[name] for name in names], ids=names)


def by_length():
    """As by_name, with every second case among the slow tests: derivatives of all orders take long."""
    cases = [
        pytest.param(v, id=name, marks=pytest.mark.slow if k % 2 else ()) for k, (name, v) in enumerate(VECTORS.items())
    ]
    return pytest.mark.parametrize("v", cases)


def np_hat(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def np_left_tangent(v):
    """∫₀¹ exp(s v̂) ds as a block of a larger exponential; analytic, so complex steps pass through."""
    block = np.zeros((6, 6), dtype=complex)
    block[:3, :3], block[:3, 3:] = np_hat(v), np.eye(3)
    return expm(block)[:3, 3:]


def np_quaternion_exp(v):
    """First column of exp(½ (0, v) ⊗), the left multiplication by a pure quaternion."""
    left = np.zeros((4, 4), dtype=complex)
    left[0, 1:], left[1:, 0], left[1:, 1:] = -v, v, np_hat(v)
    return expm(left / 2)[:, 0]


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


def test_hat_is_the_cross_product_and_vee_undoes_it():
    v, u = normal(2, 3)
    assert_allclose(full(rotation.hat(ca.DM(v))) @ u, np.cross(v, u), rtol=1e-14, atol=1e-15)
    assert_allclose(full(rotations.vee(rotation.hat(ca.DM(v)))).ravel(), v, rtol=1e-15, atol=1e-16)
    assert_allclose(full(rotations.vee(rotation.hat(ca.DM(v)) + ca.DM.eye(3))).ravel(), v, rtol=1e-15, atol=1e-16)


@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
def test_structural_zeros_stay_structural(symbol):
    """A rod bent in one plane: quaternions (w, 0, y, 0)."""
    planar = ca.vertcat(symbol.sym("w", 1, 3), symbol(1, 3), symbol.sym("y", 1, 3), symbol(1, 3))
    vector = ca.vertcat(symbol(1, 3), symbol.sym("k", 1, 3), symbol(1, 3))
    in_plane = ca.vertcat(symbol.sym("a", 1, 3), symbol(1, 3), symbol.sym("b", 1, 3))

    def filled_rows(matrix):
        return [row.nnz() // 3 for row in ca.vertsplit(matrix)]

    assert filled_rows(rotation.quaternion_product(planar, planar)) == [1, 0, 1, 0]
    assert filled_rows(rotation.quaternion_conjugate(planar)) == [1, 0, 1, 0]
    assert filled_rows(rotations.quaternion_exp(vector)) == [1, 0, 1, 0]
    assert filled_rows(rotations.quaternion_log(planar)) == [0, 1, 0]
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
    assert_allclose(R_slope, R @ np_hat(k), rtol=1e-13, atol=1e-14)
    assert_allclose(R_slope, np.cross(R @ k, R.T).T, rtol=1e-13, atol=1e-14)


@by_name()
def test_quaternion_exp_vs_scipy(v):
    q = full(rotations.quaternion_exp(ca.DM(v))).ravel()
    expected = scipy_quaternion(v)
    assert_allclose(q * np.sign(q @ expected), expected, rtol=1e-14, atol=1e-15)
    assert q @ q == pytest.approx(1.0, rel=2e-15, abs=0)


@by_name()
def test_quaternion_exp_derivatives(v, check_derivatives):
    check_derivatives(rotations.quaternion_exp, np_quaternion_exp, v)


def test_quaternion_exp_works_on_columns():
    v = np.stack(list(VECTORS.values()), axis=1)
    columns = np.stack([full(rotations.quaternion_exp(ca.DM(c))).ravel() for c in v.T], axis=1)
    assert_allclose(full(rotations.quaternion_exp(ca.DM(v))), columns, rtol=1e-15, atol=1e-16)
    short = np.stack([VECTORS[name] for name in SHORT], axis=1)
    logs = rotations.quaternion_log(rotations.quaternion_exp(ca.DM(short)))
    assert_allclose(full(logs), short, rtol=1e-13, atol=1e-22)


@by_name(SHORT)
@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
def test_log_of_exp_is_the_identity_to_second_order(v, symbol, casadi_derivatives):
    value, jacobian, hessian = casadi_derivatives(
        lambda x: rotations.quaternion_log(rotations.quaternion_exp(x)), v, symbol
    )
    assert_allclose(value, v, rtol=1e-13, atol=1e-22)
    assert_allclose(jacobian, np.eye(3), rtol=1e-12, atol=1e-12)
    assert_allclose(hessian, np.zeros((3, 3, 3)), rtol=0, atol=1e-11)


def np_quaternion_log(q):
    """Rotation vector for w ≥ 0 and a vector part that is not zero, analytic."""
    s = np.sqrt(q[1:] @ q[1:])
    return 2 * (np.pi / 2 - np.arctan(q[0] / s)) / s * q[1:]


@pytest.mark.parametrize(
    "q",
    [
        np.array([0.0, *AXIS]),
        np.array([0.0, 1.0, 0.0, 0.0]),
        np.array([1e-9, *AXIS]),
        np.array([0.8, *0.6 * AXIS]),
    ]
    + [np.array([1.0, *np.tan(0.5 * angle) * AXIS]) for angle in (0.2486, 0.2489, 0.3)],
)
def test_quaternion_log_derivatives_up_to_half_turns(q, check_derivatives):
    check_derivatives(rotations.quaternion_log, np_quaternion_log, q)


@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
def test_quaternion_log_at_the_identity_vs_its_series(symbol, casadi_derivatives):
    """2 v/w (1 − |v|²/3w² + …): the first and second derivatives at (1, 0, 0, 0)."""
    value, jacobian, hessian = casadi_derivatives(rotations.quaternion_log, [1, 0, 0, 0], symbol)
    second = np.zeros((3, 4, 4))
    for i in range(3):
        second[i, 0, i + 1] = second[i, i + 1, 0] = -2.0
    assert_allclose(value, np.zeros(3), rtol=0, atol=0)
    assert_allclose(jacobian, np.hstack([np.zeros((3, 1)), 2 * np.eye(3)]), rtol=0, atol=1e-15)
    assert_allclose(hessian, second, rtol=0, atol=1e-14)


def test_quaternion_log_takes_the_short_way_and_ignores_length():
    q = scipy_quaternion(2.0 * AXIS)
    for factor in (1.0, -1.0, 3.5, -0.2):
        assert_allclose(full(rotations.quaternion_log(ca.DM(factor * q))).ravel(), 2.0 * AXIS, rtol=1e-14, atol=1e-15)
    half_turn = full(rotations.quaternion_log(ca.DM([0, 0, -1, 0]))).ravel()
    assert_allclose(half_turn, [0, -np.pi, 0], rtol=1e-15, atol=1e-16)


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


@by_name()
def test_matrix_to_quaternion_undoes_quaternion_to_matrix(v):
    q = rotation.matrix_to_quaternion(Rotation.from_rotvec(v).as_matrix())
    expected = scipy_quaternion(v)
    assert q[0] >= 0
    assert_allclose(q * np.sign(q @ expected), expected, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("matrix", [np.eye(2), np.diag([1.0, 1, -1]), 2 * np.eye(3), np.full((3, 3), np.nan)])
def test_matrix_to_quaternion_refuses_what_is_no_rotation(matrix):
    with pytest.raises(ValueError, match="rotation matrix"):
        rotation.matrix_to_quaternion(matrix)


# --- so(3) ------------------------------------------------------------


@by_name()
def test_rotation_exp_vs_scipy(v):
    R = full(rotations.rotation_exp(ca.DM(v)))
    assert_allclose(R, Rotation.from_rotvec(v).as_matrix(), rtol=1e-14, atol=2e-15)
    assert_allclose(R @ R.T, np.eye(3), rtol=0, atol=2e-15)
    assert_allclose(R @ full(rotations.rotation_exp(ca.DM(-v))), np.eye(3), rtol=0, atol=2e-15)


@by_length()
def test_rotation_exp_derivatives(v, check_derivatives):
    check_derivatives(rotations.rotation_exp, lambda x: expm(np_hat(x)), v)


@by_length()
def test_left_tangent_derivatives(v, check_derivatives):
    check_derivatives(rotations.left_tangent, np_left_tangent, v)


@by_length()
def test_left_tangent_inverse_derivatives(v, check_derivatives):
    check_derivatives(rotations.left_tangent_inverse, lambda x: np.linalg.inv(np_left_tangent(x)), v)


@by_name()
def test_left_tangent_is_the_rate_of_the_exponential(v):
    """d exp(v) exp(v)⁻¹ = T(v) dv, by automatic differentiation of the exponential."""
    x, dx = ca.MX.sym("x", 3), normal(3)
    rate = rotations.vee(ca.jtimes(rotations.rotation_exp(x), x, dx) @ rotations.rotation_exp(x).T)
    both = ca.Function("f", [x], [rate, rotations.left_tangent(x) @ dx])(v)
    assert_allclose(full(both[0]), full(both[1]), rtol=1e-13, atol=1e-14)


@by_name(SHORT)
@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
def test_rotation_log_of_exp_is_the_identity_to_second_order(v, symbol, casadi_derivatives):
    value, jacobian, hessian = casadi_derivatives(
        lambda x: rotations.rotation_log(rotations.rotation_exp(x)), v, symbol
    )
    assert_allclose(value, v, rtol=1e-13, atol=1e-22)
    assert_allclose(jacobian, np.eye(3), rtol=1e-12, atol=1e-12)
    assert_allclose(hessian, np.zeros((3, 3, 3)), rtol=0, atol=1e-11)


@pytest.mark.parametrize("axis", [*np.eye(3), AXIS, np.array([0, -0.6, 0.8])])
def test_rotation_log_on_exact_half_turns(axis, casadi_derivatives):
    half_turn = ca.DM(2 * np.outer(axis, axis) - np.eye(3))
    log = full(rotations.rotation_log(half_turn)).ravel()
    assert_allclose(log * np.sign(log @ axis), np.pi * axis, rtol=1e-14, atol=1e-15)
    flat = half_turn.full().ravel(order="F")
    for symbol in (ca.SX, ca.MX):
        casadi_derivatives(lambda x: rotations.rotation_log(ca.reshape(x, 3, 3)), flat, symbol)


def intermediate_values(expression, x, point):
    """The value of every operation in an SX expression."""
    found, waiting = {}, [entry for row in ca.vertsplit(expression) for entry in ca.horzsplit(row)]
    while waiting:
        entry = waiting.pop()
        if entry.element_hash() not in found:
            found[entry.element_hash()] = entry
            waiting.extend(entry.dep(k) for k in range(entry.n_dep()))
    return ca.Function("all", [x], [ca.vertcat(*found.values())])(point).full()


@pytest.mark.parametrize(
    ("function", "point"),
    [
        (rotations.quaternion_exp, np.zeros(3)),
        (rotations.rotation_exp, np.zeros(3)),
        (rotations.left_tangent, np.zeros(3)),
        (rotations.left_tangent_inverse, np.zeros(3)),
        (rotations.quaternion_log, np.array([1.0, 0, 0, 0])),
        (rotations.quaternion_log, np.array([0.0, 0, 0, 1])),
    ],
)
def test_the_branch_not_taken_is_finite_too(function, point):
    """Nothing on the way is infinite or not a number, whatever a consumer does with the branches."""
    x = ca.SX.sym("x", len(point))
    value = ca.densify(ca.vec(function(x)))
    jacobian = ca.densify(ca.vec(ca.jacobian(value, x)))
    second = ca.densify(ca.vec(ca.jacobian(jacobian, x)))
    assert np.all(np.isfinite(intermediate_values(ca.vertcat(value, jacobian, second), x, point)))


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
