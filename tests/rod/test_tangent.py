"""The structured Jacobian against AD and finite differences, also where formulas with angles are singular."""

from functools import cache

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose
from rods import (
    CURVED,
    RODS,
    STRAIGHT,
    coordinates,
    hat,
    line,
    mixed_loads,
    model,
    point,
    rod,
    strain_basis,
)

from cosserat_casadi.rod.tangent import Tangent
from tests.derivatives import central_differences

BREAKS = {"one": (0.0, 1.0), "two": (0.0, 0.3, 1.0)}
LOADS = ["point-force", "point-moment", "line-force", "line-moment", "all"]


def loads(basis, kind, follower):
    value = np.array([0.8, -1.1, 0.6])
    at = basis.grid.breaks[1]
    spread = np.outer(value, [1.0, 0.4])
    return {
        "none": lambda: [],
        "point-force": lambda: [point(at, value, follower=follower), point(1.0, -value, follower=follower)],
        "point-moment": lambda: [point(at, moment=value, follower=follower)],
        "line-force": lambda: [line(basis, spread, follower=follower)],
        "line-moment": lambda: [line(basis, moment=spread, follower=follower)],
        "all": lambda: [*mixed_loads(basis, follower=follower), *mixed_loads(basis, follower=not follower, seed=1)],
        "zero": lambda: mixed_loads(basis, follower=follower, size=0.0),
    }[kind]()


def compared(basis, wrenches):
    """The function q ↦ (residual, structured Jacobian, Jacobian by AD)."""
    q = ca.MX.sym("q", basis.size)
    igm = model(basis, q, wrenches)
    outputs = [igm.residual, Tangent(igm).jacobian, ca.jacobian(igm.residual, q)]
    dense = [ca.densify(value) for value in outputs]
    return ca.Function("compared", [q], dense, ["q"], ["residual", "structured", "automatic"])


@cache
def case(name, breaks, load, follower, transport="magnus8", straight=False):
    properties = rod(RODS[name], STRAIGHT if straight else CURVED)
    basis = strain_basis(properties, modes=2, nodes=4, breaks=BREAKS[breaks], transport=transport)
    return basis, compared(basis, loads(basis, load, follower))


def differences_of_residual(f, q):
    return central_differences(f.factory("residual_alone", ["q"], ["residual"]), q, 1e-5)


PLACED = [*(("one", load) for load in LOADS[:-1]), ("two", "all")]
MAIN = ["planar", "kirchhoff", "reissner", "bent-stretched", "odd", "stretched"]


def every_case(function):
    function = pytest.mark.parametrize("follower", [False, True], ids=["dead", "follower"])(function)
    function = pytest.mark.parametrize(("breaks", "load"), PLACED)(function)
    return pytest.mark.parametrize("name", MAIN)(function)


@every_case
def test_structured_jacobian_vs_ad(name, breaks, load, follower):
    basis, f = case(name, breaks, load, follower)
    _, structured, automatic = (v.full() for v in f(coordinates(basis, 1)))
    assert_allclose(structured, automatic, rtol=1e-11, atol=1e-12)


@every_case
def test_structured_jacobian_vs_central_differences(name, breaks, load, follower):
    basis, f = case(name, breaks, load, follower)
    q = coordinates(basis, 1)
    assert_allclose(f(q)[1].full(), differences_of_residual(f, q), rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("transport", ["magnus4", "magnus6", "magnus8"])
@pytest.mark.parametrize("name", ["planar", "kirchhoff", "reissner"])
def test_structured_jacobian_vs_ad_for_each_transport(name, transport):
    basis, f = case(name, "two", "all", True, transport)
    _, structured, automatic = (v.full() for v in f(coordinates(basis, 2, 2.0)))
    assert_allclose(structured, automatic, rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("straight", [True, False], ids=["straight", "curved"])
@pytest.mark.parametrize("load", ["none", "zero", "all"])
@pytest.mark.parametrize("name", RODS)
def test_structured_jacobian_vs_ad_at_zero(name, load, straight):
    basis, f = case(name, "one", load, True, straight=straight)
    q = np.zeros(basis.size)
    residual, structured, automatic = (v.full() for v in f(q))
    assert np.all(np.isfinite(residual))
    assert np.all(np.isfinite(automatic))
    assert_allclose(structured, automatic, rtol=1e-12, atol=1e-13)
    assert_allclose(structured, differences_of_residual(f, q), rtol=1e-7, atol=1e-8)
    if load != "all":
        assert_allclose(structured, basis.stiffness, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("turns", [0.5, 1.0, -0.5, -1.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("name", ["kirchhoff", "reissner"])
def test_structured_jacobian_vs_ad_at_half_and_full_turns(name, axis, turns):
    """The tip has turned by exactly π and 2π: a quaternion and its logarithm are at their worst."""
    basis, f = case(name, "one", "all", True, straight=True)
    q = np.zeros(basis.size)
    q[basis.columns[axis].start] = 2 * np.pi * turns / basis.properties.length / basis.scales[axis]
    trace = np.trace(model(basis, q, []).shape.rotation_at(basis.grid.size - 1).full())
    assert_allclose(trace, 1 + 2 * np.cos(2 * np.pi * turns), rtol=0, atol=1e-13)
    _, structured, automatic = (v.full() for v in f(q))
    assert np.all(np.isfinite(automatic))
    assert_allclose(structured, automatic, rtol=1e-11, atol=1e-12)
    assert_allclose(structured, differences_of_residual(f, q), rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("breaks", BREAKS)
@pytest.mark.parametrize("name", RODS)
@pytest.mark.parametrize("size", [0.0, 1.0])
def test_variation_of_a_section_vs_ad(name, breaks, size):
    basis = strain_basis(rod(RODS[name]), modes=2, nodes=5, breaks=BREAKS[breaks])
    q = ca.MX.sym("q", basis.size)
    igm = model(basis, q, [])
    tangent = Tangent(igm)
    values = coordinates(basis, 3, size)
    for node in (0, 3, basis.grid.node_at(BREAKS[breaks][1]), basis.grid.size - 1):
        R, r = igm.shape.rotation_at(node), igm.shape.position_at(node)
        outputs = [R, ca.jacobian(r, q), ca.jacobian(ca.vec(R), q), tangent.position(node), tangent.rotation_of(node)]
        f = ca.Function("f", [q], [ca.densify(v) for v in outputs])
        R, dr, dR, position, rotation = (v.full() for v in f(values))
        assert_allclose(position, dr, rtol=1e-12, atol=1e-14)
        for column, theta in zip(dR.T, rotation.T, strict=True):
            spin = column.reshape(3, 3, order="F") @ R.T
            assert_allclose(spin, hat(theta), rtol=0, atol=1e-13)


@pytest.mark.parametrize("size", [0.0, 1.0])
@pytest.mark.parametrize("load", ["zero", "all"])
@pytest.mark.parametrize("name", ["planar", "kirchhoff", "reissner"])
def test_second_derivatives_vs_differences_of_the_jacobian(name, load, size):
    properties = rod(RODS[name], STRAIGHT)
    basis = strain_basis(properties, modes=1 if name == "reissner" else 2, nodes=3, transport="magnus6")
    q = ca.MX.sym("q", basis.size)
    igm = model(basis, q, loads(basis, load, True))
    jacobian = ca.jacobian(igm.residual, q)
    f = ca.Function("f", [q], [Tangent(igm).jacobian, ca.jacobian(ca.vec(ca.densify(jacobian)), q)])
    values = coordinates(basis, 4, size)
    hessian = f(values)[1].full()
    assert np.all(np.isfinite(hessian))
    assert_allclose(hessian, central_differences(lambda q: f(q)[0], values, 1e-4), rtol=1e-6, atol=1e-7)
