"""The inverse geometric model: gradient of an energy, reciprocity, and what no choice of frame or unit may change."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rods import (
    HOOKE,
    KIRCHHOFF,
    PLANAR,
    REISSNER,
    STRAIGHT,
    balance,
    coordinates,
    equilibrium,
    line,
    mixed_loads,
    model,
    point,
    reference_wrench,
    rod,
    strain_basis,
    tapered,
    uniform,
)
from scipy.spatial.transform import Rotation

from cosserat_casadi.model.load_assembly import RodBase
from cosserat_casadi.rod.tangent import Tangent

BREAKS = pytest.mark.parametrize("breaks", [(0.0, 1.0), (0.0, 0.4, 1.0)])
SUBSETS = pytest.mark.parametrize("admitted", [PLANAR, KIRCHHOFF, REISSNER, (0, 5), (1, 2, 3), (3, 4, 5)])


def dead_forces(basis, seed=0):
    draw = np.random.default_rng(seed).uniform
    points = [point(at, draw(-2, 2, 3)) for at in basis.grid.breaks[1:]]
    return [*points, line(basis, draw(-2, 2, (3, 2)))]


def potential(igm, wrenches):
    """Elastic energy less the work of dead forces, from positions alone."""
    basis, position = igm.shape.rod, igm.shape.position
    work = 0
    for w in wrenches[:-1]:
        work += ca.dot(w.force, position[:, basis.grid.node_at(w.at)])
    along = (wrenches[-1].force.full() @ wrenches[-1].profiles) * basis.grid.weights * basis.properties.length
    return igm.energy - work - ca.dot(ca.DM(along), position)


@BREAKS
@SUBSETS
@pytest.mark.parametrize("transport", ["magnus4", "magnus8"])
def test_residual_vs_gradient_of_the_potential(admitted, breaks, transport):
    """Exact on the coarsest grid: the backward sweep is the transpose of the forward sweep."""
    basis = strain_basis(rod(admitted), nodes=5, breaks=breaks, transport=transport)
    q, wrenches = ca.MX.sym("q", basis.size), dead_forces(basis)
    igm = model(basis, q, wrenches)
    f = ca.Function("f", [q], [igm.residual, ca.gradient(potential(igm, wrenches), q) / basis.energy_unit])
    residual, gradient = (v.full() for v in f(coordinates(basis, 1)))
    assert_allclose(residual, gradient, rtol=1e-12, atol=1e-12)


def test_residual_vs_gradient_with_a_planar_moment():
    basis = strain_basis(rod((1,), STRAIGHT), nodes=6, breaks=(0.0, 0.4, 1.0))
    q = ca.MX.sym("q", basis.size)
    wrenches = [point(0.4, moment=[0.0, 0.7, 0.0]), point(1.0, moment=[0.0, -1.2, 0.0])]
    igm = model(basis, q, wrenches)
    curvature = ca.DM(basis.at_nodes[1]) @ q
    angles = [
        basis.properties.length * ca.DM(basis.grid.integration_matrix[[basis.grid.node_at(at)]]) @ curvature
        for at in (0.4, 1.0)
    ]
    total = igm.energy - 0.7 * angles[0] + 1.2 * angles[1]
    f = ca.Function("f", [q], [igm.residual, ca.gradient(total, q) / basis.energy_unit])
    residual, gradient = (v.full() for v in f(coordinates(basis, 2)))
    assert_allclose(residual, gradient, rtol=1e-12, atol=1e-13)


@BREAKS
@pytest.mark.parametrize("hooke", [uniform(), tapered], ids=["uniform", "tapered"])
def test_energy_vs_quadrature_of_the_strains(breaks, hooke):
    basis = strain_basis(rod(REISSNER, hooke=hooke, length=0.8), nodes=20, breaks=breaks)
    q = coordinates(basis, 3)
    X = basis.grid.nodes
    elements = np.repeat(np.arange(basis.grid.elements), basis.grid.intervals + 1)
    elastic = [basis.shape_functions(c, X, elements) @ q[basis.columns[c]] for c in range(6)]
    density = np.sum(hooke(X) * np.array(elastic).T ** 2, axis=1)
    expected = 0.5 * 0.8 * basis.grid.weights @ density
    assert_allclose(float(model(basis, q, []).energy), expected, rtol=1e-12, atol=0)


@pytest.mark.parametrize("seed", range(3))
def test_floating_base_vs_wrench_in_the_world(seed):
    """Loads of the world placed in the base frame leave the internal wrench of a rod integrated in the world."""
    basis = strain_basis(rod(REISSNER), nodes=28)
    q, wrenches = coordinates(basis, seed), mixed_loads(basis, follower=False, seed=seed)
    world_R_base = Rotation.from_rotvec([0.4 + seed, -1.3, 0.7]).as_matrix()
    base = RodBase(ca.DM(3, 1), ca.DM(world_R_base.T))
    tip, along = wrenches
    placed = [
        point(1.0, *(base.in_base_axes(v, follower=False) for v in (tip.force, tip.moment))),
        line(basis, *(base.in_base_axes(v, follower=False) for v in (along.force, along.moment))),
    ]
    found = model(basis, q, placed).statics.internal_wrench().full().T
    expected = reference_wrench(basis, q, wrenches, world_R_base)
    assert_allclose(found, expected, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("angle", [0.3, np.pi / 2, 2.5])
def test_rod_and_loads_turned_about_the_axis_vs_turned_residual(angle):
    """A rod that is the same about its axis does not know where x is."""
    basis = strain_basis(rod(REISSNER, STRAIGHT, hooke=uniform(np.array([1.0, 1.0, 0.7, 50.0, 50.0, 90.0]))))
    turn = Rotation.from_rotvec([0, 0, angle]).as_matrix()
    both = np.kron(np.kron(np.eye(2), turn), np.eye(3))
    q = coordinates(basis, 4)
    force, moment = np.array([0.5, 1.0, -2.0]), np.array([0.3, 0.2, 0.6])
    residual = model(basis, q, [point(1.0, force, moment)]).residual.full().ravel()
    turned = model(basis, both @ q, [point(1.0, turn @ force, turn @ moment)]).residual.full().ravel()
    assert_allclose(turned, both @ residual, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("factor", [1e-3, 20.0])
def test_residual_vs_residual_in_another_unit_of_length(factor):
    small = rod(REISSNER, STRAIGHT)
    hooke = HOOKE * np.array([factor**2] * 3 + [1.0] * 3)
    large = rod(REISSNER, STRAIGHT, length=0.5 * factor, hooke=uniform(hooke))
    q = coordinates(strain_basis(small), 5)
    force, moment = np.array([0.5, 1.0, -2.0]), np.array([0.3, 0.2, 0.6])
    residuals = [
        model(strain_basis(r), q, [point(1.0, force, k * moment), line(strain_basis(r), force[:, None] / k)]).residual
        for r, k in ((small, 1.0), (large, factor))
    ]
    assert_allclose(residuals[0].full(), residuals[1].full(), rtol=1e-11, atol=1e-12)


@BREAKS
@SUBSETS
def test_jacobian_of_dead_forces_vs_its_transpose(admitted, breaks):
    basis = strain_basis(rod(admitted), nodes=5, breaks=breaks)
    jacobian = balance(basis, dead_forces(basis))(coordinates(basis, 6))[1].full()
    assert_allclose(jacobian, jacobian.T, rtol=1e-12, atol=1e-12)


def test_jacobian_of_a_follower_vs_its_transpose():
    basis = strain_basis(rod(KIRCHHOFF))
    jacobian = balance(basis, [point(1.0, [2.0, 1.0, 0.0], follower=True)])(coordinates(basis, 6))[1].full()
    assert np.abs(jacobian - jacobian.T).max() > 1e-2


def tip_pose(basis, wrench):
    """Rotation and position of the tip in equilibrium with a wrench [moment; force]."""
    wrenches = [point(1.0, wrench[3:], wrench[:3])]
    pose = model(basis, equilibrium(basis, wrenches), wrenches).shape
    node = basis.grid.size - 1
    return pose.rotation_at(node).full(), pose.position_at(node).full().ravel()


@pytest.mark.parametrize("admitted", [KIRCHHOFF, REISSNER])
def test_flexibility_of_the_tip_vs_finite_differences_and_its_transpose(admitted):
    """Maxwell and Betti: tip moments and forces against tip rotations and displacements at zero load."""
    basis = strain_basis(rod(admitted), modes=2, nodes=6)
    tangent = Tangent(model(basis, np.zeros(basis.size), []))
    node, step = basis.grid.size - 1, 1e-4
    motion = ca.vertcat(tangent.rotation_of(node), tangent.position(node)).full()
    flexibility = motion @ np.linalg.solve(tangent.jacobian.full(), motion.T) / basis.energy_unit
    found = np.zeros((6, 6))
    for i, unit in enumerate(step * np.eye(6)):
        (R_plus, r_plus), (R_minus, r_minus) = (tip_pose(basis, w) for w in (unit, -unit))
        found[:3, i] = Rotation.from_matrix(R_plus @ R_minus.T).as_rotvec() / (2 * step)
        found[3:, i] = (r_plus - r_minus) / (2 * step)
    assert_allclose(found, flexibility, rtol=1e-6, atol=1e-8)
    assert_allclose(found, found.T, rtol=1e-6, atol=1e-8)
    assert np.linalg.eigvalsh(flexibility).min() > 0


def test_flexibility_of_a_straight_tip_vs_beam_theory():
    L, (EIx, EIy, GJ, GAx, GAy, EA) = 0.5, HOOKE
    basis = strain_basis(rod(REISSNER, STRAIGHT))
    tangent = Tangent(model(basis, np.zeros(basis.size), []))
    node = basis.grid.size - 1
    motion = ca.vertcat(tangent.rotation_of(node), tangent.position(node)).full()
    found = motion @ np.linalg.solve(tangent.jacobian.full(), motion.T) / basis.energy_unit
    expected = np.diag([L / EIx, L / EIy, L / GJ, L**3 / 3 / EIy + L / GAx, L**3 / 3 / EIx + L / GAy, L / EA])
    expected[1, 3] = expected[3, 1] = L**2 / 2 / EIy
    expected[0, 4] = expected[4, 0] = -(L**2) / 2 / EIx
    assert_allclose(found, expected, rtol=1e-12, atol=1e-14)


def test_unloaded_rod_vs_zero_residual():
    basis = strain_basis(rod(REISSNER), breaks=(0.0, 0.4, 1.0))
    assert_allclose(model(basis, np.zeros(basis.size), []).residual.full(), 0.0, rtol=0, atol=0)
