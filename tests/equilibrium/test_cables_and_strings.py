"""Slack cables in wind and taut strings, whose tension is many times EI/L², against collocation by SciPy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Model, Outcome, Scene, build, discretise, scene_from_dict, solve
from cosserat_casadi.numerics.broyden import newton_step
from tests.reference.held_cables import HeldCable
from tests.scenes import rod, scene

CABLE = HeldCable(length=10.4, distance=10.0, bending=2.0, torsion=1.5, axial=1e6, weight=7.848, wind=(0.0, 8.0, 0.0))
STRING = HeldCable(length=0.65, distance=0.652, bending=8e-5, torsion=6e-5, axial=1.4e4, weight=3.0)


def scene_of(cable: HeldCable, strain: tuple[str, ...] = ("bending_x", "bending_y", "torsion", "extension")) -> Scene:
    stiffness = {
        "bending_x": cable.bending,
        "bending_y": cable.bending,
        "torsion": cable.torsion,
        "extension": cable.axial,
    }
    cable_itself = {
        "name": "rod",
        "length": cable.length,
        "strain": list(strain),
        "stiffness": {name: stiffness[name] for name in strain},
        "linear_density": cable.weight / 9.81,
        "base": {"position": [0, 0, 0], "tangent": [1, 0, 0]},
    }
    support = {"rod": "rod", "kind": "pinned", "position": [cable.distance, 0, 0]}
    if not cable.pinned:
        support |= {"kind": "clamped", "tangent": [1, 0, 0]}
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}
    drag = {"density": 1.225, "normal": cable.normal, "tangential": cable.tangential, "diameter": cable.diameter}
    wind = {"name": "wind", "kind": "flow", "velocity": list(cable.wind), **drag}
    return scene_from_dict({"schema": 1, "rods": [cable_itself], "supports": [support], "loads": [weight, wind]})


def on_modes(scene: Scene, modes: int) -> Model:
    return build(scene, discretise(scene, modes, 2 * modes + 4))


def assert_is_collocated(cable: HeldCable, method: str, modes: int, bound: float, **more: Any) -> None:
    solution = solve(on_modes(scene_of(cable, **more), modes), method=method)
    assert solution.converged, solution.message
    assert solution.paced
    assert "the shape alone bounded its steps" in solution.message
    assert solution.stable is None or solution.stable
    assert solution.error_estimate is not None
    off = np.linalg.norm(solution.pose(0.5).position - cable.middle()) / cable.length
    assert off <= bound
    assert off <= solution.error_estimate


def test_a_slack_cable_in_wind_is_found_without_help() -> None:
    assert_is_collocated(CABLE, "continuation", 11, 3e-4)


@pytest.mark.parametrize(
    "cable",
    [
        replace(CABLE, wind=(0.0, 20.0, 0.0)),
        replace(CABLE, wind=(14.0, -12.0, 8.0)),
        replace(CABLE, wind=(8.0, 0.0, 0.0), pinned=True),
        replace(CABLE, weight=1e-9),
    ],
    ids=["strong", "oblique", "along", "wind-alone"],
)
def test_cables_in_wind_vs_collocation(cable: HeldCable) -> None:
    assert_is_collocated(cable, "taut", 16, 6e-5)


def test_a_cable_that_cannot_extend_vs_collocation() -> None:
    assert_is_collocated(replace(CABLE, axial=1e9), "taut", 16, 6e-5, strain=("bending_x", "bending_y", "torsion"))


def test_a_string_stretched_by_two_millimetres_vs_collocation() -> None:
    solution = solve(on_modes(scene_of(STRING, strain=("bending_y", "extension")), 30), method="taut")
    assert solution.converged, solution.message
    assert solution.stable
    assert_allclose(solution.pose(0.5).position, STRING.middle(), rtol=3e-3, atol=1e-9)


@pytest.mark.parametrize("method", ["taut", "continuation"])
def test_a_cable_that_cannot_extend_and_is_held_straight_has_no_equilibrium(method: str) -> None:
    straight = scene_of(replace(CABLE, length=10.0), strain=("bending_x", "bending_y", "torsion"))
    solution = solve(on_modes(straight, 3), method=method)
    assert solution.outcome is Outcome.LOAD_STALLED
    assert not solution.paced


def test_rods_in_a_row_that_are_too_short_and_cannot_extend_have_no_equilibrium() -> None:
    """Relative to a tension without bound their gap is as small as any residual."""
    even = dict.fromkeys(("bending_x", "bending_y", "torsion"), 1.0)
    base = {"position": [0, 0, 0], "tangent": [1, 0, 0]}
    carried = {"rod": "first", "at": 1.0, "position": [0, 0, 0], "quaternion": [1, 0, 0, 0]}
    rods = [
        rod(name="first", length=0.5, base=base, stiffness=even, linear_density=0.5),
        rod(name="second", length=0.4999, base=carried, stiffness=even, linear_density=0.5),
    ]
    weight = {"name": "weight", "kind": "gravity", "acceleration": [0, 0, -9.81]}
    row = scene(weight, rods=rods, supports=[{"rod": "second", "kind": "pinned", "position": [1, 0, 0]}])
    solution = solve(build(row, discretise(row, 4, 10)), method="taut")
    assert solution.outcome is Outcome.LOAD_STALLED
    assert "not closed" in solution.message


def test_a_step_is_regular_where_some_rows_are_large_and_the_shortest_where_one_is_neutral() -> None:
    """A spring of compliance 1e-8 beside a geometric stiffness of 1e6: condition 1e14, and 1e8 in units of the rows."""
    jacobian = np.diag([1e6, 1.0, 1e-8])
    wanted = np.array([2.0, 3.0, 5.0])
    assert_allclose(newton_step(jacobian, -jacobian @ wanted), wanted, rtol=1e-12, atol=0)
    neutral = np.diag([1e6, 1.0, 1e-17])
    assert_allclose(newton_step(neutral, -neutral @ wanted), [2.0, 3.0, 0.0], rtol=1e-12, atol=0)
