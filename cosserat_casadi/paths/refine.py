"""A path on a discretisation that is fine enough: refined until the events and the end stay where they are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import ceil

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.metrics import ROUNDING, largest_turn
from cosserat_casadi.accuracy.refine import Report
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise, nodes_for
from cosserat_casadi.numerics.arclength import ArcSettings
from cosserat_casadi.numerics.continuation import Progress
from cosserat_casadi.paths.follow import EquilibriumPath, follow_path
from cosserat_casadi.paths.trace import PathOutcome

LADDER = (6, 9, 12, 16, 21, 28, 36)
"""Modes per strain component and element, rung by rung."""

SPARE = 2
"""Intervals beyond those that the modes of an unbent rod need."""

LOOKED_AT = 12
"""Points of a path whose turn says how many intervals the next rung needs."""


def follow_scene_path(
    scene: scenes.Scene,
    name: str,
    value: npt.ArrayLike,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    branch: int = 0,
    settings: ArcSettings | None = None,
    progress: Progress | None = None,
    report: Report | None = None,
) -> EquilibriumPath:
    """Follow a path of a scene on modes and nodes that meet its tolerance.

    Where the scene fixes modes or nodes they are used as they are, and no error is estimated. Else the path is
    followed with more and more modes until the factors of its events, relative, and the tips there and at the end,
    relative to the lengths, change by less than the tolerance; the last change is ``error_estimate``.

    Args:
        scene: a validated scene.
        name: as in :func:`follow_path`, like all that follow but the last.
        value: its value at factor 1.
        values: other inputs.
        branch: number of the bifurcation to leave at.
        settings: limits.
        progress: told the largest factor reached.
        report: told the discretisation.

    Raises:
        SceneError: the input is unknown, or a value is refused.
    """

    def follow(model: Model) -> EquilibriumPath:
        if report is not None:
            report(f"{model.size} unknowns, {max(d.nodes for d in model.discretisation.values())} intervals")
        return follow_path(model, name, value, values, branch=branch, settings=settings, progress=progress)

    if scene.accuracy.modes is not None or scene.accuracy.nodes is not None:
        return follow(build(scene))
    coarse: EquilibriumPath | None = None
    for modes in LADDER:
        turn = 0.0 if coarse is None else _turn(coarse)
        nodes = nodes_for(modes) + SPARE + ceil(turn / 2)
        fine = follow(build(scene, discretise(scene, modes, nodes, "magnus8")))
        change = np.inf if coarse is None else path_distance(coarse, fine)
        if change <= scene.accuracy.tolerance:
            return replace(fine, error_estimate=change + ROUNDING)
        coarse = fine
    return fine if not fine.converged else _unresolved(fine)


def path_distance(one: EquilibriumPath, other: EquilibriumPath) -> float:
    """Largest difference of two paths of a scene: event factors (relative), tips there and at factor 1 (over length).

    Infinite where they end otherwise or have other events.
    """
    kinds = [[event.kind for event in path.events] for path in (one, other)]
    if one.outcome is not other.outcome or kinds[0] != kinds[1]:
        return float("inf")
    gaps = [0.0]
    for a, b in zip(one.events, other.events, strict=True):
        gaps.append(abs(a.factor - b.factor) / max(abs(b.factor), 1e-12))
    for name, discrete_rod in one.model.discrete.rods.items():
        moved = [
            one.event_tip(a, name).position - other.event_tip(b, name).position
            for a, b in zip(one.events, other.events, strict=True)
        ]
        if one.converged:
            moved.append(one.tip(name).position[-1:] - other.tip(name).position[-1:])
        gaps += [float(np.abs(gap).max()) / discrete_rod.properties.length for gap in moved]
    return max(gaps)


def _turn(path: EquilibriumPath) -> float:
    """Largest angle through which an element turns at some points of a path, rad."""
    if not len(path.factor):
        return 0.0
    chosen = np.unique(np.linspace(0, len(path.factor) - 1, LOOKED_AT).astype(int))
    return max(largest_turn(path.solution(int(i))) for i in chosen)


def _unresolved(path: EquilibriumPath) -> EquilibriumPath:
    return replace(path, outcome=PathOutcome.UNRESOLVED, message=PathOutcome.UNRESOLVED.value)
