"""Rods whose tendons have no length left along them, in C: the status is that of Python, from every start."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from cosserat_casadi import Outcome, scene_from_dict, solve
from tests.codegen.contact_libraries import exported_contact
from tests.codegen.libraries import Exported, Recipe
from tests.equilibrium.test_strain_limits import described, pulled
from tests.families import mostly_slow

ExportRecipe = Callable[..., Exported]


@pytest.mark.parametrize("strain", mostly_slow(["planar", "kirchhoff"], quick=["planar"]))
def test_vanished_path_vs_python(export_recipe: ExportRecipe, strain: str) -> None:
    """Cold, warm, followed, and in a batch."""
    made = export_recipe(f"vanished_{strain}", Recipe(pulled(strain, 50.0), 2, 8), estimates=False)
    near = made.compiled.solve(np.array([50.0]))
    assert near.converged
    far = np.array([150.0])
    cold = made.compiled.solve(far)
    assert cold.outcome is made.solve(far).outcome is Outcome.PATH_VANISHED
    assert made.compiled.solve(far, near.x).outcome is Outcome.PATH_VANISHED
    assert made.compiled.follow(np.array([50.0]), far, near.x).outcome is Outcome.PATH_VANISHED
    batch = made.compiled.solve_batch([far, np.array([50.0])])
    assert [one.outcome for one in batch] == [Outcome.PATH_VANISHED, Outcome.CONVERGED]


@pytest.mark.slow
def test_rod_turned_past_a_vanished_path_vs_python(export_recipe: ExportRecipe) -> None:
    """An equilibrium of the equations in which the tendon goes backwards is none of the rod."""
    made = export_recipe("vanished_turned", Recipe(pulled("planar", 1e-9, moment=12.0), 1, 12), estimates=False)
    inputs = made.model.pack()
    assert made.compiled.solve(inputs).outcome is made.solve(inputs).outcome is Outcome.PATH_VANISHED


@pytest.mark.slow
def test_rod_in_contact_vs_python(tmp_path: Path) -> None:
    """Where a rod may touch an obstacle, here one far away."""
    far = {"name": "table", "kind": "plane", "point": [0, 0, -5.0], "normal": [0, 0, 1]}
    wanted = scene_from_dict({**described("planar", 1e-9, moment=6.0), "obstacles": [far]})
    library = exported_contact(wanted, tmp_path / "far", np.array([[0.0, 3.0, 0.0, 1e-9]]), 1, 12)
    twice = 2 * library.model.pack()
    found = library.loaded.solve(twice)
    assert found.outcome is solve(library.model, twice).outcome is Outcome.PATH_VANISHED


def test_scene_without_tendons_looks_at_none(library: Callable[[str], Exported]) -> None:
    source = (library("planar").folder / "planar_kernels.c").read_text()
    assert "strain_margins" not in source
