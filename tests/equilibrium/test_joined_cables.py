"""Two cables with a joint between them, in wind, against one cable of their length by collocation in SciPy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cosserat_casadi import build, discretise, scene_from_dict, solve
from cosserat_casadi.equilibrium.load_path import NEARLY_LOADED, nearly_loaded
from tests.equilibrium.test_cables_and_strings import CABLE, scene_of

WITHOUT_MOMENT = 3e-4
"""Distance of the joint, which carries no moment, from the middle of one cable: about κ EI/T, over the length."""


@pytest.mark.parametrize("wind", [(0.0, 8.0, 0.0), (40.0, 0.0, 0.0)])
def test_joined_cables_in_wind_vs_collocation(wind: tuple[float, float, float]) -> None:
    cable = replace(CABLE, wind=wind)
    half = scene_of(replace(cable, length=cable.length / 2)).model_dump(mode="json", exclude_unset=True)
    first = half["rods"][0] | {"name": "first"}
    second: dict[str, Any] = first | {"name": "second"}
    second["base"] = {"position": [cable.distance, 0, 0], "tangent": [-1, 0, 0]}
    between = [{"rod": "first", "at": 1.0}, {"rod": "second", "at": 1.0}]
    joint = {"name": "joint", "kind": "spherical", "between": between}
    scene = scene_from_dict({"schema": 1, "rods": [first, second], "joints": [joint], "loads": half["loads"]})
    model = build(scene, discretise(scene, 8, 20))
    assert nearly_loaded(model) < 0.8 < NEARLY_LOADED
    solution = solve(model)
    assert solution.converged, solution.message
    assert solution.error_estimate is not None
    off = np.linalg.norm(solution.tip("first").position - cable.middle()) / cable.length
    assert off <= WITHOUT_MOMENT + solution.error_estimate
    assert off <= 2e-3
