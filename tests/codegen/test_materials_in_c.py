"""Materials that are not linear, in C: equilibria, limits and errors are those of Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Outcome
from tests.codegen.libraries import Exported, Recipe
from tests.families import mostly_slow
from tests.model.test_material_laws import CIRCLE, LAWS, TABLE, loaded, rod

ExportRecipe = Callable[..., Exported]


def pushed(material: dict[str, Any], strain: str) -> Any:
    scene = loaded(rod(material, CIRCLE, strain), force=[0.01, 0.01, 0.0])
    return scene.model_copy(update={"inputs": ("push.force",)})


@pytest.mark.parametrize("name", mostly_slow(LAWS, quick=["superelastic"]))
def test_law_vs_python(export_recipe: ExportRecipe, name: str) -> None:
    # Fibres along one axis of the section are half as much text.
    strain = "planar" if name == "neo_hookean" else "kirchhoff"
    made = export_recipe(f"law_{name.replace(' ', '_')}", Recipe(pushed(LAWS[name], strain), 3, 10), estimates=False)
    for inputs in (made.model.pack(), np.array([0.02, -0.01, 0.01])):
        in_python = made.solve(inputs)
        in_c = made.compiled.solve(inputs)
        assert in_python.converged
        assert in_c.converged
        assert_allclose(in_c.x, in_python.x, rtol=0, atol=1e-9)


@pytest.mark.slow
def test_strain_beyond_a_table_vs_python(export_recipe: ExportRecipe) -> None:
    """The status is that of Python, cold, warm and in a batch."""
    material = {"law": "table", "table": {"bending_y": TABLE}}
    made = export_recipe("beyond_table", Recipe(pushed(material, "planar"), 3, 10), estimates=False)
    near, far = np.array([0.01, 0.0, 0.0]), np.array([0.3, 0.0, 0.0])
    assert made.solve(far).outcome is Outcome.BEYOND_MATERIAL
    assert made.compiled.solve(far).outcome is Outcome.BEYOND_MATERIAL
    inside = made.compiled.solve(near)
    assert inside.converged
    assert made.compiled.solve(far, inside.x).outcome is Outcome.BEYOND_MATERIAL
    batch = made.compiled.solve_batch([far, near])
    assert [one.outcome for one in batch] == [Outcome.BEYOND_MATERIAL, Outcome.CONVERGED]
