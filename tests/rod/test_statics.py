"""Internal wrenches: world form against body form, global balance, signs, and the printed formulas that are wrong."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rods import (
    HOOKE,
    KIRCHHOFF,
    REISSNER,
    STRAIGHT,
    coordinates,
    equilibrium,
    line,
    mixed_loads,
    model,
    point,
    reference_poses,
    reference_wrench,
    rod,
    strain_basis,
)

from cosserat_casadi.rod.statics import Statics

BREAKS = pytest.mark.parametrize("breaks", [(0.0, 1.0), (0.0, 0.4, 1.0)])
FOLLOWER = pytest.mark.parametrize("follower", [False, True], ids=["dead", "follower"])


def internal(statics):
    """(m, n) at the nodes, each (M, 3), base frame."""
    return statics.internal_moment.full().T, statics.internal_force.full().T


def loaded(breaks=(0.0, 1.0), follower=False, seed=0, admitted=REISSNER, length=0.5, nodes=28):
    basis = strain_basis(rod(admitted, length=length), nodes=nodes, breaks=breaks)
    q = coordinates(basis, seed)
    return basis, q, mixed_loads(basis, follower=follower, seed=seed + 1)


@FOLLOWER
@BREAKS
@pytest.mark.parametrize(("seed", "length"), [(0, 0.5), (1, 1.0), (2, 2.0)])
def test_world_form_vs_body_form(seed, length, breaks, follower):
    """(1.17, 1.18) by sums in the base frame against (1.29) corrected, integrated from the tip by DOP853."""
    basis, q, wrenches = loaded(breaks, follower, seed, length=length)
    found = model(basis, q, wrenches).statics.internal_wrench().full().T
    assert_allclose(found, reference_wrench(basis, q, wrenches), rtol=1e-11, atol=1e-11)


def test_dead_and_follower_together_vs_body_form():
    basis, q, wrenches = loaded()
    wrenches = [*wrenches, *mixed_loads(basis, follower=True, seed=9), point(1.0, [0.3, 0.1, -2.0])]
    found = model(basis, q, wrenches).statics.internal_wrench().full().T
    assert_allclose(found, reference_wrench(basis, q, wrenches), rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("part", ["force", "moment"])
@pytest.mark.parametrize("kind", ["point", "line"])
@FOLLOWER
def test_one_part_alone_vs_body_form(kind, part, follower):
    basis, q, _ = loaded()
    value = [0.5, -1.0, 0.7]
    if kind == "point":
        wrench = point(1.0, **{part: value}, follower=follower)
    else:
        wrench = line(basis, **{part: np.outer(value, [1.0, 0.5, -0.3])}, follower=follower)
    found = model(basis, q, [wrench]).statics.internal_wrench().full().T
    assert_allclose(found, reference_wrench(basis, q, [wrench]), rtol=1e-11, atol=1e-11)


@FOLLOWER
@BREAKS
def test_base_wrench_vs_global_balance(breaks, follower):
    """Clamp, loads and lever arms sum to nothing, the sums taken by hand."""
    basis, q, wrenches = loaded(breaks, follower, 3)
    R, r = reference_poses(basis, q)
    *points, along = wrenches
    force, moment = np.zeros(3), np.zeros(3)
    for w in points:
        i = basis.grid.node_at(w.at)
        turn = R[i] if follower else np.eye(3)
        f, c = turn @ w.force.full().ravel(), turn @ w.moment.full().ravel()
        force, moment = force + f, moment + c + np.cross(r[i], f)
    turn = R if follower else np.broadcast_to(np.eye(3), R.shape)
    f = np.einsum("kij,jk->ki", turn, along.force.full() @ along.profiles)
    c = np.einsum("kij,jk->ki", turn, along.moment.full() @ along.profiles)
    weights = basis.properties.length * basis.grid.weights
    force, moment = force + weights @ f, moment + weights @ (c + np.cross(r, f))
    statics = model(basis, q, wrenches).statics
    assert_allclose(statics.base_force.full().ravel(), -force, rtol=1e-12, atol=1e-12)
    assert_allclose(statics.base_moment.full().ravel(), -moment, rtol=1e-11, atol=1e-11)


@FOLLOWER
@BREAKS
def test_base_wrench_vs_internal_wrench_at_the_base(breaks, follower):
    """Λ(0) = −F₋."""
    basis, q, wrenches = loaded(breaks, follower, 4)
    statics = model(basis, q, wrenches).statics
    m, n = internal(statics)
    assert_allclose(statics.base_force.full().ravel(), -n[0], rtol=1e-12, atol=1e-13)
    assert_allclose(statics.base_moment.full().ravel(), -m[0], rtol=1e-11, atol=1e-12)


def test_internal_wrench_at_the_tip_vs_tip_load():
    """Slip of (1.29): Λ(ℓ) = +F₊."""
    basis, q, _ = loaded()
    tip = point(1.0, [0.3, -0.2, 0.9], [0.1, 0.4, -0.5])
    m, n = internal(model(basis, q, [tip]).statics)
    assert_allclose(n[-1], [0.3, -0.2, 0.9], rtol=1e-15, atol=0)
    assert_allclose(m[-1], [0.1, 0.4, -0.5], rtol=1e-14, atol=1e-15)


@FOLLOWER
def test_jump_of_the_internal_wrench_vs_point_wrench(follower):
    basis, q, _ = loaded((0.0, 0.4, 1.0))
    force, moment = np.array([0.3, -0.2, 0.9]), np.array([0.1, 0.4, -0.5])
    tip = point(1.0, [0.5, 0.5, 0.0])
    igm = model(basis, q, [point(0.4, force, moment, follower=follower), tip])
    m, n = internal(igm.statics)
    left = basis.grid.node_at(0.4)
    turn = igm.shape.rotation_at(left).full() if follower else np.eye(3)
    assert_allclose(n[left] - n[left + 1], turn @ force, rtol=1e-13, atol=1e-14)
    assert_allclose(m[left] - m[left + 1], turn @ moment, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize(("i", "j"), [(0, 28), (4, 15), (10, 27)])
def test_balance_of_a_piece_vs_printed_1_16(i, j):
    """Slip of (1.16): the lever r₁ × n₁ is taken off, not added."""
    basis, q, wrenches = loaded()
    along = wrenches[-1]
    igm = model(basis, q, wrenches)
    m, n = internal(igm.statics)
    r = igm.shape.position.full().T
    f, c = ((v.full() @ along.profiles).T for v in (along.force, along.moment))
    pieces = basis.properties.length * (basis.grid.integration_matrix[j] - basis.grid.integration_matrix[i])
    load = pieces @ (c + np.cross(r, f))
    correct = m[j] + np.cross(r[j], n[j]) - m[i] - np.cross(r[i], n[i]) + load
    assert_allclose(correct, np.zeros(3), rtol=0, atol=1e-11)
    if i > 0:
        printed = m[j] + np.cross(r[j], n[j]) - m[i] + np.cross(r[i], n[i]) + load
        assert np.abs(printed).max() > 1e-2


@pytest.fixture(scope="module")
def bent():
    """A Reissner rod in equilibrium with forces that bend, twist and stretch it."""
    basis = strain_basis(rod(REISSNER), modes=12, nodes=28)
    wrenches = [
        point(1.0, [4.0, -2.0, 3.0], [0.5, 0.4, -0.6]),
        line(basis, np.array([[2.0, 1.0], [-1.0, 0.5], [3.0, 0.0]])),
    ]
    return basis, equilibrium(basis, wrenches), wrenches


def test_strain_in_equilibrium_vs_constitutive_law(bent):
    """Slips of (1.26), (1.27): curvature goes with the moment, both through Rᵀ."""
    basis, q, wrenches = bent
    igm = model(basis, q, wrenches)
    X = basis.grid.nodes
    xi = basis.at(ca.DM(q), X).full().T
    elastic = xi - basis.properties.intrinsic_strain(X)
    m, n = internal(igm.statics)
    R, _ = reference_poses(basis, q)
    body_m, body_n = np.einsum("kij,ki->kj", R, m), np.einsum("kij,ki->kj", R, n)
    assert_allclose(elastic[:, :3], body_m / HOOKE[:3], rtol=1e-6, atol=1e-7)
    assert_allclose(elastic[:, 3:], body_n / HOOKE[3:], rtol=1e-6, atol=1e-7)
    for printed_k in (np.einsum("kij,kj->ki", R, n), np.einsum("kij,kj->ki", R, m), body_n):
        assert np.abs(elastic[:, :3] - printed_k / HOOKE[:3]).max() > 1e-2
    for printed_g in (body_m, np.einsum("kij,kj->ki", R, n)):
        assert np.abs(elastic[:, 3:] - printed_g / HOOKE[3:]).max() > 1e-2


@pytest.mark.parametrize("admitted", [KIRCHHOFF, REISSNER])
@pytest.mark.parametrize("direction", [0, 1])
@pytest.mark.parametrize("follower", [False, True])
def test_cantilever_pushed_sideways_vs_beam_theory(admitted, direction, follower):
    """Pushed to +x it bends to +x, pushed to +y to +y."""
    length, push = 0.5, np.zeros(3)
    push[direction] = 1e-4
    basis = strain_basis(rod(admitted, STRAIGHT, length=length))
    wrenches = [point(1.0, push, follower=follower)]
    q = equilibrium(basis, wrenches)
    tip = model(basis, q, wrenches).shape.position_at(basis.grid.size - 1).full().ravel()
    bending, shear = HOOKE[1 - direction], HOOKE[3 + direction]
    expected = 1e-4 * (length**3 / (3 * bending) + (length / shear if 3 in admitted else 0.0))
    assert tip[direction] > 0
    assert_allclose(tip[direction], expected, rtol=1e-7, atol=0)


@pytest.mark.parametrize("direction", [0, 1])
def test_first_step_from_rest_vs_printed_sign_of_the_load(direction):
    """Slip of (1.29): K_εε q = −Q_ad bends with the push; with Λ_ℓ = −F₊ the rod bends against it."""
    push = np.zeros(3)
    push[direction] = 1e-3
    basis = strain_basis(rod(KIRCHHOFF, STRAIGHT))
    wrenches = [point(1.0, push)]
    force = model(basis, np.zeros(basis.size), wrenches).generalised_force.full()
    for sign in (1, -1):
        q = -sign * np.linalg.solve(basis.stiffness, force).ravel()
        assert sign * float(model(basis, q, wrenches).shape.position_at(basis.grid.size - 1)[direction]) > 1e-5


@pytest.mark.parametrize(("axis", "sign"), [(0, -1), (1, 1)])
def test_cantilever_turned_by_a_moment_vs_arc(axis, sign):
    """M about +y turns z towards +x, M about +x turns z towards −y."""
    moment = np.zeros(3)
    moment[axis] = 2.0
    basis = strain_basis(rod(KIRCHHOFF, STRAIGHT), nodes=20)
    wrenches = [point(1.0, moment=moment)]
    q = equilibrium(basis, wrenches)
    tip = model(basis, q, wrenches).shape.position_at(basis.grid.size - 1).full().ravel()
    kappa = 2.0 / HOOKE[axis]
    assert_allclose(tip[1 - axis], sign * (1 - np.cos(kappa * 0.5)) / kappa, rtol=1e-12, atol=0)
    assert_allclose(tip[2], np.sin(kappa * 0.5) / kappa, rtol=1e-12, atol=0)


def test_pulled_rod_vs_hooke():
    basis = strain_basis(rod((2, 5), STRAIGHT), modes=2)
    wrenches = [point(1.0, [0.0, 0.0, 7.0], [0.0, 0.0, 0.3])]
    q = equilibrium(basis, wrenches)
    xi = basis.at(ca.DM(q), np.array([0.2, 0.9])).full()
    assert_allclose(xi[5], 1 + 7.0 / HOOKE[5], rtol=1e-13, atol=0)
    assert_allclose(xi[2], 0.3 / HOOKE[2], rtol=1e-12, atol=0)


def literal_force(basis, q, wrenches):
    """−∫ Φᵀ Bᵀ Λ dX by the weights of the grid, without ℓ, from the reference wrench."""
    wrench = reference_wrench(basis, q, wrenches)
    parts = [basis.at_nodes[c].T @ (basis.grid.weights * wrench[:, c]) for c in basis.properties.admitted]
    return -np.concatenate(parts)


@FOLLOWER
@BREAKS
@pytest.mark.parametrize("admitted", [KIRCHHOFF, REISSNER, (0, 4), (3, 5)])
def test_transposed_sweep_vs_literal_quadrature(admitted, breaks, follower):
    """Q_ad of the transposed forward sweep against (2.16) at the nodes of the permuted solution."""
    q = coordinates(strain_basis(rod(admitted), breaks=breaks), 6)
    forces = []
    for transport in ("magnus8", "permuted"):
        basis = strain_basis(rod(admitted), nodes=28, breaks=breaks, transport=transport)
        forces.append(model(basis, q, mixed_loads(basis, follower=follower)).generalised_force.full())
    assert_allclose(forces[0], forces[1], rtol=1e-10, atol=1e-11)


@FOLLOWER
@pytest.mark.parametrize("length", [0.25, 2.0])
def test_generalised_force_vs_quadrature_with_the_length(length, follower):
    """Slip of (2.14) to (2.18): ℓ stays in Q_ad as in K_εε; without it the force is another."""
    basis, q, wrenches = loaded(follower=follower, seed=7, length=length, admitted=REISSNER)
    found = model(basis, q, wrenches).generalised_force.full().ravel() * basis.energy_unit
    without = literal_force(basis, q, wrenches)
    assert_allclose(found, length * without, rtol=1e-10, atol=1e-11)
    assert np.abs(found - without).max() > 0.2 * np.abs(without).max()


def test_no_wrenches_vs_zero():
    basis, q, _ = loaded()
    statics = model(basis, q, []).statics
    for value in (statics.base_force, statics.base_moment, statics.internal_force, statics.internal_moment):
        assert_allclose(value.full(), 0.0, rtol=0, atol=0)
    assert isinstance(statics, Statics)


@pytest.mark.parametrize("symbol", [ca.SX, ca.MX])
def test_symbolic_statics_vs_numeric_statics(symbol):
    basis, q, wrenches = loaded((0.0, 0.4, 1.0), True, nodes=6)
    x = symbol.sym("q", basis.size)
    igm, numeric = model(basis, x, wrenches), model(basis, q, wrenches)
    outputs = [igm.statics.internal_wrench(), igm.statics.base_moment, igm.residual]
    found = ca.Function("f", [x], outputs)(q)
    expected = [numeric.statics.internal_wrench(), numeric.statics.base_moment, numeric.residual]
    for a, b in zip(found, expected, strict=True):
        assert_allclose(a.full(), b.full(), rtol=1e-11, atol=1e-12)
