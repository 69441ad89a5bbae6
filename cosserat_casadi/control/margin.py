"""Margin of an equilibrium from instability, as a function that an optimiser can bound.

The second variation of the energy is compared with that of the elastic energy of the unloaded rods, over the admissible
variations. Its smallest eigenvalue is the remaining share of the elastic stiffness under loads: 1 − P/P_c for a column
under the thrust P, zero at a critical equilibrium, for any units and number of modes. It has a kink where two
eigenvalues meet, which is common in symmetric robots. The margin is the soft minimum −w log Σ exp(−λ/w): smooth, never
above the smallest eigenvalue, and below it by at most w times the logarithm of the number of eigenvalues. It depends on
all eigenvalues, so that an optimiser cannot escape to a higher one, as it may if one eigenpair is part of the
problem.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from cosserat_casadi.control.soft_minimum import soft_minimum
from cosserat_casadi.equilibrium.solve import check_potential
from cosserat_casadi.equilibrium.stability import variations
from cosserat_casadi.errors import Problem, refuse
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.obstacle_checks import refuse_obstacles
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.small_motions import quaternion_growth

WIDTH = 0.02
"""Width w of the soft minimum."""


def stability_margin(model: Model, width: float = WIDTH, *, parameters: bool = False) -> ca.Function:
    """Make a smooth lower bound of the smallest eigenvalue of the second variation, relative to the elastic stiffness.

    If it is positive, ``solve`` judges the equilibrium stable, over the same variations, which supports, joints and
    cables of given length admit. First and second derivatives are exact, also at multiple eigenvalues. NumPy computes
    the eigenvalues, so the function cannot be exported to C.

    Args:
        model: model with loads that have a potential, without stops and cables that may go slack.
        width: width w of the soft minimum.
        parameters: whether the parameters of the scene, if it names some, are an argument; by default they have the
            scene's values. The elastic stiffness for comparison always has the scene's values.

    Returns:
        (x, inputs), or (x, inputs, p), ↦ margin; off equilibrium the margin of the symmetric part of the Jacobian
        there. NaN if x or inputs are, or if a body may move without strain in the rods.

    Raises:
        SceneError: the loads have no potential, a cable may go slack, or a joint has a stop.
        ValueError: the width is not positive, or not finite.
    """
    refuse_obstacles(model.scene, "a margin of stability")
    if not 0.0 < width < np.inf:
        raise ValueError(f"the width of a soft minimum is positive and finite, got {width}")
    nominal = model.at()
    check_potential(nominal, nominal.pack())
    _refuse_slack(nominal)
    if not parameters:
        model = nominal
    given = model.residual.mx_in()
    bordered = _bordered(model, given)
    measure = _elastic(nominal).tobytes()
    margin = soft_minimum(measure, bordered.shape[0], width)(bordered)
    return ca.Function(
        "stability_margin",
        given,
        [margin],
        model.residual.name_in(),
        ["margin"],
    )


def _refuse_slack(model: Model) -> None:
    """Refuse cables and stops that hold the rod only in some states, where eigenvalues jump."""
    problems = []
    for i, actuator in enumerate(model.scene.actuators):
        if EFFECTS[actuator.kind].may_go_slack(actuator):
            reason = "a cable that may go slack makes eigenvalues jump"
            problems.append(Problem(f"actuators[{i}].slack", reason, "give it slack = false"))
    stops = model.discrete.stops
    problems += [Problem(stop.owner, "a stop makes eigenvalues jump", "leave it out") for stop in stops]
    refuse(problems)


def _energy_units(model: Model) -> FloatArray:
    """Energy unit of each free unknown, over the largest one, shape (n,)."""
    units = variations(model).units
    largest = units.max(initial=0.0)
    return np.asarray(units / largest)


def _bordered(model: Model, given: list[Matrix]) -> Matrix:
    """Second variation, bordered by the linearised constraints and the norms of quaternions, symmetric.

    Args:
        model: model with or without parameters.
        given: arguments x, inputs, and p if the model has parameters.
    """
    admissible = variations(model)
    jacobian = model.jacobian(*given)[0]
    free = admissible.free.tolist()
    held = admissible.held.tolist()
    # Each row of the residual is divided by the unit of its rod: times these units the rows are energies.
    stiffness = ca.diag(ca.DM(_energy_units(model))) @ jacobian[free, free]
    symmetric = (stiffness + stiffness.T) / 2
    constraints = ca.vertcat(jacobian[held, free], _quaternion_growth(model, given[0])[:, free])
    corner = ca.MX(constraints.shape[0], constraints.shape[0])
    blocks = [[symmetric, constraints.T], [constraints, corner]]
    bordered: Matrix = ca.densify(ca.blockcat(blocks))
    return bordered


def _quaternion_growth(model: Model, x: Matrix) -> Matrix:
    """Variation of the norm of each floating frame's quaternion, which moves nothing and is excluded, k×size."""
    at_start = quaternion_growth(model, np.zeros(model.size))
    # The growth is affine in x, each entry in its own unknown.
    slopes = quaternion_growth(model, np.ones(model.size)) - at_start
    return ca.sparsify(ca.DM(at_start)) + ca.sparsify(ca.DM(slopes)) * ca.repmat(x.T, len(slopes), 1)


def _elastic(model: Model) -> FloatArray:
    """Second variation of the elastic energy of the unloaded rods, n×n; zero for floating frames."""
    # At load factor 0 the loads are gone and constraints yield: on the rods' own blocks only elasticity is left.
    jacobian = model.path_jacobian(model.unloaded(), model.pack(), 0.0).full()
    elastic = np.zeros_like(jacobian)
    for _, rod_slice in model.discrete.unknowns.of_kind(BlockKind.STRAIN):
        elastic[rod_slice, rod_slice] = jacobian[rod_slice, rod_slice]
    free = variations(model).free
    units = _energy_units(model)
    scaled = units[:, None] * elastic[np.ix_(free, free)]
    return np.asarray((scaled + scaled.T) / 2)
