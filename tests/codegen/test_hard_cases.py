"""Hard cases in C: the same equilibrium as in Python where growing the load leads to it, else an honest end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Outcome, Scene, solve
from tests.codegen.libraries import Exported, Recipe
from tests.families import mostly_slow
from tests.scenes import push, rod, scene

ExportRecipe = Callable[..., Exported]

ROUND = {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.8}

MOMENT = {"force": [0, 0, 0], "moment": [0, 4 * np.pi, 0]}
"""Rolls up a rod of unit length and stiffness into two circles."""


def straight(strain: str, *loads: dict[str, Any], **changes: Any) -> Scene:
    """A rod of length 1 and unit bending stiffness."""
    stiffness = {"bending_y": 1.0} if strain == "planar" else ROUND
    return scene(*loads, rods=[rod(strain, length=1.0, stiffness=stiffness)], **changes)


def shortened() -> Scene:
    support = {"rod": "rod", "kind": "clamped", "position": [0, 0, 0.9], "quaternion": [1, 0, 0, 0]}
    return straight("planar", push(force=[0, 0, 0]), supports=[support])


def deep_arch() -> Scene:
    """Clamped-hinged arch of 215 degrees with R = 1, EI = 1, pushed at its crown: it snaps at 8.97309 EI/R²."""
    angle = np.deg2rad(215.0)
    half = angle / 2
    base = {"position": [-np.sin(half), 0.0, np.cos(half)], "tangent": [np.cos(half), 0.0, np.sin(half)]}
    arch = rod("planar", length=angle, stiffness={"bending_y": 1.0}, intrinsic={"curvature": [0, 1.0, 0]}, base=base)
    crown = {"name": "crown", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0.0, 0.0, -1.0]}
    hinge = {"rod": "rod", "kind": "pinned", "position": [np.sin(half), 0.0, np.cos(half)]}
    return scene(crown, rods=[arch], supports=[hinge])


def slack_cable() -> Scene:
    """Its tension, 4000 EI/L², bounds the steps so that the first load path stalls."""
    strains = {"bending_y": 2.0, "extension": 1e6}
    cable = rod(list(strains), length=10.4, stiffness=strains, base={"position": [0, 0, 0], "tangent": [1, 0, 0]})
    clamp = {"rod": "rod", "kind": "clamped", "position": [10, 0, 0], "tangent": [1, 0, 0]}
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}
    return scene(weight, rods=[cable], supports=[clamp])


SIDE = {"frame": "body", "force": [40.0, 0, 0]}

CASES = {
    "elastica": (Recipe(straight("planar", push(force=[100.0, 0, 0])), 8, 16), Outcome.CONVERGED),
    "follower": (Recipe(straight("planar", push(**SIDE)), 8, 16), Outcome.CONVERGED),
    "rollup": (Recipe(straight("kirchhoff", push(**MOMENT)), 1, 12), Outcome.CONVERGED),
    "helical": (Recipe(straight("kirchhoff", push(force=[0, 0.5, 0], moment=[0, 9.0, 0])), 3, 8), Outcome.CONVERGED),
    "shortened": (Recipe(shortened(), 5, 10), Outcome.LOAD_STALLED),
    "unresolved": (Recipe(straight("planar", push(**MOMENT)), 2, 5), Outcome.UNRESOLVED),
}
"""Scenes with few modes, and how growing the load ends."""


@pytest.mark.parametrize("name", mostly_slow(CASES, quick=["unresolved"]))
def test_hard_case_vs_python(export_recipe: ExportRecipe, name: str) -> None:
    recipe, outcome = CASES[name]
    made = export_recipe(f"hard_{name}", recipe, estimates=False)
    inputs = made.model.pack()
    ours, theirs = made.compiled.solve(inputs), made.solve(inputs)
    assert ours.outcome is theirs.outcome is outcome, (ours, theirs.message)
    if ours.outcome is Outcome.LOAD_STALLED:
        assert 0.0 < ours.load_factor < 1.0
        assert_allclose(ours.load_factor, theirs.load_factor, rtol=0, atol=1e-3)
    else:
        assert_allclose(made.tips(ours.x, inputs), made.tips(theirs.x, inputs), rtol=0, atol=1e-9 * made.length)


@pytest.mark.parametrize(("force", "outcome"), [(8.5, Outcome.CONVERGED), (9.5, Outcome.LOAD_STALLED)])
def test_deep_arch_about_its_limit_load_vs_python(export_recipe: ExportRecipe, force: float, outcome: Outcome) -> None:
    """Followed from the arch at rest; beyond 8.97 no equilibrium is near, and where the path ends is the limit."""
    made = export_recipe("hard_arch", Recipe(deep_arch(), 6, 10), estimates=False)
    none, wanted = np.zeros(3), np.array([0.0, 0.0, -force])
    rest = made.solve(none)
    ours = made.compiled.follow(none, wanted, rest.x)
    theirs = solve(made.model, {"crown.force": wanted}, start=rest)
    assert ours.outcome is theirs.outcome is outcome
    assert_allclose(made.tips(ours.x, wanted), made.tips(theirs.x, wanted), rtol=0, atol=1e-8)
    assert_allclose(ours.load_factor, theirs.load_factor, rtol=0, atol=1e-3)
    if outcome is Outcome.LOAD_STALLED:
        assert_allclose(force * ours.load_factor, 8.97309, rtol=5e-3, atol=0)


def test_slack_cable_vs_python(export_recipe: ExportRecipe) -> None:
    made = export_recipe("hard_cable", Recipe(slack_cable(), 6, 16), estimates=False)
    inputs = made.model.pack()
    theirs = made.solve(inputs)
    assert theirs.converged
    for ours in (made.compiled.solve(inputs), *made.compiled.solve_batch([inputs, 2 * inputs])[:1]):
        assert ours.converged
        assert ours.load_factor == 1.0
        assert_allclose(ours.x, theirs.x, rtol=1e-8, atol=1e-8)


def taut_string() -> Scene:
    """A string stretched by two millimetres: its tension is 2e5 EI/L², the compliance of its extension 1e-8."""
    strains = {"bending_y": 8e-5, "extension": 1.4e4}
    base = {"position": [0, 0, 0], "tangent": [1, 0, 0]}
    string = rod(list(strains), length=0.65, stiffness=strains, linear_density=0.3, base=base)
    clamp = {"rod": "rod", "kind": "clamped", "position": [0.652, 0, 0], "tangent": [1, 0, 0]}
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}
    return scene(weight, rods=[string], supports=[clamp])


def test_a_taut_string_has_no_singular_jacobian(export_recipe: ExportRecipe) -> None:
    """Large entries of the columns of its shape leave the pivots of its extension small."""
    made = export_recipe("hard_string", Recipe(taut_string(), 10, 24), estimates=False)
    inputs = made.model.pack()
    theirs = made.solve(inputs)
    shape = made.model.discrete.unknowns.differential
    assert theirs.converged
    for ours in (made.compiled.solve(inputs), *made.compiled.solve_batch([inputs, 2 * inputs])[:1]):
        assert ours.converged, ours.message
        assert_allclose(ours.x[shape], theirs.x[shape], rtol=1e-6, atol=1e-8)


def test_unresolved_from_every_start(export_recipe: ExportRecipe) -> None:
    """Cold, warm and following other inputs: with too few nodes none is called converged."""
    made = export_recipe("hard_unresolved", CASES["unresolved"][0], estimates=False)
    inputs = made.model.pack()
    cold = made.compiled.solve(inputs)
    assert made.compiled.solve(inputs, cold.x).outcome is Outcome.UNRESOLVED
    near = made.compiled.solve(inputs / 4)
    assert near.converged
    assert made.compiled.follow(inputs / 4, inputs, near.x).outcome is Outcome.UNRESOLVED
    assert [one.outcome for one in made.compiled.solve_batch([inputs, inputs / 4])] == [
        Outcome.UNRESOLVED,
        Outcome.CONVERGED,
    ]


def test_round_rod_that_may_turn_without_energy_vs_python(export_recipe: ExportRecipe) -> None:
    """Buckled round column: its Jacobian is singular to rounding. A start nearby stays near, turned or not."""
    column = straight("kirchhoff", push(force=[0, 0, -5.0]))
    made = export_recipe("hard_neutral", Recipe(column, 3, 6), estimates=False)
    inputs = made.model.pack()
    bent = made.solve(inputs, made.compiled.solve(inputs).x)
    assert bent.stable is False
    start = _buckled(made)
    ours, theirs = made.compiled.solve(inputs, start), made.solve(inputs, start)
    assert ours.outcome is theirs.outcome is Outcome.CONVERGED
    assert theirs.stable is True
    assert "neutral" in theirs.message
    ours_tip, theirs_tip = made.tips(ours.x, inputs)[0], made.tips(theirs.x, inputs)[0]
    assert_allclose(ours_tip[2], theirs_tip[2], rtol=0, atol=1e-9)
    assert_allclose(np.hypot(*ours_tip[:2]), np.hypot(*theirs_tip[:2]), rtol=0, atol=1e-9)


def _buckled(made: Exported) -> np.ndarray:
    """Unknowns a little off the buckled column."""
    return solve(made.model, stable=True).x + 1e-3
