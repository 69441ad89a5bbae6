"""Catalogue (d), (e): columns and the deep arch beyond their critical loads.

Critical loads, branches and their elliptic integrals are in tests/paths/test_path.py.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import build, discretise, follow, read_scene, solve
from tests.catalogue import cases
from tests.catalogue.checks import fine_model
from tests.conftest import ROOT
from tests.shooting_near import integrate


@pytest.mark.parametrize(("weight", "stable"), [(7.837, True), (7.838, False)])
def test_standing_column_on_both_sides_of_its_critical_weight(weight: float, stable: bool) -> None:
    heavy: dict[str, Any] = {"name": "weight", "kind": "gravity", "acceleration": [0.0, 0.0, -weight]}
    found = solve(fine_model(cases.table({"linear_density": 1.0}, heavy), 10, 24))
    assert found.converged, found.message
    assert found.stable is stable
    assert stable or "unstable" in found.message


@pytest.mark.slow
def test_arch_beyond_its_limit_load_is_in_equilibrium() -> None:
    """A point between the limits and the end, integrated from the clamp: the hinge is met, no moment is left."""
    file = ROOT / "examples" / "deep_arch.toml"
    scene = read_scene(file)
    path = follow(build(scene, discretise(scene, 18, 44, "magnus8")), "crown.force", [0, 0, -1000.0])
    assert path.converged
    first, second = (event.position for event in path.events)
    for index in ((first + second) // 2, -1):
        solution = path.solution(index)
        base = solution.base_wrench()
        pushed = read_scene(file, (f"crown.force=[0, 0, {float(-1000.0 * path.factor[index])!r}]",))
        reached = integrate(pushed, base.force, base.moment)
        assert_allclose(reached.position, scene.supports[0].position, rtol=0, atol=1e-8 * scene.rods[0].length)
        assert_allclose(reached.moment_left, 0.0, rtol=0, atol=1e-8 * np.abs(base.moment).max())
