"""One optimal-control problem of a quasi-static rod: what several packages are given, and its optimum by an NLP."""

from __future__ import annotations

import casadi as ca
import numpy as np

from cosserat_casadi import Model, Solution, build, solve
from cosserat_casadi.control import lifted
from examples.trace_circle import LENGTH, finger

STAGES, STEP = 4, 0.25
"""Intervals with constant rates, and the length of each, s."""

LARGEST, RATE = 2.6, 2.0
"""Bounds on the tensions, N, and on their rates, N/s; some are active at the optimum."""

GOAL = [0.095, 0.02, -0.015]
"""Where the tip is to be at the end, m."""

IPOPT = {"ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-10, "print_time": False}


def robot() -> tuple[Model, Solution]:
    """A finger with three tendons, pulled by 1 N each at first."""
    model = finger()
    return model, solve(model, raise_on_failure=True)


def robot_with_parameters(*names: str) -> Model:
    """The same finger, some numbers of which are parameters."""
    model = finger()
    return build(model.scene.model_copy(update={"parameters": names}), model.discretisation)


def arrival(model: Model, x: ca.MX, tensions: ca.MX, *parameters: ca.MX) -> ca.MX:
    """What is paid for the tip's distance from the goal at the end."""
    return 100 * ca.sumsqr((model.tip["finger"](x, tensions, *parameters)[0] - ca.DM(GOAL)) / LENGTH)


def effort(tensions: ca.MX, rates: ca.MX) -> ca.MX:
    """What is paid at the start of every interval."""
    return 1e-3 * ca.sumsqr(tensions) + 1e-3 * ca.sumsqr(rates)


def optimum(other: Model | None = None) -> np.ndarray:
    """Tensions after each interval, shape (STAGES, 3), N: the lifted rod at the end of the horizon in an Opti.

    Args:
        other: a finger with other numbers.
    """
    model, near = robot()
    if other is not None:
        model, near = other, solve(other, raise_on_failure=True)
    opti = ca.Opti()
    rates = opti.variable(3, STAGES)
    tensions = [ca.MX(ca.DM(near.inputs))]
    cost = ca.MX(0)
    for k in range(STAGES):
        cost += effort(tensions[k], rates[:, k])
        tensions.append(tensions[k] + STEP * rates[:, k])
        opti.subject_to(opti.bounded(0, tensions[k + 1], LARGEST))
    opti.subject_to(opti.bounded(-RATE, ca.vec(rates), RATE))
    rod = lifted(model, opti.variable(model.size), tensions[-1], near)
    opti.subject_to(rod.residual == 0)
    opti.set_initial(rod.x, rod.start)
    opti.minimize(cost + arrival(model, rod.x, tensions[-1]))
    opti.solver("ipopt", IPOPT)
    found = opti.solve()
    return np.array([found.value(each) for each in tensions[1:]])
