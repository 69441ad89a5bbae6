"""Data that go to and from a page: inputs as it sends them, equilibria as it draws them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cosserat_casadi.codegen.compiled_results import CompiledSolution
from cosserat_casadi.equilibrium.solution import Equilibrium
from cosserat_casadi.maths.typing import FloatArray


def stacked_inputs(inputs: Sequence[float | None]) -> FloatArray:
    """Stacked inputs; NaN for null, which JSON has in place of a number."""
    return np.array([np.nan if value is None else value for value in inputs], dtype=np.float64)


def state_of(found: Equilibrium[Any] | CompiledSolution, drawn: FloatArray, *, anew: bool) -> dict[str, Any]:
    """The end of a solve for a page.

    Args:
        found: how the solve ended, in Python or in C.
        drawn: drawn parts of the equilibrium, shape (k,).
        anew: whether it was solved from the unloaded scene, because the last equilibrium led nowhere.
    """
    return {
        "found": found.converged,
        "label": found.outcome.label,
        "text": found.outcome.value,
        "anew": anew,
        "loadFactor": found.load_factor,
        "iterations": found.iterations,
        "drawn": drawn.tolist(),
    }


def accuracy_of(solution: Equilibrium[Any] | None) -> dict[str, Any]:
    """The estimated error of an equilibrium for a page: in words, and whether it is within the tolerance.

    Args:
        solution: with its estimates; None where there is no equilibrium.
    """
    if solution is None or solution.within_tolerance is None:
        return {"within": None, "text": "", "refines": False}
    accuracy = solution.model.scene.accuracy
    error = solution.judged_error
    if error is None or not solution.converged:
        return {"within": False, "text": solution.message, "refines": False}
    text = f"Estimated error {error:.1g} of the length, asked {accuracy.tolerance:g}."
    if not solution.within_tolerance:
        text += " " + solution.remedy
    scene = solution.model.scene
    refines = not (solution.within_tolerance or accuracy.fixed_by_hand or scene.touches_exactly or scene.tubes)
    return {"within": solution.within_tolerance, "text": text, "refines": refines}
