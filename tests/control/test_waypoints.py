"""A path through waypoints that are constraints: it asks for the curvature of the constraints."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Solution, solve
from cosserat_casadi.codegen.stage import compiled_stage
from examples.tendon_robot_mpc import robots
from tests.codegen.test_load import cached, needs_compiler

STAGES = 10
WAYPOINTS = (3, 6, 9)
"""Stages at whose end the tip is somewhere given."""

LARGEST = 8.0
"""Tension of the path that is known to be feasible, N."""

MOST_ITERATIONS = 150


def feasible_path(model: Model) -> list[Solution]:
    """Equilibria along tensions that swing, the second and fourth twice as fast."""
    phases = np.random.default_rng(1).uniform(0.0, 6.28, 4)
    speeds = 2 * np.pi / STAGES * np.array([1.0, 2.0, 1.0, 2.0])
    solutions: list[Solution] = []
    for stage in range(STAGES):
        tensions = LARGEST * (0.5 + 0.5 * np.sin(phases + speeds * stage))
        start = solutions[-1] if solutions else None
        solutions.append(solve(model, tensions, start=start, raise_on_failure=True))
    return solutions


def solved_path(model: Model, stage: ca.Function, wanted: list[Solution]) -> tuple[bool, np.ndarray]:
    """Whether ipopt finds the tensions that change least along the waypoints, and these, shape (STAGES, 4)."""
    variables = []
    constraints = []
    cost = ca.MX(0)
    before = ca.MX(0, 0)
    for k in range(STAGES):
        tensions = ca.MX.sym(f"tensions_{k}", 4)
        x = ca.MX.sym(f"x_{k}", model.size)
        residual, pose = stage(x, tensions)
        constraints.append(residual)
        if k in WAYPOINTS:
            constraints.append(pose[:3] - ca.DM(np.ravel(wanted[k].tip().position)))
        cost += ca.sumsqr(tensions - before) if k else 1e-3 * ca.sumsqr(tensions)
        before = tensions
        variables += [tensions, x]
    problem = {"x": ca.vertcat(*variables), "f": cost, "g": ca.vertcat(*constraints)}
    options = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.max_iter": MOST_ITERATIONS}
    solver = ca.nlpsol("path", "ipopt", problem, options)
    unbounded = np.full(model.size, np.inf)
    at_one = solve(model, np.ones(4)).x
    found = solver(
        x0=np.tile(np.concatenate([np.ones(4), at_one]), STAGES),
        lbx=np.tile(np.concatenate([np.zeros(4), -unbounded]), STAGES),
        ubx=np.tile(np.concatenate([np.full(4, 1.5 * LARGEST), unbounded]), STAGES),
        lbg=0.0,
        ubg=0.0,
    )
    by_stage = found["x"].full().reshape(STAGES, 4 + model.size)
    return bool(solver.stats()["success"]), by_stage[:, :4]


@needs_compiler
@pytest.mark.slow
def test_waypoints_are_met_with_exact_second_derivatives_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cached(tmp_path, monkeypatch)
    model = robots()[0].model
    wanted = feasible_path(model)
    success, tensions = solved_path(model, compiled_stage(model, "waypoints"), wanted)
    assert success
    for k in WAYPOINTS:
        reached = solve(model, tensions[k], start=wanted[k], raise_on_failure=True)
        assert_allclose(reached.tip().position, wanted[k].tip().position, rtol=0, atol=1e-6)
    bare = compiled_stage(model, "waypoints_bare", curvature=False)
    success, _ = solved_path(model, bare, wanted)
    assert not success
