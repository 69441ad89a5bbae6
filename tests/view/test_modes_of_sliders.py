"""Wherever the sliders of a shipped robot go, the modes that it is viewed with are right."""

from __future__ import annotations

import numpy as np
import pytest

from cosserat_casadi import build, choose, discretise, read_scene, solve
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.page.slider_ranges import sliders
from tests.conftest import ROOT


@pytest.mark.slow
def test_a_template_is_right_all_over_its_sliders() -> None:
    """Against finer modes; those of its own inputs, which lie in a plane, are off by a hundred times the tolerance."""
    robot = read_scene(ROOT / "cosserat_casadi" / "cli" / "templates" / "tendon-robot.toml")
    model = choose(robot).model
    fine = build(robot, discretise(robot, 10, 20, "magnus8"))
    own = build(robot, solve(robot).model.discretisation)
    ends = sliders(model)
    least = np.array([slider.least for slider in ends])
    most = np.array([slider.most for slider in ends])
    random = np.random.default_rng(3)
    worst = 0.0
    for share in random.random((6, len(ends))):
        inputs = least + share * (most - least)
        exact = solve(fine, inputs, estimate_error=False)
        assert pose_distance(solve(model, inputs, estimate_error=False), exact) <= 1e-4
        worst = max(worst, pose_distance(solve(own, inputs, estimate_error=False), exact))
    assert worst > 1e-2
