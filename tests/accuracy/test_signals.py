"""What a scene puts along its rods: the modes that it asks for, and those that a solution lacks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import Scene, build, discretise, solve
from cosserat_casadi.accuracy.levels import REFERENCE_MODES, USUAL_MODES, Level
from cosserat_casadi.accuracy.preview import Preview
from cosserat_casadi.accuracy.resolution import LOADED_SWEEPS, Resolution
from cosserat_casadi.equilibrium.metrics import cable_distance
from cosserat_casadi.maths.pose_change import change_size
from cosserat_casadi.model.required_modes import BEYOND, signal_modes
from tests.families import mostly_slow
from tests.scenes import push, scene

ROD: dict[str, Any] = {
    "name": "rod",
    "length": 1.0,
    "strain": "kirchhoff",
    "stiffness": {"bending_x": 1.0, "bending_y": 1.0, "torsion": 0.8},
}


def cabled(**routing: Any) -> Scene:
    tendon = {"name": "cable", "kind": "tendon", "rod": "rod", "tension": 5.0, **routing}
    return scene(push(force=[0.4, 0.0, 0.0]), rods=[ROD], actuators=[tendon])


def wound(turns: float, **routing: Any) -> Scene:
    return cabled(helix={"radius": 0.03, "turns": turns}, **routing)


@pytest.mark.parametrize("turns", [3.0, 8.3, -8.3, 20.0])
def test_modes_of_a_helix_go_beyond_its_frequency(turns: float) -> None:
    """cos(πns) has Legendre coefficients up to about πn, which then fall faster than any power."""
    frequency = np.pi * abs(turns)
    assert frequency < signal_modes(wound(turns)) < 1.1 * frequency + 6 + BEYOND


def test_modes_of_a_helix_along_a_part_are_those_of_its_turns_there() -> None:
    part = signal_modes(wound(20.0, span=[0.0, 0.25]))
    assert abs(part - signal_modes(wound(5.0))) <= 2


def test_slow_signals_ask_for_no_more_than_the_first_levels_have() -> None:
    straight = cabled(offset=[0.02, 0.01])
    converging = cabled(offset=[[0.02, -0.01], [0.01, 0.0]])
    bare = scene(push(force=[0.4, 0.0, 0.0]), rods=[ROD])
    assert signal_modes(straight) == BEYOND
    assert signal_modes(converging) <= REFERENCE_MODES[1]
    assert signal_modes(bare) == BEYOND


def test_degree_of_curvatures_and_spread_loads() -> None:
    curved = {**ROD, "intrinsic": {"curvature": [0.0, [0.0] * 12 + [1.0, 0.01], 0.0]}}
    assert signal_modes(scene(push(force=[1.0, 0, 0]), rods=[curved])) == 12 + BEYOND
    wind = {"name": "wind", "kind": "distributed_wrench", "rod": "rod", "force": [0, [0.1, 0, 0, 0, 0, 0, 1.0], 0]}
    assert signal_modes(scene(wind, rods=[ROD])) == 6 + BEYOND


def test_first_level_sees_the_signals() -> None:
    assert Level.first(1e-3) == Level.first(1e-3, 5)
    assert Level.first(1e-3, 40).modes >= 40
    assert REFERENCE_MODES[Level.first(1e-3, 40).finest] >= 80
    assert REFERENCE_MODES[Level.first(1e-3, 5).finest] == USUAL_MODES
    assert Level.first(1e-3, 10_000).modes == REFERENCE_MODES[-1]


def test_waves_beyond_all_levels_are_said_to_be_unresolved() -> None:
    solution = solve(wound(70.0))
    assert not solution.converged
    assert solution.message.startswith("An equilibrium of the discrete model")


@pytest.mark.parametrize("modes", mostly_slow([15, 17], quick=[15]))
def test_modes_that_are_missing_vs_a_model_that_has_them(modes: int) -> None:
    wanted = wound(4.3)
    discretisations = [discretise(wanted, m, n, "magnus8") for m, n in ((modes, 60), (2 * modes, 60))]
    coarse, fine = (solve(build(wanted, d)) for d in discretisations)
    preview = Preview(coarse)
    found = preview.finer_shift(discretisations[1], LOADED_SWEEPS).tips
    truth = Preview(fine).tips.change_from(preview.tips)
    assert change_size(truth) > 1e-9
    assert_allclose(found, truth, rtol=0, atol=0.02 * np.abs(truth).max())


def test_hidden_modes_count_where_there_are_waves() -> None:
    """Between the frequency of a helix and its double the last coefficients tell too little."""
    wanted = wound(4.0)
    solution = solve(build(wanted, discretise(wanted, 7, 30, "magnus8")))
    fine = solve(build(wanted, discretise(wanted, 24, 60, "magnus8")))
    error = change_size(Preview(solution).tips.change_from(Preview(fine).tips))
    assert Resolution(Preview(solution)).modes_error < error
    assert Resolution(Preview(solution), waves=True).modes_error > error


def test_length_of_a_cable_is_within_the_tolerance() -> None:
    wanted = wound(6.0)
    tolerance = wanted.accuracy.tolerance
    solution = solve(wanted)
    fine = solve(build(wanted, discretise(wanted, 40, 90, "magnus8")))
    assert solution.error_estimate is not None
    assert cable_distance(solution, fine) <= min(tolerance, 1.01 * solution.error_estimate)
