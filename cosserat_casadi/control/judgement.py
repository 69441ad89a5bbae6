"""Verdict on the equilibrium at the end of an optimisation, by the test of ``solve``."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.answer_error import with_error_estimate
from cosserat_casadi.equilibrium.judge import correct, judge
from cosserat_casadi.equilibrium.load_path import continuation_limits
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.obstacle_checks import refuse_obstacles
from cosserat_casadi.numerics.outcome import Outcome


def judged(
    model: Model,
    x: npt.ArrayLike,
    inputs: npt.ArrayLike,
    *,
    parameters: Mapping[str, npt.ArrayLike] | npt.ArrayLike | None = None,
) -> Solution:
    """Judge the equilibrium at the end of an optimisation by residual, stability and error estimate.

    An optimiser satisfies the balance to its own tolerance, on modes that were chosen for other inputs. Newton's method
    corrects the unknowns if it keeps them near; otherwise they are judged as they are. Only a solution that has
    ``converged`` and is ``within_tolerance`` is valid for the rod.

    Args:
        model: the model of the problem.
        x: unknowns at the end of the optimiser, shape (model.size,).
        inputs: stacked inputs there, shape (model.inputs.size,).
        parameters: parameters as for :meth:`Model.at`; by default the scene's values.

    Raises:
        SceneError: contact is exact, or an input or a parameter is refused.
        ValueError: the number of unknowns differs from that of the model.
    """
    refuse_obstacles(model.scene, "an optimum")
    model = model.at(parameters)
    unknowns = np.asarray(x, dtype=float).ravel()
    if len(unknowns) != model.size:
        raise ValueError(f"the optimum has {len(unknowns)} unknowns, the model {model.size}")
    stacked = np.asarray(inputs, dtype=float).ravel()
    given = model.pack(model.inputs.split(stacked))
    settings = continuation_limits(model).newton
    outcome = Outcome.MAX_ITERATIONS
    iterations = 0
    corrected = correct(model, given, unknowns, settings)
    if corrected is not None:
        unknowns, outcome, iterations = corrected.x, corrected.outcome, corrected.iterations
    solution = judge(model, given, unknowns, outcome, iterations, load_factor=1.0, tolerance=settings.tolerance)
    return with_error_estimate(solution)
