"""What a page draws is what the library computes, and no ordinary folder pays for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, Solution, build, solve
from cosserat_casadi.codegen.export import folder_files
from cosserat_casadi.page.drawn_model import SECTIONS, DrawnModel, drawn_layout
from cosserat_casadi.plots.scene_plot import scene_arrows
from cosserat_casadi.plots.scenery import actuator_routing
from tests.codegen.libraries import RECIPES
from tests.families import mostly_slow
from tests.page.pages_made import finger, portal


def parts(solution: Solution) -> list[tuple[dict[str, Any], np.ndarray]]:
    """Entries of the layout with their numbers."""
    model = DrawnModel(solution.model.discrete)
    numbers = model.drawn(solution.x, solution.inputs).full()[:, 0]
    layout = drawn_layout(model)
    assert sum(entry["rows"] * entry["columns"] for entry in layout) == len(numbers)
    found = []
    for entry in layout:
        end = entry["first"] + entry["rows"] * entry["columns"]
        found.append((entry, numbers[entry["first"] : end].reshape(entry["columns"], entry["rows"])))
    return found


@pytest.mark.parametrize("scene", mostly_slow([finger, portal], quick=[portal]))
def test_rods_and_bodies_are_drawn_where_they_are(scene: Callable[[], Scene]) -> None:
    solution = solve(build(scene()))
    assert solution.converged
    drawn = {(entry["kind"], entry["name"]): numbers for entry, numbers in parts(solution)}
    for name in solution.model.discrete.rods:
        pose = solution.pose(SECTIONS, name)
        assert_allclose(drawn["rod", name], np.hstack([pose.position, pose.quaternion]), rtol=0, atol=1e-14)
    for body in solution.model.scene.bodies:
        pose = solution.body(body.name)
        assert_allclose(drawn["body", body.name][0], np.hstack([pose.position, pose.quaternion]), rtol=0, atol=1e-14)


def test_tendons_are_drawn_along_their_spans() -> None:
    solution = solve(build(finger()))
    drawn = {entry["name"]: numbers for entry, numbers in parts(solution) if entry["kind"] == "actuator"}
    for actuator in solution.model.scene.actuators:
        # The pictures of matplotlib sample more densely: every so many of their points is one of ours.
        routing = actuator_routing(solution, actuator)
        sampled = np.interp(SECTIONS, np.linspace(0, 1, len(routing)), np.arange(len(routing)))
        same = np.isclose(sampled, np.round(sampled), rtol=0, atol=1e-9)
        assert same.sum() >= 9
        expected = routing[np.round(sampled[same]).astype(int)]
        assert_allclose(drawn[actuator.name][same], expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("scene", [finger, portal])
def test_arrows_are_those_of_the_pictures(scene: Callable[[], Scene]) -> None:
    solution = solve(build(scene()))
    expected = [(arrow.sort, [*arrow.start, *arrow.vector]) for arrow in scene_arrows(solution)]
    drawn = [(entry, numbers) for entry, numbers in parts(solution) if entry["kind"] == "arrows"]
    found = [(entry["sort"], row) for entry, numbers in drawn for row in numbers if np.any(row[3:])]
    assert [sort for sort, _ in found] == [sort for sort, _ in expected]
    assert_allclose([row for _, row in found], [row for _, row in expected], rtol=0, atol=1e-14)


def test_an_ordinary_folder_has_no_picture() -> None:
    model = RECIPES["tiny"].model()
    with_picture = folder_files(DrawnModel(model.discrete), "robot")
    without = folder_files(model, "robot")
    assert "robot_drawn(" in with_picture["robot.h"]
    assert not any("drawn" in text for text in without.values())
