"""One discretisation for many load cases: what a controller needs, chosen beforehand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.model.load_cases import CaseLayout, case_layout
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene.writing import scene_tables

ROUNDS = 6
"""Most times that a discretisation is refined because a case misses the tolerance on it."""

Values = Mapping[str, npt.ArrayLike]
Progress = Callable[[int, int], None]
"""Told how many of how many solves are done; the total may grow."""


@dataclass(frozen=True)
class Tuning:
    """A discretisation that meets a tolerance over a set of load cases, or the best found.

    Attributes:
        scene: the scene with its modes, nodes and rotation integrator fixed, and the ranges that they hold over.
        solutions: of every case on that discretisation, each with its error estimate.
        met: whether every case converged with an estimate within the tolerance.
    """

    scene: scenes.Scene
    solutions: tuple[Solution, ...]
    met: bool

    @property
    def worst(self) -> int:
        """Index of the case with the largest error estimate; of the first that did not converge where one did not."""
        errors = [_error(solution) for solution in self.solutions]
        return errors.index(max(errors))


def tune(
    scene: scenes.Scene,
    cases: Sequence[Values],
    tolerance: float | None = None,
    progress: Progress | None = None,
) -> Tuning:
    """The smallest discretisation found that meets a tolerance at every load case.

    Each case chooses for itself; the union of what they chose is tried on all, and refined while a case misses.

    Args:
        scene: a validated scene; modes and nodes that it fixes are chosen anew.
        cases: inputs and parameters by name, at least one; those not named keep the scene's values.
        tolerance: wanted error of the tip poses relative to length; the scene's own by default.
        progress: told how many solves are done.

    Raises:
        SceneError: a value or the tolerance is refused.
    """
    if tolerance is None:
        tolerance = scene.accuracy.tolerance
    layout = case_layout(scene)
    rows = np.array([layout.pack(values) for values in cases])
    free = unfixed(scene, tolerance)
    variants = [_variant(free, layout, values) for values in cases]
    solved_cases = 0
    # Each case once by itself and once on the union, which may have to be refined.
    expected = 2 * len(cases)

    def solve_reporting(variant: scenes.Scene, values: Values) -> Solution:
        nonlocal solved_cases
        solution = solve_rods(variant, values)
        solved_cases += 1
        if progress is not None:
            progress(solved_cases, max(solved_cases, expected))
        return solution

    alone = [solve_reporting(variant, values) for variant, values in variants]
    chosen, together = common_discretisation(variants, alone, solve_reporting)
    met = all(_error(solution) <= tolerance for solution in together)
    tuned = with_accuracy(fixed(free, chosen), chosen_for=list(layout.ranges(rows)) or None)
    return Tuning(tuned, tuple(together), met)


def _variant(free: scenes.Scene, layout: CaseLayout, values: Values) -> tuple[scenes.Scene, Values]:
    """The scene with the parameters of a case as constants, and its inputs."""
    parameters = {name: value for name, value in values.items() if name in layout.parameters.names}
    inputs = {name: value for name, value in values.items() if name not in parameters}
    if not parameters:
        return free.baked(), inputs
    return layout.parameters.set_in(free, parameters), inputs


def common_discretisation(
    cases: Sequence[tuple[scenes.Scene, Values]],
    alone: Sequence[Solution],
    solve_case: Callable[[scenes.Scene, Values], Solution] = solve_rods,
) -> tuple[Discretisation, list[Solution]]:
    """One discretisation for many cases: the union of what each chose alone, refined while a case misses.

    Args:
        cases: scenes that leave modes and nodes open, of one tolerance, each with inputs by name.
        alone: solution of each case on a discretisation of its own.
        solve_case: solves a scene whose discretisation is fixed.

    Returns:
        the discretisation, and the solution of every case on it.
    """
    chosen = union_of([d for solution in alone for d in solution.model.discretisation.values()])
    for _ in range(ROUNDS):
        together = [solve_case(fixed(free, chosen), values) for free, values in cases]
        met = True
        for (free, _), solution in zip(cases, together, strict=True):
            met = met and _error(solution) <= free.accuracy.tolerance
        # More modes do not help a case that has no equilibrium.
        if met or not all(solution.converged for solution in together):
            break
        more_modes = tuple(m + 1 for m in chosen.modes)
        chosen = Discretisation(more_modes, chosen.nodes + 2, transport=chosen.transport)
    return chosen, together


def _error(solution: Solution) -> float:
    if not solution.converged or solution.error_estimate is None:
        return float("inf")
    return solution.error_estimate


def union_of(chosen: Sequence[Discretisation]) -> Discretisation:
    """The least discretisation with all the modes and nodes of these; one number of modes where rods differ."""
    counts = {len(d.modes) for d in chosen}
    if len(counts) == 1:
        by_component = zip(*[d.modes for d in chosen], strict=True)
        modes = tuple(max(component) for component in by_component)
    else:
        modes = (max(max(d.modes) for d in chosen),)
    nodes = max(d.nodes for d in chosen)
    # Names of the Magnus methods sort by their order.
    transport = max(d.transport for d in chosen)
    return Discretisation(modes, nodes, transport=transport)


def unfixed(scene: scenes.Scene, tolerance: float) -> scenes.Scene:
    """The scene with its discretisation to be chosen for a tolerance."""
    return with_accuracy(
        scene,
        tolerance=tolerance,
        modes=None,
        nodes=None,
        rotation=None,
        of_rods=None,
        chosen_for=None,
    )


def fixed(scene: scenes.Scene, chosen: Discretisation) -> scenes.Scene:
    """The scene with all rods on one discretisation."""
    modes: int | tuple[int, ...] = chosen.modes
    # One number suits rods that admit different strains too.
    if len(set(chosen.modes)) == 1:
        modes = chosen.modes[0]
    return with_accuracy(
        scene,
        modes=modes,
        nodes=chosen.nodes,
        rotation=chosen.transport,
        of_rods=None,
    )


def with_accuracy(scene: scenes.Scene, **changes: object) -> scenes.Scene:
    """The scene read again with other entries of its accuracy; None leaves one out."""
    tables = scene_tables(scene)
    entries = tables.get("accuracy", {})
    entries = {**entries, **changes}
    tables["accuracy"] = {key: value for key, value in entries.items() if value is not None}
    # Read again, so that what the scene format refuses is refused here too.
    return scenes.scene_from_dict(tables)
