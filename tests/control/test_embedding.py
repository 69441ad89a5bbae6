"""A rod in an optimisation problem: lifted and embedded give the same optimum; a failed root is seen."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Solution, build, solve
from cosserat_casadi.control import embedded, lifted
from tests.derivatives import central_differences
from tests.scenes import push, scene

WANTED = [0.35, 0.1, 0.65]
QUIET = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-11}


def cantilever() -> tuple[Model, Solution]:
    model = build(scene(push(), inputs=["push.force"], accuracy={"modes": 4}))
    return model, solve(model)


def cost(model: Model, x: ca.MX, force: ca.MX) -> ca.MX:
    return ca.sumsqr(model.tip["rod"](x, force)[0] - ca.DM(WANTED)) + 1e-2 * ca.sumsqr(force)


def cost_of(solution: Solution) -> float:
    tip = solution.tip().position
    return float(np.sum((tip - WANTED) ** 2) + 1e-2 * np.sum(solution.inputs**2))


def lifted_optimum(model: Model, near: Solution) -> ca.DM:
    """As a raw NLP."""
    force, x = ca.MX.sym("force", 3), ca.MX.sym("x", model.size)
    rod = lifted(model, x, force, near)
    problem = {"x": ca.vertcat(force, x), "f": cost(model, rod.x, force), "g": rod.residual}
    solver = ca.nlpsol("solver", "ipopt", problem, QUIET)
    return solver(x0=ca.vertcat(near.inputs, rod.start), lbg=0, ubg=0)["x"][:3]


def embedded_optimum(model: Model, near: Solution) -> ca.DM:
    """As an Opti."""
    opti = ca.Opti()
    force = opti.variable(3)
    x, excess = embedded(model, near)(force)
    opti.minimize(cost(model, x, force))
    opti.set_initial(force, near.inputs)
    opti.solver("ipopt", QUIET)
    found = opti.solve()
    assert found.value(excess) <= 1.0
    return ca.DM(found.value(force))


def test_lifted_vs_embedded_optimum() -> None:
    model, near = cantilever()
    one, other = lifted_optimum(model, near), embedded_optimum(model, near)
    assert_allclose(one.full(), other.full(), rtol=0, atol=1e-7)
    start = solve(model, {"push.force": one.full()})
    assert start.converged
    least = cost_of(start)
    for step in 1e-3 * np.vstack([np.eye(3), -np.eye(3)]):
        moved = solve(model, {"push.force": one.full()[:, 0] + step}, start=start)
        assert cost_of(moved) > least


def test_derivatives_of_the_embedded_rod_vs_solves() -> None:
    """First against the implicit-function theorem, second against central differences of the first."""
    model, near = cantilever()
    root, force = embedded(model, near), ca.MX.sym("force", 3)
    slope = ca.Function("slope", [force], [ca.jacobian(root(force)[0], force)])
    expected = -np.linalg.solve(
        model.jacobian(near.x, near.inputs)[0].full(), model.input_jacobian(near.x, near.inputs).full()
    )
    assert_allclose(slope(near.inputs).full(), expected, rtol=1e-9, atol=1e-11)
    bend = ca.Function("bend", [force], [ca.hessian(model.tip["rod"](root(force)[0], force)[0][0], force)[0]])
    gradient = ca.Function("gradient", [force], [ca.gradient(model.tip["rod"](root(force)[0], force)[0][0], force)])
    differences = central_differences(gradient, near.inputs, 1e-5)
    assert_allclose(bend(near.inputs).full(), differences, rtol=1e-5, atol=1e-8)


def test_a_root_that_was_not_found_is_seen() -> None:
    model, near = cantilever()
    assert float(embedded(model, near)(near.inputs)[1]) <= 1.0
    assert not float(embedded(model, near, iterations=1)([30.0, -40.0, 20.0])[1]) <= 1.0
    assert not float(embedded(model, near)([np.nan, 0.0, 0.0])[1]) <= 1.0
