"""Numbers of rods that touch obstacles exactly, from what an independent solver makes of the same rods."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Identification, Scene, Solution, build, identify, scene_from_dict, solve
from cosserat_casadi.errors import SceneError
from cosserat_casadi.identification.fit_problem import Task, _Started
from cosserat_casadi.identification.fit_unknowns import unknown_layout
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.robust_loss import Loss
from tests.families import mostly_slow
from tests.reference.discrete_rods import discrete_equilibrium

MODULUS = 2e6
SIGMA = 2e-4
FLOOR = {"name": "floor", "kind": "plane", "point": [0, 0, -0.1], "normal": [0, 0, 1]}
WEIGHTS = (-0.006, -0.014, -0.2)
"""Forces per length, N/m: the rod hangs free, its tip is on the floor, and it lies there."""

AT = (0.4, 0.7, 1.0)
SEGMENTS = 80


def tables(modulus: float, weight: float = 0.0) -> dict[str, Any]:
    """A rubber rod that hangs over a floor."""
    rod = {
        "name": "rod",
        "length": 1.0,
        "strain": "planar",
        "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]},
        "material": {"youngs_modulus": modulus, "poisson_ratio": 0.45, "density": 1100.0},
        "section": {"shape": "circle", "radius": 0.01},
    }
    load = {"name": "weight", "kind": "distributed_wrench", "rod": "rod", "force": [0, 0, weight]}
    return {
        "schema": 1,
        "rods": [rod],
        "loads": [load],
        "obstacles": [FLOOR],
        "inputs": ["weight.force"],
        "accuracy": {"modes": 4, "nodes": 8},
    }


def measured(modulus: float, **more: Any) -> Scene:
    """The rod with markers whose places were measured, and its modulus and the height of its clamp unknown."""
    positions = {
        "name": "markers",
        "quantity": "position",
        "file": "markers.csv",
        "rod": "rod",
        "at": "X",
        "case": "case",
        "columns": ["x", "y", "z"],
        "sigma": SIGMA,
        "inputs": {"weight.force.z": "weight"},
    }
    unknowns = [
        {"parameter": "rod.material.youngs_modulus", "lower": 5e5, "upper": 8e6},
        {"parameter": "rod.base.position.z", "lower": -0.05, "upper": 0.05},
    ]
    return scene_from_dict({**tables(modulus), "measurements": [positions], "unknowns": unknowns, **more})


@cache
def truth(weight: float) -> Solution:
    return solve(build(scene_from_dict(tables(MODULUS, weight))))


@cache
def markers() -> dict[str, Any]:
    """Places of the markers of discrete rods, with noise."""
    places = []
    for weight in WEIGHTS:
        solution = truth(weight)
        sections = np.linspace(0.0, 1.0, SEGMENTS + 1)
        between = (sections[1:] + sections[:-1]) / 2
        start = {"rod": (solution.pose(sections).position, solution.pose(between).rotation)}
        minimum = discrete_equilibrium(tables(MODULUS, weight), start)
        assert minimum.solved
        places.append([minimum.ends["rod"][round(X * SEGMENTS) - 1] for X in AT])
    noise = np.random.default_rng(5).normal(size=(len(WEIGHTS), len(AT), 3))
    return table(WEIGHTS, np.array(places) + SIGMA * noise)


def table(weights: Sequence[float], places: FloatArray) -> dict[str, Any]:
    """Places of the markers of each case, shape (cases, markers, 3), as a file has them."""
    return {
        "markers.csv": {
            "X": np.tile(AT, len(weights)),
            "case": np.repeat(np.arange(len(weights)), len(AT)),
            "weight": np.repeat(weights, len(AT)),
            **dict(zip("xyz", places.reshape(-1, 3).T, strict=True)),
        }
    }


def kinds(solutions: tuple[Solution, ...]) -> list[list[str]]:
    """How the rod touches in each case."""
    return [[contact.kind for contact in solution.contacts] for solution in solutions]


def started(scene: Scene, data: dict[str, Any]) -> _Started:
    """The cases where the search begins."""
    model = build(scene.with_unknowns())
    layout = unknown_layout(model)
    cases = read_cases(model.scene, model.inputs, data)
    task = Task(model, layout, Loss("squares", 1.0), scene.identification, 1, lambda stage: None, None)
    first, missing = task._first(cases, layout.start(0)[0])
    assert first is not None and not missing
    return first


@pytest.mark.slow
def test_a_modulus_is_found_while_contacts_open_and_close() -> None:
    stiff = 1.6 * MODULUS
    first = started(measured(stiff), markers())
    found: Identification = identify(build(measured(stiff).with_unknowns()), markers())
    assert found.converged, found.message
    # Stiffer rods touch otherwise: the search has followed them through changes of their contacts.
    assert kinds(found.equilibria) == kinds(tuple(truth(weight) for weight in WEIGHTS)) == [[], ["point"], ["line"]]
    assert kinds(first.misfit.solutions(first.state)) != kinds(found.equilibria)
    for value, wanted, (lower, upper) in zip(found.shared, (MODULUS, 0.0), found.intervals, strict=True):
        assert lower < wanted < upper, value
    assert found.sigma[0] < 0.01 * MODULUS
    rms = found.rms()
    assert rms is not None and 0.6 < rms < 1.4


@pytest.mark.parametrize("weight", mostly_slow(WEIGHTS, quick=[WEIGHTS[1]]))
def test_derivatives_of_the_misfit_are_those_of_solves_that_find_their_contacts(weight: float) -> None:
    first = started(measured(MODULUS), table([weight], np.zeros((1, len(AT), 3))))
    by_shared, _ = first.misfit.jacobians(first.state)
    for column, change in enumerate((1e-4 * MODULUS, 1e-5)):
        sides = []
        for sign in (1.0, -1.0):
            numbers = [MODULUS, 0.0]
            numbers[column] += sign * change
            scene = tables(numbers[0], weight)
            scene["rods"][0]["base"]["position"] = [0.0, 0.0, numbers[1]]
            solution = solve(build(scene_from_dict(scene)), start=truth(weight))
            sides.append(solution.pose(np.array(AT)).position.ravel() / SIGMA)
        differences = (sides[0] - sides[1]) / (2 * change)
        scale = np.abs(differences).max()
        assert_allclose(by_shared[:, column], differences, rtol=0, atol=2e-6 * scale)


def test_what_moves_is_refused_in_exact_contact() -> None:
    frequency = {
        "quantity": "frequency",
        "file": "markers.csv",
        "columns": ["f"],
        "mode": 1,
        "sigma": 0.1,
        "inputs": {"weight.force.z": "weight"},
    }
    vibrating = measured(MODULUS, measurements=[frequency])
    with pytest.raises(SceneError, match="is of a vibration"):
        identify(build(vibrating.with_unknowns()), {"markers.csv": {"f": np.ones(3), "weight": np.array(WEIGHTS)}})
