"""A rod in an optimisation problem: its unknowns are variables of the problem, or solved for by a rootfinder.

*Lifted* gives the optimiser the unknowns as variables and the equilibrium as constraints: there is no inner loop, and
the optimiser may pass through states out of balance. *Embedded* keeps the problem small: x is a function of the inputs,
the root that Newton's method finds from a start, with derivatives by the implicit function theorem. CasADi's
rootfinders report success even on failure, so the root comes with its residual, which a problem must hold near zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from cosserat_casadi.equilibrium.contact.relaxed_contact import RelaxedContact
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.obstacle_checks import RELAXED, refuse_obstacles
from cosserat_casadi.numerics.newton import NewtonSettings

CERTIFIED = NewtonSettings().tolerance
"""Largest relative residual of a root that counts as an equilibrium."""


@dataclass(frozen=True)
class Lifted:
    """One state of a model in an optimisation problem, for raw NLPs and ``Opti`` alike.

    Attributes:
        x: the unknowns, symbols of the problem, shape (size,).
        residual: residual that the problem must constrain to zero, shape (size,).
        start: initial guess of x, shape (size,).
    """

    x: Matrix
    residual: Matrix
    start: FloatArray


def lifted(
    model: Model | RelaxedContact,
    x: Matrix,
    inputs: Matrix,
    near: Solution | None = None,
    parameters: Matrix | None = None,
) -> Lifted:
    """Make a state of a model whose unknowns are variables of the problem.

    Args:
        model: the model; for a scene in exact contact the one that :func:`relaxed_contact` makes of it.
        x: variables for its unknowns, shape (model.size,): ``MX.sym`` or ``opti.variable``.
        inputs: stacked inputs, any expressions, shape (model.inputs.size,).
        near: an equilibrium as initial guess; by default the unloaded rods.
        parameters: stacked parameters, any expressions, shape (model.parameters.size,): variables or parameters of the
            problem; by default the scene's values. For relaxed contact, the smoothing and the abscissae.
    """
    if isinstance(model, RelaxedContact):
        p = model.defaults if parameters is None else parameters
        return Lifted(x, model.residual(x, inputs, p), np.zeros(model.size) if near is None else model.near(near))
    refuse_obstacles(model.scene, "an embedded model", RELAXED)
    start = model.unloaded() if near is None else near.x
    if parameters is None:
        residual = model.at().residual(x, inputs)
    else:
        residual = model.residual(x, inputs, parameters)
    return Lifted(x, residual, start)


def embedded(
    model: Model | RelaxedContact, near: Solution, iterations: int = 50, *, parameters: bool = False
) -> ca.Function:
    """Make the equilibrium as a function of the inputs, on the branch of a solution.

    Newton's method starts from the unknowns of that solution for all inputs; first and second derivatives are exact.

    Args:
        model: the model; for a scene in exact contact the one that :func:`relaxed_contact` makes of it.
        near: the equilibrium from which it starts.
        iterations: most steps.
        parameters: whether the parameters of the scene, if it names some, are an argument; by default they have the
            scene's values. Parameters of relaxed contact are always an argument.

    Returns:
        inputs, or (inputs, p), ↦ (x, excess): ``excess`` is the squared relative residual over its squared tolerance.
        Only if it is at most 1 is x an equilibrium, with meaningful derivatives; it is NaN if the residual is. A
        problem needs a constraint on it; ``lifted`` needs none.
    """
    if isinstance(model, RelaxedContact):
        start = model.near(near)
    else:
        refuse_obstacles(model.scene, "an embedded model", RELAXED)
        start = near.x
        if not parameters:
            model = model.at()
    options = {
        # A decimal below what the excess certifies, so that Newton's last step does not decide.
        "abstol": CERTIFIED / 10,
        "max_iter": iterations,
        "error_on_fail": False,
        "jacobian_function": model.jacobian,
    }
    finder = ca.rootfinder("equilibrium", "newton", model.residual, options)
    given = model.residual.mx_in()[1:]
    x = finder(ca.DM(start), *given)
    residual = model.residual(x, *given)
    # Squares, since the norm has no derivative where the residual is zero.
    scale = CERTIFIED**2 * (1 + ca.sumsqr(x))
    excess = ca.sumsqr(residual) / scale
    return ca.Function(
        "embedded",
        given,
        [x, excess],
        model.residual.name_in()[1:],
        ["x", "excess"],
    )
