"""What ``solve`` prints of joints, and of rods that hang on them."""

from __future__ import annotations

from typing import Any

import pytest
from rich.console import Console

from cosserat_casadi import build, scene_from_dict
from cosserat_casadi.cli.reports.model import print_check
from cosserat_casadi.cli.reports.solution import print_solution
from cosserat_casadi.model.operation_cost import price, prices_of_effects
from tests.equilibria import solve
from tests.model.test_base_joints import hinge, link, scene


@pytest.mark.parametrize("stops", [{}, {"upper_stop": 0.5}])
def test_joints_show_their_stops_and_no_rounding(stops: dict[str, Any]) -> None:
    """A rod that stands on a spring under its weight: what is not along the vertical is rounding."""
    tables = scene([link("a")], [hinge(name="foot", stiffness=10.0, **stops)])
    console = Console(record=True, width=80)
    print_solution(console, solve(build(scene_from_dict(tables))), [])
    text = console.export_text()
    assert "base force, N" in text and "clamp" not in text
    assert ("of stops" in text) == bool(stops)
    assert "angle 0 rad" in text and "moment 0 N m" in text
    assert "e-1" not in text.split("residual")[0]


@pytest.mark.parametrize(
    ("joint", "noted"),
    [
        ({"kind": "fixed"}, True),
        ({"kind": "fixed", "tangent": [1, 0, 0]}, False),
        ({"kind": "revolute", "axis": [0, 1, 0]}, False),
        ({"kind": "revolute", "axis": [0, 0, 1]}, True),
        ({"kind": "spherical"}, False),
    ],
)
def test_check_tells_of_sections_turned_to_the_axes_of_the_world(joint: dict[str, Any], noted: bool) -> None:
    """A rod along x: only the first hinge lets its tip turn to the axes of the world, about which it stands askew."""
    rod = link("a", strain="kirchhoff", base={"tangent": [1, 0, 0]})
    held = {"rod": "a", "position": [0.45, 0, 0], **joint}
    console = Console(record=True, width=200)
    model = build(scene_from_dict(scene([rod], [held])))
    print_check(console, model, [], price(model), prices_of_effects(model.scene))
    assert ("Note: joints[0] turns a at X = 1 to the axes of the world" in console.export_text()) == noted


@pytest.mark.parametrize(("depth", "told"), [(0.3, False), (0.015, True)])
def test_the_error_of_widths_is_told_where_something_touches(depth: float, told: bool) -> None:
    rod = link("a", base={"tangent": [1, 0, 0]})
    table = {"name": "table", "kind": "plane", "point": [0, 0, -depth], "normal": [0, 0, 1], "width": 0.01}
    tables = {**scene([rod], []), "obstacles": [table]}
    console = Console(record=True, width=200)
    print_solution(console, solve(build(scene_from_dict(tables))), [])
    assert ("contact without widths" in console.export_text()) == told
