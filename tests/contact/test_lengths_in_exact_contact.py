"""Exact contact of rods whose length an input or a parameter sets: sums of forces, and scenes written so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, build, export, load, modes_of, read_scene, scene_from_dict, solve
from cosserat_casadi.codegen.contact.compiled import CompiledContact
from cosserat_casadi.scene.writing import scene_tables
from tests.conftest import ROOT


def example(name: str, ratio: float = 1.0, **changes: Any) -> Model:
    """An example on few modes with a rod so many times as long, and with other tables."""
    tables = scene_tables(read_scene(ROOT / "examples" / f"{name}.toml", ["accuracy.modes=5", "accuracy.nodes=12"]))
    (rod,) = tables["rods"]
    rod = rod | {"length": ratio * rod["length"]}
    if "material" not in rod:
        rod |= {"linear_density": 0.1}
    return build(scene_from_dict(tables | {"rods": [rod]} | changes))


@pytest.mark.parametrize("ratio", [0.8, 0.9])
@pytest.mark.parametrize("how", ["parameters", "inputs"])
def test_a_table_and_a_clamp_bear_the_weight_of_a_rod(how: str, ratio: float) -> None:
    model = example("rod_on_table", **{how: ["rod.length"]})
    moved = {"rod.length": ratio * 1.5}
    found = solve(model, parameters=moved) if how == "parameters" else solve(model, moved)
    assert found.converged, found.message
    (line,) = found.contacts
    assert line.kind == "line"
    weight = 9.81 * 1100.0 * np.pi * 8e-3**2 * ratio * 1.5
    assert_allclose(found.base_wrench().force + line.force, [0.0, 0.0, weight], rtol=0, atol=1e-7 * weight)


def test_frequencies_of_a_rod_that_slides_on_a_bar_are_those_of_a_scene_written_so() -> None:
    """How a point of contact slides depends on the curvature of the rod along its own length."""
    moved = solve(example("rod_over_bar", inputs=["rod.length"]), {"rod.length": 1.15})
    written = solve(example("rod_over_bar", 1.15))
    assert [contact.kind for contact in moved.contacts] == [contact.kind for contact in written.contacts] == ["point"]
    assert_allclose(moved.contacts[0].start, written.contacts[0].start, rtol=0, atol=1e-7)
    frequencies = [modes_of(found, count=3).angular_frequencies for found in (moved, written)]
    assert_allclose(frequencies[0], frequencies[1], rtol=1e-5, atol=0)


@pytest.mark.slow  # a compiler runs
def test_forces_in_c_are_those_on_the_length_that_an_input_gives(tmp_path: Path) -> None:
    model = example("rod_on_table", inputs=["rod.length"])
    length = 0.9 * 1.5
    library = load(export(model, tmp_path / "rod", load_cases=np.array([[length]])))
    assert isinstance(library, CompiledContact)
    (line,) = library.solve({"rod.length": length}).contacts
    (wanted,) = solve(model, {"rod.length": length}).contacts
    assert_allclose(line.force, wanted.force, rtol=1e-7, atol=1e-9)
