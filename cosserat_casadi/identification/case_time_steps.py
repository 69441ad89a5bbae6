"""Lengths of the steps of measured motions: their error counts in standard deviations of the measurements."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.identification.misfit import Misfit, MisfitState
from cosserat_casadi.motion.fall_of_errors import HALVED, LEFT_BY_HALF
from cosserat_casadi.tubes.tube_functions import AnyModel

STEP_ERROR = 0.05
"""Error that the steps leave in any number that was measured, in standard deviations, that is small enough."""

SPARE = 0.2
"""Share of the error of the steps which longer steps aim at."""

ORDER = 4.0
"""Least power of the step that the error of the steps goes with."""

MOST_LONGER = 4.0
"""Most that steps are made longer at once."""

TINY = 1e-9
"""Error, in standard deviations, below which all steps are alike."""

MOST_HALVINGS = 9
"""Times that the first steps are halved before they are taken as they are."""


def given_steps(model: AnyModel) -> bool:
    """Whether the scene says how long the steps are."""
    simulation = model.scene.simulation
    return simulation is not None and simulation.step is not None


def error_of_steps(misfit: Misfit, state: MisfitState) -> float:
    """Largest error of a residual by the length of the steps, from half of it; 0 where nothing moves."""
    return HALVED * _distance_to_half(misfit, state)[0] if misfit.motions.times else 0.0


def with_steps(misfit: Misfit, state: MisfitState) -> MisfitState:
    """The state with steps that are short enough; steps that the scene prescribes are kept.

    Args:
        misfit: its steps are shortened.
        state: with its present steps.
    """
    if not misfit.motions.times or given_steps(misfit.model):
        return state
    case = min(misfit.motions.times)
    point = state.point
    misfit.motions.suggest_size(case, point.x[case], point.inputs[case], point.p)
    state = misfit.first(point, state.shared, state.own)
    error = HALVED * _distance_to_half(misfit, state)[0]
    longer = (SPARE * STEP_ERROR / max(error, TINY)) ** (1.0 / ORDER)
    if longer > 1.0:
        misfit.motions.size *= min(longer, MOST_LONGER)
        state = misfit.first(point, state.shared, state.own)
    for _ in range(MOST_HALVINGS):
        distance, finer = _distance_to_half(misfit, state)
        if HALVED * distance <= STEP_ERROR:
            break
        misfit.motions.size /= 2.0
        state = finer
        if LEFT_BY_HALF * distance <= STEP_ERROR:
            break
    return state


def _distance_to_half(misfit: Misfit, state: MisfitState) -> tuple[float, MisfitState]:
    """Largest change of a residual where the steps are half as long, and the state with these."""
    misfit.motions.size /= 2.0
    finer = misfit.first(state.point, state.shared, state.own)
    misfit.motions.size *= 2.0
    # Modes that do not swing have no residual either way.
    changes = np.abs(finer.residual - state.residual)[misfit.moves[misfit.row_cases]]
    distance = float(np.max(changes))
    return (distance if np.isfinite(distance) else np.inf), finer
