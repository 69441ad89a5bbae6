"""Differences between model and measurements in all cases, with exact derivatives by the implicit function theorem.

Each case has its own equilibrium g(x, inputs, p) = 0, so that dx = −(∂g/∂x)⁻¹ (∂g/∂inputs d inputs + ∂g/∂p dp). A case
that was measured over time begins there, or unloaded, and is integrated as in identification/case_motions.py.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.strain_limits import BeyondLimit, first_beyond
from cosserat_casadi.identification.case_equilibria import Equilibria, Flags, Point, resolution_index
from cosserat_casadi.identification.case_motions import Motions, Run
from cosserat_casadi.identification.fit_unknowns import UnknownLayout
from cosserat_casadi.identification.measured_cases import Case
from cosserat_casadi.identification.measured_modes import JointModes, MeasuredModes, Vibrations
from cosserat_casadi.identification.measured_rows import MeasuredRows, by_instant
from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.measurements import ModeMeasurement
from cosserat_casadi.tubes.tube_functions import AnyModel, TubeFunctions

ROUNDING = 1e-10
"""Derivative, times the size of its unknown, over the largest one, below which it counts as rounding."""


@dataclass
class MisfitState:
    """The misfit at some unknowns.

    Attributes:
        shared: shared unknowns, shape (n,).
        own: unknowns of each case, shape (cases, k).
        point: the equilibria.
        residual: differences in standard deviations, case by case, shape (m,); NaN for modes that do not oscillate,
            and for motions that could not be computed.
        runs: motions of the cases that were measured over time, by index of the case; None if steps failed.
        sensitivities: derivatives of the equilibria by the shared unknowns, then by the unknowns of the case, shape
            (cases, size, n + k); None until they are computed.
    """

    shared: FloatArray
    own: FloatArray
    point: Point
    residual: FloatArray
    runs: dict[int, Run | None] = field(default_factory=dict)
    sensitivities: FloatArray | None = None


class Misfit:
    """The least-squares problem of an identification.

    Attributes:
        model: model with the unknown parameters.
        layout: the unknowns.
        cases: the measured cases.
        equilibria: equilibria of the cases; for a motion the equilibrium at its start.
        moves: mask of the cases that are motions, shape (cases,).
        motions: motions of these cases.
        measurements: rows by measurement.
        offsets: first residual of each case, followed by their number, shape (cases + 1,).
    """

    def __init__(self, model: AnyModel, layout: UnknownLayout, cases: Sequence[Case], equilibria: Equilibria) -> None:
        self.model = model
        self.layout = layout
        self.cases = cases
        self.equilibria = equilibria
        self.measured_inputs = inputs_of(cases)
        self.moves = moving(cases)
        self.motions = Motions(model, {i: _times(case) for i, case in enumerate(cases) if case.moves})
        self.measurements: dict[int, MeasuredRows | MeasuredModes] = {}
        vibrations = Vibrations(model)
        for number, record in enumerate(model.parametric_scene.measurements):
            rows = [(i, case.data[number]) for i, case in enumerate(cases) if number in case.data]
            if rows and isinstance(record, ModeMeasurement):
                self.measurements[number] = MeasuredModes(vibrations, record, rows)
            elif rows:
                self.measurements[number] = MeasuredRows(model, record, by_instant(rows))
        row_cases = np.concatenate([rows.row_cases for rows in self.measurements.values()]).astype(np.int64)
        # Residuals stand case after case.
        self.order: Indices = np.argsort(row_cases, kind="stable")
        counts = np.bincount(row_cases, minlength=len(cases))
        self.offsets: Indices = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
        self.row_cases: Indices = row_cases[self.order]

    def first(self, point: Point, shared: FloatArray, own: FloatArray) -> MisfitState:
        """Make the state at known equilibria."""
        runs = {case: self.motions.run(case, point.x[case], point.inputs[case], point.p) for case in self.motions.times}
        return MisfitState(shared, own, point, self._residual(point, runs), runs)

    def at(self, shared: FloatArray, own: FloatArray, near: MisfitState) -> MisfitState | None:
        """Follow the state to other unknowns; None if a case cannot be followed there."""
        # Steps that Newton's method cannot follow are too long for the linear model that proposes them.
        point, reached = self.moved(shared, own, near, far=False)
        if not np.all(reached):
            return None
        return self.first(point, shared, own)

    def moved(self, shared: FloatArray, own: FloatArray, near: MisfitState, *, far: bool = True) -> tuple[Point, Flags]:
        """Follow equilibria to other unknowns; also return which were reached; ``far`` as in `Equilibria.tracked`."""
        of_cases = self.layout.inputs(shared, own, self.measured_inputs)
        inputs = self.motions.start.of(of_cases, self.moves)
        p = self.layout.parameters(shared)
        predicted = near.point.x
        if near.sensitivities is not None:
            changes = np.hstack([np.tile(shared - near.shared, (len(own), 1)), own - near.own])
            predicted = predicted + np.einsum("cik,ck->ci", near.sensitivities, changes)
        return self.equilibria.tracked(near.point, predicted, inputs, p, far=far)

    def jacobian(self, state: MisfitState) -> FloatArray:
        """Derivatives of the residual by the shared unknowns, then by those of the row's case, shape (m, n + k)."""
        state.point = self.equilibria.at_point(state.point)
        p_by_all, inputs_by_all = self._given_by_all(state)
        state.sensitivities = self.equilibria.sensitivities(state.point, p_by_all, inputs_by_all)
        rates = self._rates(state, state.sensitivities, inputs_by_all, p_by_all)
        return without_rounding(rates, np.concatenate([self.layout.scales(state.shared), self.layout.own_scales]))

    def _given_by_all(self, state: MisfitState) -> tuple[FloatArray, FloatArray]:
        """Derivatives of parameters and inputs by all unknowns, as from :meth:`UnknownLayout.derivatives`."""
        return self.layout.derivatives(state.shared, state.own, state.point.inputs.shape[1])

    def _rates(
        self, state: MisfitState, x_by_all: FloatArray, inputs_by_all: FloatArray, p_by_all: FloatArray
    ) -> FloatArray:
        """Derivatives of the residual by the unknowns of each row, from derivatives of x, inputs and parameters."""
        moved = {
            case: self.motions.sensitivity(run, x_by_all[case], inputs_by_all[case], p_by_all)
            for case, run in state.runs.items()
            if run is not None
        }
        columns = []
        for rows in self.measurements.values():
            by_x, by_inputs, by_p = rows.derivatives(*self._at_places(rows, state.point, state.runs))
            x_by = x_by_all[rows.cases]
            inputs_by = inputs_by_all[rows.cases]
            for place, case, instant in self._instants(rows):
                over_time, held = moved[case]
                x_by[place] = over_time[instant]
                inputs_by[place] = held
            of_rows = np.einsum("mi,min->mn", by_x, x_by[rows.places])
            of_rows += np.einsum("mi,min->mn", by_inputs, inputs_by[rows.places])
            columns.append(of_rows + by_p @ p_by_all)
        return np.concatenate(columns)[self.order]

    def solutions(self, state: MisfitState) -> tuple[Solution, ...]:
        """The equilibria of the cases, each with its contacts, for exact contact; else empty."""
        return ()

    def marginal(self, state: MisfitState) -> list[str]:
        """Sentences on contacts that change for only one direction of a change of the unknowns."""
        return []

    def kinked(self, state: MisfitState, other: MisfitState) -> Flags:
        """Mask of the cases whose derivatives jump between two states, because contacts change, shape (cases,)."""
        return np.zeros(len(self.cases), dtype=bool)

    def at_kink(self, state: MisfitState, other: MisfitState) -> list[str]:
        """Changes of contacts between two states, in words."""
        return []

    @property
    def barred(self) -> list[str]:
        """Cases with a refused step, which would have led through a smooth obstacle or a rod."""
        return [case.where for case, barred in zip(self.cases, self.equilibria.barred, strict=True) if barred]

    def unstable(self, state: MisfitState) -> list[str]:
        """Cases whose equilibrium is unstable, if stability has a meaning."""
        flags = self.equilibria.unstable(state.point)
        return [case.where for case, is_unstable in zip(self.cases, flags, strict=True) if is_unstable]

    def unresolved(self, state: MisfitState) -> list[str]:
        """Cases in which the nodes do not resolve the rods."""
        unresolved = []
        for case, x, inputs in self._states(state):
            places = zip(x, inputs, strict=True)
            indices = [resolution_index(self.model, *place, state.point.p) for place in places]
            if not np.max(indices) <= 1.0:
                unresolved.append(case)
        return unresolved

    def passages(self, state: MisfitState) -> list[tuple[str, str]]:
        """Cases whose motion leads through a smooth obstacle or a rod, and a sentence on when it does."""
        told = [(i, self.motions.told_passage(run)) for i, run in state.runs.items() if run is not None]
        return [(self.cases[i].where, sentence) for i, sentence in told if sentence]

    def beyond_limits(self, state: MisfitState) -> list[tuple[str, BeyondLimit]]:
        """Cases that are beyond a limit, each with that limit."""
        if isinstance(self.model, TubeFunctions) or self.model.strain_margins is None:
            return []
        bound = self.model.at(state.point.p)
        limits = [(case, first_beyond(bound, x, inputs)) for case, x, inputs in self._states(state)]
        return [(case, limit) for case, limit in limits if limit is not None]

    def _states(self, state: MisfitState) -> Iterator[tuple[str, FloatArray, FloatArray]]:
        """Each case with its equilibrium or, for a motion, the states at all measured times."""
        for i, case in enumerate(self.cases):
            x = state.point.x[i : i + 1]
            inputs = state.point.inputs[i : i + 1]
            run = state.runs.get(i)
            if run is not None:
                x = np.vstack([x, run.x])
                inputs = np.vstack([inputs, run.inputs])
            yield case.where, x, inputs

    def joint_modes(self, state: MisfitState) -> list[JointModes]:
        """Measured modes of one frequency, whose mean is compared; the Jacobian must have been computed before."""
        found = []
        assert state.sensitivities is not None, "follow from the Jacobian"
        p_by_all, inputs_by_all = self._given_by_all(state)
        sizes = self.layout.scales(state.shared)
        for rows in self.measurements.values():
            if isinstance(rows, MeasuredModes):
                by_all = [np.vstack([state.sensitivities[i], inputs_by_all[i], p_by_all]) for i in rows.cases]
                at_places = self._at_places(rows, state.point, state.runs)
                found += rows.joint_modes(*at_places, np.array(by_all)[:, :, : len(sizes)], sizes)
        return found

    def residual_of(self, rows: MeasuredRows | MeasuredModes, state: MisfitState) -> FloatArray:
        """Differences of one measurement in standard deviations, in the order of its data."""
        return rows.residual(*self._at_places(rows, state.point, state.runs))

    def _instants(self, rows: MeasuredRows | MeasuredModes) -> list[tuple[int, int, int]]:
        """Places of rows of motions, each with its case and the index of its time there."""
        if isinstance(rows, MeasuredModes):
            return []
        found = []
        for place, (case, time) in enumerate(zip(rows.cases.tolist(), rows.times.tolist(), strict=True)):
            if case in self.motions.times:
                found.append((place, case, int(np.searchsorted(self.motions.times[case], time))))
        return found

    def _at_places(
        self, rows: MeasuredRows | MeasuredModes, point: Point, runs: Mapping[int, Run | None]
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Unknowns and inputs at the places of the rows, and parameters; NaN for motions that were not computed."""
        x = point.x[rows.cases]
        inputs = point.inputs[rows.cases]
        for place, case, instant in self._instants(rows):
            run = runs[case]
            x[place] = np.nan if run is None else run.x[instant]
            inputs[place] = np.nan if run is None else run.inputs[instant]
        return x, inputs, point.p

    def _residual(self, point: Point, runs: Mapping[int, Run | None]) -> FloatArray:
        residuals = [rows.residual(*self._at_places(rows, point, runs)) for rows in self.measurements.values()]
        return np.concatenate(residuals)[self.order]


def inputs_of(cases: Sequence[Case]) -> FloatArray:
    """Inputs set by columns, and the scene's values of others, shape (cases, inputs)."""
    return np.array([case.inputs for case in cases]).reshape(len(cases), -1)


def moving(cases: Sequence[Case]) -> Flags:
    """Mask of the cases that are motions, shape (cases,)."""
    return np.array([case.moves for case in cases], dtype=bool)


def _times(case: Case) -> FloatArray:
    """Times at which a motion was measured, ascending, s."""
    return np.unique([datum.time for data in case.data.values() for datum in data])


def without_rounding(derivatives: FloatArray, sizes: FloatArray) -> FloatArray:
    """Set columns of unknowns on which no datum depends to zero.

    Rounding in such a column would act as a datum of that unknown, and drive it far away.

    Args:
        derivatives: derivatives by the shared unknowns, then by those of the row's case, shape (m, n + k).
        sizes: sizes of these unknowns, shape (n + k,).
    """
    norms = np.linalg.norm(derivatives, axis=0) * sizes
    return np.where(norms > ROUNDING * norms.max(initial=0.0), derivatives, 0.0)
