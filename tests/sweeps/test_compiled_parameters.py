"""Sweeps over numbers that one library takes as parameters: beside closed forms and baked models."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import SceneError, solve, sweep
from cosserat_casadi.model.build import build
from cosserat_casadi.sweeps.arguments import extreme_rows
from cosserat_casadi.sweeps.scratch import MEMORY
from cosserat_casadi.sweeps.table import table_of
from cosserat_casadi.sweeps.variants import variants_of
from tests.scenes import push, rod, scene

pytestmark = pytest.mark.usefixtures("few_checked")

LENGTH, MOMENT = 0.8, 0.7
STEEL = {"youngs_modulus": 2e9, "poisson_ratio": 0.3}
WIRE = {
    "name": "rod",
    "length": LENGTH,
    "strain": "planar",
    "material": STEEL,
    "section": {"shape": "circle", "radius": 5e-3},
    "intrinsic": {"curvature": [0.0, 0.3, 0.0]},
}
TENDON = {"name": "east", "kind": "tendon", "rod": "rod", "tension": 5.0, "offset": [0.02, 0.0]}
BENT = scene(
    push(force=[0.0, 0.0, 0.0], moment=[0.0, MOMENT, 0.0]),
    rods=[WIRE],
    actuators=[TENDON],
    accuracy={"modes": 3, "nodes": 10, "tolerance": 1e-4},
)


def tolerances(count: int) -> dict[str, np.ndarray]:
    """A modulus, a radius, a curvature and an offset, all drawn together."""
    rng = np.random.default_rng(6)
    return {
        "rod.material.youngs_modulus": rng.uniform(1.8e9, 2.2e9, count),
        "rod.section.radius": rng.uniform(4.8e-3, 5.2e-3, count),
        "rod.intrinsic.curvature.y": rng.uniform(0.1, 0.5, count),
        "east.offset.x": rng.uniform(0.019, 0.021, count),
    }


def arcs(table: dict[str, np.ndarray]) -> np.ndarray:
    """Tips of rods whose curvature is constant: a tendon beside the axis bends as the moment of its tension does."""
    modulus, radius, curvature, offset = table.values()
    stiffness = modulus * np.pi * radius**4 / 4
    # A pull at positive x bends towards positive x: a moment about y.
    bending = curvature + (MOMENT + TENDON["tension"] * offset) / stiffness
    angle = bending * LENGTH
    return np.column_stack([(1 - np.cos(angle)) / bending, np.sin(angle) / bending])


@pytest.mark.slow
def test_all_rows_share_one_library_vs_arcs() -> None:
    table = tolerances(1100)
    found = sweep(BENT, table)
    assert found.record["arguments"] == list(table)
    assert found.converged.all()
    assert_allclose(found.positions()[:, [0, 2]], arcs(table), rtol=0, atol=1e-9)
    # The rows that are checked were solved on models that bake their numbers in.
    assert max(entry["difference"] for entry in found.record["checked"]) < 1e-9
    assert found.holds


@pytest.mark.slow
def test_few_rows_are_solved_on_models_of_their_own() -> None:
    """The same names serve there: those of ``--set``, and those of parameters."""
    table = tolerances(3)
    found = sweep(BENT, table)
    assert found.record["arguments"] == []
    assert_allclose(found.positions()[:, [0, 2]], arcs(table), rtol=0, atol=1e-9)


def test_columns_that_are_no_parameters_make_scenes() -> None:
    """Where a load acts decides the elements: rows of one place share a library, if they are many."""
    loaded = scene(
        {"name": "weight", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0.3, 0.0, 0.0]},
        rods=[rod("planar", stiffness={"bending_y": 1.4})],
    )
    few = variants_of(loaded, table_of({"rod.stiffness.bending_y": np.linspace(1, 2, 1200), "weight.at": 0.5}))
    assert few.arguments == ("rod.stiffness.bending_y",)
    assert len(few.entries) == 1
    rows = variants_of(
        loaded, table_of({"rod.stiffness.bending_y": np.linspace(1, 2, 30), "weight.at": np.tile([0.4, 0.6], 15)})
    )
    assert rows.arguments == ()
    assert len(rows.entries) == 30


def test_scene_of_a_row_has_its_numbers() -> None:
    table = tolerances(1100)
    variants = variants_of(BENT, table_of({**table, "push.moment.y": 0.2}))
    own = variants.scene_of_row(7)
    assert own.parameters == ()
    assert own.rods[0].material.youngs_modulus == table["rod.material.youngs_modulus"][7]
    assert own.actuators[0].offset[0] == table["east.offset.x"][7]
    model = build(own)
    bent = solve(model, variants.inputs_of_row(7))
    assert bent.inputs[model.inputs.slices["push.moment"]][1] == 0.2


def test_rows_that_the_scene_refuses_are_named() -> None:
    table = tolerances(1100)
    table["rod.section.radius"][700] = -1e-3
    with pytest.raises(SceneError, match=r"row 701, rod.section.radius: must be > 0"):
        variants_of(BENT, table_of(table))
    tube = {**WIRE, "section": {"shape": "annulus", "outer_radius": 5e-3, "inner_radius": 3e-3}}
    rng = np.random.default_rng(2)
    radii = {
        "rod.section.outer_radius": rng.uniform(4e-3, 6e-3, 1100),
        "rod.section.inner_radius": rng.uniform(2e-3, 3.5e-3, 1100),
    }
    hollow = scene(push(), rods=[tube])
    assert variants_of(hollow, table_of(radii)).arguments == tuple(radii)
    # Neither radius is beyond those of other rows: the two together are.
    radii["rod.section.outer_radius"][300] = 3.3e-3
    radii["rod.section.outer_radius"][301] = 3.2e-3
    radii["rod.section.inner_radius"][300] = 3.4e-3
    with pytest.raises(SceneError, match=r"row 30[12], rod.section.inner_radius: must be < outer_radius"):
        variants_of(hollow, table_of(radii))


def test_extreme_rows_hold_every_corner_of_two_columns() -> None:
    values = np.random.default_rng(1).uniform(size=(500, 4))
    rows = extreme_rows(values, MEMORY)
    for one in range(4):
        for other in range(one):
            assert int(np.argmax(values[:, one] - values[:, other])) in rows
    assert len(rows) < 80
