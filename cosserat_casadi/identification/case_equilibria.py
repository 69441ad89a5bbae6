"""The equilibria of all cases at once, as functions of inputs and parameters, tracked as these change.

Newton's method runs on all cases together, each with its own Jacobian, from what the sensitivities predict. A case that
strays is followed along the straight line to the new inputs and parameters, with steps as long as it allows.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.judge import MAX_DISTANCE
from cosserat_casadi.equilibrium.load_path import column, continuation_limits, load_path
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.continuation import Path, follow
from cosserat_casadi.numerics.newton import NewtonSettings
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.tubes.tube_functions import AnyModel, TubeFunctions
from cosserat_casadi.tubes.tube_solve import solve_at

STEPS = 12
"""Newton steps of all cases together; cases that have not converged by then are followed one by one."""

CONTRACTION = 0.05
"""Share of the residual that a step with an earlier Jacobian may leave; else the next one has a new Jacobian."""

Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Point:
    """Equilibria of all cases.

    Attributes:
        x: unknowns, shape (cases, size).
        inputs: stacked inputs, shape (cases, size of the inputs).
        p: parameters, shape (size of the parameters,).
        inverses: of Jacobians at or near x, shape (cases, size, size).
    """

    x: FloatArray
    inputs: FloatArray
    p: FloatArray
    inverses: FloatArray


class Equilibria:
    """The equations of all cases.

    Attributes:
        model: of the scene, with its parameters.
        cases: their number.
        sought: which cases are to be in equilibrium, shape (cases,); the others stay unloaded.
    """

    def __init__(self, model: AnyModel, cases: int, unloaded: Flags | None = None) -> None:
        self.model = model
        self.cases = cases
        self.sought: Flags = np.ones(cases, dtype=bool) if unloaded is None else ~unloaded
        self._tolerance = NewtonSettings()
        self._residual = self._mapped(model.residual)
        self._jacobian = self._mapped(model.jacobian)
        self._moved = model.shape_unknowns
        self._input_jacobian: ca.Function | None = None
        self._parameter_jacobian: ca.Function | None = None

    def _mapped(self, function: ca.Function) -> ca.Function:
        """A function of x and inputs, and perhaps of p, for all cases that share p."""
        return mapped(function, self.cases, has_parameters=self.model.parameters.size > 0)

    def residuals(self, x: FloatArray, inputs: FloatArray, p: FloatArray) -> FloatArray:
        """Residuals of all cases, shape (cases, size)."""
        residuals: FloatArray = self._residual(*self._arguments(x, inputs, p)).full().T
        return residuals

    def jacobians(self, x: FloatArray, inputs: FloatArray, p: FloatArray) -> FloatArray:
        """Jacobians of all cases, shape (cases, size, size)."""
        return split(self._jacobian(*self._arguments(x, inputs, p))[0], self.cases)

    def by_inputs(self, point: Point) -> FloatArray:
        """Derivatives of the residuals with the inputs, shape (cases, size, size of the inputs)."""
        if self._input_jacobian is None:
            self._input_jacobian = self._mapped(self.model.input_jacobian)
        return split(self._input_jacobian(*self._arguments(point.x, point.inputs, point.p)), self.cases)

    def by_parameters(self, point: Point) -> FloatArray:
        """Derivatives of the residuals with the parameters, shape (cases, size, size of the parameters)."""
        if self._parameter_jacobian is None:
            self._parameter_jacobian = self._mapped(self.model.parameter_jacobian)
        return split(self._parameter_jacobian(*self._arguments(point.x, point.inputs, point.p)), self.cases)

    def _arguments(self, x: FloatArray, inputs: FloatArray, p: FloatArray) -> list[FloatArray]:
        return [x.T, inputs.T, p] if self.model.parameters.size else [x.T, inputs.T]

    def loaded(self, inputs: FloatArray, p: FloatArray) -> tuple[Point, list[Outcome]]:
        """The equilibria at the ends of the load paths, and how each path ended.

        Args:
            inputs: stacked inputs, shape (cases, size of the inputs).
            p: parameters, shape (size of the parameters,).
        """
        x = np.zeros((self.cases, self.model.size))
        outcomes = []
        for case in range(self.cases):
            if not self.sought[case]:
                outcomes.append(Outcome.CONVERGED)
                continue
            x[case], outcome = self._loaded(inputs[case], p)
            outcomes.append(outcome)
        return Point(x, inputs, p, self._inverses(x, inputs, p)), outcomes

    def _loaded(self, inputs: FloatArray, p: FloatArray) -> tuple[FloatArray, Outcome]:
        """The end of one load path, of tubes of that from straight ones, and how it ended."""
        model = self.model
        if isinstance(model, TubeFunctions):
            solution = solve_at(model.at(p), inputs)
            return solution.x, solution.outcome
        given = p if model.parameters.size else None
        end = follow(load_path(model, inputs, given), continuation_limits(model))
        return end.x, end.outcome

    def _inverses(self, x: FloatArray, inputs: FloatArray, p: FloatArray) -> FloatArray:
        jacobians = self.jacobians(x, inputs, p)
        try:
            inverses = np.asarray(np.linalg.inv(jacobians))
        except np.linalg.LinAlgError:
            # One singular matrix stops them all; a pseudo-inverse there leaves it to the residual to tell.
            finite = np.where(np.isfinite(jacobians), jacobians, 0.0)
            inverses = np.asarray(np.linalg.pinv(finite))
        return inverses

    def at_point(self, point: Point) -> Point:
        """The same equilibria with Jacobians that are of them."""
        return Point(point.x, point.inputs, point.p, self._inverses(point.x, point.inputs, point.p))

    def tracked(
        self, near: Point, predicted: FloatArray, inputs: FloatArray, p: FloatArray, *, far: bool = True
    ) -> tuple[Point, Flags]:
        """The equilibria at other inputs and parameters, on the branches of those near, and which could be reached.

        Args:
            near: equilibria to come from.
            predicted: unknowns to begin with, shape (cases, size).
            inputs: stacked inputs, shape (cases, size of the inputs).
            p: parameters.
            far: whether cases that Newton's method does not reach from there are followed along a path.
        """
        x, inverses, converged = self._newton(predicted, inputs, p, near.inverses)
        moved = np.linalg.norm((x - predicted)[:, self._moved], axis=1)
        reached = converged & (moved <= MAX_DISTANCE)
        astray = np.flatnonzero(~reached & far)
        for case in astray:
            end = follow(self._path(near, int(case), inputs[case], p), continuation_limits(self.model))
            if end.outcome is Outcome.CONVERGED:
                x[case] = end.x
                reached[case] = True
        return Point(x, inputs, p, inverses), reached

    def _newton(
        self, start: FloatArray, inputs: FloatArray, p: FloatArray, inverses: FloatArray
    ) -> tuple[FloatArray, FloatArray, Flags]:
        """Newton's method on all cases: unknowns, inverse Jacobians, and which cases converged."""
        x = start.copy()
        residual = self.residuals(x, inputs, p)
        norms = np.where(self.sought, _relative(residual, x), 0.0)
        fresh = False
        for _ in range(STEPS):
            waiting = norms > self._tolerance.aim
            if not np.any(waiting):
                break
            tried = x - np.einsum("cij,cj->ci", inverses, residual)
            tried[~waiting] = x[~waiting]
            tried_residual = self.residuals(tried, inputs, p)
            tried_norms = np.where(self.sought, _relative(tried_residual, tried), 0.0)
            better = waiting & (tried_norms < norms)
            slow = waiting & ~(tried_norms <= CONTRACTION * norms) & (norms > self._tolerance.tolerance)
            x[better] = tried[better]
            residual[better] = tried_residual[better]
            norms[better] = tried_norms[better]
            if np.any(slow):
                # A step with a Jacobian of this very place that does not help never will.
                if fresh and not np.any(better):
                    break
                inverses = self._inverses(x, inputs, p)
                fresh = True
            elif not np.any(better):
                break
            else:
                fresh = False
        return x, inverses, norms <= self._tolerance.tolerance

    def _path(self, near: Point, case: int, inputs: FloatArray, p: FloatArray) -> Path:
        """The path of one case on the straight line to other inputs and parameters."""
        model = self.model
        inputs_change = inputs - near.inputs[case]
        p_change = p - near.p

        def given(t: float) -> list[FloatArray]:
            values = [near.inputs[case] + t * inputs_change]
            if model.parameters.size:
                values.append(near.p + t * p_change)
            return values

        def residual(x: FloatArray, t: float) -> FloatArray:
            return column(model.residual(x, *given(t)))

        def jacobian(x: FloatArray, t: float) -> FloatArray:
            dense: FloatArray = model.jacobian(x, *given(t))[0].full()
            return dense

        def rate(x: FloatArray, t: float) -> FloatArray:
            arguments = given(t)
            change = np.zeros(model.size)
            if np.any(inputs_change):
                change += column(model.input_jacobian(x, *arguments) @ inputs_change)
            if np.any(p_change):
                change += column(model.parameter_jacobian(x, *arguments) @ p_change)
            return change

        return Path(residual, jacobian, rate, near.x[case], step_weights=model.step_weights)


def mapped(function: ca.Function, cases: int, *, has_parameters: bool) -> ca.Function:
    """A function of x, inputs and perhaps p, and of more, for all cases, whose columns stand side by side."""
    shared = [2] if has_parameters else []
    return function.map("mapped", "serial", cases, shared, [])


def split(columns: ca.DM, cases: int) -> FloatArray:
    """Matrices side by side as an array, shape (cases, rows, columns)."""
    rows, width = columns.shape
    return np.asarray(columns.full().reshape(rows, cases, width // cases).transpose(1, 0, 2))


def _relative(residual: FloatArray, x: FloatArray) -> FloatArray:
    """Norms of the residuals over one plus those of the unknowns, shape (cases,); infinite where not finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        norms = np.linalg.norm(residual, axis=1) / (1 + np.linalg.norm(x, axis=1))
    return np.where(np.isfinite(norms), norms, np.inf)
