"""The equilibria of all cases at once, as functions of inputs and parameters, tracked as these change.

Newton's method runs on all cases together, each with its own Jacobian, from the prediction of the sensitivities. A case
that strays is followed along the straight line to the new inputs and parameters, with steps as long as it allows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.judge import MAX_DISTANCE
from cosserat_casadi.equilibrium.load_path import continuation_limits, input_path, load_path
from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers, past_no_obstacle, places_along
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, stability_of, variations
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.continuation import Path, follow
from cosserat_casadi.numerics.newton import NewtonSettings
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.tubes.tube_functions import AnyModel, TubeFunctions
from cosserat_casadi.tubes.tube_solve import solve_at
from cosserat_casadi.tubes.tube_stability import stability_of as stability_of_tubes

STEPS = 12
"""Most Newton steps of all cases together; cases that have not converged by then are followed one by one."""

CONTRACTION = 0.05
"""Largest ratio of residuals after and before a step with an old Jacobian at which the Jacobian is kept."""

NOT_FOLLOWED = "The search could not follow its equilibrium from the scene's numbers to the first guess."
"""Reason for a case without an equilibrium at the start of the search."""

Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Point:
    """Equilibria of all cases.

    Attributes:
        x: unknowns, shape (cases, size).
        inputs: stacked inputs, shape (cases, size of the inputs).
        p: parameters, shape (size of the parameters,).
        inverses: inverses of Jacobians at or near x, shape (cases, size, size).
    """

    x: FloatArray
    inputs: FloatArray
    p: FloatArray
    inverses: FloatArray

    def chosen(self, kept: Sequence[int]) -> Point:
        """The equilibria of some cases."""
        return Point(self.x[kept], self.inputs[kept], self.p, self.inverses[kept])

    def joined(self, other: Point) -> Point:
        """The equilibria of these cases, then of others at the same parameters."""
        pairs = [(self.x, other.x), (self.inputs, other.inputs), (self.inverses, other.inverses)]
        x, inputs, inverses = map(np.concatenate, pairs)
        return Point(x, inputs, self.p, inverses)


class Equilibria:
    """The equations of all cases.

    Attributes:
        model: model of the scene, with its parameters.
        cases: number of cases.
        sought: mask of the cases that must be in equilibrium, shape (cases,); the others stay unloaded.
        barred: mask of the cases with a refused step, through a smooth bar, ball or rod, shape (cases,).
    """

    def __init__(self, model: AnyModel, cases: int, unloaded: Flags | None = None) -> None:
        self.model = model
        self.cases = cases
        self.sought: Flags = np.ones(cases, dtype=bool) if unloaded is None else ~unloaded
        self.barred: Flags = np.zeros(cases, dtype=bool)
        self._tolerance = NewtonSettings()
        self._mapped: dict[str, ca.Function] = {}
        self._watched = None if isinstance(model, TubeFunctions) or not SmoothBarriers(model).any else model
        """The model, if it has smooth bars, balls or rods through which no step may lead; else None."""

    def _over_cases(self, name: str, x: FloatArray, inputs: FloatArray, p: FloatArray) -> ca.DM:
        """Evaluate a function of the model at all cases, side by side; it is mapped at its first use."""
        if name not in self._mapped:
            shared = [2] if self.model.parameters.size else []
            self._mapped[name] = getattr(self.model, name).map("mapped", "serial", self.cases, shared, [])
        parameters = [p] if self.model.parameters.size else []
        # A Jacobian comes with the residual behind it.
        first: ca.DM = self._mapped[name].call([x.T, inputs.T, *parameters])[0]
        return first

    def residuals(self, x: FloatArray, inputs: FloatArray, p: FloatArray) -> FloatArray:
        """Residuals of all cases, shape (cases, size)."""
        return np.asarray(self._over_cases("residual", x, inputs, p).full().T)

    def jacobians(self, x: FloatArray, inputs: FloatArray, p: FloatArray) -> FloatArray:
        """Jacobians of all cases, shape (cases, size, size)."""
        return split(self._over_cases("jacobian", x, inputs, p), self.cases)

    def by_inputs(self, point: Point) -> FloatArray:
        """Derivatives of the residuals by the inputs, shape (cases, size, size of the inputs)."""
        return split(self._over_cases("input_jacobian", point.x, point.inputs, point.p), self.cases)

    def by_parameters(self, point: Point) -> FloatArray:
        """Derivatives of the residuals by the parameters, shape (cases, size, size of the parameters)."""
        return split(self._over_cases("parameter_jacobian", point.x, point.inputs, point.p), self.cases)

    def started(
        self, inputs: FloatArray, wanted: FloatArray, first_p: FloatArray, p: FloatArray
    ) -> tuple[Point, list[str]]:
        """Solve for the equilibria from which a search begins; also return why a case has none there.

        Args:
            inputs: inputs of the scene, which are solved first, shape (cases, size of the inputs).
            wanted: inputs at the start of the search, shape (cases, size of the inputs).
            first_p: parameters of the scene.
            p: parameters at the start of the search.

        Returns:
            the equilibria, and a sentence for each case, empty if it has one.
        """
        point, outcomes = self.loaded(inputs, first_p)
        # The path leads from the scene's numbers to the start, if a bound or another value moves the start.
        moved, reached = self.tracked(point, point.x, wanted, p)
        converged = np.array([outcome is Outcome.CONVERGED for outcome in outcomes])
        if not np.all(converged & reached) and (np.any(p != first_p) or np.any(wanted != point.inputs)):
            # There may be an equilibrium where the search begins, and none at the scene's own numbers.
            direct, direct_outcomes = self.loaded(wanted, p)
            for i in np.flatnonzero(~(converged & reached)):
                if direct_outcomes[i] is Outcome.CONVERGED:
                    moved.x[i] = direct.x[i]
                    outcomes[i] = Outcome.CONVERGED
                    reached[i] = True
        reasons = []
        for i, outcome in enumerate(outcomes):
            reason = "" if reached[i] else NOT_FOLLOWED
            if outcome is not Outcome.CONVERGED:
                reason = outcome.value
            elif not reason and resolution_index(self.model, moved.x[i], moved.inputs[i], p) > 1.0:
                reason = Outcome.UNRESOLVED.value
            reasons.append(reason)
        # Cases that were reached in another way have other Jacobians.
        return self.at_point(moved), reasons

    def loaded(self, inputs: FloatArray, p: FloatArray) -> tuple[Point, list[Outcome]]:
        """Solve for the equilibria at the ends of load paths; also return the outcome of each path.

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
        """Follow one load path, or the path from straight tubes; return its end and outcome."""
        model = self.model
        if isinstance(model, TubeFunctions):
            solution = solve_at(model.at(p), inputs)
            return solution.x, solution.outcome
        given = p if model.parameters.size else None
        path = load_path(model, inputs, given)
        path = past_no_obstacle(path, model, (inputs, inputs), None if given is None else (given, given))
        end = follow(path, continuation_limits(model))
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
        """Return the equilibria with inverse Jacobians that are computed at them."""
        return Point(point.x, point.inputs, point.p, self._inverses(point.x, point.inputs, point.p))

    def sensitivities(self, point: Point, p_by_all: FloatArray, inputs_by_all: FloatArray) -> FloatArray:
        """Derivatives of the equilibria by the unknowns of each case, shape (cases, size, unknowns).

        Args:
            point: the equilibria, with Jacobians that are computed at them.
            p_by_all: derivatives of the parameters by these unknowns, shape (parameters, unknowns).
            inputs_by_all: derivatives of the inputs of each case, shape (cases, inputs, unknowns).
        """
        by_all = np.zeros((*point.x.shape, p_by_all.shape[1]))
        if np.any(p_by_all):
            by_all += self.by_parameters(point) @ p_by_all
        if np.any(inputs_by_all):
            by_all += self.by_inputs(point) @ inputs_by_all
        return np.where(self.sought[:, None, None], -point.inverses @ by_all, 0.0)

    def unstable(self, point: Point) -> Flags:
        """Mask of the cases with an unstable equilibrium, if stability has a meaning, shape (cases,)."""
        jacobians = self.jacobians(point.x, point.inputs, point.p)
        flags = np.zeros(self.cases, dtype=bool)
        is_stable = self._stability(point.p)
        for i, (x, inputs, jacobian) in enumerate(zip(point.x, point.inputs, jacobians, strict=True)):
            if self.sought[i] and self.model.has_potential(inputs):
                flags[i] = not is_stable(x, inputs, jacobian)
        return flags

    def _stability(self, p: FloatArray) -> Callable[[FloatArray, FloatArray, FloatArray], bool]:
        """Make (x, inputs, Jacobian) ↦ whether an equilibrium with these parameters is stable."""
        model = self.model
        if not isinstance(model, TubeFunctions):
            allowed = variations(model)
            return lambda x, inputs, jacobian: bool(stability_of(admissible_eigenvalues(jacobian, allowed)).stable)
        try:
            bound = model.at(p)
        except SceneError:
            # Numbers that the scene refuses are no tubes whose stability could be told.
            return lambda x, inputs, jacobian: True
        return lambda x, inputs, jacobian: bool(stability_of_tubes(bound, x, inputs).stable)

    def tracked(
        self, near: Point, predicted: FloatArray, inputs: FloatArray, p: FloatArray, *, far: bool = True
    ) -> tuple[Point, Flags]:
        """Follow equilibria to other inputs and parameters on their branches; also return which were reached.

        Args:
            near: initial equilibria.
            predicted: initial guess of the unknowns, shape (cases, size).
            inputs: stacked inputs, shape (cases, size of the inputs).
            p: parameters.
            far: whether cases that Newton's method does not reach are followed along a path.
        """
        x, inverses, converged = self._newton(predicted, inputs, p, near.inverses)
        moved = np.linalg.norm((x - predicted)[:, self.model.shape_unknowns], axis=1)
        reached = converged & (moved <= MAX_DISTANCE)
        reached &= ~self._barred(near, x, inputs, p, reached)
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
        """Run Newton's method on all cases; return unknowns, inverse Jacobians, and the mask of converged cases."""
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
        """Make the path of one case on the straight line to other inputs and parameters, through no obstacle."""
        model = self.model
        ends = (near.inputs[case], model.inputs.nearer(near.inputs[case], inputs))
        parameters = (near.p, model.parameters.nearer(near.p, p)) if model.parameters.size else None
        path = input_path(model, near.x[case], *ends, parameters)
        return path if isinstance(model, TubeFunctions) else past_no_obstacle(path, model, ends, parameters)

    def _barred(self, near: Point, x: FloatArray, inputs: FloatArray, p: FloatArray, reached: Flags) -> Flags:
        """Mask of the reached cases that would pass through a smooth bar, ball or rod on the way, shape (cases,)."""
        barred: Flags = np.zeros(self.cases, dtype=bool)
        if self._watched is None:
            return barred
        try:
            places = None if np.array_equal(near.p, p) else places_along(self._watched, (near.p, p))
            after = SmoothBarriers(self._watched.at(p))
            for case in np.flatnonzero(reached & self.sought):
                ends = (near.inputs[case], inputs[case])
                barred[case] = after.are_between(near.x[case], x[case], ends, places)
        except SceneError:
            # The scene refuses such parameters: where its rods would be is not known.
            return reached
        self.barred |= barred
        return barred


def resolution_index(model: AnyModel, x: FloatArray, inputs: FloatArray, p: FloatArray) -> float:
    """Resolution index, above 1 if the nodes do not resolve the rods, or the steps the tubes."""
    parameters: list[FloatArray] = [p] if model.parameters.size else []
    return float(model.resolution_index(x, inputs, *parameters))


def split(columns: ca.DM, cases: int) -> FloatArray:
    """Split matrices side by side into an array, shape (cases, rows, columns)."""
    rows, width = columns.shape
    return np.asarray(columns.full().reshape(rows, cases, width // cases).transpose(1, 0, 2))


def _relative(residual: FloatArray, x: FloatArray) -> FloatArray:
    """Norms of the residuals over one plus norms of the unknowns, shape (cases,); infinite if not finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        norms = np.linalg.norm(residual, axis=1) / (1 + np.linalg.norm(x, axis=1))
    return np.where(np.isfinite(norms), norms, np.inf)
