"""What a robot feels: the inputs of each measured case that explain it best, given what is known beforehand.

The maximum a posteriori of each case is found in C, from the unloaded rod, on all cores. Its covariance is that of
the linearised model there: S. Särkkä, *Bayesian Filtering and Smoothing*, Cambridge University Press 2013, section
A.3; the Gaussian approximation of Laplace.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.refine import solve_scene
from cosserat_casadi.accuracy.tune import tune
from cosserat_casadi.codegen.estimator import (
    ENDINGS,
    Estimates,
    EstimatorLibrary,
    Knowledge,
    MeasuredCases,
    estimator_library,
)
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.estimation.outcome import NOT_DETERMINED, REASONS, Estimate, what_is_known
from cosserat_casadi.estimation.stacking import differences, sections_of, stacked
from cosserat_casadi.identification.cases import Data, read_cases
from cosserat_casadi.identification.unknowns import UnknownLayout, unknown_layout
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.scene.measurements import ModeMeasurement
from cosserat_casadi.sweep.local import available_cores

CHUNK = 256
"""Cases that a thread takes at once."""

CHECKED = 3
"""Cases that are solved again on a finer discretisation."""

REACH = 2.0
"""Deviations of the prior up to which the discretisation is to serve."""

DRAWS = 6
"""Cases within that reach that it is chosen on."""

SEED = 22
"""Of these cases: the same scene gives the same discretisation."""

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
        model: of a scene with measurements, whose unknowns are inputs ``per_row``: ``build(scene.with_unknowns())``.
        data: columns by measurement, by its name or its file, that stand for the file.
        cores: threads, at least 1; those of this machine by default.
        progress: told what is being done.

    Raises:
        SceneError: a table is refused, or an unknown is no input that is found anew in each row.
        ExportError: there is no C compiler, or it fails.
    """
    report = progress or _ignore
    model = model.at()
    check_unknowns(model.scene)
    layout = unknown_layout(model)
    cases = read_cases(model.scene, model.inputs, data)
    labels = layout.own_labels
    indices = [int(index) for entry in layout.own for index in entry.indices]
    sections = sections_of(model, cases)
    table = stacked(model, cases, sections)
    known = knowledge_of(layout)
    # The search begins at what is expected, or else at the scene's values.
    expected = np.where(known.weight > 0.0, known.mean, table.inputs[:, indices])
    table.inputs[:, indices] = expected
    report("Compiling", 0, 0)
    library = estimator_library(model, differences(model, sections, indices, table.at), indices)
    found = _found(library, table, known, cores or available_cores(), report)
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
        inputs=inputs,
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
        scene: with measurements, whose unknowns are inputs ``per_row``.
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
    completed = scene.with_unknowns().baked()
    draft = build(completed)
    # All that is refused is refused before time is spent on a discretisation.
    layout = unknown_layout(draft)
    cases = read_cases(completed, draft.inputs, data)
    if not scene.accuracy.fixed:
        report("Choosing the discretisation", 0, 0)
        inputs = np.array([case.inputs for case in cases])
        completed = tune(completed, [draft.inputs.unpack(row) for row in _reach(layout, inputs)]).scene
    result = estimate(build(completed), data, cores=cores, progress=progress)
    return replace(result, checked=tuple(_checked(result, report)))


def check_unknowns(scene: scenes.Scene) -> None:
    """Refuse a scene whose measurements or unknowns an estimate has no use for.

    Raises:
        SceneError: with every fault.
    """
    problems = []
    if not scene.measurements:
        problems.append(Problem("measurements", "missing", "say what was measured"))
    for i, measurement in enumerate(scene.measurements):
        if isinstance(measurement, ModeMeasurement):
            problem = f"{measurement.quantity}: an estimate knows equilibria, and none of their vibrations"
            problems.append(Problem(f"measurements[{i}].quantity", problem, "use cosserat identify"))
        elif getattr(measurement, "time", None) is not None:
            problem = "an estimate knows equilibria, and no motion"
            problems.append(Problem(f"measurements[{i}].time", problem, "leave it out, or use cosserat identify"))
    if not scene.unknowns:
        problems.append(Problem("unknowns", "missing", "name what is to be felt"))
    for i, unknown in enumerate(scene.unknowns):
        where = f"unknowns[{i}]"
        if not unknown.per_row:
            problem = f"{unknown.name} is the same in all rows; an estimate finds what differs from row to row"
            remedy = "give an input per_row = true; find what is shared with cosserat identify --write before"
            problems.append(Problem(where, problem, remedy))
        elif unknown.name.endswith("quaternion"):
            remedy = "find it with cosserat identify"
            problems.append(Problem(where, "an orientation is not estimated row by row", remedy))
    if problems:
        raise SceneError(*problems)


def _ignore(doing: str, done: int, total: int) -> None:
    """Progress that nobody asked for."""


def knowledge_of(layout: UnknownLayout) -> Knowledge:
    """What a scene says of its unknowns beforehand: bounds, priors, typical sizes."""
    limits = layout.own_limits
    typical = np.concatenate([entry.scales for entry in layout.own])
    # What is known beforehand says best what is much and what is little.
    deviations = 1.0 / np.where(limits.weight > 0.0, limits.weight, 1.0)
    sizes = np.where(limits.weight > 0.0, deviations, typical)
    return Knowledge(limits.lower, limits.upper, limits.mean, limits.weight, sizes)


def _found(
    library: EstimatorLibrary, cases: MeasuredCases, known: Knowledge, cores: int, report: Progress
) -> Estimates:
    """All cases, in chunks on all cores."""
    count = len(cases.inputs)
    parts = [cases.part(slice(first, first + CHUNK)) for first in range(0, count, CHUNK)]
    found = []
    done = 0
    with ThreadPoolExecutor(cores) as pool:
        for part in pool.map(lambda chunk: library.estimate(chunk, known), parts):
            found.append(part)
            done += len(part.outcome)
            report("Estimating", done, count)
    return Estimates(
        outcome=np.concatenate([part.outcome for part in found]),
        iterations=np.concatenate([part.iterations for part in found]),
        cost=np.concatenate([part.cost for part in found]),
        unknowns=np.vstack([part.unknowns for part in found]),
        information=np.vstack([part.information for part in found]),
        x=np.vstack([part.x for part in found]),
    )


def _reach(layout: UnknownLayout, inputs: FloatArray) -> list[FloatArray]:
    """Stacked inputs that the discretisation is chosen on: those of some cases, the unknown ones within reach."""
    limits = layout.own_limits
    indices = np.concatenate([entry.indices for entry in layout.own])
    rng = np.random.default_rng(SEED)
    rows = []
    for k in range(DRAWS):
        row = inputs[rng.integers(len(inputs))].copy()
        signs = rng.choice([-1.0, 1.0], len(indices)) if k else np.zeros(len(indices))
        deviations = np.where(limits.weight > 0.0, 1.0 / np.where(limits.weight > 0.0, limits.weight, 1.0), 0.0)
        expected = np.where(limits.weight > 0.0, limits.mean, row[indices])
        reached = expected + REACH * signs * deviations
        row[indices] = np.clip(reached, limits.lower, limits.upper)
        rows.append(row)
    return rows


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
        scene = result.model.scene
        solution = solve_scene(scene, result.model.inputs.unpack(result.inputs[row]))
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
