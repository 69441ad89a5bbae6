"""The error that modes leave is told by the power of their number, also where rungs of modes are unevenly apart."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cosserat_casadi import scene_from_dict, simulate
from cosserat_casadi.accuracy.levels import VERIFIED_MODES
from cosserat_casadi.motion.felt_modes import SAFETY, UNKNOWN_ORDER
from cosserat_casadi.motion.motion_refinement import FASTEST, SLOWEST, ResolvedMotion, _Search
from cosserat_casadi.scene.simulation import Simulation
from tests.motion import transients


def search(modes: tuple[int, ...], order: float, tolerance: float = 1e-3, lost: float = 0.0) -> _Search:
    """A search whose errors are modes^−order, and whose impacts took an energy, J."""
    anything: Any = None
    history: Any = SimpleNamespace(lost=lost)
    found = _Search(anything, Simulation(duration=1.0), None, None, None, (), tolerance, VERIFIED_MODES)
    before = float("inf")
    for number in modes:
        error = float(number) ** -order
        found.levels.append(ResolvedMotion(anything, history, anything, 0, number, before - error))
        before = error
    return found


@pytest.mark.parametrize("order", [1.0, 2.3, 5.0])
@pytest.mark.parametrize("modes", [(6, 9, 12), (9, 12, 16), (6, 12, 14)])
def test_errors_by_a_power_are_told_with_the_factor_of_safety(modes: tuple[int, ...], order: float) -> None:
    assert_allclose(search(modes, order).space_error, SAFETY * modes[-1] ** -order, rtol=2e-3, atol=0)


def test_orders_beyond_belief_are_bounded() -> None:
    assert search((6, 9, 12), 20.0).order == FASTEST
    assert search((6, 9, 12), 0.01).order == SLOWEST
    assert search((6, 9, 12), 5.0, lost=1e-3).order == UNKNOWN_ORDER


def test_waves_that_modes_do_not_see_yet_end_no_search() -> None:
    """Errors of short waves hardly fall at first, and then with the fourth power: a search goes on if that would do."""
    stagnant = search((9, 12, 16), 0.7, tolerance=0.01)
    assert stagnant.foreseen(VERIFIED_MODES[-1], stagnant.order) > 0.09
    rung = VERIFIED_MODES.index(16)
    stagnant.levels[-1] = replace(stagnant.last, rung=rung)
    assert stagnant.climb() == rung + 3
    assert replace(stagnant, tolerance=1e-4).climb() is None


def test_modes_whose_last_coefficients_do_not_tell_are_enough_and_their_error_is_told() -> None:
    tolerance = 1e-2
    motion = simulate(scene_from_dict(transients.line_load(tolerance=tolerance)))
    error = np.linalg.norm(motion.tip().position[:, [0, 2]] - transients.LINE_LOAD_TIP, axis=1).max()
    assert motion.converged
    assert motion.model.discretisation["rod"].modes == (VERIFIED_MODES[0],)
    assert max(error, 0.1 * tolerance) < motion.error_estimate
