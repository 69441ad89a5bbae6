"""The inverse problem of a scene on a discretisation that meets its tolerance at the resulting inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, overload

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.refine import LARGEST_SHAPE_ERROR
from cosserat_casadi.control.inverse import STARTS, check_targets, first_solution, inverse_problem, search, search_near
from cosserat_casadi.control.inverse import inverse as inverse_model
from cosserat_casadi.control.inverse_levels import levels_of
from cosserat_casadi.control.inverse_result import Inverse, with_verdict
from cosserat_casadi.control.targets import TARGET_KINDS, TargetMiss, length_of, target_errors, wanted_poses
from cosserat_casadi.equilibrium.contact.contact_state import given_inputs
from cosserat_casadi.equilibrium.solution import Equilibrium
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.pose_change import rotation_angles
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.system_functions import SystemFunctions
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import CountProgress, Report

Targets = tuple[scenes.Target, ...]
"""Targets that are to be met simultaneously."""


@overload
def inverse(subject: scenes.Scene, *, stable: bool = False, report: Report | None = None) -> Inverse: ...


@overload
def inverse(
    subject: SystemFunctions,
    *,
    start: Equilibrium[Any] | None = None,
    stable: bool = False,
    starts: int = STARTS,
    estimate_error: bool = True,
) -> Inverse: ...


def inverse(subject: scenes.Scene | SystemFunctions, **options: Any) -> Inverse:
    """Find inputs for which a scene, or a model, meets its targets.

    Of several solutions, one near the scene's own inputs is found. If the targets cannot all be met, within the bounds
    or at all, the weighted sum of squared target errors has a local minimum.

    For a scene, modes and nodes are chosen to meet its tolerance at the resulting inputs: the equilibrium there is also
    solved with more modes, and if that moves the poses by more than half of the tolerance, the search goes on with
    these modes. If the scene fixes modes or nodes, the error is only estimated: targets count as met if the target
    error and this estimate are both within the tolerance.

    Args:
        subject: a validated scene with targets, and with inputs that it lists or bounds; or a model of it.
        options: named as follows.
        stable: whether a stable equilibrium is wanted: an unstable one is relaxed and the search goes on from there,
            once. For loads that have a potential.
        report: callback with the discretisation; for a scene.
        start: equilibrium to start from, by default the one at the scene's own inputs, clipped to the bounds; for a
            model, like all further options.
        starts: number of further starts if a target error remains: scattered, by a fixed seed, over the inputs that are
            bounded on both sides; the best result counts. 0 for none.
        estimate_error: whether the error by modes and nodes at the resulting inputs is estimated; targets then count as
            met only if it is within the tolerance too.

    Raises:
        SceneError: the scene has no targets, or names no inputs to find; or a stable equilibrium is wanted under loads
            without a potential.
    """
    if not isinstance(subject, scenes.Scene):
        return inverse_model(subject, **options)
    (found,) = inverse_rows(subject, [subject.targets], **options)
    return found


def inverse_rows(
    scene: scenes.Scene,
    rows: Sequence[Targets],
    *,
    stable: bool = False,
    report: Report | None = None,
    progress: CountProgress | None = None,
) -> list[Inverse]:
    """Find inputs for each of many sets of targets, with every model built once for all rows that need it.

    A row starts from the nearest row that has met its targets, the first one from the scene's own inputs; rows are
    solved in order of nearness. Modes and nodes are chosen for each row as in :func:`inverse`.

    Args:
        scene: a validated scene.
        rows: sets of targets, at least one, with equal kinds, sections and bodies in every row.
        stable: whether stable equilibria are wanted, as in :func:`inverse`.
        report: callback with the discretisation.
        progress: callback with the numbers of finished rows and of all rows.

    Raises:
        SceneError: as in :func:`inverse`.
    """
    levels = levels_of(scene)
    for targets in rows:
        check_targets(targets)
    model = levels.first()
    settled: dict[int, Inverse] = {}
    pending: dict[int, Inverse] = {}
    starts: dict[int, Equilibrium[Any]] = {}
    for count in levels.counts:
        if report is not None:
            report(levels.told(model))
        if starts:
            pending = _refined(model, pending, starts, stable)
        else:
            pending = _searched(model, rows, stable, progress, report)
        for row, result in list(pending.items()):
            solution = result.solution
            if not solution.converged and solution.outcome is not Outcome.UNRESOLVED:
                settled[row] = with_verdict(pending.pop(row), stable)
        if not pending:
            break
        finer = levels.finer(count, model, [result.solution for result in pending.values()])
        starts = {}
        for row, result in list(pending.items()):
            # One solve at the same inputs gives the error of the level, and the start of a further search.
            reference = levels.reference(result.solution, finer)
            judged = replace(result, solution=levels.judged(result.solution, reference))
            ended = _ended(judged, stable, fixed=scene.accuracy.fixed)
            if ended is None:
                starts[row] = reference
            else:
                settled[row] = ended
        if not starts:
            break
        model = finer
    for row in starts:
        settled[row] = _unresolved(pending[row])
    return [settled[row] for row in range(len(rows))]


def _ended(judged: Inverse, stable: bool, *, fixed: bool) -> Inverse | None:
    """The result of a row whose error was estimated; None where more modes and nodes serve it better."""
    shape_error = judged.solution.largest_error
    if fixed and (shape_error is None or shape_error > LARGEST_SHAPE_ERROR):
        # As for a solve on fixed modes and nodes, the gaps are not known without an estimate.
        return _unresolved(judged)
    # A search that took too long for its starts is not repeated on more modes, where it takes longer still.
    if fixed or _error_within(judged) or judged.starts_left_out or judged.cut_short:
        return with_verdict(judged, stable)
    return None


def _searched(
    model: SystemFunctions,
    rows: Sequence[Targets],
    stable: bool,
    progress: CountProgress | None,
    report: Report | None,
) -> dict[int, Inverse]:
    """Search for every row on the first discretisation, each from its nearest neighbour that met its targets."""
    first = first_solution(model)
    problem = inverse_problem(model, rows[0], first, stable)
    lengths = np.array([length_of(model, target) for target in rows[0]])
    wanted = np.array([wanted_poses(targets).reshape(-1, POSE_SIZE) for targets in rows])
    starts = [first] * len(rows)
    # The nearest to where the rods are anyway comes first.
    distances = np.array([_distance(target_errors(first, targets), lengths) for targets in rows])
    found: dict[int, Inverse] = {}
    remaining = set(range(len(rows)))
    while remaining:
        if progress is not None:
            progress(len(found), len(rows))
        row = min(remaining, key=lambda candidate: (distances[candidate], candidate))
        remaining.discard(row)
        # The first equilibrium meets no targets: whether they are near is not known.
        searched = search if starts[row] is first else search_near
        result = searched(replace(problem, targets=rows[row]), starts[row], stable, STARTS, report)
        found[row] = result
        if not result.met:
            continue
        from_here = _distances(wanted, wanted[row], lengths)
        for other in remaining:
            if from_here[other] < distances[other]:
                distances[other] = from_here[other]
                starts[other] = result.solution
    return found


def _refined(
    model: SystemFunctions, before: Mapping[int, Inverse], starts: Mapping[int, Equilibrium[Any]], stable: bool
) -> dict[int, Inverse]:
    """Search for rows on a finer discretisation, each from its result on the coarser one."""
    first_row, first_start = next(iter(starts.items()))
    problem = inverse_problem(model, before[first_row].targets, first_start, stable)
    found = {}
    for row, start in starts.items():
        origin = problem.variables.clipped(given_inputs(start.model, start.inputs))
        of_row = replace(problem, targets=before[row].targets, origin=origin)
        # Scattered on the first discretisation alone: the next ones start from its end.
        result = search_near(of_row, start, stable, 0)
        rounds = before[row].rounds + result.rounds
        found[row] = replace(result, rounds=rounds, starts=max(before[row].starts, result.starts))
    return found


def _distance(gaps: Sequence[TargetMiss], lengths: FloatArray) -> float:
    """Distance of a solution from targets: the largest of distances over the lengths of their rods, and angles, rad."""
    distances = [0.0]
    for gap, length in zip(gaps, lengths, strict=True):
        distances += [gap.position / length, gap.angle or 0.0]
    return max(distances)


def _distances(wanted: FloatArray, here: FloatArray, lengths: FloatArray) -> FloatArray:
    """Distances of the wanted poses of rows from the poses of one row, over lengths, or angles, rad.

    Args:
        wanted: wanted poses, as in :func:`wanted_poses`, shape (rows, targets, 7).
        here: poses of the one row, shape (targets, 7).
        lengths: lengths of the rods, shape (targets,), m.

    Returns:
        the largest distance over the targets of each row, shape (rows,).
    """
    distances = np.linalg.norm(wanted[:, :, :3] - here[:, :3], axis=2) / lengths
    largest = distances.max(axis=1)
    for i, pose in enumerate(here):
        quaternions = np.broadcast_to(pose[3:], (len(wanted), 4))
        # Free orientations are zeros, which are no angle apart.
        angles = rotation_angles(quaternions, wanted[:, i, 3:])
        largest = np.maximum(largest, angles)
    return np.asarray(largest)


def _error_within(result: Inverse) -> bool:
    """Whether the estimated errors of the tips, and of the sections of targets, are within the tolerance."""
    solution = result.solution
    tolerance = solution.model.scene.accuracy.tolerance
    at_targets = [TARGET_KINDS[target.kind].model_error(target, solution) for target in result.targets]
    errors = [solution.error_estimate, *at_targets]
    return all(error is not None and error <= tolerance for error in errors)


def _unresolved(result: Inverse) -> Inverse:
    """Mark a result as unresolved; its target errors are those of the discrete model."""
    solution = result.solution.unresolved()
    if solution.largest_error is not None:
        message = f"{solution.message} The estimated error is {solution.largest_error:.2g} of the length."
        solution = replace(solution, message=message)
    return replace(result, solution=solution, gaps=target_errors(solution, result.targets), met=False)
