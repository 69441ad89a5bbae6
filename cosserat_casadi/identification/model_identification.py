"""Identification of a model's unknowns from its measurements, with the error by modes and nodes.

Equilibria, vibrations and motions may be measured; modes and nodes are chosen for these measurements.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.common_modes import CommonModes, LoadCase
from cosserat_casadi.accuracy.fixing import fixed_alike, unfixed, union_of, with_accuracy
from cosserat_casadi.accuracy.models import build
from cosserat_casadi.equilibrium.answer_error import UNKNOWN, answer_error
from cosserat_casadi.equilibrium.contact.contact_answer_error import estimated_in_contact
from cosserat_casadi.equilibrium.metrics import SAFETY
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.identification.case_motions import StartInputs, check_motions
from cosserat_casadi.identification.fit_problem import SEED, Progress, Task
from cosserat_casadi.identification.fit_unknowns import UnknownLayout, refuse_row_parameters, unknown_layout
from cosserat_casadi.identification.fitted_scene import with_inputs
from cosserat_casadi.identification.identification_result import Identification
from cosserat_casadi.identification.measured_cases import Case, Data, Datum, read_cases
from cosserat_casadi.identification.measured_modes import check_vibrations
from cosserat_casadi.identification.misfit import inputs_of, moving
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.motion_refinement import simulate
from cosserat_casadi.motion.vibration_modes import ModesOutcome, modes_of
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Report, not_told
from cosserat_casadi.numerics.robust_loss import Loss
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene.measurements import ModeMeasurement
from cosserat_casadi.spelling import counted
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.tube_functions import AnyModel, TubeFunctions
from cosserat_casadi.tubes.tube_solve import (
    FEWEST_STEPS,
    TubeModels,
    error_beside,
    finer_than,
    solution_at,
    solve_inputs,
)

SAMPLES = 4
"""Number of cases for which a discretisation is chosen."""

SHARE_OF_SIGMA = 0.1
"""Largest error of the model, in standard deviations of the measurements."""

LOOSEST = 1e-3
"""Largest tolerance of equilibria, as `accuracy.tolerance`, because a sigma may be a guess."""

LEAST = 1e-6
"""Tolerance of a motion, over the length, below which none is asked for where the scene does not."""

RECHOSEN = 2
"""Most repeated choices of a discretisation, at the identified numbers."""


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

    A model keeps its modes and nodes, or its steps. For a scene they are chosen to meet its tolerance, for the cases
    that are farthest apart: at the scene's own numbers, and again at the identified numbers, which may bend the rods
    differently. If these need more modes or steps, the search is repeated on them. If the scene has no tolerance and
    only poses were measured, the tolerance is a tenth of the least of their deviations.

    Args:
        subject: a scene with measurements and unknowns; or a model in which these are parameters and inputs:
            ``build(scene.with_unknowns())``.
        data: columns by measurement, by its name or its file, which replace the file.
        hold_out: share of the cases that is predicted and not fitted; by default the scene's.
        starts: number of starts of the search; by default the scene's.
        report: callback with the work under way.
        progress: callback with the steps of the search.

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
            # The result is reported all the same; a request for the scene gets the reason why there is none.
            break
        judged = with_discretisation(fitted, draft, _with_identified_inputs(cases, found), tell)
        same = judged.scene.accuracy == choice.scene.accuracy
        if same and judged.steps == choice.steps:
            break
        choice = replace(judged, scene=completed.model_copy(update={"accuracy": judged.scene.accuracy}))
        found = identify_model(choice.model, data, hold_out=hold_out, starts=starts, report=report, progress=progress)
    return replace(found, warnings=(*choice.warnings, *found.warnings))


def _with_identified_inputs(cases: Sequence[Case], found: Identification) -> list[Case]:
    """Cases that took part, with the inputs that were found for them."""
    by_name = {case.where: case for case in cases}
    added = StartInputs(found.model).added
    chosen = []
    for where, inputs in zip(found.cases, found.inputs, strict=True):
        case = by_name[where]
        chosen.append(replace(case, inputs=inputs - added if case.moves else inputs))
    return chosen


def check_measured(model: AnyModel) -> None:
    """Refuse a scene without measurements, or with measurements that it cannot provide.

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
        SceneError: there are such measurements; the error lists all of them.
    """
    over_time = "was measured over time, and a motion that strikes an exact obstacle has no derivative at the blow"
    vibrating = "belongs to a vibration, whose derivatives are not known while exact contacts slide"
    problems = []
    for i, measurement in enumerate(scene.measurements):
        timed = getattr(measurement, "time", None) is not None
        if timed or isinstance(measurement, ModeMeasurement):
            problem = over_time if timed else vibrating
            problems.append(Problem(f"measurements[{i}]", problem, "give each obstacle a width, m"))
    refuse(problems)


def _split(cases: Sequence[Case], share: float) -> tuple[list[Case], list[Case]]:
    """Split cases into fitted and held-out ones: the cases that rows mark, and a share of the rest."""
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
    """Refuse fewer data than unknowns, which any data would fit.

    Raises:
        SceneError: there are fewer data than unknowns.
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
    """Add the largest error of the measured equilibria to an identification, with a warning if it is large.

    Motions have errors of their steps, and are left out here.

    Args:
        found: result of a search.
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
    """Estimate the error of an equilibrium for comparison with the tolerance; for tubes by twice the steps."""
    if isinstance(model, TubeFunctions):
        solution = solution_at(model, inputs, x, found=True)
        beside = error_beside(solution, finer_than(solution), SAFETY)
        return UNKNOWN if beside is None else beside
    equilibrium = Solution(model, inputs, x, Outcome.CONVERGED, "", 0.0, 0)
    error = answer_error(equilibrium)
    return error.shape if equilibrium.model.scene.accuracy.shape else error.watched


def _error_in_contact(solution: Solution) -> float:
    """Estimate the error of an equilibrium in exact contact; UNKNOWN if the search for contacts fails."""
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
        f"The model itself {error} in {found.error_case}, where the tolerance is {tolerance:g}: the identified "
        f"numbers make up for that. {remedy}"
    )


@dataclass(frozen=True)
class FitDiscretisation:
    """A scene on chosen modes and nodes, with warnings about them.

    Attributes:
        scene: scene with fixed modes and nodes, unless no case has an equilibrium for which to choose them.
        warnings: warnings as sentences.
        steps: steps of a piece of concentric tubes; None for rods.
    """

    scene: scenes.Scene
    warnings: tuple[str, ...] = ()
    steps: int | None = None

    @property
    def model(self) -> AnyModel:
        """The model of the scene."""
        return build(self.scene) if self.steps is None else build(self.scene, self.steps)


def with_discretisation(
    scene: scenes.Scene, draft: AnyModel, cases: Sequence[Case], report: Report
) -> FitDiscretisation:
    """Choose modes and nodes of the scene for the cases that are farthest apart.

    Args:
        scene: scene whose unknowns and inputs set by columns are free.
        draft: a model of the scene.
        cases: the measured cases.
        report: callback with the stage.
    """
    if scene.accuracy.fixed:
        return FitDiscretisation(scene)
    tolerance = _tolerance(scene, cases)
    if isinstance(draft, TubeFunctions):
        asked = with_accuracy(scene, tolerance=tolerance)
        models = TubeModels(robot_of(asked))
        rows = inputs_of(cases)
        steps = [solve_inputs(models, rows[row]).model.steps for row in _far_apart(rows, SAMPLES)]
        return FitDiscretisation(asked, steps=max(steps))
    baked = unfixed(scene.baked(), tolerance)
    warnings: list[str] = []
    chosen: list[Discretisation] = []
    moves = moving(cases)
    inputs = StartInputs(draft).of(inputs_of(cases), moves)
    unloaded = scene.simulation is not None and scene.starts_unloaded
    at_rest = inputs[~moves] if unloaded else inputs
    chosen += _for_equilibria(baked, draft, at_rest, report)
    numbers = [int(datum.at) for case in cases for datum in _vibrations(scene, case)]
    if numbers:
        row = next(i for i, case in enumerate(cases) if _vibrations(scene, case))
        values = draft.inputs.unpack(inputs[row])
        of_modes = _after("discretisation for frequencies", report)
        modes = modes_of(baked, values, count=max(numbers) + 1, report=of_modes)
        chosen += modes.model.discretisation.values()
        if modes.outcome is not ModesOutcome.RESOLVED:
            warnings.append(f"The discretisation for frequencies: {modes.message}")
    if np.any(moves):
        moved = _moving_scene(baked, draft, cases[int(np.flatnonzero(moves)[0])])
        of_motion = _after("discretisation for motions", report)
        motion = simulate(moved, progress=lambda at: of_motion(f"{at.stage}, t = {at.time:.4g} s"), compiled=False)
        chosen += motion.model.discretisation.values()
        if not motion.converged:
            warnings.append(f"The discretisation for motions: {motion.message}")
    if not chosen:
        return FitDiscretisation(scene)
    # Written out: a tolerance that nobody has written asks nothing of modes that are fixed.
    asked = with_accuracy(scene, tolerance=tolerance)
    return FitDiscretisation(fixed_alike(asked, union_of(chosen)), tuple(warnings))


def _tolerance(scene: scenes.Scene, cases: Sequence[Case]) -> float:
    """Tolerance of the scene; if it has none, the one that the least deviation of the measured poses needs.

    Deviations of other quantities, such as forces or frequencies, are not comparable with pose errors: the default is
    used then.
    """
    default = scene.accuracy.tolerance
    if "tolerance" in scene.accuracy.model_fields_set:
        return default
    lengths = {rod.name: rod.length for rod in scene.rods} | {tube.name: tube.length for tube in scene.tubes}
    relative: list[float] = []
    for number in {number for case in cases for number in case.data}:
        record = scene.measurements[number]
        units = record.differences
        if not set(units) <= {"m", "rad"}:
            return default
        # A body is as far from a base as the longest rod.
        length = lengths.get(getattr(record, "rod", None) or "", max(lengths.values()))
        sigmas = np.broadcast_to(np.asarray(record.sigma, dtype=float), len(units))
        relative += [sigma / length if unit == "m" else sigma for sigma, unit in zip(sigmas, units, strict=True)]
    return min(max(default, SHARE_OF_SIGMA * float(min(relative, default=0.0))), LOOSEST)


def _after(task: str, report: Report) -> Report:
    """Make a callback for the stages of a task that is one stage of another task."""
    return lambda stage: report(f"{task}: {stage}")


def _for_equilibria(baked: scenes.Scene, draft: Model, inputs: FloatArray, report: Report) -> list[Discretisation]:
    """Choose a discretisation for rows of inputs, shape (cases, size): a list of one, empty without an equilibrium."""
    if not len(inputs):
        return []
    cases = [LoadCase(baked, draft.inputs.unpack(inputs[row])) for row in _far_apart(inputs, SAMPLES)]
    search = CommonModes(cases, lambda done, total: report(f"discretisation for equilibria: {done} of {total} solves"))
    answers = search.refined()
    if len(search.without_equilibrium) == len(cases):
        return []
    return list(answers.chosen.values())


def _vibrations(scene: scenes.Scene, case: Case) -> list[Datum]:
    """Measurements of vibrations in a case."""
    data: list[Datum] = []
    for number, rows in case.data.items():
        if isinstance(scene.measurements[number], ModeMeasurement):
            data += rows
    return data


def _moving_scene(scene: scenes.Scene, draft: Model, case: Case) -> scenes.Scene:
    """Make the scene with the inputs of a case, and with a tolerance of its motion that suits the measurements."""
    given = draft.inputs.unpack(case.inputs)
    moved = {motion.input for motion in scene.motions if motion.is_table}
    changed = with_inputs(scene, {name: value for name, value in given.items() if name not in moved})
    simulation = changed.simulation
    assert simulation is not None, "rules of the scene"
    if simulation.tolerance is not None:
        return changed
    sigmas = [
        float(np.min(scene.measurements[number].sigma))
        for number in case.data
        if scene.measurements[number].differences[0] == "m"
    ]
    length = sum(rod.length for rod in scene.rods)
    tolerance = max([LEAST, *(SHARE_OF_SIGMA * sigma / length for sigma in sigmas)])
    return changed.model_copy(update={"simulation": simulation.model_copy(update={"tolerance": min(tolerance, 1e-2)})})


def _far_apart(points: FloatArray, count: int) -> list[int]:
    """Select rows of points that are far apart, relative to the range of columns; the first is farthest from zero."""
    width = np.ptp(points, axis=0)
    scaled = points / np.where(width > 0, width, np.inf)
    chosen = [int(np.argmax(np.linalg.norm(scaled, axis=1)))]
    distance = np.linalg.norm(scaled - scaled[chosen[0]], axis=1)
    while len(chosen) < count and distance.max() > 0:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(scaled - scaled[chosen[-1]], axis=1))
    return chosen
