"""Rods that touch rods where an input or a parameter sets their lengths, radii and places: as scenes written so."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Solution, build, scene_from_dict, solve
from cosserat_casadi.equilibrium.rubbing import rubbing_stretches
from cosserat_casadi.errors import SceneError

LENGTH = 0.2
RADIUS = 2e-3
WIDTH = 1e-3


def rod(name: str, **changes: Any) -> dict[str, Any]:
    """A rod of rubber along x."""
    return {
        "name": name,
        "length": LENGTH,
        "strain": "kirchhoff",
        "base": {"tangent": [1, 0, 0]},
        "material": {"youngs_modulus": 2e6, "poisson_ratio": 0.45, "density": 1100.0},
        "section": {"shape": "circle", "radius": RADIUS},
        **changes,
    }


def with_itself(**more: Any) -> Model:
    """A straight rod that would touch itself."""
    contact = {"rods": ["rod"], "width": WIDTH, "stiffness": 1e5}
    tables = {
        "schema": 1,
        "rods": [rod("rod")],
        "rod_contacts": [contact],
        "accuracy": {"modes": 2, "nodes": 4},
    }
    return build(scene_from_dict(tables | more))


@pytest.mark.parametrize(("name", "ratio"), [("rod.section.radius", 3.0), ("rod.length", 0.2)])
def test_a_straight_rod_does_not_touch_itself_with_other_sizes(name: str, ratio: float) -> None:
    """Sections that are 2 (2 ρ + w) apart in the file would be nearer than they are thick."""
    model = with_itself(parameters=[name])
    moved = {name: ratio * model.parameters.pack()[0]}
    assert float(model.contact_depth(model.unloaded(), model.pack(), model.parameters.pack(moved))) == 0.0
    assert not solve(model, parameters=moved).contacts


def test_a_straight_rod_does_not_touch_itself_with_a_length_as_input() -> None:
    model = with_itself(inputs=["rod.length"])
    shorter = model.pack({"rod.length": 0.2 * LENGTH})
    assert float(model.contact_depth(model.unloaded(), shorter)) == 0.0


def crossing(at: float, *, parameters: bool = False, **contact: Any) -> Model:
    """A rod that a force at a section presses on another one below it, across."""
    below = rod("other", base={"position": [0.054, -0.1, -0.005], "tangent": [0, 1, 0]})
    push = {"name": "push", "kind": "point_wrench", "rod": "rod", "at": at, "force": [0, 0, -0.01]}
    tables = {
        "schema": 1,
        "rods": [rod("rod"), below],
        "loads": [push],
        "inputs": ["push.force"],
        "rod_contacts": [{"rods": ["rod", "other"], "width": WIDTH, "stiffness": 1e4, **contact}],
        "accuracy": {"modes": 3, "nodes": 6},
        "parameters": ["push.at", "other.base.position"] if parameters else [],
    }
    return build(scene_from_dict(tables))


def touching_place(found: Solution) -> list[float]:
    """Where the rods touch, abscissae."""
    assert found.converged, found.message
    (contact,) = found.contacts
    assert contact.on_rods is not None and contact.gap is not None
    return [*contact.on_rods, contact.start, contact.end]


def test_places_of_contact_follow_element_ends_that_a_parameter_moves() -> None:
    moved = solve(crossing(0.3, parameters=True), parameters={"push.at": 0.38}, estimate_error=False)
    written = solve(crossing(0.38), estimate_error=False)
    assert_allclose(moved.tip("rod").position, written.tip("rod").position, rtol=0, atol=1e-5)
    # Sections stand elsewhere in other elements.
    assert_allclose(touching_place(moved), touching_place(written), rtol=0, atol=8e-3)
    assert_allclose(moved.contacts[0].gap, written.contacts[0].gap, rtol=0, atol=1e-2 * WIDTH)
    assert_allclose(moved.contacts[0].force, written.contacts[0].force, rtol=0, atol=1e-4)


def test_rods_rub_where_their_sections_are_with_element_ends_that_a_parameter_moves() -> None:
    """A section between the ends 0.2 and 0.3 of the file, of which the second is moved to 0.38."""
    model = crossing(0.3, parameters=True, friction=0.3).at({"push.at": 0.38})
    (pair,) = model.discrete.pairs
    slip = np.full(pair.sections[0], -1.0)
    number = int(0.27 * len(slip))
    slip[number] = 0.5
    (stretch,) = rubbing_stretches(model, slip)
    place = 0.2 + 1.8 * ((number + 0.5) / len(slip) - 0.2)
    assert_allclose([stretch.start, stretch.end], place + 0.9 / len(slip) * np.array([-1.0, 1.0]), rtol=0, atol=1e-12)


def test_parameters_that_put_rods_into_each_other_are_refused() -> None:
    """As in a scene written so: to which side they belong is not known."""
    model = crossing(0.3, parameters=True)
    inside = {"other.base.position": [0.054, -0.1, -0.002]}
    with pytest.raises(SceneError, match="inside each other where nothing acts"):
        solve(model, parameters=inside)


@pytest.mark.parametrize("width", [None, 1e-3])
def test_parameters_that_put_a_base_into_an_obstacle_are_refused(width: float | None) -> None:
    floor = {"name": "floor", "kind": "plane", "point": [0, 0, -0.01], "normal": [0, 0, 1]}
    obstacle = floor if width is None else floor | {"width": width}
    tables = {"schema": 1, "rods": [rod("rod")], "obstacles": [obstacle], "parameters": ["rod.base.position"]}
    model = build(scene_from_dict(tables))
    with pytest.raises(SceneError, match=r"starts 0\.007 m inside it"):
        model.at({"rod.base.position": [0, 0, -0.015]})


def test_rods_that_are_drawn_apart_have_a_finer_sum_on_the_richer_model() -> None:
    """At 3.6 times the length 9.8e-4 of 1.7e-3 was told; from four times on the error is not known."""
    model = with_itself(parameters=["rod.length"])
    (pair,), (finer,) = model.discrete.pairs, model.discrete.richer.discrete.pairs
    assert finer.sections[0] > 2 * pair.sections[0]
    assert model.sections_apart is not None
    for ratio, lie_apart in ((1.0, False), (3.6, False), (4.5, True)):
        p = model.parameters.pack({"rod.length": ratio * LENGTH})
        assert bool(model.sections_apart(model.unloaded(), model.pack(), p)) is lie_apart
    assert model.at({"rod.length": 4.5 * LENGTH}).sections_apart is not None
    alone = with_itself()
    assert alone.discrete.richer.discrete.pairs[0].sections[0] < 2 * pair.sections[0]
    assert alone.sections_apart is None
