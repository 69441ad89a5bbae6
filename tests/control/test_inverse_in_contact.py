"""Inverse problems of rods in exact contact: inputs that a solve had, over a change of contacts, and others."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, build, inverse, scene_from_dict, solve
from cosserat_casadi.control.inverse import ContactProblem, inverse_problem
from cosserat_casadi.equilibrium.contact.contact_answer_error import same_contacts
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations
from cosserat_casadi.equilibrium.contact.gaps import gap_along, pairs


def over_ball(position: list[float], lower: float = -2.0, start: float = 0.0) -> Scene:
    """A rod above a ball, whose tip a force across it is to bring to a position."""
    rod = {
        "name": "rod",
        "length": 1.0,
        "strain": "planar",
        "stiffness": {"bending_y": 0.5},
        "base": {"tangent": [1, 0, 0]},
    }
    tables = {
        "schema": 1,
        "rods": [rod],
        "loads": [{"name": "push", "kind": "tip_wrench", "rod": "rod", "force": [0, 0, start]}],
        "obstacles": [{"name": "ball", "kind": "sphere", "centre": [0.45, 0, -0.13], "radius": 0.1}],
        "inputs": ["push.force"],
        "bounds": [{"input": "push.force", "lower": [0, 0, lower], "upper": [0, 0, 0.5]}],
        "targets": [{"kind": "position", "rod": "rod", "position": position}],
        "accuracy": {"modes": 4, "nodes": 8, "tolerance": 1e-4},
    }
    return scene_from_dict(tables)


@pytest.mark.parametrize("push", [-1.4, pytest.param(-0.1, marks=pytest.mark.slow)])
def test_inputs_of_a_solve_are_found_over_a_change_of_contacts(push: float) -> None:
    """From a rod that is free to one that presses, and from one that presses to one that is free."""
    wanted = solve(build(over_ball([1.0, 0, 0])), {"push.force": [0, 0, push]}, estimate_error=False)
    begun = -1.4 - 0.1 - push
    found = inverse(build(over_ball(wanted.tip().position.tolist(), start=begun)), starts=0)
    assert found.met and found.starts == 1
    assert found.rounds <= 12
    assert_allclose(found.values["push.force"][:, 0], [0, 0, push], rtol=0, atol=1e-7)
    assert list(found.values) == ["push.force"]
    assert same_contacts(found.solution, wanted)
    assert found.solution.error_estimate is not None and found.solution.error_estimate < 1e-4


@pytest.mark.slow
def test_a_target_inside_the_ball_is_missed_by_a_rod_that_does_not_enter_it() -> None:
    found = inverse(build(over_ball([0.45, 0, -0.1])), starts=0, estimate_error=False)
    assert not found.met
    assert "closest result misses" in found.solution.message
    ((rod, obstacle),) = pairs(found.solution.model.scene)
    assert gap_along(found.solution, rod, obstacle, np.linspace(0, 1, 101)).min() > -1e-6


@pytest.mark.slow
def test_a_search_that_comes_no_nearer_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """With derivatives of the wrong sign no step helps: what is told is the start."""
    own = ContactEquations.arguments_moved
    monkeypatch.setattr(ContactEquations, "arguments_moved", lambda *given: -own(*given))
    monkeypatch.setattr(import_module("cosserat_casadi.control.inverse"), "MOST_DAMPING", 1e3)
    scene = over_ball([0.8, 0, -0.4], start=-1.0)
    model = build(scene)
    start = solve(model, estimate_error=False)
    problem = inverse_problem(model, scene.targets, start, False)
    assert isinstance(problem, ContactProblem)
    found = problem.solve(start, problem.change(start.inputs[:3]))
    assert not found.met and found.solution.converged
    assert_allclose(found.values["push.force"][:, 0], [0, 0, -1.0], rtol=0, atol=1e-12)


@pytest.mark.slow
def test_the_scene_chooses_modes_at_the_inputs_that_result() -> None:
    tables = over_ball([0.8, 0, -0.4])
    wanted = solve(build(tables), {"push.force": [0, 0, -1.4]}, estimate_error=False)
    scene = over_ball(wanted.tip().position.tolist()).model_copy(
        update={"accuracy": tables.accuracy.model_copy(update={"modes": None, "nodes": None})}
    )
    found = inverse(scene)
    assert found.met, found.solution.message
    assert found.solution.within_tolerance
