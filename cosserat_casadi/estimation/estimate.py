"""What a robot feels: inputs and places of each measured case that explain it best, given what is known beforehand.

The maximum a posteriori of each case is found in C, from the unloaded rod, on all cores; where a place along a rod or
another parameter is unknown, from several values between its bounds. Its covariance is that of
the linearised model there: S. Särkkä, *Bayesian Filtering and Smoothing*, Cambridge University Press 2013, section
A.3; the Gaussian approximation of Laplace.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.choose import choose
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.codegen.estimator import (
    ENDINGS,
    Estimates,
    EstimatorLibrary,
    Knowledge,
    MeasuredCases,
    estimator_library,
)
from cosserat_casadi.estimation.beforehand import (
    cases_within_reach,
    check_ranges,
    check_unknowns,
    expected_values,
    knowledge_of,
    of_parameters,
    row_parameters,
    stacked_indices,
    with_row_parameters,
)
from cosserat_casadi.estimation.optima import best_of, spread_starts
from cosserat_casadi.estimation.outcome import NOT_DETERMINED, REASONS, Estimate, what_is_known
from cosserat_casadi.estimation.stacking import differences, sections_of, stacked
from cosserat_casadi.identification.cases import Data, read_cases
from cosserat_casadi.identification.unknowns import UnknownLayout, unknown_layout
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.load_cases import CaseLayout
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.sweep.local import available_cores

CHUNK = 256
"""Cases that a thread takes at once."""

CHECKED = 3
"""Cases that are solved again on a finer discretisation."""

POOR = 2.0
"""Root mean square of the residuals, in standard deviations, beyond which the model does not explain the data."""

TOLD = 3
"""Cases that a sentence names."""

Progress = Callable[[str, int, int], None]
"""Told what is being done, how much of it is done, and of how much."""


def estimate(
    model: Model,
    data: Data | None = None,
    *,
    cores: int | None = None,
    progress: Progress | None = None,
) -> Estimate:
    """What explains each measured case of a model's scene best.

    Args:
        model: of a scene with measurements, whose unknowns are ``per_row``: ``build(scene.with_unknowns())``.
        data: columns by measurement, by its name or its file, that stand for the file.
        cores: threads, at least 1; those of this machine by default.
        progress: told what is being done.

    Raises:
        SceneError: a table is refused, an unknown is not found anew in each row, or the scene refuses a parameter that
            is between its bounds.
        ExportError: there is no C compiler, or it fails.
    """
    report = progress or _ignore
    check_unknowns(model.scene)
    model = with_row_parameters(model)
    layout = unknown_layout(model)
    check_ranges(model, layout)
    cases = read_cases(model.scene, model.inputs, data)
    labels = layout.own_labels
    indices = stacked_indices(layout, model.inputs.size)
    sections = sections_of(model, cases)
    table = stacked(model, cases, sections)
    known = knowledge_of(layout)
    table.inputs[:, indices] = expected_values(known, table.inputs[:, indices])
    report("Compiling", 0, 0)
    library = estimator_library(model, differences(model, sections, indices, table.at), indices)
    tables = start_tables(table, layout, indices, model.scene)
    runs = _found(library, tables, known, cores or available_cores(), report)
    found = runs[0]
    second = None
    if len(runs) > 1:
        found, second = best_of(runs)
    told = what_is_known(found, known, labels)
    outcomes = []
    for ending, determined in zip(found.outcome.tolist(), told.determined.tolist(), strict=True):
        undetermined = ending == 0 and not determined
        outcomes.append(NOT_DETERMINED if undetermined else ENDINGS[ending])
    values = np.where(told.determined[:, None], found.unknowns, np.nan)
    inputs = table.inputs.copy()
    inputs[:, indices] = values
    units = tuple(entry.unit for entry in layout.own for _ in entry.labels)
    result = Estimate(
        model=model,
        cases=tuple(case.where for case in cases),
        labels=labels,
        units=units,
        outcomes=tuple(outcomes),
        values=values,
        covariance=told.covariance,
        cost=found.cost,
        numbers=np.count_nonzero(table.weights, axis=1),
        x=found.x,
        inputs=inputs[:, : model.inputs.size],
        parameters=inputs[:, model.inputs.size :],
        second=second,
        unseen=told.unseen,
    )
    return replace(result, warnings=tuple(_remarks(result, table.weights, known)))


def estimate_scene(
    scene: scenes.Scene,
    data: Data | None = None,
    *,
    cores: int | None = None,
    progress: Progress | None = None,
) -> Estimate:
    """What explains each measured case of a scene best, on modes and nodes that meet its tolerance.

    They are chosen for loads within two deviations of the priors, and some cases are solved again at the end on a finer
    discretisation that tells their error.

    Args:
        scene: with measurements, whose unknowns are ``per_row``.
        data: as in :func:`estimate`.
        cores: as there.
        progress: as there.

    Raises:
        SceneError: as in :func:`estimate`.
        ExportError: as there.
    """
    report = progress or _ignore
    refuse_tubes(scene)
    check_unknowns(scene)
    completed = scene.with_unknowns().model_copy(update={"parameters": row_parameters(scene)})
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
    result = estimate(build(completed), data, cores=cores, progress=progress)
    return replace(result, checked=tuple(_checked(result, report)))


def _ignore(doing: str, done: int, total: int) -> None:
    """Progress that nobody asked for."""


def start_tables(
    table: MeasuredCases, layout: UnknownLayout, indices: Sequence[int], scene: scenes.Scene
) -> list[MeasuredCases]:
    """The cases with the values from which each search begins: parameters are spread between their bounds.

    Args:
        table: the cases, unknown inputs with the values to begin with.
        layout: of the unknowns.
        indices: places of their numbers in a row of the inputs.
        scene: says how many searches are made, where parameters are unknown.
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
    library: EstimatorLibrary, tables: Sequence[MeasuredCases], known: Knowledge, cores: int, report: Progress
) -> list[Estimates]:
    """What was found from each table of starts, in chunks on all cores."""
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
    return [_joined(found[first : first + each]) for first in range(0, len(found), each)]


def _joined(parts: Sequence[Estimates]) -> Estimates:
    """Chunks of cases as one."""
    return Estimates(
        outcome=np.concatenate([part.outcome for part in parts]),
        iterations=np.concatenate([part.iterations for part in parts]),
        cost=np.concatenate([part.cost for part in parts]),
        unknowns=np.vstack([part.unknowns for part in parts]),
        information=np.vstack([part.information for part in parts]),
        x=np.vstack([part.x for part in parts]),
    )


def _checked(result: Estimate, report: Progress) -> Iterator[tuple[int, float | None]]:
    """Some cases solved again in Python, with the error that a finer discretisation tells."""
    found = np.flatnonzero(result.found)
    if not found.size:
        return
    # The cases that differ most from the unloaded rod are those that the discretisation serves worst.
    bent = np.linalg.norm(result.x[found], axis=1)
    rows = found[np.argsort(-bent, kind="stable")[:CHECKED]].tolist()
    for done, row in enumerate(rows):
        report("Checking rows", done, len(rows))
        model = result.model
        scene = model.scene
        if model.parameters.size:
            scene = model.parameters.set_in(scene, model.parameters.unpack(result.parameters[row]))
        solution = solve_rods(scene, model.inputs.unpack(result.inputs[row]))
        yield row, solution.error_estimate if solution.converged else None


def _remarks(result: Estimate, weights: FloatArray, known: Knowledge) -> Iterator[str]:
    """What a user must know of what was found."""
    for outcome, reason in REASONS.items():
        rows = [case for case, word in zip(result.cases, result.outcomes, strict=True) if word == outcome]
        if rows:
            yield f"{len(rows)} of {len(result.cases)} rows not found: {_named(rows)}. {reason}"
    seen = max(1, int(np.count_nonzero(np.isfinite(result.values[:, 0]))))
    for direction, count in list(result.unseen.items())[:TOLD]:
        yield f"The data do not see {direction} in {count} of {seen} rows: there the prior alone speaks."
    at_bound = (result.values <= known.lower) | (result.values >= known.upper)
    for k in np.flatnonzero(at_bound.any(axis=0)):
        yield f"{result.labels[k]} is at a bound in {int(at_bound[:, k].sum())} rows: its deviation means little there."
    doubtful = [case for case, is_doubtful in zip(result.cases, result.doubtful, strict=True) if is_doubtful]
    if doubtful:
        yield (
            f"{len(doubtful)} of {seen} rows have another explanation nearly as good, told as the second best: "
            f"{_named(doubtful)}. Values and deviations there are those of the best alone."
        )
    measured = max(1, int(np.count_nonzero(weights[result.found])))
    rms = float(np.sqrt(2.0 * np.sum(result.cost[result.found]) / measured))
    if rms > POOR:
        yield (
            f"The residuals are {rms:.3g} standard deviations (rms): the model does not explain the data to the "
            "accuracy that sigma states."
        )


def _named(rows: Sequence[str]) -> str:
    """Some rows by name, and how many more there are."""
    names = ", ".join(rows[:TOLD])
    return names if len(rows) <= TOLD else f"{names} and {len(rows) - TOLD} more"
