"""Rods that a discretisation does not resolve are called so, and rods of many turns get what they need."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from cosserat_casadi import Outcome, Scene, Solution, build, discretise, scene_from_dict
from cosserat_casadi.accuracy.assess import min_modes, node_residual
from cosserat_casadi.equilibrium.metrics import largest_turn
from tests.catalogue.cases import helical_form
from tests.equilibria import solve
from tests.reference.closed_forms import roll_up
from tests.scenes import push, rod, scene
from tests.shooting_near import shoot

UNIT = {"planar": {"bending_y": 1.0}, "kirchhoff": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.8}}


def rolled(turns: float, strain: str = "planar", **changes: Any) -> Scene:
    """A straight rod under the tip moment that rolls it up."""
    straight = {"name": "rod", "length": 1.0, "strain": strain, "stiffness": UNIT[strain]}
    return scene(push(force=[0, 0, 0], moment=[0, 2 * np.pi * turns, 0]), rods=[straight], **changes)


def spring(force: float) -> Scene:
    """Ten turns of radius 1 and pitch 1/2, clamped at one end and pulled at the other across its first tangent."""
    slope = 0.5 / (2 * np.pi)
    curvature = [0.0, 1 / (1 + slope**2), slope / (1 + slope**2)]
    coil = rod("kirchhoff", length=20 * np.pi * np.hypot(1, slope), intrinsic={"curvature": curvature})
    return scene(push(force=[force, 0.0, 0.0]), rods=[{**coil, "stiffness": UNIT["kirchhoff"]}])


@pytest.mark.parametrize("transport", ["magnus4", "magnus8"])
@pytest.mark.parametrize("strain", ["planar", "kirchhoff"])
def test_resolution_index_vs_quadrature_of_the_curvature(strain: str, transport: str) -> None:
    """The largest ∫|K| ds over an interval, in units of 2 rad; what the Taylor coefficients bound it by is near it."""
    wanted = rolled(0.0, strain)
    model = build(wanted, discretise(wanted, 3, 8, transport))
    x = np.random.default_rng(1).standard_normal(model.size)
    solution = Solution(model, model.pack(), x, Outcome.CONVERGED, "", 0.0, 0)
    nodes = model.discrete.rods["rod"].grid.nodes
    turns = [quad(lambda X: float(np.linalg.norm(solution.strain([X])[0, :3])), a, b)[0] for a, b in pairwise(nodes)]
    largest = 2.0 * float(model.resolution_index(x, model.pack()))
    assert max(turns) * (1 - 1e-3) <= largest <= 1.25 * max(turns)


@pytest.mark.parametrize("strain", ["planar", "kirchhoff"])
def test_load_too_large_for_the_nodes_is_unresolved(strain: str) -> None:
    """The discrete equations are solved, the rod is not: its tip lies far from where it must."""
    wanted = rolled(5.0, strain)
    coarse = solve(build(wanted, discretise(wanted, 2, 6, "magnus4")))
    assert coarse.outcome is Outcome.UNRESOLVED
    assert coarse.residual_norm <= 1e-11
    assert coarse.stable is None
    fine = solve(build(wanted, discretise(wanted, 2, 40, "magnus4")))
    assert fine.converged
    assert_allclose(fine.tip().position, roll_up(5.0)[0], rtol=0, atol=1e-9)
    assert np.abs(coarse.tip().position - roll_up(5.0)[0]).max() > 1e-2


def test_literal_system_that_loses_the_unit_quaternion_is_unresolved() -> None:
    wanted = rolled(5.0)
    for nodes, outcome in ((8, Outcome.UNRESOLVED), (40, Outcome.CONVERGED)):
        assert solve(build(wanted, discretise(wanted, 1, nodes, "permuted"))).outcome is outcome


@pytest.mark.slow
@pytest.mark.parametrize("force", [5e-4, 4e-3])
def test_spring_of_ten_turns_vs_shooting(force: float) -> None:
    solution = solve(spring(force))
    assert solution.converged
    length = solution.model.scene.rods[0].length
    assert_allclose(solution.tip().position, shoot(solution, [1.0]).position[-1], rtol=0, atol=1e-6 * length)


@pytest.mark.slow
def test_wave_that_few_modes_cannot_see_shows_at_the_nodes() -> None:
    """Ten turns with seven modes: the equations hold, the balance of stress at the nodes does not."""
    wanted = scene_from_dict(helical_form(1.0))
    blind = solve(build(wanted, discretise(wanted, 7, 56, "magnus6")))
    assert blind.converged
    assert node_residual(blind) > 1e-2
    # Which of the solutions of too few modes the path ends at is open: all of them ask for far more.
    assert min_modes(blind, largest_turn(blind), 1e-6) >= 2 * 7
    circle = solve(build(rolled(5.0), discretise(rolled(5.0), 2, 40, "magnus4")))
    assert node_residual(circle) < 1e-9
    assert min_modes(circle, largest_turn(circle), 1e-6) == 0
