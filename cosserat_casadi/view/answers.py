"""What goes to and from a page: inputs as it sends them, equilibria as it draws them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cosserat_casadi.codegen.compiled_results import CompiledSolution
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray


def stacked_inputs(inputs: Sequence[float | None]) -> FloatArray:
    """Stacked inputs; JSON has null for what is not a number."""
    return np.array([np.nan if value is None else value for value in inputs], dtype=np.float64)


def state_of(found: Solution | CompiledSolution, drawn: FloatArray, *, anew: bool) -> dict[str, Any]:
    """The end of a solve for a page.

    Args:
        found: how the solve ended, in Python or in C.
        drawn: what is drawn of it, shape (k,).
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
