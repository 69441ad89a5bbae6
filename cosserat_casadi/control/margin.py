"""How far an equilibrium is from instability, as a function that an optimiser can bound.

The smallest eigenvalue of the second variation has a kink where two eigenvalues meet, which is the rule in symmetric
robots. The margin is their soft minimum −w log Σ exp(−λ/w): smooth, never above the smallest eigenvalue, and below it by
at most w times the logarithm of the number of eigenvalues. It looks at all eigenvalues at once, so no optimiser escapes to
a higher one, as it may where one eigenpair is made part of the problem.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from cosserat_casadi.control.soft_minimum import soft_minimum
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.solver.solve import check_potential
from cosserat_casadi.solver.stability import variations

WIDTH = 0.01
"""Width w of the soft minimum, in units of EI/ℓ."""


def stability_margin(model: Model, width: float = WIDTH) -> ca.Function:
    """A smooth lower bound of the smallest eigenvalue of the second variation.

    The eigenvalues are those that ``solve`` judges: over the variations that supports, joints and cables of given
    length admit, in units of EI/ℓ of the stiffest rod. First and second derivatives are exact, at multiple eigenvalues
    too. NumPy finds the eigenvalues, so the function cannot be exported to C.

    Args:
        model: with loads that have a potential, and without cables that may go slack.
        width: of the soft minimum, in units of EI/ℓ.

    Returns:
        (x, inputs) ↦ margin; off equilibrium that of the symmetric part of the Jacobian there.

    Raises:
        SceneError: the loads have no potential, or a cable may go slack.
        ValueError: the width is not positive.
    """
    if not width > 0.0:
        raise ValueError(f"the width of a soft minimum is positive, got {width}")
    check_potential(model, model.pack())
    _refuse_slack(model)
    x, inputs = ca.MX.sym("x", model.size), ca.MX.sym("inputs", model.inputs.size)
    margin = soft_minimum(len(variations(model).free), model.size, width)(_bordered(model, x, inputs))
    return ca.Function("stability_margin", [x, inputs], [margin], ["x", "inputs"], ["margin"])


def _refuse_slack(model: Model) -> None:
    """Refuse cables that hold the rod at times only: the eigenvalues jump where they go slack."""
    problems = [
        Problem(f"actuators[{i}].slack", "a cable that may go slack makes eigenvalues jump", "give it slack = false")
        for i, one in enumerate(model.scene.actuators)
        if one.kind == "tendon" and one.length is not None and one.slack
    ]
    if problems:
        raise SceneError(*problems)


def _bordered(model: Model, x: Matrix, inputs: Matrix) -> Matrix:
    """Second variation bordered by the linearised gaps, in the scale in which stability is judged."""
    allowed, jacobian = variations(model), model.jacobian(x, inputs)[0]
    free, held = allowed.free.tolist(), allowed.held.tolist()
    roots = ca.DM(np.sqrt(allowed.units / allowed.units.max(initial=0.0)))
    stiffness = ca.diag(roots) @ jacobian[free, free] @ ca.diag(1 / roots)
    gaps = jacobian[held, free] @ ca.diag(1 / roots)
    lower = ca.horzcat(gaps, ca.MX(len(held), len(held)))
    return ca.densify(ca.vertcat(ca.horzcat((stiffness + stiffness.T) / 2, gaps.T), lower))
