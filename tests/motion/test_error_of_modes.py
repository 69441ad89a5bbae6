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
from cosserat_casadi.motion.felt_modes import SAFETY, UNKNOWN_ORDER, felt, lacking, out_of_phase, told_by_modes
from cosserat_casadi.motion.motion_refinement import (
    FASTEST,
    FASTEST_OF_WAVES,
    ORDER_OF_FRONTS,
    SLOWEST,
    SPACE_SHARE,
    ResolvedMotion,
    _Search,
)
from cosserat_casadi.motion.simulate import Simulator, started
from cosserat_casadi.motion.trajectory import MotionOutcome
from cosserat_casadi.scene.simulation import Simulation
from tests.motion import transients
from tests.motion.stepping import moving_model
from tests.motion.test_error_of_steps import SOFT, dropped


def search(modes: tuple[int, ...], order: float, tolerance: float = 1e-3, lost: float = 0.0) -> _Search:
    """A search whose errors are modes^−order, and whose impacts took an energy, J."""
    anything: Any = None
    found = _Search(anything, Simulation(duration=1.0), None, None, None, (), tolerance, VERIFIED_MODES)
    before = float("inf")
    for number in modes:
        error = float(number) ** -order
        history: Any = SimpleNamespace(lost=lost, events=())
        found.levels.append(ResolvedMotion(anything, history, anything, 0, number, before - error))
        before = error
    return found


@pytest.mark.parametrize("order", [1.0, 2.3, 5.0])
@pytest.mark.parametrize("modes", [(6, 9, 12), (9, 12, 16), (6, 12, 14)])
def test_errors_by_a_power_are_told_with_the_factor_of_safety(modes: tuple[int, ...], order: float) -> None:
    assert_allclose(search(modes, order).space_error, SAFETY * modes[-1] ** -order, rtol=2e-3, atol=0)


@pytest.mark.parametrize("order", [0.5, 1.7, 4.0])
@pytest.mark.parametrize(("modes", "others"), [(8, 12), (12, 8), (1, 5)])
def test_two_motions_tell_the_error_of_either(modes: int, others: int, order: float) -> None:
    own, other = (float(number) ** -order for number in (modes, others))
    assert_allclose(told_by_modes(modes, others, order) * abs(own - other), SAFETY * own, rtol=1e-12, atol=0)


def test_orders_beyond_belief_are_bounded() -> None:
    assert search((6, 9, 12), 20.0).order == FASTEST
    assert search((6, 9, 12), 0.01).order == SLOWEST
    assert search((6, 9, 12), 5.0, lost=1e-3).order == UNKNOWN_ORDER


def test_orders_of_waves_lie_between_those_of_fronts_and_of_few_modes() -> None:
    """A strip let go told 1.7e-7 on 28 modes after 12 where 5.7e-7 was true: the power falls from 5 to 2."""
    for order, believed in ((0.3, ORDER_OF_FRONTS), (6.0, FASTEST_OF_WAVES)):
        waves = search((6, 9, 12), order)
        waves.levels[-1] = replace(waves.last, waves=True)
        assert waves.order == believed


@pytest.mark.parametrize("kind", ["impact", "stop_hit"])
def test_blows_that_take_no_energy_bound_the_order(kind: str) -> None:
    """The energies of elastic blows are rounding, of either sign."""
    struck = search((6, 9, 12), 5.0, lost=-1e-18)
    assert_allclose(struck.order, 5.0, rtol=0, atol=0.05)
    struck.last.history.events = [SimpleNamespace(kind=kind)]
    assert struck.order == UNKNOWN_ORDER


def test_waves_that_modes_do_not_see_yet_end_no_search() -> None:
    """Errors of short waves hardly fall at first, and then with the fourth power: a search goes on if that would do."""
    stagnant = search((9, 12, 16), 0.7, tolerance=0.01)
    assert stagnant.foreseen(VERIFIED_MODES[-1], stagnant.order) > 0.09
    rung = VERIFIED_MODES.index(16)
    stagnant.levels[-1] = replace(stagnant.last, rung=rung)
    assert stagnant.climb() == rung + 3
    assert replace(stagnant, tolerance=1e-4).climb() is None


def test_impacts_are_foreseen_on_the_modes_that_the_tolerance_asks_for() -> None:
    """Errors go as modes^−1.7 and impacts as their square: on 18 modes there are four times those on 9."""
    tolerance = SAFETY * 18.0**-UNKNOWN_ORDER / SPACE_SHARE
    found = search((6, 9), UNKNOWN_ORDER, tolerance)
    for level in found.levels:
        level.history.events = [SimpleNamespace(kind="impact")] * level.modes**2
    assert_allclose(found.foreseen_impacts, 18**2, rtol=1e-9, atol=0)
    assert_allclose(replace(found, tolerance=1.0).foreseen_impacts, 9**2, rtol=1e-9, atol=0)


@pytest.mark.slow
def test_a_rod_that_strikes_over_and_over_is_given_up_with_its_error() -> None:
    tables = dropped(SOFT, 1e-3, 0.2, 0.04, 0.2)
    del tables["accuracy"]
    tables["simulation"]["tolerance"] = 1e-2
    motion = simulate(scene_from_dict(tables))
    assert motion.outcome is MotionOutcome.UNRESOLVED
    assert "strike over and over" in motion.message
    assert max(motion.model.discretisation["rod"].modes) <= 12
    assert 1e-2 < motion.error_estimate < 0.2


def test_modes_whose_last_coefficients_do_not_tell_are_enough_and_their_error_is_told() -> None:
    tolerance = 1e-2
    motion = simulate(scene_from_dict(transients.line_load(tolerance=tolerance)))
    error = np.linalg.norm(motion.tip().position[:, [0, 2]] - transients.LINE_LOAD_TIP, axis=1).max()
    assert motion.converged
    assert motion.model.discretisation["rod"].modes == (VERIFIED_MODES[0],)
    assert max(error, 0.1 * tolerance) < motion.error_estimate


def simulator_on(tables: transients.Table, modes: int) -> Simulator:
    """The motion of a scene on so many modes."""
    model = moving_model(tables, modes)
    simulation = model.scene.simulation
    assert simulation is not None
    return Simulator(model, simulation, started(model, simulation, None))


def test_what_grows_with_time_is_not_hidden_by_long_steps_nor_judged_by_them() -> None:
    """A column above its critical weight, which a small push sets falling: with long steps it rested."""
    rod = {"base": {"tangent": [0, 0, 1]}, "stiffness": {"bending_y": [1.0, 0.02]}}
    knock = {"input": "push.force", "times": [0.0, 0.025, 0.05], "values": [[0, 0, 0], [1e-4, 0, 0], [0, 0, 0]]}
    asked = {"duration": 6.0, "frames": 2, "start": "unloaded", "tolerance": 0.1}
    tables = transients.table(rod, transients.gravity(12.0), transients.at_tip(), motions=[knock], simulation=asked)
    motion = simulate(scene_from_dict(tables))
    assert np.linalg.norm(motion.tip().position[-1] - [0, 0, 1]) > 0.5
    history: Any = motion.interpolant
    assert motion.converged
    assert motion.error_estimate > lacking(history.__self__, 6.0)


@pytest.mark.slow
def test_coefficients_that_modes_lack_put_waves_out_of_phase() -> None:
    """Waves in the third mode of a cantilever: their last coefficients stay, their error grows with time."""
    frequency = 61.70 / (2 * np.pi)
    times = np.linspace(0.0, 10.0 / frequency, 81)
    force = 0.2 * np.sin(np.pi * times / times[-1]) * np.sin(2 * np.pi * frequency * times)
    values = [[0.0, 0.0, float(value)] for value in force]
    burst = {"input": "push.force", "times": times.tolist(), "values": values, "interpolation": "cubic"}
    asked = {"duration": 6.0, "frames": 2, "start": "unloaded"}
    tables = transients.table({}, transients.at_tip(), motions=[burst], simulation=asked)
    simulators = [simulator_on(tables, modes) for modes in (6, 12)]
    histories = [simulator.controlled(1e-5) for simulator in simulators]
    few, many = (simulator.paths(history).points for simulator, history in zip(simulators, histories, strict=True))
    errors = np.linalg.norm(few - many, axis=2).max(axis=1)
    third = len(errors) // 3
    assert errors[-third:].max() > 2.0 * errors[:third].max()
    late = out_of_phase(histories[0], 6.0, felt(histories[0], 6.0))
    assert errors.max() < late < 50.0 * errors.max()
