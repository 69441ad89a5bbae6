"""What ``solve`` prints of joints, and of rods that hang on them."""

from __future__ import annotations

from typing import Any

import pytest
from rich.console import Console

from cosserat_casadi import build, scene_from_dict
from cosserat_casadi.cli.reports.solution import print_solution
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
