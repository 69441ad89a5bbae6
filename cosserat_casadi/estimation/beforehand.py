"""Prior knowledge of an estimate: the unknown numbers of each row, their ranges, priors and typical sizes.

These numbers are stacked as in the solver in C: inputs, followed by parameters.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.codegen.estimator import Knowledge
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.identification.fit_unknowns import UnknownEntry, UnknownLayout
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.load_cases import CaseLayout
from cosserat_casadi.scene.measurements import ModeMeasurement

REACH = 2.0
"""Deviations of the prior up to which the discretisation must be valid."""

DRAWS = 6
"""Number of cases within that reach for which the discretisation is chosen."""

SEED = 22
"""Seed of the draw of these cases, so that equal scenes have equal discretisations."""


def check_unknowns(scene: scenes.Scene) -> None:
    """Refuse a scene with measurements or unknowns that an estimate cannot use.

    Raises:
        SceneError: the scene has faults; the error lists all of them.
    """
    problems = []
    if not scene.measurements:
        problems.append(Problem("measurements", "missing", "say what was measured"))
    for i, measurement in enumerate(scene.measurements):
        if isinstance(measurement, ModeMeasurement):
            problem = f"{measurement.quantity}: an estimate has equilibria only, not their vibrations"
            problems.append(Problem(f"measurements[{i}].quantity", problem, "use cosserat identify"))
        elif getattr(measurement, "time", None) is not None:
            problem = "an estimate has equilibria only, no motion"
            problems.append(Problem(f"measurements[{i}].time", problem, "leave it out, or use cosserat identify"))
    if not scene.unknowns:
        problems.append(Problem("unknowns", "missing", "name the unknowns to estimate"))
    for i, unknown in enumerate(scene.unknowns):
        where = f"unknowns[{i}]"
        if not unknown.per_row and unknown.prior is None:
            problem = f"{unknown.name} is the same in all rows, and has no prior"
            remedy = "give it a prior, or per_row = true; or find it with cosserat identify --write before"
            problems.append(Problem(where, problem, remedy))
        elif unknown.name.endswith("quaternion"):
            remedy = "find it with cosserat identify"
            problems.append(Problem(where, "an estimate cannot find an orientation row by row", remedy))
    if scene.unknowns and not any(unknown.per_row for unknown in scene.unknowns):
        remedy = "give an input per_row = true, or find numbers that all rows share with cosserat identify"
        problems.append(Problem("unknowns", "no unknown differs from row to row", remedy))
    refuse(problems)


def unknown_parameters(scene: scenes.Scene) -> tuple[str | tuple[str, ...], ...]:
    """Names of the unknown parameters, of each row or shared by all."""
    return tuple(unknown.parameter for unknown in scene.unknowns if unknown.parameter is not None)


def with_unknown_parameters(model: Model) -> Model:
    """Make the model with these parameters alone; all other numbers become constants."""
    wanted = unknown_parameters(model.scene)
    if not wanted:
        return model.at()
    if model.scene.parameters == wanted:
        return model
    return build(model.scene.model_copy(update={"parameters": wanted}), model.discretisation)


def check_ranges(model: Model, layout: UnknownLayout) -> None:
    """Refuse ranges of parameters within which the structure of the scene changes, such as the order of places.

    The corners of the ranges of every two numbers are tried, with all others at the scene's values.

    Raises:
        SceneError: the scene refuses a corner; the error contains the first refusal for each unknown.
    """
    sides: list[tuple[int, float]] = []
    for entry in (*layout.own, *layout.shared):
        if not entry.of_input:
            lower, upper, _, _ = entry.limits()
            ends = zip([*entry.indices, *entry.indices], [*lower, *upper], strict=True)
            # Unknowns that all rows share have a prior, and need no bounds.
            sides += [(index, end) for index, end in ends if np.isfinite(end)]
    corners = [[side] for side in sides]
    corners += [list(pair) for pair in combinations(sides, 2) if pair[0][0] != pair[1][0]]
    problems: dict[str, Problem] = {}
    for corner in corners:
        p = model.parameters.pack()
        for index, value in corner:
            p[index] = value
        try:
            model.parameters.set_in(model.scene, model.parameters.unpack(p))
        except SceneError as error:
            for problem in error.problems:
                remedy = "narrow lower and upper of the unknowns" + (f": {problem.remedy}" if problem.remedy else "")
                problems.setdefault(problem.where, Problem(problem.where, problem.problem, remedy))
    refuse(problems.values())


def stacked_indices(entries: Sequence[UnknownEntry], inputs: int) -> list[int]:
    """Indices of the unknown numbers among the stacked inputs, followed by parameters."""
    found = []
    for entry in entries:
        first = 0 if entry.of_input else inputs
        found += (first + entry.indices).tolist()
    return found


def of_parameters(layout: UnknownLayout) -> list[int]:
    """Indices of the unknown numbers that are parameters."""
    kinds = [entry.of_input for entry in layout.own for _ in entry.labels]
    return [k for k, of_input in enumerate(kinds) if not of_input]


def knowledge_of(layout: UnknownLayout) -> Knowledge:
    """Collect the prior knowledge of the unknowns of each row: bounds, priors, typical sizes."""
    limits = layout.own_limits
    typical = np.concatenate([entry.scales for entry in layout.own])
    # Priors give the best scale of an unknown.
    deviations = 1.0 / np.where(limits.weight > 0.0, limits.weight, 1.0)
    sizes = np.where(limits.weight > 0.0, deviations, typical)
    # Searches of rows have no bound on steps: bounds by ratio are for unknowns that all cases share.
    return Knowledge(replace(limits, ratios=np.zeros_like(limits.ratios)), sizes)


def cases_within_reach(cases: CaseLayout, layout: UnknownLayout, inputs: FloatArray) -> Iterator[dict[str, FloatArray]]:
    """Cases for the choice of a discretisation: measured ones, with unknowns as far off as can be expected.

    Args:
        cases: inputs and parameters of the scene.
        layout: layout of the unknowns.
        inputs: inputs of all measured cases, shape (cases, inputs).
    """
    known = knowledge_of(layout)
    indices = stacked_indices(layout.own, cases.inputs.size)
    of_shared = stacked_indices(layout.shared, cases.inputs.size)
    limits = known.limits
    has_prior = limits.weight > 0.0
    # Parameters have bounds, whatever is known of them.
    is_parameter = np.isin(np.arange(len(indices)), of_parameters(layout))
    rng = np.random.default_rng(SEED)
    for k in range(DRAWS):
        row = cases.default.copy()
        row[: cases.inputs.size] = inputs[rng.integers(len(inputs))]
        row[of_shared] = layout.shared_limits.mean
        signs = rng.choice([-1.0, 1.0], len(indices)) if k else np.zeros(len(indices))
        deviations = np.where(has_prior, known.size, np.where(is_parameter, limits.upper - limits.lower, 0.0))
        row[indices] = limits.clipped(limits.expected(row[indices]) + REACH * signs * deviations)
        yield cases.unpack(row)
