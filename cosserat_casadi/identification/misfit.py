"""How far the model is from what was measured in all cases, with exact derivatives by the implicit function theorem.

Each case has its own equilibrium g(x, inputs, p) = 0, so that dx = −(∂g/∂x)⁻¹ (∂g/∂inputs d inputs + ∂g/∂p dp).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.identification.cases import Case, Datum
from cosserat_casadi.identification.equilibria import Equilibria, Flags, Point, split
from cosserat_casadi.identification.quantities import difference
from cosserat_casadi.identification.unknowns import UnknownLayout
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model

Indices = npt.NDArray[np.int64]


class MeasuredRows:
    """All rows of one measurement.

    Attributes:
        record: the measurement.
        cases: the cases that have such rows, shape (count,).
        data: these rows, in the order of the residuals.
    """

    def __init__(self, model: Model, record: Any, rows: Sequence[tuple[int, list[Datum]]]) -> None:
        self.record = record
        self.cases: Indices = np.array([case for case, _ in rows], dtype=np.int64)
        count = len(rows)
        sections = max(len(data) for _, data in rows)
        entries = len(record.entries)
        differences = len(record.differences)
        self._at = np.zeros((count, sections))
        measured = np.zeros((count, entries, sections))
        if record.quantity == "pose":
            measured[:, 3] = 1.0
        known = np.zeros((count, sections, differences), dtype=bool)
        self.data: list[tuple[Datum, int]] = []
        self.row_cases: list[int] = []
        for i, (case, data) in enumerate(rows):
            for k, datum in enumerate(data):
                self._at[i, k] = 0.0 if np.isnan(datum.at) else datum.at
                given = np.isfinite(datum.values)
                measured[i, given, k] = datum.values[given]
                known[i, k] = given[:differences]
                for entry in np.flatnonzero(known[i, k]).tolist():
                    self.data.append((datum, entry))
                    self.row_cases.append(case)
        self._measured = measured
        self._known = known.reshape(count, sections * differences)
        deviations = np.broadcast_to(np.asarray(record.sigma, dtype=float), differences)
        self.sigma = np.tile(deviations, sections)
        function = difference(model, record, sections)
        arguments = function.mx_in()
        value = ca.Function("value", arguments, function.call(arguments)[:1])
        self._values = value.map("values", "serial", count, [2], [])
        self._derivatives = function.map("derivatives", "serial", count, [2], [])

    def _arguments(self, point: Point) -> list[FloatArray]:
        count = len(self.cases)
        at = self._at.reshape(1, -1)
        measured = self._measured.transpose(1, 0, 2).reshape(-1, count * self._at.shape[1])
        return [point.x[self.cases].T, point.inputs[self.cases].T, point.p, at, measured]

    def residual(self, point: Point) -> FloatArray:
        """Differences in standard deviations, those measured, case after case, shape (rows,)."""
        values = self._values(*self._arguments(point)).full().T
        scaled = values / self.sigma
        return np.asarray(scaled[self._known])

    def derivatives(self, point: Point) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives of the residual with x, inputs and p of its case, (rows, …) each."""
        count = len(self.cases)
        _, *matrices = self._derivatives(*self._arguments(point))
        by_x, by_inputs, by_p = ((split(matrix, count) / self.sigma[:, None])[self._known] for matrix in matrices)
        return by_x, by_inputs, by_p


@dataclass
class MisfitState:
    """The misfit at some unknowns.

    Attributes:
        shared: shared unknowns, shape (n,).
        own: those of each case, shape (cases, k).
        point: the equilibria.
        residual: differences in standard deviations, case after case, shape (m,).
        sensitivities: derivatives of the equilibria with the shared unknowns and with those of the case, (cases, size,
            n) and (cases, size, k); None until they are asked for.
    """

    shared: FloatArray
    own: FloatArray
    point: Point
    residual: FloatArray
    sensitivities: tuple[FloatArray, FloatArray] | None = None


class Misfit:
    """The least-squares problem of an identification.

    Attributes:
        model: with the parameters that are unknown.
        layout: what is unknown.
        cases: what was measured.
        measurements: rows by measurement.
        offsets: where the residuals of each case begin, shape (cases + 1,).
    """

    def __init__(self, model: Model, layout: UnknownLayout, cases: Sequence[Case], equilibria: Equilibria) -> None:
        self.model = model
        self.layout = layout
        self.cases = cases
        self.equilibria = equilibria
        self.measured_inputs = np.array([case.inputs for case in cases]).reshape(len(cases), -1)
        self.measurements: dict[int, MeasuredRows] = {}
        for number, record in enumerate(model.scene.measurements):
            rows = [(i, case.data[number]) for i, case in enumerate(cases) if number in case.data]
            if rows:
                self.measurements[number] = MeasuredRows(model, record, rows)
        row_cases = np.concatenate([rows.row_cases for rows in self.measurements.values()]).astype(np.int64)
        # Residuals stand case after case.
        self.order: Indices = np.argsort(row_cases, kind="stable")
        counts = np.bincount(row_cases, minlength=len(cases))
        self.offsets: Indices = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        self.row_cases: Indices = row_cases[self.order]

    def first(self, point: Point, shared: FloatArray, own: FloatArray) -> MisfitState:
        """The state at equilibria that are known."""
        return MisfitState(shared, own, point, self._residual(point))

    def at(self, shared: FloatArray, own: FloatArray, near: MisfitState) -> MisfitState | None:
        """The state at other unknowns; None where a case cannot be followed there."""
        # Steps that Newton's method cannot follow are too long for the linear model that proposes them.
        point, reached = self.moved(shared, own, near, far=False)
        if not np.all(reached):
            return None
        return MisfitState(shared, own, point, self._residual(point))

    def moved(self, shared: FloatArray, own: FloatArray, near: MisfitState, *, far: bool = True) -> tuple[Point, Flags]:
        """The equilibria at other unknowns, and which of them could be reached; far as in `Equilibria.tracked`."""
        inputs = self.layout.inputs(shared, own, self.measured_inputs)
        p = self.layout.parameters(shared)
        predicted = near.point.x
        if near.sensitivities is not None:
            by_shared, by_own = near.sensitivities
            predicted = predicted + by_shared @ (shared - near.shared)
            predicted = predicted + np.einsum("cik,ck->ci", by_own, own - near.own)
        return self.equilibria.tracked(near.point, predicted, inputs, p, far=far)

    def jacobians(self, state: MisfitState) -> tuple[FloatArray, FloatArray]:
        """Derivatives of the residual with the shared unknowns, (m, n), and with those of the row's case, (m, k)."""
        state.point = self.equilibria.at_point(state.point)
        inputs = state.point.inputs.shape[1]
        p_by_shared, inputs_by_shared = self.layout.by_shared(state.shared, inputs)
        inputs_by_own = self.layout.by_own(state.own, inputs)
        state.sensitivities = self._sensitivities(state.point, p_by_shared, inputs_by_shared, inputs_by_own)
        x_by_shared, x_by_own = state.sensitivities
        shared = []
        own = []
        for rows in self.measurements.values():
            by_x, by_inputs, by_p = rows.derivatives(state.point)
            cases = np.array(rows.row_cases)
            by_shared = np.einsum("mi,min->mn", by_x, x_by_shared[cases])
            shared.append(by_shared + by_inputs @ inputs_by_shared + by_p @ p_by_shared)
            by_own = np.einsum("mi,mik->mk", by_x, x_by_own[cases])
            own.append(by_own + np.einsum("mi,mik->mk", by_inputs, inputs_by_own[cases]))
        return np.concatenate(shared)[self.order], np.concatenate(own)[self.order]

    def _sensitivities(
        self, point: Point, p_by_shared: FloatArray, inputs_by_shared: FloatArray, inputs_by_own: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Derivatives of the equilibria with shared and own unknowns."""
        cases, size = point.x.shape
        by_shared = np.zeros((cases, size, p_by_shared.shape[1]))
        by_own = np.zeros((cases, size, inputs_by_own.shape[2]))
        if np.any(p_by_shared):
            by_shared += self.equilibria.by_parameters(point) @ p_by_shared
        if np.any(inputs_by_shared) or inputs_by_own.size:
            by_inputs = self.equilibria.by_inputs(point)
            by_shared += by_inputs @ inputs_by_shared
            by_own += by_inputs @ inputs_by_own
        return -point.inverses @ by_shared, -point.inverses @ by_own

    def _residual(self, point: Point) -> FloatArray:
        residuals = [rows.residual(point) for rows in self.measurements.values()]
        return np.concatenate(residuals)[self.order]
