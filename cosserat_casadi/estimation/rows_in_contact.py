"""Inputs that explain rows of measurements for rods in exact contact, in Python, row by row.

Each row is a fit of all its numbers, whose equilibrium is followed with its contacts
(identification/case_contacts.py), with the derivatives and the prior knowledge of the solver in C.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.estimator import ENDINGS, Estimates, Knowledge, MeasuredCases
from cosserat_casadi.equilibrium.contact.shape_projection import projected
from cosserat_casadi.estimation.stacking import differences
from cosserat_casadi.identification.case_contacts import CaseInContact, ContactEquilibria
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.numerics.arrow_least_squares import ArrowFit, FitOutcome, Limits


@dataclass(frozen=True)
class _State:
    """State of a row at some values of its numbers.

    Attributes:
        shared: the numbers, shape (k,).
        own: empty array of block unknowns, shape (1, 0).
        case: the equilibrium.
        residual: differences in standard deviations, shape (rows,).
        by_numbers: derivatives of the residual by the numbers, shape (rows, k).
        z_by_numbers: derivatives of the solution z in contact by the numbers, shape (len(z), k).
    """

    shared: FloatArray
    own: FloatArray
    case: CaseInContact
    residual: FloatArray
    by_numbers: FloatArray
    z_by_numbers: FloatArray


@dataclass(frozen=True)
class _Row:
    """One row as a problem of least squares.

    Attributes:
        solver: the solver of all rows.
        table: table with this row alone.
    """

    solver: RowsInContact
    table: MeasuredCases

    @property
    def offsets(self) -> npt.NDArray[np.int64]:
        """Start and end of the single block of residuals, shape (2,)."""
        return np.array([0, self.table.weights.size])

    def inputs_and_parameters(self, numbers: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Inputs and parameters for values of the numbers."""
        both = self.table.inputs[0].copy()
        both[self.solver.indices] = numbers
        inputs = self.solver.model.inputs.size
        return both[:inputs], both[inputs:]

    def first(self, numbers: FloatArray) -> _State | None:
        """Solve the row at initial numbers; None if it has no equilibrium."""
        inputs, p = self.inputs_and_parameters(numbers)
        point, reasons = self.solver.equilibria.started(inputs[None], inputs[None], p, p)
        return None if reasons[0] else self._state(numbers, point.settled[0])

    def at(self, shared: FloatArray, own: FloatArray, near: _State) -> _State | None:
        """Follow the row to other numbers; None if its equilibrium cannot be followed there."""
        predicted = near.case.z + near.z_by_numbers @ (shared - near.shared)
        case = self.solver.equilibria.followed(near.case, predicted, *self.inputs_and_parameters(shared))
        state = None if case is None else self._state(shared, case)
        return state if state is not None and np.all(np.isfinite(state.by_numbers)) else None

    def jacobian(self, state: _State) -> FloatArray:
        """Derivatives of the residual by the numbers, shape (rows, k)."""
        return state.by_numbers

    def _state(self, numbers: FloatArray, case: CaseInContact) -> _State:
        """Make the state of the row at an equilibrium, with derivatives for constant contacts."""
        equations = case.equations
        chosen = np.zeros((self.table.inputs.shape[1], len(numbers)))
        chosen[self.solver.indices, np.arange(len(numbers))] = 1.0
        by_inputs, by_parameters = np.split(chosen, [self.solver.model.inputs.size])
        z_by_numbers = equations.moved(case.z, by_inputs, by_parameters)
        x, inputs, p = equations.arguments(case.z)
        measured = self.solver.measured(equations.model)
        given = np.concatenate([inputs, p])
        value, by_x, by_given = measured(x, given, self.table.at[0], self.table.measured[0])
        moved = equations.arguments_moved(z_by_numbers, by_inputs, by_parameters)
        weights = self.table.weights[0]
        by_numbers = weights[:, None] * (np.hstack([by_x.full(), by_given.full()]) @ moved)
        return _State(numbers, np.zeros((1, 0)), case, weights * value.full()[:, 0], by_numbers, z_by_numbers)


@dataclass(frozen=True)
class RowsInContact:
    """The solver of all rows.

    Attributes:
        model: the measured model.
        sections: number of rows of each measurement in one case, by index of the measurement.
        indices: indices of the estimated numbers among the stacked inputs, followed by parameters.
    """

    model: Model
    sections: Mapping[int, int]
    indices: list[int]

    @property
    def equilibria(self) -> ContactEquilibria:
        """Equilibria of single rows, with their contacts."""
        return ContactEquilibria(self.model, 1)

    def measured(self, model: Model) -> ca.Function:
        """Make the differences of all measurements for a model whose elements end at contacts."""
        everything = range(model.inputs.size + model.parameters.size)
        # Abscissae that differ from row to row are arguments.
        abscissae = np.outer([0.0, 1.0], np.ones(sum(self.sections.values())))
        return kept_with(model, "_differences", lambda: differences(model, dict(self.sections), everything, abscissae))

    def estimate(self, cases: MeasuredCases, known: Knowledge) -> Estimates:
        """Find the numbers that explain each row best."""
        rows = [self._estimated(cases.part(slice(i, i + 1)), known) for i in range(len(cases.inputs))]
        return Estimates.joined(rows)

    def contact_changes(
        self, cases: MeasuredCases, numbers: FloatArray, covariance: FloatArray, known: Knowledge
    ) -> dict[int, str]:
        """Contacts that open, close or change within a standard deviation of estimates, in words, by index of the row.

        Args:
            cases: all rows.
            numbers: estimates of the rows, shape (cases, k); NaN without an estimate.
            covariance: covariance of the first j numbers, with the rest held, shape (cases, j, j).
            known: prior knowledge of these j numbers, which stay within their bounds.
        """
        changes = {}
        for i in np.flatnonzero(np.isfinite(numbers).all(axis=1) & np.isfinite(covariance).all(axis=(1, 2))).tolist():
            row = _Row(self, cases.part(slice(i, i + 1)))
            state = row.first(numbers[i])
            squares, axes = np.linalg.eigh(covariance[i])
            deviations = np.sqrt(np.maximum(squares, 0.0))[:, None] * axes.T
            for step in [*deviations, *-deviations]:
                moved = numbers[i].copy()
                moved[: len(step)] = known.limits.clipped(moved[: len(step)] + step)
                beside = None if state is None else row.at(moved, np.zeros((1, 0)), state)
                if state is not None and beside is not None and state.case.touches_otherwise(beside.case):
                    changes[i] = state.case.difference(beside.case)
                    break
        return changes

    def _estimated(self, table: MeasuredCases, known: Knowledge) -> Estimates:
        row = _Row(self, table)
        limits = known.limits
        numbers = limits.clipped(table.inputs[0, self.indices])
        state = row.first(numbers)
        if state is None:
            return self._ended("no_equilibrium", table, numbers)
        if not np.all(np.isfinite(state.by_numbers)):
            return self._ended("singular", table, numbers)
        none = np.zeros(0)
        nothing = Limits(none, none, none, none, np.zeros(0, dtype=bool))
        # Contacts, and with them derivatives, may differ between two states.
        arrow = ArrowFit(row, limits, nothing, kinked=lambda one, two: np.array([one.case.touches_otherwise(two.case)]))
        fit = arrow.run(numbers, state.own, state)
        ending = "found" if fit.outcome in (FitOutcome.CONVERGED, FitOutcome.AT_KINK) else "not_found"
        ended = self._ended(ending, table, fit.shared, fit.iterations)
        by_numbers, residual = fit.state.by_numbers, fit.state.residual
        ended.cost[0] = fit.cost
        ended.information[0] = by_numbers.T @ by_numbers + np.diag(limits.weight**2)
        ended.gradient[0] = by_numbers.T @ residual + limits.weight * limits.residual(fit.shared)
        ended.residuals[0] = residual
        ended.x[0] = projected(fit.state.case.found.solution, self.model.at())
        return ended

    def _ended(self, ending: str, table: MeasuredCases, numbers: FloatArray, iterations: int = 0) -> Estimates:
        """Make the result of a search of which only the numbers are known."""
        k = len(numbers)
        return Estimates(
            outcome=np.array([ENDINGS.index(ending)]),
            iterations=np.array([iterations]),
            cost=np.full(1, np.nan),
            unknowns=numbers[None] if ending == "found" else np.full((1, k), np.nan),
            information=np.full((1, k, k), np.nan),
            gradient=np.full((1, k), np.nan),
            residuals=np.full(table.weights.shape, np.nan),
            x=np.full((1, self.model.size), np.nan),
        )

    def costs(
        self, cases: MeasuredCases, inputs: FloatArray, x: FloatArray, known: Knowledge, steps: FloatArray
    ) -> FloatArray:
        """Compute costs at some steps from estimates, shape (cases, draws); infinite without an equilibrium."""
        costs = np.full(steps.shape[:2], np.inf)
        for i, of_row in enumerate(steps):
            row = _Row(self, cases.part(slice(i, i + 1)))
            numbers = inputs[i, self.indices]
            start = row.first(numbers)
            for k, step in enumerate(of_row):
                drawn = numbers + step
                inside = np.all(drawn == known.limits.clipped(drawn))
                state = row.at(drawn, np.zeros((1, 0)), start) if start is not None and inside else None
                if state is not None:
                    prior = known.limits.residual(drawn)
                    costs[i, k] = float(state.residual @ state.residual + prior @ prior) / 2
        return costs
