"""A rod that cannot extend, held straight at both ends, bears no load across it, and the solve says so at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cosserat_casadi import Outcome, Solution, build, discretise, solve
from cosserat_casadi.equilibrium.taut_rods import TAUT, held_taut
from tests.scenes import rod, scene

LENGTH = 0.8


def held(kind: str, distance: float, strain: str, **more: Any) -> Any:
    support = {"rod": "rod", "kind": kind, "position": [0.0, 0.0, distance]}
    side = {"name": "side", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [0.02, 0.0, 0.0]}
    base = {"position": [0, 0, 0], "tangent": [0, 0, 1]}
    return scene(side, rods=[rod(strain, base=base)], supports=[support | more])


@pytest.mark.parametrize("strain", ["planar", "kirchhoff"])
@pytest.mark.parametrize(("kind", "more"), [("clamped", {"tangent": [0, 0, 1]}), ("pinned", {})])
def test_a_rod_held_straight_is_told_at_once(kind: str, more: dict[str, Any], strain: str) -> None:
    solution = solve(held(kind, LENGTH, strain, **more))
    assert isinstance(solution, Solution)
    assert solution.outcome is Outcome.LOAD_STALLED
    assert solution.message.endswith(TAUT)
    # One path on one set of modes: others would end like it.
    assert solution.iterations < 100


def test_a_rod_that_may_extend_sags() -> None:
    solution = solve(held("clamped", LENGTH, "reissner", tangent=[0, 0, 1]))
    assert solution.converged
    assert solution.pose(0.5).position[0] > 0


def test_a_string_tuned_to_many_times_its_bending_stiffness_is_found() -> None:
    """Half a stiff string, EI w''' - T w' = -F/2 with level ends, has w = F/(4T) (L - 4/k tanh(kL/4)), k² = T/EI."""
    length, stretched, force = 0.65, 0.652, 0.2
    bending, axial = 6e-3, 4e4
    string = rod(["bending_y", "extension"], length=length, base={"position": [0, 0, 0], "tangent": [0, 0, 1]})
    string["stiffness"] = {"bending_y": bending, "extension": axial}
    pluck = {"name": "pluck", "kind": "point_wrench", "rod": "rod", "at": 0.5, "force": [force, 0, 0]}
    bridge = {"rod": "rod", "kind": "clamped", "position": [0, 0, stretched], "tangent": [0, 0, 1]}
    given = scene(pluck, rods=[string], supports=[bridge])
    solution = solve(build(given, discretise(given, 14, 30)))
    assert solution.converged, solution.message
    assert solution.stable

    tension = axial * (stretched / length - 1)
    k = np.sqrt(tension / bending)
    deflection = force / (4 * tension) * (stretched - 4 / k * np.tanh(k * stretched / 4))
    np.testing.assert_allclose(solution.pose(0.5).position[0], deflection, rtol=3e-4)


def test_a_rod_held_nearer_is_not_taut() -> None:
    given = held("pinned", 0.9 * LENGTH, "planar")
    model = build(given, discretise(given, 4, 10))
    assert not held_taut(model, model.inputs.pack())
    solution = solve(given)
    assert solution.converged
    assert TAUT not in solution.message


def test_a_curved_rod_that_its_modes_lock_is_not_taut() -> None:
    """One mode has no way to move between clamps; the rod itself may bend."""
    arch = rod("planar", length=1.0, intrinsic={"curvature": [0, 3.0, 0]})
    clamp = {"rod": "rod", "kind": "clamped", "position": [(1 - np.cos(3)) / 3, 0, np.sin(3) / 3]}
    clamp["quaternion"] = [np.cos(1.5), 0, np.sin(1.5), 0]
    given = scene(rods=[arch], supports=[clamp])
    model = build(given, discretise(given, 1, 10))
    assert not held_taut(model, model.inputs.pack())


def test_a_start_with_other_parameters_is_told_of_obstacles_where_there_are_some() -> None:
    name = "rod.stiffness.bending_y"
    unloaded = held("pinned", LENGTH, "planar")
    model = build(unloaded.model_copy(update={"parameters": (name,)}), discretise(unloaded, 4, 10))
    start = solve(model, {"side.force": [0.0, 0.0, 0.0]})
    assert start.converged
    # So large a load ends the path at its first step.
    stalled = solve(model, {"side.force": [1e6, 0.0, 0.0]}, parameters={name: 2.0}, start=start)
    assert stalled.load_factor == 0.0
    assert stalled.message.endswith(TAUT)
