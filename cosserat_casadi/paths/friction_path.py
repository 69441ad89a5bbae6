"""Paths with friction: one input grows in increments, with a history of the rods.

Friction at rest depends on the path. The path begins at the equilibrium without friction. Each increment uses the
history of the point before, ends at an equilibrium, and then updates the history: implicit Euler for Coulomb's law.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from cosserat_casadi.equilibrium.judge import judge
from cosserat_casadi.equilibrium.load_path import column, input_path
from cosserat_casadi.equilibrium.rubbing import RubbingStretch, rubbing_stretches
from cosserat_casadi.equilibrium.smooth_passage import SmoothBarriers
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.arclength import ArcSettings
from cosserat_casadi.numerics.newton import NewtonSettings, newton
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Progress
from cosserat_casadi.numerics.trace import GROWTH, PathOutcome
from cosserat_casadi.paths.equilibrium_path import EquilibriumPath, InputChange, path_along

QUICK = NewtonSettings(iterations=20)
"""Limits of Newton's method at an increment."""

SHORTEST = 1e-6
"""Share of the input below which an increment counts as stalled."""

WITHIN = 0.9
"""Share of the longest change of the shape at which an increment aims, by extrapolation of the last one."""


@dataclass(frozen=True, repr=False, kw_only=True)
class FrictionPath(EquilibriumPath):
    """Equilibria of rods with friction on obstacles, or on each other.

    Attributes:
        histories: inputs ``history`` of the model at each point, shape (k, h), on which friction depends.
        slips: drag over the drag at which a section slips, for nodes load after load, then for sections pair after
            pair, shape (k, nodes and sections); −1 for sections that are not pressed.
    """

    histories: FloatArray
    slips: FloatArray

    @property
    def all_inputs(self) -> FloatArray:
        """Stacked inputs at all points, shape (k, model.inputs.size)."""
        inputs = super().all_inputs
        inputs[:, self.model.inputs.memory] = self.histories
        return inputs

    def rubbing(self, index: int) -> tuple[RubbingStretch, ...]:
        """The stretches that stick or slip at a point of the path."""
        return rubbing_stretches(self.model, self.slips[index])


@dataclass(frozen=True)
class _Point:
    """A point of the path.

    Attributes:
        factor: share of the input.
        solution: equilibrium.
        history: for the next increment, shape (h,).
        slips: slips of the nodes and sections.
    """

    factor: float
    solution: Solution
    history: FloatArray
    slips: FloatArray


def _equilibrium(model: Model, inputs: FloatArray, before: list[Solution], longest: float) -> Solution | None:
    """Equilibrium next to the last point of a path; None if none is found.

    Newton's method begins at the extrapolated last increment, since sections that slip continue so, then at the last
    point, whose slipping sections are at the limit. If many sections change from sticking to slipping both may fail:
    the inputs are then moved in parts.

    Args:
        model: model with memory.
        inputs: stacked inputs with the history of the last point.
        before: the last two points, or the first one.
        longest: largest change of shapes and poses, in the 2-norm of their unknowns; forces may jump.
    """
    last = before[-1]
    barriers = SmoothBarriers(model)
    places = model.discrete.unknowns.differential
    equations = input_path(model, last.x, inputs, inputs).at(1.0)
    found: Solution | None = None
    for start in (2 * last.x - before[0].x, last.x):
        end = newton(equations, start, QUICK)
        if end.outcome is Outcome.CONVERGED and np.linalg.norm((end.x - last.x)[places]) <= longest:
            found = judge(model, inputs, end.x, end.outcome, end.iterations, 1.0, QUICK.tolerance)
            break
    if found is None:
        # A new history does not change the forces: the last point is in balance with it.
        settled = np.where(model.inputs.of_memory, inputs, last.inputs)
        found = solve(model, inputs, start=replace(last, inputs=settled), estimate_error=False)
    near = np.linalg.norm((found.x - last.x)[places]) <= longest
    passes = barriers.any and barriers.are_between(last.x, found.x, (last.inputs, inputs))
    return found if found.converged and near and not passes else None


def next_factor(settings: ArcSettings, step: float, last: Sequence[tuple[float, FloatArray]]) -> float:
    """Factor of the next point of a path with friction.

    Args:
        settings: settings with the longest increment and the longest change of the shape.
        step: wanted increment, unless the shape, at its last rate of change, would change too much.
        last: factor and shape, in equal units, of the last two points, or of the first one.
    """
    (before, shape), (factor, reached) = last[0], last[-1]
    way = float(np.linalg.norm(reached - shape))
    allowed = WITHIN * settings.longest * (factor - before) / way if way > 0.0 else inf
    end = min(factor + min(step, settings.load_factor_change, allowed), 1.0)
    return 1.0 if 1.0 - end < SHORTEST else end


def follow_friction_path(
    moved: InputChange[Model],
    settings: ArcSettings,
    *,
    first: EquilibriumPath | None = None,
    progress: Progress | None = None,
) -> FrictionPath:
    """Follow the equilibrium of rods with friction while one input grows to its value.

    Args:
        moved: the change of an input of a model with memory, without history.
        first: a path that this one continues; by default there is no friction at factor 0.
        settings: settings, of which only the limits of the load factor and of a step are used.
        progress: receives the reached factor.
    """
    model = moved.model
    memory = model.inputs.memory
    assert memory is not None, "a model with memory"
    places = model.discrete.unknowns.differential

    def point(factor: float, solution: Solution) -> _Point:
        history, slips, _ = model.memory(solution.x, solution.inputs)
        return _Point(factor, solution, column(history), column(slips.T))

    start = solve(model, moved.base, estimate_error=False) if first is None else first.solution(-1)
    points = [point(0.0, start)] if start.converged else []
    outcome: PathOutcome | None = None if points else PathOutcome.NO_START
    step = settings.first
    while outcome is None:
        before = points[-1]
        factor = next_factor(settings, step, [(point.factor, point.solution.x[places]) for point in points[-2:]])
        inputs = moved.inputs(factor)
        inputs[memory] = before.history
        found = _equilibrium(model, inputs, [point.solution for point in points[-2:]], settings.longest)
        if found is not None:
            points.append(point(factor, found))
            step = GROWTH * (factor - before.factor)
        else:
            step = (factor - before.factor) / 2
        if progress is not None:
            progress(points[-1].factor)
        if points[-1].factor == 1.0:
            outcome = PathOutcome.CONVERGED
        elif step < SHORTEST:
            outcome = PathOutcome.LOAD_STALLED
        elif len(points) > settings.steps:
            outcome = PathOutcome.MAX_STEPS
    return path_along(
        moved,
        FrictionPath,
        outcome,
        factor=np.array([found.factor for found in points]),
        x=np.array([found.solution.x for found in points]).reshape(-1, model.size),
        smallest_eigenvalue=None,
        neutral=None,
        events=(),
        histories=np.array([found.solution.inputs[memory] for found in points]).reshape(-1, memory.stop - memory.start),
        slips=np.array([found.slips for found in points]).reshape(-1, model.memory.size_out(1)[1]),
    )
