"""A path on a sufficiently fine discretisation: refined until events and shapes do not change any more.

See docs/theory.md, section 12, "Modes".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import repeat
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.assess import min_modes
from cosserat_casadi.accuracy.levels import seeing_modes, verified_model
from cosserat_casadi.equilibrium.metrics import ROUNDING, cable_distance, largest_turn, pose_distance
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.numerics.arclength import ArcSettings
from cosserat_casadi.numerics.progress import Progress, Report
from cosserat_casadi.numerics.trace import PathOutcome
from cosserat_casadi.paths.equilibrium_path import EquilibriumPath
from cosserat_casadi.paths.follow import follow_path
from cosserat_casadi.paths.tube_path import TubePath, follow_tubes
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.tube_solution import TubeSolution

MODES = (6, 9, 12, 16, 21, 28, 36)
"""Modes per strain component and element, one refinement level after the other."""

SAMPLES = 12
"""Number of points of a path whose turns determine the modes and intervals of the next refinement level."""

SMALLEST_FACTOR = 1e-12
"""Factor of an event below which differences count absolutely."""


@overload
def follow(
    subject: scenes.Scene,
    name: str,
    value: npt.ArrayLike,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    branch: int = 0,
    settings: ArcSettings | None = None,
    first: TubeSolution | None = None,
    progress: Progress | None = None,
    report: Report | None = None,
) -> EquilibriumPath | TubePath: ...


@overload
def follow(
    subject: Model,
    name: str,
    value: npt.ArrayLike,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    branch: int = 0,
    settings: ArcSettings | None = None,
    first: EquilibriumPath | None = None,
    progress: Progress | None = None,
) -> EquilibriumPath: ...


@overload
def follow(
    subject: TubeFunctions,
    name: str,
    value: npt.ArrayLike,
    values: Mapping[str, npt.ArrayLike] | npt.ArrayLike | None = None,
    *,
    first: TubeSolution | None = None,
    settings: ArcSettings | None = None,
    progress: Progress | None = None,
) -> TubePath: ...


def follow(
    subject: scenes.Scene | Model | TubeFunctions,
    name: str,
    value: npt.ArrayLike,
    values: Any = None,
    **options: Any,
) -> EquilibriumPath | TubePath:
    """Follow the equilibria of a scene, or of a model, while one input moves.

    A model keeps its modes and nodes, or its steps. A scene is followed on modes and nodes, or steps, that meet its
    tolerance. Modes or nodes that the scene fixes are used, and no error is estimated. Otherwise the path is followed
    with more and more modes until the factors of its events, relative, and poses and lengths of cables at events, at
    both ends and between change by less than the tolerance; the last change is ``error_estimate``.

    An input begins at its value in ``values``, or by default at zero for rods, at the scene's value for concentric
    tubes.

    Args:
        subject: a validated scene, or a model of it: of rods, or of concentric tubes.
        name: an input; for concentric tubes a scalar, such as "inner.rotation" or "push.force.z".
        value: its value at factor 1.
        values: inputs at the beginning of the path, by name; other inputs keep the scene's values.
        options: named as follows.
        branch: for rods: number of the bifurcation, counted from 1, at which to leave along the crossing branch;
            negative for the other half of that branch, 0 to go straight on.
        settings: limits.
        first: for tubes, an equilibrium to begin at, such as one of another path; for rods with friction, a path that
            this one continues, with the history of friction at its end.
        progress: receives the largest factor reached.
        report: receives the discretisation of rods, in words.

    Raises:
        SceneError: the input is unknown, a value is refused, a path of tubes is to leave at a bifurcation, or one of
            rods to begin at an equilibrium of tubes.
    """
    if isinstance(subject, Model):
        return follow_path(subject, name, value, values, **options)
    if isinstance(subject, TubeFunctions) or subject.tubes:
        if options.pop("branch", 0):
            problem = "needs a scene of rods: a path of tubes goes straight on"
            raise SceneError(Problem("--branch", problem, "leave it out"))
        options.pop("report", None)
        return follow_tubes(subject, name, value, values, **options)
    if options.pop("first", None) is not None:
        problem = "needs concentric tubes, or friction on the modes and nodes of a model"
        raise SceneError(Problem("first", problem, "leave it out, or follow the model of a path"))
    return _follow_refined(subject, name, value, values, **options)


def _follow_refined(
    scene: scenes.Scene,
    name: str,
    value: npt.ArrayLike,
    values: Mapping[str, npt.ArrayLike] | None,
    *,
    branch: int = 0,
    settings: ArcSettings | None = None,
    progress: Progress | None = None,
    report: Report | None = None,
) -> EquilibriumPath:
    """Follow a path of rods on modes and nodes that meet the tolerance of their scene; see :func:`follow`."""

    def followed(model: Model, level: int = 0) -> EquilibriumPath:
        if report is not None:
            discretisations = model.discretisation.values()
            intervals = max(discretisation.nodes for discretisation in discretisations)
            report(f"{model.size} unknowns, {intervals} intervals")
        limits = settings or ArcSettings()
        if model.rubs_on_paths:
            # Friction is integrated from point to point: their distance is refined with the modes, so that its error
            # shows too.
            first, longest = limits.first / 2**level, limits.load_factor_change / 2**level
            limits = replace(limits, first=first, load_factor_change=longest)
        return follow_path(model, name, value, values, branch=branch, settings=limits, progress=progress)

    scene = scene.baked()
    accuracy = scene.accuracy
    fixed = accuracy.modes is not None or accuracy.nodes is not None
    if fixed:
        # Without a refinement there is no error estimate.
        return followed(build(scene))
    coarse: EquilibriumPath | None = None
    turn = 0.0
    visible_from = 0
    for level, modes in enumerate(seeing_modes(scene, MODES)):
        if modes < visible_from:
            continue
        fine = followed(verified_model(scene, modes, turn), level)
        samples = _samples(fine)
        turns = [largest_turn(sample) for sample in samples]
        visible_from = max(map(min_modes, samples, turns, repeat(accuracy.tolerance)), default=0)
        turn = max(turns, default=0.0)
        # Two levels may be near each other where both are blind to a wave.
        if coarse is not None and modes >= visible_from:
            change = path_distance(coarse, fine)
            if change <= accuracy.tolerance:
                change = max(change, _distance_between_events(coarse, fine))
            if change <= accuracy.tolerance:
                return replace(fine, error_estimate=change + ROUNDING)
        coarse = fine
    if not fine.converged:
        return fine
    return replace(fine, outcome=PathOutcome.UNRESOLVED, message=PathOutcome.UNRESOLVED.value)


def path_distance(coarse: EquilibriumPath, fine: EquilibriumPath) -> float:
    """Largest difference of two paths of a scene: of event factors, relative, and of watched poses and lengths.

    Poses and lengths of cables are compared at the first point, at the events and at factor 1. It is infinite if the
    paths end differently or have other events.
    """
    coarse_kinds = [event.kind for event in coarse.events]
    fine_kinds = [event.kind for event in fine.events]
    if coarse.outcome is not fine.outcome or coarse_kinds != fine_kinds:
        return float("inf")
    differences = [0.0]
    for coarse_event, fine_event in zip(coarse.events, fine.events, strict=True):
        difference = abs(coarse_event.factor - fine_event.factor)
        scale = max(abs(fine_event.factor), SMALLEST_FACTOR)
        differences.append(difference / scale)
    differences += [_distance(*pair) for pair in zip(_compared(coarse), _compared(fine), strict=True)]
    return max(differences)


def _distance_between_events(coarse: EquilibriumPath, fine: EquilibriumPath) -> float:
    """Largest such difference at points between events; infinite if the finer path has no nearby equilibrium.

    A path may bend rods more between its ends than there: a heavy rod that is turned from hanging to standing is
    straight at both ends.
    """
    differences = [0.0]
    for index, near, x in coarse.between_events(fine):
        if x is None:
            return float("inf")
        factor = float(coarse.factor[index])
        differences.append(_distance(coarse.shape(index, coarse.x[index], factor), fine.shape(near, x, factor)))
    return max(differences)


def _distance(coarse: Solution, fine: Solution) -> float:
    """Larger difference of two equilibria, of their poses and of the lengths of cables."""
    return max(pose_distance(coarse, fine), cable_distance(coarse, fine))


def _compared(path: EquilibriumPath) -> list[Solution]:
    """Equilibria at which paths are compared: the first point, the events, and the point at factor 1 if any."""
    if not len(path.factor):
        return []
    # A path that does not reach factor 1 has no end to compare.
    ends = (0, -1) if path.converged else (0,)
    solutions = [path.shape(index, path.x[index], float(path.factor[index])) for index in ends]
    return solutions + [path.event_shape(event) for event in path.events]


def _samples(path: EquilibriumPath) -> list[Solution]:
    """Equilibria at some points of a path, whose turns determine the next level."""
    count = len(path.factor)
    # Short paths have fewer points than samples.
    indices = np.unique(np.linspace(0, count - 1, min(SAMPLES, count)).astype(int))
    return [path.solution(int(index)) for index in indices]
