"""The inverse problem of rods in exact contact: least squares over equilibria, each solved with its contacts.

The errors of the targets are functions of the inputs that are smooth while the contacts stay, and have a kink where
they change. Each turn takes the shortest change of the inputs that ends the linearised errors, no farther than was
believed before, and keeps the equilibrium there if it is nearer to the targets. Where other contacts hold there and it
is not, the next turn tries with the derivatives of that side.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.control.decision_variables import decision_variables, scales
from cosserat_casadi.control.inverse_result import Inverse, gap_left
from cosserat_casadi.control.nearby_inputs import SETTLED, shortest
from cosserat_casadi.control.sought_inputs import SoughtInputs
from cosserat_casadi.control.targets import wanted_poses, weighted_errors
from cosserat_casadi.equilibrium.contact.contact_search import equations_at
from cosserat_casadi.equilibrium.contact.contact_state import given_inputs
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.equilibrium.solve import check_potential
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.system_functions import SystemFunctions

MOST_TURNS = 20
"""Equilibria that are tried from one start."""

FIRST_DAMPING = 1e-1
"""Weight of the square of the first change of the inputs, in their scales, beside the squares of the errors."""

MOST_DAMPING = 1e8
"""Weight of the square of a change of the inputs from which on a search ends that comes no nearer."""

EASED = 10.0
"""Factor by which that weight falls after a turn that has come nearer."""

TIGHTENED = 5.0
"""Factor by which that weight grows after a turn that has come no nearer."""

NEARER = 0.1
"""Share of the expected decrease of the error that a turn has to reach."""


@dataclass(frozen=True)
class _AtPlaces:
    """A model as targets ask for it: functions of unknowns and inputs, the places of contact being given."""

    model: Model
    places: ca.MX

    def __getattr__(self, name: str) -> Any:
        member = getattr(self.model, name)
        if name == "lengths" or not self.places.shape[0]:
            return member
        # Parameters stand behind the inputs.
        return {owner: self._at_places(function) for owner, function in member.items()}

    def _at_places(self, function: ca.Function) -> Callable[..., Any]:
        return lambda x, inputs, *more: function(x, inputs, self.places, *more)


@dataclass(frozen=True)
class ContactProblem(SoughtInputs):
    """Decision variables alone: the unknowns follow by solves."""

    def solve(self, start: Equilibrium[Any], change: FloatArray) -> Inverse:
        """Damped steps between equilibria, each with its own contacts."""
        here = self._at(start, change)
        if not here.solution.converged:
            return here
        lower, upper = self.ranges()
        linear = self._linearised(here.solution)
        damping = FIRST_DAMPING
        turns = 0
        while turns < MOST_TURNS and linear is not None and damping < MOST_DAMPING:
            errors, moved = linear
            # The damped change within ranges after which least is left of the errors.
            damped = np.vstack([moved, np.sqrt(damping) * np.eye(len(change))])
            padded = np.concatenate([errors, np.zeros(len(change))])
            step = shortest(damped, padded, lower - change, upper - change)
            if float(np.abs(step).max(initial=0.0)) <= SETTLED:
                break
            turns += 1
            there = self._at(here.solution, change + step)
            before, after = gap_left(here), gap_left(there)
            expected = before - float(np.linalg.norm(errors + moved @ step))
            # Off a stable branch steps would go far for little.
            leaves = there.unstable and not here.unstable
            if after < before and before - after >= NEARER * expected and not leaves:
                damping /= EASED
                here, change = there, change + step
                linear = self._linearised(here.solution)
            else:
                damping *= TIGHTENED
        return replace(here, rounds=turns)

    def _at(self, start: Equilibrium[Any], change: FloatArray) -> Inverse:
        return self.judged(start if start.converged else None, change, rounds=0)

    def _linearised(self, solution: Equilibrium[Any]) -> tuple[FloatArray, FloatArray] | None:
        """Errors of an equilibrium, shape (m,), and what changes of n inputs in their scales move them by, (m, n).

        None where its contacts leave it no derivatives.
        """
        assert isinstance(solution, Solution), "rods alone touch obstacles"
        equations, z = equations_at(solution)
        model = equations.model
        x = ca.MX.sym("x", model.size)
        inputs = ca.MX.sym("inputs", model.inputs.size)
        places = model.parameters.symbol
        wanted = ca.MX(wanted_poses(self.targets))
        errors = weighted_errors(_AtPlaces(model, places), self.targets, wanted, x, inputs)
        symbols = [x, inputs, places]
        by_arguments = ca.horzcat(*[ca.jacobian(errors, symbol) for symbol in symbols])
        function = ca.Function("errors", symbols, [errors, by_arguments])
        values, by_all = (part.full() for part in function(*equations.arguments(z)))
        by_variables = np.eye(len(equations.given))[:, self.variables.indices] * self.scale
        unmoved = np.zeros((0, len(self.scale)))
        by_z = equations.moved(z, by_variables, unmoved)
        moved = by_all @ equations.arguments_moved(by_z, by_variables, unmoved)
        return (values[:, 0], moved) if np.all(np.isfinite(moved)) else None


def contact_problem(
    model: SystemFunctions, targets: tuple[scenes.Target, ...], start: Solution, stable: bool
) -> ContactProblem:
    """The problem of a model of rods in exact contact, with the arguments of :func:`lifted_problem`."""
    variables = decision_variables(model)
    given = given_inputs(start.model, start.inputs)
    if stable:
        check_potential(start.model, start.inputs)
    return ContactProblem(model, targets, variables, scales(model, variables, start), variables.clipped(given))
