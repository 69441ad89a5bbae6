"""A rod bent so far that the path of a tendon has no length left: told in every strain form, wherever it is met."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import (
    MotionOutcome,
    Outcome,
    PathOutcome,
    Scene,
    build,
    discretise,
    follow,
    scene_from_dict,
    simulate,
    solve,
)

STIFFNESS: dict[str, dict[str, float]] = {
    "planar": {"bending_y": 1.0},
    "kirchhoff": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 1.0},
    "reissner": {
        "bending_x": 1.0,
        "bending_y": 1.0,
        "torsion": 1.0,
        "shear_x": 1e5,
        "shear_y": 1e5,
        "extension": 1e5,
    },
}
ARM = 0.1
"""Distance of the tendon from the axis, m: its path has no length left at a curvature of 1/ARM."""


def described(strain: str, tension: float, moment: float = 0.0, **more: Any) -> dict[str, Any]:
    """A rod of one metre and unit stiffness with a parallel tendon at ARM from its axis, turned at its tip."""
    rod = {"name": "rod", "length": 1.0, "strain": strain, "stiffness": STIFFNESS[strain]}
    cable = {"name": "cable", "kind": "tendon", "rod": "rod", "tension": tension, "offset": [ARM, 0.0], **more}
    turn = {"name": "turn", "kind": "tip_wrench", "rod": "rod", "moment": [0.0, moment, 0.0]}
    loads = [turn] if moment else []
    return {"schema": 1, "accuracy": {"tolerance": 1e-6}, "rods": [rod], "actuators": [cable], "loads": loads}


def pulled(strain: str, tension: float, moment: float = 0.0, **more: Any) -> Scene:
    """The scene of these numbers."""
    return scene_from_dict(described(strain, tension, moment, **more))


def on_grid(scene: Scene, modes: int, nodes: int) -> Scene:
    """The scene with modes and nodes that are fixed."""
    accuracy = scene.accuracy.model_copy(update={"modes": modes, "nodes": nodes})
    return scene.model_copy(update={"accuracy": accuracy})


@pytest.mark.parametrize("strain", STIFFNESS)
def test_path_that_vanishes_is_told(strain: str) -> None:
    """No tension of more than EI/ARM² has an equilibrium: the way ends where the curvature is 1/ARM."""
    solution = solve(pulled(strain, 150.0))
    assert solution.outcome is Outcome.PATH_VANISHED
    assert "'cable'" in solution.message
    assert_allclose(solution.load_factor, 100.0 / 150.0, rtol=2e-3, atol=0)


@pytest.mark.parametrize("moment", [0.037, 0.05, 0.1])
def test_a_stall_at_the_end_of_a_measured_curve_is_told(moment: float) -> None:
    """The curve is level at its last point, 0.036 N m, and the load stalls short of it, however large it is."""
    points = [[0, 0], [2, 0.02], [5, 0.03], [10, 0.034], [20, 0.036]]
    material = {"law": "table", "youngs_modulus": 2e9, "poisson_ratio": 0.4, "table": {"bending_y": points}}
    section = {"shape": "rectangle", "width": 6e-3, "height": 2e-3}
    lath = {"name": "lath", "length": 0.4, "strain": "planar", "material": material, "section": section}
    turn = {"name": "turn", "kind": "tip_wrench", "rod": "lath", "moment": [0, moment, 0]}
    solution = solve(scene_from_dict({"schema": 1, "rods": [lath], "loads": [turn]}))
    assert solution.outcome is Outcome.BEYOND_MATERIAL
    assert "'lath'" in solution.message
    assert_allclose(solution.load_factor, 0.036 / moment, rtol=1e-4, atol=0)


@pytest.mark.parametrize("strain", ["planar", "kirchhoff"])
def test_path_with_length_left_is_no_matter(strain: str) -> None:
    solution = solve(pulled(strain, 99.0))
    assert solution.converged, solution.message
    assert_allclose(solution.actuator("cable")["length"], 1.0 - 99.0 * ARM**2, rtol=0, atol=1e-9)


@pytest.mark.parametrize("strain", ["planar", "kirchhoff"])
def test_rod_turned_past_a_vanished_path_is_no_equilibrium(strain: str) -> None:
    """A moment alone may bend the rod past the curvature at which a limp tendon's path vanishes."""
    scene = pulled(strain, 1e-9, moment=12.0)
    solution = solve(build(scene, discretise(scene, 1, 12)))
    assert solution.outcome is Outcome.PATH_VANISHED, solution.message
    # Of a tendon that goes backwards the length is that of its course all the same.
    assert_allclose(solution.actuator("cable")["length"], 12.0 * ARM - 1.0, rtol=0, atol=1e-6)


@pytest.mark.parametrize("more", [{}, {"friction": 0.3, "pull": 1.0}], ids=["smooth", "rubbing"])
@pytest.mark.parametrize("curvature", [4.0, 16.0])
def test_planar_rod_vs_spatial_one_on_either_side(curvature: float, more: dict[str, Any]) -> None:
    """Residual, Jacobian and length of a planar rod are those of a rod in space that is bent in the plane."""
    found = {}
    for strain in ("planar", "kirchhoff"):
        scene = pulled(strain, 50.0, **more)
        model = build(scene, discretise(scene, 2, 8))
        x = np.zeros(model.size)
        bent = model.discrete.rods["rod"].columns[1]
        constant_mode = model.discrete.rods["rod"].at_nodes[1][0, 0]
        x[bent] = curvature / constant_mode, 0.3
        jacobian, residual = model.jacobian(x, model.pack())
        length = model.actuator["cable"](x, model.pack())[1]
        found[strain] = (residual.full()[bent, 0], jacobian.full()[bent, bent], float(length))
    for own, other in zip(found["planar"], found["kirchhoff"], strict=True):
        assert_allclose(own, other, rtol=1e-11, atol=1e-11)


def test_residual_is_the_gradient_beyond_a_vanished_path() -> None:
    scene = pulled("planar", 50.0)
    model = build(scene, discretise(scene, 3, 8))
    x = ca.MX.sym("x", model.size)
    gradient = ca.Function("gradient", [x], [ca.gradient(model.potential(x, model.pack()), x)])
    bent = np.array([16.0, 0.5, -0.3])
    expected = gradient(bent).full()[:, 0] / model.discrete.rods["rod"].energy_unit
    assert_allclose(model.residual(bent, model.pack()).full()[:, 0], expected, rtol=1e-11, atol=1e-11)


def test_path_of_equilibria_that_passes_a_vanished_path() -> None:
    path = follow(pulled("planar", 1e-9, moment=12.0), "turn.moment", [0.0, 12.0, 0.0])
    assert path.outcome is PathOutcome.PATH_VANISHED, path.message
    assert "'cable'" in path.message


def test_motion_that_passes_a_vanished_path() -> None:
    """Let go straight under a moment, the rod overshoots what the moment alone would hold."""
    table = described("planar", 1e-9, moment=8.0)
    table["rods"][0] |= {"linear_density": 0.1, "damping": {"bending_y": 0.05}}
    table["accuracy"] = {"modes": 2, "nodes": 8, "tolerance": 1e-2}
    table["simulation"] = {"duration": 1.0, "start": "unloaded"}
    motion = simulate(scene_from_dict(table))
    assert motion.outcome is MotionOutcome.PATH_VANISHED, motion.message
    assert "'cable'" in motion.message


def test_paths_that_no_strain_changes_cost_nothing() -> None:
    """A tendon on the axis of a rod that cannot be stretched, and a scene without tendons, have no such function."""
    table = described("planar", 1.0)
    table["actuators"][0]["offset"] = [0.0, 0.0]
    central = scene_from_dict(table)
    assert build(central, discretise(central, 2, 6)).strain_margins is None
    table["actuators"] = []
    without = scene_from_dict(table)
    assert build(without, discretise(without, 2, 6)).strain_margins is None
