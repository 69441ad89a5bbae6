"""The error that modes and nodes leave in the measured equilibria: identified numbers make up for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from cosserat_casadi.equilibrium.answer_error import UNKNOWN, answer_error
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import SceneError
from cosserat_casadi.identification.identification_result import Identification
from cosserat_casadi.identification.measured_cases import Case
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.tubes.tube_functions import AnyModel, TubeFunctions
from cosserat_casadi.tubes.tube_solve import error_beside, finer_than, solution_at


def with_model_error(found: Identification, cases: Mapping[str, Case]) -> Identification:
    """An identification with the largest error of the equilibria that were measured, and a warning where it is large.

    Motions have the errors of their steps, and are left out here.

    Args:
        found: at the end of a search.
        cases: the fitted cases, by their first rows in words.
    """
    try:
        model = found.model.at(found.parameters)
    except SceneError:
        # Numbers that the scene refuses are no model whose error could be told.
        return found
    errors = {
        where: _error(model, inputs, x)
        for where, x, inputs in zip(found.cases, found.unknowns_x, found.inputs, strict=True)
        if not cases[where].moves
    }
    if not errors:
        return found
    worst = max(errors, key=lambda where: errors[where])
    told = replace(found, error_estimate=errors[worst], error_case=worst)
    if told.within_tolerance is not False:
        return told
    return replace(told, warnings=(*told.warnings, _warning(told)))


def _error(model: AnyModel, inputs: FloatArray, x: FloatArray) -> float:
    """The estimated error of an equilibrium that the tolerance binds; of tubes beside twice the steps."""
    if isinstance(model, TubeFunctions):
        solution = solution_at(model, inputs, x, found=True)
        beside = error_beside(solution, finer_than(solution))
        return UNKNOWN if beside is None else beside
    equilibrium = Solution(model, inputs, x, Outcome.CONVERGED, "", 0.0, 0)
    error = answer_error(equilibrium)
    return error.shape if equilibrium.model.scene.accuracy.shape else error.watched


def _warning(found: Identification) -> str:
    tolerance = found.model.scene.accuracy.tolerance
    remedy = "Choose modes and nodes for the range of what was measured with cosserat tune."
    if isinstance(found.model, TubeFunctions):
        remedy = "Build the model with more steps, or identify the scene."
    error = f"may be off by {found.error_estimate:.2g} of the length"
    if found.error_estimate == UNKNOWN:
        error = "has an error that is not known"
    return (
        f"The model itself {error} in {found.error_case}, where the tolerance is {tolerance:g}: the numbers found make "
        f"up for that. {remedy}"
    )
