"""One discretisation for many load cases: what a controller needs, chosen beforehand."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene.writing import scene_tables
from cosserat_casadi.solver.accuracy import solve_scene
from cosserat_casadi.solver.solution import Solution

ROUNDS = 6
"""Most times that a discretisation is refined because a case misses the tolerance on it."""

Values = Mapping[str, npt.ArrayLike]
Progress = Callable[[int, int], None]
"""Told how many of how many solves are done; the total may grow."""


@dataclass(frozen=True)
class Tuning:
    """A discretisation that meets a tolerance over a set of load cases, or the best found.

    Attributes:
        scene: the scene with its modes, nodes and rotation integrator fixed.
        solutions: of every case on that discretisation, each with its error estimate.
        met: whether every case converged with an estimate within the tolerance.
    """

    scene: scenes.Scene
    solutions: tuple[Solution, ...]
    met: bool

    @property
    def worst(self) -> int:
        """Index of the case with the largest error estimate; of the first that did not converge where one did not."""
        return max(range(len(self.solutions)), key=lambda i: _error(self.solutions[i]))


def tune(
    scene: scenes.Scene, cases: Sequence[Values], tolerance: float | None = None, progress: Progress | None = None
) -> Tuning:
    """The smallest discretisation found that meets a tolerance at every load case.

    Each case chooses for itself; the union of what they chose is tried on all, and refined while a case misses.

    Args:
        scene: a validated scene; modes and nodes that it fixes are chosen anew.
        cases: inputs by name, at least one; those not named keep the scene's values.
        tolerance: wanted error of the tip poses relative to length; the scene's own by default.
        progress: told how many solves are done.

    Raises:
        SceneError: a value or the tolerance is refused.
    """
    wanted = scene.accuracy.tolerance if tolerance is None else tolerance
    free = _with_accuracy(scene, tolerance=wanted, modes=None, nodes=None, rotation=None)
    done, total = 0, 2 * len(cases)

    def told(solution: Solution) -> Solution:
        nonlocal done
        done += 1
        if progress is not None:
            progress(done, max(done, total))
        return solution

    alone = [told(solve_scene(free, values)) for values in cases]
    chosen = _union([d for s in alone for d in s.model.discretisation.values()])
    for _ in range(ROUNDS):
        fixed = _fixed(free, chosen)
        together = tuple(told(solve_scene(fixed, values)) for values in cases)
        met = all(_error(solution) <= wanted for solution in together)
        if met or not all(solution.converged for solution in together):
            break
        chosen = Discretisation(tuple(m + 1 for m in chosen.modes), chosen.nodes + 2, transport=chosen.transport)
    return Tuning(fixed, together, met)


def _error(solution: Solution) -> float:
    if not solution.converged or solution.error_estimate is None:
        return float("inf")
    return solution.error_estimate


def _union(chosen: Sequence[Discretisation]) -> Discretisation:
    """The least discretisation with all the modes and nodes of these; one number of modes where rods differ."""
    counts = {len(d.modes) for d in chosen}
    if len(counts) == 1:
        modes = tuple(max(column) for column in zip(*[d.modes for d in chosen], strict=True))
    else:
        modes = (max(max(d.modes) for d in chosen),)
    order = max(d.transport for d in chosen)
    return Discretisation(modes, max(d.nodes for d in chosen), transport=order)


def _fixed(scene: scenes.Scene, chosen: Discretisation) -> scenes.Scene:
    modes = chosen.modes[0] if len(set(chosen.modes)) == 1 else chosen.modes
    return _with_accuracy(scene, modes=modes, nodes=chosen.nodes, rotation=chosen.transport)


def _with_accuracy(scene: scenes.Scene, **changes: object) -> scenes.Scene:
    """The scene read again with other entries of its accuracy; None leaves one out."""
    tables = scene_tables(scene)
    entries = tables.get("accuracy", {}) | changes
    tables["accuracy"] = {key: value for key, value in entries.items() if value is not None}
    return scenes.scene_from_dict(tables)
