"""Numbers of rods that touch obstacles exactly, from what an independent solver makes of the same rods."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from cosserat_casadi import Identification, Scene, Solution, build, identify, scene_from_dict, solve
from cosserat_casadi.equilibrium.contact import pressing_contacts
from cosserat_casadi.errors import SceneError
from cosserat_casadi.identification.fit_problem import Task, _Started
from cosserat_casadi.identification.fit_unknowns import unknown_layout
from cosserat_casadi.identification.measured_cases import read_cases
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.robust_loss import Loss
from tests.derivatives import central_differences
from tests.families import mostly_slow
from tests.identification.over_floor import AT, MARKERS, MODULUS, SIGMA, WEIGHTS, markers, table, tables, truth


def measured(modulus: float, **more: Any) -> Scene:
    """The rod with markers whose places were measured, and its modulus and the height of its clamp unknown."""
    positions = {**MARKERS, "inputs": {"weight.force.z": "weight"}}
    unknowns = [
        {"parameter": "rod.material.youngs_modulus", "lower": 5e5, "upper": 8e6},
        {"parameter": "rod.base.position.z", "lower": -0.05, "upper": 0.05},
    ]
    return scene_from_dict({**tables(modulus), "measurements": [positions], "unknowns": unknowns, **more})


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
    misfit, state = started(measured(stiff), markers())
    found: Identification = identify(build(measured(stiff).with_unknowns()), markers())
    assert found.converged, found.message
    # Stiffer rods touch otherwise: the search has followed them through changes of their contacts.
    assert kinds(found.equilibria) == kinds(tuple(truth(weight) for weight in WEIGHTS)) == [[], ["point"], ["line"]]
    assert kinds(misfit.solutions(state)) != kinds(found.equilibria)
    for value, wanted, (lower, upper) in zip(found.shared, (MODULUS, 0.0), found.intervals, strict=True):
        assert lower < wanted < upper, value
    assert found.sigma[0] < 0.01 * MODULUS
    rms = found.rms()
    assert rms is not None and 0.6 < rms < 1.4


@pytest.mark.parametrize("weight", mostly_slow(WEIGHTS, quick=[WEIGHTS[1]]))
def test_derivatives_of_the_misfit_are_those_of_solves_that_find_their_contacts(
    weight: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    misfit, state = started(measured(MODULUS), table([weight], np.zeros((1, len(AT), 3))))
    by_shared = misfit.jacobian(state)

    def seen(numbers: FloatArray) -> FloatArray:
        modulus, height = numbers.tolist()
        scene = tables(modulus, weight)
        scene["rods"][0]["base"]["position"] = [0.0, 0.0, height]
        solution = solve(build(scene_from_dict(scene)), start=truth(weight))
        return solution.pose(np.array(AT)).position.ravel() / SIGMA

    differences = central_differences(seen, [MODULUS, 0.0], [1e-4 * MODULUS, 1e-5])
    for column, wanted in zip(by_shared.T, differences.T, strict=True):
        assert_allclose(column, wanted, rtol=0, atol=2e-6 * np.abs(wanted).max())
    # A contact that presses by little, or a small gap, is told: it may open or close on one side of the answer.
    assert not misfit.marginal(state)
    monkeypatch.setattr(pressing_contacts, "LEAST_TOLERANCE", 1e3)
    assert len(misfit.marginal(state)) == 1


@pytest.mark.slow
def test_the_least_misfit_may_be_where_a_contact_comes_or_goes() -> None:
    """Its place is that of a rod without a floor whose tip comes to the height of the floor."""

    def shape(modulus: float, *, floor: bool) -> Solution:
        scene = tables(modulus, WEIGHTS[1]) | ({} if floor else {"obstacles": []})
        return solve(build(scene_from_dict(scene)), estimate_error=False)

    modulus = brentq(lambda own: shape(own, floor=False).tip().position[2] + 0.09, MODULUS, 4 * MODULUS, xtol=1e-3)
    steps = [1e-3 * modulus, -1e-3 * modulus]
    at_kink = shape(modulus, floor=False).pose(np.array(AT)).position
    moved = [shape(modulus + step, floor=step < 0).pose(np.array(AT)).position - at_kink for step in steps]
    slopes = [way / np.linalg.norm(way) for way in moved]
    # Away from the kink, either way, the markers go farther from where they were measured.
    places = at_kink - 3 * SIGMA * (slopes[0] + slopes[1])
    unknowns = [{"parameter": "rod.material.youngs_modulus", "lower": 5e5, "upper": 2e7}]
    scene = measured(1.05 * modulus, unknowns=unknowns)
    found = identify(build(scene.with_unknowns()), table([WEIGHTS[1]], places[None]))
    assert found.converged and found.iterations < 30, found.message
    # Contacts hold to the tolerance of the scene.
    assert_allclose(found.shared, [modulus], rtol=1e-4, atol=0)
    (warning,) = [own for own in found.warnings if "exactly where contacts come" in own]
    assert "a point of 'rod' on 'floor'" in warning


def poked(at: float, **more: Any) -> dict[str, Any]:
    """The rod with a force on a section, whose place is unknown."""
    poke = {"name": "poke", "kind": "point_wrench", "rod": "rod", "at": at, "force": [0, 0, -0.02]}
    scene = tables(MODULUS, -0.02)
    return {**scene, "loads": [*scene["loads"], poke | more]}


def poked_and_measured(scene: dict[str, Any]) -> Scene:
    """The same with markers that were measured."""
    positions = {**MARKERS, "inputs": {"weight.force.z": "weight"}}
    unknowns = [{"parameter": "poke.at", "lower": 0.3, "upper": 0.95}]
    return scene_from_dict({**scene, "measurements": [positions], "unknowns": unknowns})


@pytest.mark.slow
def test_a_load_moves_past_a_contact() -> None:
    bar = {"name": "bar", "kind": "capsule", "from": [0.5, -0.5, -0.06], "to": [0.5, 0.5, -0.06], "radius": 0.04}
    true = solve(build(scene_from_dict({**poked(0.7), "obstacles": [bar]})))
    (contact,) = true.contacts
    assert 0.42 < contact.start < 0.7
    begun = poked_and_measured({**poked(0.42), "obstacles": [bar]})
    found = identify(build(begun.with_unknowns()), table([-0.02], true.pose(np.array(AT)).position[None]))
    assert found.converged and not found.unstable and not found.warnings
    assert_allclose(found.shared, [0.7], rtol=0, atol=1e-6)


def lying(accuracy: dict[str, int], **more: Any) -> dict[str, Any]:
    """The rod on the floor, with a load on a section that its weight holds there."""
    scene = poked(0.9, **more) | {"accuracy": accuracy}
    scene["loads"][0]["force"] = [0, 0, -0.3]
    return scene


def test_a_load_moves_inside_a_line_of_contact() -> None:
    """The floor carries it wherever it is: nothing else moves."""
    scene = poked_and_measured(lying({"modes": 2, "nodes": 4}))
    misfit, state = started(scene, table([-0.3], np.zeros((1, len(AT), 3))))
    (solution,) = misfit.solutions(state)
    (line,) = solution.contacts
    (section,) = line.inside
    assert line.kind == "line" and line.start < section.at < line.end
    assert_allclose([section.at, section.force], [0.9, 0.02], rtol=1e-9, atol=0)
    assert_allclose(misfit.jacobian(state), 0, rtol=0, atol=1e-8)


@pytest.mark.slow
def test_a_moment_moves_beside_a_line_of_contact() -> None:
    """It lifts the tip: the line ends before it, and moves with it."""
    scene = lying({"modes": 3, "nodes": 6}, force=[0, 0, 0], moment=[0, -0.005, 0])
    true = solve(build(scene_from_dict(scene)))
    (line,) = true.contacts
    assert line.kind == "line" and line.end < 0.9
    misfit, state = started(poked_and_measured(scene), table([-0.3], np.zeros((1, len(AT), 3))))
    (by_place,) = misfit.jacobian(state).T
    sides = []
    for change in (1e-4, -1e-4):
        scene["loads"][1]["at"] = 0.9 + change
        solution = solve(build(scene_from_dict(scene)), start=true)
        sides.append(solution.pose(np.array(AT)).position.ravel() / SIGMA)
    assert np.abs(by_place).max() > 1.0
    assert_allclose(by_place, (sides[0] - sides[1]) / 2e-4, rtol=0, atol=1e-6 * np.abs(by_place).max())


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
    with pytest.raises(SceneError, match="belongs to a vibration"):
        identify(build(vibrating.with_unknowns()), {"markers.csv": {"f": np.ones(3), "weight": np.array(WEIGHTS)}})
