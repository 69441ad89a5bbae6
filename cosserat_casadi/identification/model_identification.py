"""Identification of a model's unknowns from its measurements, and the error that modes and nodes leave in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.models import build
from cosserat_casadi.equilibrium.answer_error import UNKNOWN, answer_error
from cosserat_casadi.equilibrium.contact.contact_answer_error import estimated_in_contact
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.identification.case_motions import StartInputs, check_motions
from cosserat_casadi.identification.fit_discretisation import with_discretisation
from cosserat_casadi.identification.fit_problem import SEED, Progress, Task
from cosserat_casadi.identification.fit_unknowns import UnknownLayout, refuse_row_parameters, unknown_layout
from cosserat_casadi.identification.identification_result import Identification
from cosserat_casadi.identification.measured_cases import Case, Data, read_cases
from cosserat_casadi.identification.measured_modes import check_vibrations
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Report, not_told
from cosserat_casadi.numerics.robust_loss import Loss
from cosserat_casadi.scene.measurements import ModeMeasurement
from cosserat_casadi.spelling import counted
from cosserat_casadi.tubes.tube_functions import AnyModel, TubeFunctions
from cosserat_casadi.tubes.tube_solve import FEWEST_STEPS, error_beside, finer_than, solution_at

RECHOSEN = 2
"""Times that a discretisation is chosen again at the identified numbers."""


def identify_model(
    model: AnyModel,
    data: Data | None = None,
    *,
    hold_out: float | None = None,
    starts: int | None = None,
    report: Report | None = None,
    progress: Progress | None = None,
) -> Identification:
    """Identify as :func:`identify` does, with a model on its modes and nodes."""
    refuse_row_parameters(model.scene)
    scene = model.scene
    options = scene.identification
    layout = unknown_layout(model)
    check_measured(model)
    cases = read_cases(scene, model.inputs, data)
    fitted, held_out = _split(cases, options.hold_out if hold_out is None else hold_out)
    _refuse_few_data(layout, fitted, scene)
    task = Task(
        model,
        layout,
        Loss(options.loss, options.loss_width),
        options,
        options.starts if starts is None else starts,
        report or not_told,
        progress,
    )
    found = task.run(fitted, held_out)
    task.report("judging the error of the model")
    return with_model_error(found, {case.where: case for case in fitted})


def identify(
    subject: scenes.Scene | AnyModel,
    data: Data | None = None,
    *,
    hold_out: float | None = None,
    starts: int | None = None,
    report: Report | None = None,
    progress: Progress | None = None,
) -> Identification:
    """Identify the unknowns of a scene, or of a model, from measurements.

    A model keeps its modes and nodes, or its steps. For a scene they are chosen to meet its tolerance, on the cases
    that lie farthest apart: at the scene's own numbers, and again at the identified numbers, which may bend the rods
    otherwise. Where these ask for more modes or steps, the search is made on them. Where the scene writes no tolerance
    and poses alone were measured, a tenth of the least of their deviations is enough.

    Args:
        subject: a scene with measurements and unknowns; or a model in which these are parameters and inputs:
            ``build(scene.with_unknowns())``.
        data: columns by measurement, by its name or its file, that stand for the file.
        hold_out: share of the cases that is not fitted but predicted; by default the scene's.
        starts: number of places from which the search begins; by default the scene's.
        report: called with the work under way.
        progress: told the steps of the search.

    Raises:
        SceneError: a table is refused, the model lacks an unknown, or there are fewer data than unknowns.
    """
    if not isinstance(subject, scenes.Scene):
        return identify_model(subject, data, hold_out=hold_out, starts=starts, report=report, progress=progress)
    scene = subject
    refuse_row_parameters(scene)
    completed = scene.with_unknowns()
    draft = build(completed, FEWEST_STEPS) if scene.tubes else build(completed)
    # All that is refused is refused before time is spent on a discretisation.
    unknown_layout(draft)
    check_measured(draft)
    cases = read_cases(completed, draft.inputs, data)
    tell = report or not_told
    tell("choosing the discretisation")
    choice = with_discretisation(completed, draft, cases, tell)
    found = identify_model(choice.model, data, hold_out=hold_out, starts=starts, report=report, progress=progress)
    for _ in range(RECHOSEN):
        if scene.accuracy.fixed or not found.converged:
            break
        tell("judging the discretisation")
        try:
            fitted = found.fitted_scene(completed)
        except SceneError:
            # What was found is told all the same; whoever wants the scene is told why there is none.
            break
        judged = with_discretisation(fitted, draft, _with_identified_inputs(cases, found), tell)
        same = judged.scene.accuracy == choice.scene.accuracy
        if same and judged.steps == choice.steps:
            break
        choice = replace(judged, scene=completed.model_copy(update={"accuracy": judged.scene.accuracy}))
        found = identify_model(choice.model, data, hold_out=hold_out, starts=starts, report=report, progress=progress)
    return replace(found, warnings=(*choice.warnings, *found.warnings))


def _with_identified_inputs(cases: Sequence[Case], found: Identification) -> list[Case]:
    """The cases that took part, with the inputs that were found for them."""
    by_name = {case.where: case for case in cases}
    added = StartInputs(found.model).added
    chosen = []
    for where, inputs in zip(found.cases, found.inputs, strict=True):
        case = by_name[where]
        chosen.append(replace(case, inputs=inputs - added if case.moves else inputs))
    return chosen


def check_measured(model: AnyModel) -> None:
    """Refuse a scene in which nothing was measured, or what cannot be had of it.

    Raises:
        SceneError: with all that is wrong.
    """
    scene = model.scene
    if not scene.measurements:
        raise SceneError(Problem("measurements", "missing", "say what was measured"))
    if isinstance(model, Model):
        if scene.touches_exactly:
            check_measured_in_contact(scene)
        if scene.measured_over_time:
            check_motions(model)
        check_vibrations(model)


def check_measured_in_contact(scene: scenes.Scene) -> None:
    """Refuse measurements of motions in exact contact: those over time, and of vibrations.

    Raises:
        SceneError: with every such measurement.
    """
    over_time = "was measured over time, and a motion that strikes an exact obstacle has no derivative at the blow"
    vibrating = "is of a vibration, whose derivatives are not known while exact contacts slide"
    problems = []
    for i, measurement in enumerate(scene.measurements):
        timed = getattr(measurement, "time", None) is not None
        if timed or isinstance(measurement, ModeMeasurement):
            problem = over_time if timed else vibrating
            problems.append(Problem(f"measurements[{i}]", problem, "give each obstacle a width, m"))
    refuse(problems)


def _split(cases: Sequence[Case], share: float) -> tuple[list[Case], list[Case]]:
    """Fitted cases, and held-out cases: the cases that rows name, and a share of the rest."""
    if not 0.0 <= share < 1.0:
        raise SceneError(Problem("--hold-out", f"must be >= 0 and < 1, got {share:g}"))
    others = [i for i, case in enumerate(cases) if not case.held_out]
    if not others:
        raise SceneError(Problem("measurements", "held_out holds out all cases", "leave at least one"))
    count = round(share * len(others))
    if share > 0.0 and count in (0, len(others)):
        problem = f"holds out {count} of {len(others)} cases"
        raise SceneError(Problem("--hold-out", problem, "hold out at least one, and leave at least one"))
    drawn = np.random.default_rng(SEED).permutation(len(others))[count:]
    kept = {others[i] for i in drawn.tolist()}
    fitted = [case for i, case in enumerate(cases) if i in kept]
    return fitted, [case for i, case in enumerate(cases) if i not in kept]


def _refuse_few_data(layout: UnknownLayout, cases: Sequence[Case], scene: scenes.Scene) -> None:
    """Refuse fewer data than unknowns: whatever they are, they can be met.

    Raises:
        SceneError: there are fewer.
    """
    data = 0
    for case in cases:
        for number, rows in case.data.items():
            differences = len(scene.measurements[number].differences)
            data += sum(int(np.isfinite(row.values[:differences]).sum()) for row in rows)
    shared, own = len(layout.shared_labels), len(layout.own_labels)
    priors = int(np.count_nonzero(layout.shared_limits.weight))
    priors += len(cases) * int(np.count_nonzero(layout.own_limits.weight))
    unknowns = shared + own * len(cases)
    if data + priors < unknowns:
        wanted = f"{counted(unknowns, 'unknown')} in {counted(len(cases), 'case')}"
        problem = f"{wanted} are too many for {counted(data + priors, 'number')}"
        raise SceneError(Problem("unknowns", problem, "leave some out, give priors, or measure more"))


def with_model_error(found: Identification, cases: Mapping[str, Case]) -> Identification:
    """An identification with the largest error of the equilibria that were measured, and a warning where it is large.

    Motions have the errors of their steps, and are left out here.

    Args:
        found: at the end of a search.
        cases: the fitted cases, by their first rows in words.
    """
    errors = {}
    if found.equilibria:
        for where, solution in zip(found.cases, found.equilibria, strict=True):
            errors[where] = _error_in_contact(solution)
    else:
        try:
            model = found.model.at(found.parameters)
        except SceneError:
            # Numbers that the scene refuses are no model whose error could be told.
            return found
        for where, x, inputs in zip(found.cases, found.unknowns_x, found.inputs, strict=True):
            if not cases[where].moves:
                errors[where] = _error(model, inputs, x)
    if not errors:
        return found
    worst = max(errors, key=lambda where: errors[where])
    told = replace(found, error_estimate=errors[worst], error_case=worst)
    if told.within_tolerance is not False:
        return told
    return replace(told, warnings=(*told.warnings, _warning(told)))


def _error(model: AnyModel, inputs: FloatArray, x: FloatArray) -> float:
    """The estimated error of an equilibrium that the tolerance binds; of tubes beside twice the steps."""
    if isinstance(model, TubeFunctions):
        solution = solution_at(model, inputs, x, found=True)
        beside = error_beside(solution, finer_than(solution))
        return UNKNOWN if beside is None else beside
    equilibrium = Solution(model, inputs, x, Outcome.CONVERGED, "", 0.0, 0)
    error = answer_error(equilibrium)
    return error.shape if equilibrium.model.scene.accuracy.shape else error.watched


def _error_in_contact(solution: Solution) -> float:
    """The estimated error of an equilibrium in exact contact; UNKNOWN where the search for contacts finds none."""
    if not solution.converged:
        return UNKNOWN
    judged = estimated_in_contact(solution)
    error = judged.shape_error_estimate if solution.model.scene.accuracy.shape else judged.error_estimate
    return UNKNOWN if error is None else error


def _warning(found: Identification) -> str:
    tolerance = found.model.scene.accuracy.tolerance
    remedy = "Choose modes and nodes for the range of what was measured with cosserat tune."
    if isinstance(found.model, TubeFunctions):
        remedy = "Build the model with more steps, or identify the scene."
    error = f"may be off by {found.error_estimate:.2g} of the length"
    if found.error_estimate == UNKNOWN:
        error = "has an error that is not known"
    return (
        f"The model itself {error} in {found.error_case}, where the tolerance is {tolerance:g}: the numbers found make "
        f"up for that. {remedy}"
    )
