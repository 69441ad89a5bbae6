"""Materials that are not linear, in C: equilibria, limits and errors are those of Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Outcome, solve
from tests.accuracy import test_fibres as fibres
from tests.codegen.libraries import Exported, Recipe
from tests.equilibrium.test_answer_error import stiffened
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


@pytest.mark.slow
def test_error_of_a_strained_law_vs_python(export_recipe: ExportRecipe) -> None:
    """Known, though the rod is several times as stiff as unloaded."""
    scene = stiffened("planar", 6.0).model_copy(update={"inputs": ("push.force",)})
    made = export_recipe("strained_law", Recipe(scene, 3, 10))
    for share in (0.3, 1.0):
        inputs = share * made.model.pack()
        in_c, in_python = made.compiled.solve(inputs), solve(made.model, inputs)
        assert in_c.error_estimate is not None and in_python.error_estimate is not None
        assert 1e-6 < in_c.error_estimate < 0.1
        assert_allclose(in_c.error_estimate, in_python.error_estimate, rtol=0.05, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize("law", fibres.LAWS)
def test_error_of_the_sum_over_fibres_is_told(export_recipe: ExportRecipe, law: str) -> None:
    scene = fibres.scene(law, "circle", 0.002, tolerance=1e-6)
    made = export_recipe(f"fibres_{law}", Recipe(scene, 1, 20, "magnus8"))
    for moment in (0.002, 0.008, fibres.MOMENT):
        inputs = np.array([moment, 0.0, 0.0])
        in_c, in_python = made.compiled.solve(inputs), solve(made.model, inputs)
        assert in_c.error_estimate is not None and in_python.error_estimate is not None
        assert fibres.error_of(in_python.tip().position, law, "circle", moment) <= in_c.error_estimate
        assert_allclose(in_c.error_estimate, in_python.error_estimate, rtol=0.05, atol=1e-11)
