"""Step sizes of measured motions, by their error in standard deviations of the measurements."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.identification.misfit import Misfit, MisfitState
from cosserat_casadi.motion.fall_of_errors import HALVED, LEFT_BY_HALF
from cosserat_casadi.tubes.tube_functions import AnyModel

STEP_ERROR = 0.05
"""Largest error of any measured number by the steps, in standard deviations."""

SPARE = 0.2
"""Share of that error at which longer steps aim."""

ORDER = 4.0
"""Least power of the step size with which the error falls."""

MOST_LONGER = 4.0
"""Largest factor by which steps are lengthened at once."""

TINY = 1e-9
"""Error, in standard deviations, below which step sizes make no difference."""

MOST_HALVINGS = 9
"""Most halvings of the first steps."""


def given_steps(model: AnyModel) -> bool:
    """Whether the scene prescribes the step size."""
    simulation = model.scene.simulation
    return simulation is not None and simulation.step is not None


def error_of_steps(misfit: Misfit, state: MisfitState) -> float:
    """Estimate the largest error of a residual by the steps, from steps of half the size; 0 if nothing moves."""
    return HALVED * _distance_to_half(misfit, state)[0] if misfit.motions.times else 0.0


def with_steps(misfit: Misfit, state: MisfitState) -> MisfitState:
    """Return the state with sufficiently short steps; steps that the scene prescribes are kept.

    Args:
        misfit: misfit whose steps are shortened.
        state: state with the present steps.
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
    """Largest change of a residual by halving the steps, and the state with the halved steps."""
    misfit.motions.size /= 2.0
    finer = misfit.first(state.point, state.shared, state.own)
    misfit.motions.size *= 2.0
    # Modes that do not swing have no residual either way.
    changes = np.abs(finer.residual - state.residual)[misfit.moves[misfit.row_cases]]
    distance = float(np.max(changes))
    return (distance if np.isfinite(distance) else np.inf), finer
