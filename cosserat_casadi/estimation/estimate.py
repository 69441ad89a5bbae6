"""Estimates of the inputs and places that explain each measured case best, by maximum a posteriori.

The maximum a posteriori of each case is found in C, from the unloaded rod, on all cores, or in exact contact in Python;
if a place along a rod or another parameter is unknown, from several values between its bounds. Its covariance is that
of the linearised model there: S. Särkkä, *Bayesian Filtering and Smoothing*, Cambridge University Press 2013, section
A.3; Laplace's Gaussian approximation.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.choose import choose
from cosserat_casadi.accuracy.refine import solve
from cosserat_casadi.codegen.estimator import ENDINGS, Estimates, EstimatorLibrary, Knowledge, MeasuredCases
from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers
from cosserat_casadi.equilibrium.solve import is_behind
from cosserat_casadi.equilibrium.stability import second_variation, variations
from cosserat_casadi.estimation.beforehand import (
    cases_within_reach,
    check_ranges,
    check_unknowns,
    knowledge_of,
    of_parameters,
    stacked_indices,
    unknown_parameters,
    with_unknown_parameters,
)
from cosserat_casadi.estimation.consistency import Consistency, consistency
from cosserat_casadi.estimation.estimate_outcome import (
    BEHIND,
    NOT_DETERMINED,
    REASONS,
    UNREACHED,
    Estimate,
    information_of,
)
from cosserat_casadi.estimation.optima import best_of, spread_starts
from cosserat_casadi.estimation.posterior import Sampled, sampled
from cosserat_casadi.estimation.rows_in_contact import RowsInContact
from cosserat_casadi.estimation.shared import Searched, SharedNumbers, SharedSearch
from cosserat_casadi.estimation.stacking import row_library, sections_of, sensor_names, stacked
from cosserat_casadi.identification.fit_problem import far_positions
from cosserat_casadi.identification.fit_unknowns import UnknownEntry, UnknownLayout, unknown_layout
from cosserat_casadi.identification.measured_cases import Case, Data, read_cases
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.load_cases import CaseLayout
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.numerics.progress import StageProgress, not_told
from cosserat_casadi.spelling import FEW, named
from cosserat_casadi.sweeps.local import available_cores

RowSolver: TypeAlias = EstimatorLibrary | RowsInContact
"""Solver of rows of measurements for the numbers that explain them, in C or in Python."""

CHUNK = 256
"""Number of cases that a thread takes at once."""

CHECKED = 3
"""Number of cases that are solved again on a finer discretisation."""


def estimate_model(
    model: Model,
    data: Data | None = None,
    *,
    cores: int | None = None,
    progress: StageProgress | None = None,
) -> Estimate:
    """Estimate as :func:`estimate` does, with a model on its modes and nodes."""
    report = progress or not_told
    check_unknowns(model.scene)
    model = with_unknown_parameters(model)
    layout = unknown_layout(model)
    check_ranges(model, layout)
    cases = read_cases(model.scene, model.inputs, data)
    indices = stacked_indices((*layout.own, *layout.shared), model.inputs.size)
    own = len(layout.own_labels)
    sections = sections_of(model, cases)
    table = stacked(model, cases, sections)
    known = knowledge_of(layout)
    table.inputs[:, indices[:own]] = known.limits.expected(table.inputs[:, indices[:own]])
    solver: RowSolver
    if model.scene.touches_exactly:
        # Functions are built for contacts as they change, and CasADi may not build in several threads at once.
        solver, cores = RowsInContact(model, sections, indices), 1
    else:
        report("Writing and compiling", 0, 0)
        solver = row_library(model, sections, indices, table.at)
    tables = start_tables(table, layout, indices, model.scene)
    search = Search(solver, tables, known, indices, cores or available_cores(), report)
    (found, second), shared, added = _rows_and_shared(search, layout)
    covariance, determined, unseen = information_of(found.first(own), known, layout.own_labels)
    inputs = table.inputs.copy()
    inputs[:, indices] = found.unknowns
    beyond = _beyond_obstacles(model, found, inputs)
    barred = np.array([bool(word) for word in beyond])
    determined &= ~barred
    covariance = np.where(barred[:, None, None], np.nan, covariance)
    drawn = None
    if model.scene.estimation.draws:
        drawn = search.sampled(found, covariance, model.scene.estimation.draws)
        covariance = np.where(drawn.sound[:, None, None], drawn.covariance, covariance)
    outcomes = []
    for ending, is_determined, word in zip(found.outcome.tolist(), determined.tolist(), beyond, strict=True):
        outcomes.append((word or NOT_DETERMINED) if ending == 0 and not is_determined else ENDINGS[ending])
    values = np.where(determined[:, None], found.unknowns[:, :own], np.nan)
    inputs[:, indices] = np.where(determined[:, None], found.unknowns, np.nan)
    sensors = sensor_names(model, sections, table.at)
    result = Estimate(
        model=model,
        cases=tuple(case.where for case in cases),
        labels=layout.own_labels,
        units=_units(layout.own),
        outcomes=tuple(outcomes),
        values=values,
        covariance=covariance + added,
        cost=found.cost,
        numbers=np.count_nonzero(table.weights, axis=1),
        x=found.x,
        inputs=inputs[:, : model.inputs.size],
        parameters=inputs[:, model.inputs.size :],
        second=second,
        unseen=unseen,
        shared=shared,
        consistency=_consistency(found, determined, table, layout, shared, sensors),
    )
    report("Judging stability", 0, 0)
    result = replace(result, stable=tuple(_stability(result)))
    remarks = [*far_positions(model.scene, _measured(cases)), *_remarks(result, known, drawn)]
    if isinstance(solver, RowsInContact) and drawn is None:
        report("Looking for contacts that change", 0, 0)
        remarks += _on_contacts(result.cases, solver.contact_changes(table, inputs[:, indices], covariance, known))
    return replace(result, warnings=tuple(remarks))


def _measured(cases: Sequence[Case]) -> list[tuple[int, int, float]]:
    """Index of the measurement, index of the entry, and value, for all measured numbers of all cases."""
    return [
        (measurement, entry, float(value))
        for case in cases
        for measurement, data in case.data.items()
        for datum in data
        for entry, value in enumerate(datum.values)
        if np.isfinite(value)
    ]


def _beyond_obstacles(model: Model, found: Estimates, inputs: FloatArray) -> list[str]:
    """Word for each row: BEHIND if it is behind a smooth obstacle or a rod, UNREACHED if it may be, else "".

    Args:
        model: model with its parameters free.
        found: estimates of the rows.
        inputs: stacked inputs, then parameters, of each row, shape (cases, inputs + parameters).
    """
    words = [""] * len(found.x)
    if not SmoothBarriers(model).any:
        return words
    for row in np.flatnonzero(found.outcome == 0):
        given, parameters = np.split(inputs[row], [model.inputs.size])
        behind = is_behind(model.at(parameters), found.x[row], given)
        if behind is not False:
            words[row] = BEHIND if behind else UNREACHED
    return words


def _stability(result: Estimate) -> Iterator[bool | None]:
    """Stability of the equilibrium of each row; None without an estimate, or for loads without a potential."""
    model = result.model
    allowed = variations(model)
    for row, found in enumerate(result.found.tolist()):
        inputs = result.inputs[row]
        # In exact contact the forces of contacts would be needed too.
        if not found or model.scene.touches_exactly or not model.has_potential(inputs):
            yield None
            continue
        parameters = [result.parameters[row]] if model.parameters.size else []
        jacobian, _ = model.jacobian(result.x[row], inputs, *parameters)
        yield second_variation(jacobian.full(), allowed).stable


def _on_contacts(cases: Sequence[str], changes: Mapping[int, str]) -> Iterator[str]:
    """Remark on contacts that change next to estimates, so that deviations differ between both sides."""
    if changes:
        rows = named([f"{cases[row]} ({change})" for row, change in changes.items()])
        yield (
            f"Within a standard deviation contacts come, go or change in {rows}: deviations there hold for changes "
            "that leave contacts as they are. Draws see both sides: give [estimation] draws."
        )


def _units(entries: Sequence[UnknownEntry]) -> tuple[str, ...]:
    """Unit of each estimated number."""
    return tuple(entry.unit for entry in entries for _ in entry.labels)


def _rows_and_shared(search: Search, layout: UnknownLayout) -> tuple[Searched, SharedNumbers | None, FloatArray]:
    """Find the rows, the shared numbers, and the contribution of their uncertainty to the covariances of the rows."""
    if not layout.shared:
        return search.rows(np.zeros(0)), None, np.zeros(())
    shared = SharedSearch(search.rows, layout.shared_limits, search.known.limits)
    return shared.run(layout.shared_labels, _units(layout.shared))


def _consistency(
    found: Estimates,
    rows: npt.NDArray[np.bool_],
    table: MeasuredCases,
    layout: UnknownLayout,
    shared: SharedNumbers | None,
    sensors: Sequence[str],
) -> Consistency:
    """Judge the consistency of determined rows with the model."""
    own = len(layout.own_labels)
    priors = int(np.count_nonzero(layout.own_limits.weight))
    # A number that a bound holds is not fitted to the data.
    fitted = np.count_nonzero(~layout.own_limits.at_end(found.unknowns[:, :own]), axis=1)
    freedom = np.count_nonzero(table.weights, axis=1) + priors - fitted
    squares = np.where(rows, 2 * found.cost, np.nan)
    residuals: dict[str, list[FloatArray]] = {}
    for column, name in enumerate(sensors):
        measured = rows & (table.weights[:, column] > 0.0)
        residuals.setdefault(name, []).append(found.residuals[measured, column])
    of_shared = 0.0
    held = 0
    if shared is not None:
        of_shared = float(np.sum(layout.shared_limits.residual(shared.values) ** 2))
        held = int(np.count_nonzero(layout.shared_limits.at_end(shared.values)))
    by_sensor = {name: np.concatenate(values) for name, values in residuals.items()}
    return consistency(squares, freedom, of_shared, by_sensor, held)


@dataclass(frozen=True)
class Search:
    """The search for all rows, on all cores.

    Attributes:
        library: the solver, in C unless contact is exact.
        tables: the cases, one table for each set of initial values.
        known: prior knowledge of the numbers of each row.
        indices: indices of these numbers, then of the shared ones, in a row of the inputs.
        cores: number of threads.
        report: callback with the number of finished rows.
    """

    library: RowSolver
    tables: Sequence[MeasuredCases]
    known: Knowledge
    indices: Sequence[int]
    cores: int
    report: StageProgress

    @property
    def own(self) -> int:
        """Number of estimated numbers in each row."""
        return len(self.known.size)

    def rows(self, shared: FloatArray) -> Searched:
        """Find the best minimum of each row for these values of the shared numbers, and the second best."""
        known = self.known.with_held(shared)
        tables = [self._starting(table, shared) for table in self.tables]
        runs = _found(self.library, tables, known, self.cores, self.report)
        if len(runs) > 1:
            return best_of(runs, self.own)
        return runs[0], None

    def _starting(self, table: MeasuredCases, shared: FloatArray) -> MeasuredCases:
        inputs = table.inputs.copy()
        inputs[:, list(self.indices[self.own :])] = shared
        return replace(table, inputs=inputs)

    def sampled(self, found: Estimates, covariance: FloatArray, draws: int) -> Sampled:
        """Mean squared deviations by draws around the estimates; NaN without an estimate, or if undetermined.

        Args:
            found: the rows.
            covariance: covariance of the linearised model, shape (cases, k, k).
            draws: number of draws in each round.
        """
        rows = np.flatnonzero(np.isfinite(covariance[:, 0, 0]))
        result = Sampled(np.full_like(covariance, np.nan), np.zeros(len(covariance)))
        chunks = [rows[first : first + CHUNK] for first in range(0, len(rows), CHUNK)]
        done = 0
        with ThreadPoolExecutor(self.cores) as pool:
            parts = pool.map(lambda chunk: self._sampled_chunk(found, covariance[chunk], chunk, draws), chunks)
            for chunk, part in zip(chunks, parts, strict=True):
                result.covariance[chunk] = part.covariance
                result.effective[chunk] = part.effective
                done += len(chunk)
                self.report("Drawing from posteriors", done, len(rows))
        return result

    def _sampled_chunk(
        self, found: Estimates, covariance: FloatArray, rows: npt.NDArray[np.int64], draws: int
    ) -> Sampled:
        table = self.tables[0].part(rows)
        unknowns = found.unknowns[rows]
        inputs = table.inputs.copy()
        inputs[:, list(self.indices)] = unknowns
        # The shared numbers are the same in all rows.
        known = self.known.with_held(unknowns[0, self.own :])

        def costs(steps: FloatArray) -> FloatArray:
            held = np.zeros((*steps.shape[:2], len(self.indices) - self.own))
            changes = np.concatenate([steps, held], axis=2)
            return self.library.costs(table, inputs, found.x[rows], known, changes)

        return sampled(costs, found.cost[rows], covariance, draws)


def estimate(
    subject: scenes.Scene | Model,
    data: Data | None = None,
    *,
    cores: int | None = None,
    progress: StageProgress | None = None,
) -> Estimate:
    """Estimate the unknowns of each measured case of a scene, or of a model.

    A model keeps its modes and nodes. For a scene, modes and nodes are chosen to meet its tolerance for loads within
    two deviations of the priors, and some cases are solved again at the end on a finer discretisation to estimate
    their error.

    Args:
        subject: a scene with measurements, whose unknowns are ``per_row`` or have priors; or a model of such a scene:
            ``build(scene.with_unknowns())``.
        data: columns by measurement, by its name or its file, which replace the file.
        cores: number of threads, at least 1; by default as many as the machine has cores.
        progress: callback with the work under way.

    Raises:
        SceneError: a table is refused, a shared unknown has no prior, or the scene refuses a parameter between its
            bounds.
        ExportError: there is no C compiler, or it fails.
    """
    if isinstance(subject, Model):
        return estimate_model(subject, data, cores=cores, progress=progress)
    scene = subject
    report = progress or not_told
    refuse_tubes(scene)
    check_unknowns(scene)
    completed = scene.with_unknowns().model_copy(update={"parameters": unknown_parameters(scene)})
    draft = build(completed)
    # All that is refused is refused before time is spent on a discretisation.
    layout = unknown_layout(draft)
    check_ranges(draft, layout)
    cases = read_cases(completed, draft.inputs, data)
    if not scene.accuracy.fixed:
        report("Choosing the discretisation", 0, 0)
        inputs = np.array([case.inputs for case in cases])
        expected = cases_within_reach(CaseLayout(draft.inputs, draft.parameters), layout, inputs)
        completed = choose(completed, cases=list(expected)).scene
    result = estimate_model(build(completed), data, cores=cores, progress=progress)
    return replace(result, checked=tuple(_checked(result, report)))


def start_tables(
    table: MeasuredCases, layout: UnknownLayout, indices: Sequence[int], scene: scenes.Scene
) -> list[MeasuredCases]:
    """Make a table of the cases for each search, with initial values; parameters are spread between their bounds.

    Args:
        table: the cases, with initial values of unknown inputs.
        layout: layout of the unknowns.
        indices: indices of their numbers in a row of the inputs.
        scene: scene with the number of searches for unknown parameters.
    """
    chosen = of_parameters(layout)
    if not chosen:
        return [table]
    limits = layout.own_limits
    columns = [indices[k] for k in chosen]
    tables = []
    for values in spread_starts(limits.lower[chosen], limits.upper[chosen], scene.estimation.starts):
        inputs = table.inputs.copy()
        inputs[:, columns] = values
        tables.append(replace(table, inputs=inputs))
    return tables


def _found(
    library: RowSolver, tables: Sequence[MeasuredCases], known: Knowledge, cores: int, report: StageProgress
) -> list[Estimates]:
    """Compute estimates from each table of starts, in chunks on all cores."""
    count = len(tables[0].inputs)
    chunks = [slice(first, first + CHUNK) for first in range(0, count, CHUNK)]
    parts = [table.part(chunk) for table in tables for chunk in chunks]
    found: list[Estimates] = []
    done = 0
    with ThreadPoolExecutor(cores) as pool:
        for part in pool.map(lambda chunk: library.estimate(chunk, known), parts):
            found.append(part)
            done += len(part.outcome)
            report("Estimating", done, count * len(tables))
    each = len(chunks)
    return [Estimates.joined(found[first : first + each]) for first in range(0, len(found), each)]


def _checked(result: Estimate, report: StageProgress) -> Iterator[tuple[int, float | None]]:
    """Solve some cases again in Python, with error estimates by a finer discretisation."""
    found = np.flatnonzero(result.found)
    if not found.size:
        return
    # The discretisation is worst for the cases that differ most from the unloaded rod.
    bent = np.linalg.norm(result.x[found], axis=1)
    rows = found[np.argsort(-bent, kind="stable")[:CHECKED]].tolist()
    for done, row in enumerate(rows):
        report("Checking rows", done, len(rows))
        model = result.model
        # The solve starts from the estimate: the unloaded rod may lead to another equilibrium with another error.
        start = None if model.scene.touches_exactly else result.x[row]
        parameters = result.parameters[row] if model.parameters.size else None
        solution = solve(model, result.inputs[row], parameters=parameters, start=start)
        yield row, solution.error_estimate if solution.converged else None


def _remarks(result: Estimate, known: Knowledge, drawn: Sampled | None) -> Iterator[str]:
    """Remarks on the estimates, for the user."""
    for outcome, reason in REASONS.items():
        rows = [case for case, word in zip(result.cases, result.outcomes, strict=True) if word == outcome]
        if rows:
            yield f"{len(rows)} of {len(result.cases)} rows not found: {named(rows)}. {reason}"
    seen = max(1, int(np.count_nonzero(np.isfinite(result.values[:, 0]))))
    unstable = [result.cases[row] for row, stable in enumerate(result.stable) if stable is False]
    if unstable:
        yield (
            f"{len(unstable)} of {seen} rows are explained by an equilibrium that is not stable: {named(unstable)}. A "
            "real rod leaves it. Do not believe the values there; give priors near what is felt, or measure more."
        )
    for direction, count in list(result.unseen.items())[:FEW]:
        yield f"The data do not see {direction} in {count} of {seen} rows: only the prior determines it there."
    at_bound = known.limits.at_end(result.values)
    for k in np.flatnonzero(at_bound.any(axis=0)):
        yield f"{result.labels[k]} is at a bound in {int(at_bound[:, k].sum())} rows: its deviation means little there."
    doubtful = [case for case, is_doubtful in zip(result.cases, result.doubtful, strict=True) if is_doubtful]
    if doubtful:
        yield (
            f"{len(doubtful)} of {seen} rows have another explanation nearly as good, told as the second best: "
            f"{named(doubtful)}. Values and deviations there are those of the best alone."
        )
    if drawn is not None:
        poor = np.count_nonzero(result.found & ~drawn.sound)
        if poor:
            yield (
                f"Too few draws hit the posterior in {poor} of {seen} rows: deviations there are those of the "
                "linearised model. Give [estimation] more draws."
            )
    if result.shared is not None and not result.shared.settled:
        yield "The search for the unknowns that all rows share did not end: their values and deviations may be wrong."
    yield from result.consistency.sentences(result.cases)
