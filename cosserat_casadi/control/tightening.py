"""Optimisation problems in exact contact, solved repeatedly as relaxed contacts become exact.

The smoothing of the pairs goes to zero in a few solves, each from the optimum before it, and the sections that may
touch move to the places of the exact contacts. Each result is compared with the exact law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.answer_error import with_notes
from cosserat_casadi.equilibrium.contact.contact_answer_error import estimated_in_contact
from cosserat_casadi.equilibrium.contact.passing_through import passes_through
from cosserat_casadi.equilibrium.contact.relaxed_contact import FIRST_SMOOTHING, RelaxedContact
from cosserat_casadi.equilibrium.metrics import pose_distance
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray

SMOOTHINGS = (FIRST_SMOOTHING, 1e-3, 1e-4, 1e-5, 1e-6)
"""Values of ε of one solve after the other: at the third, gap times force is 5e-9 of the length and of EI/ℓ²."""

LAST_SECTIONS = 2
"""Index of the value at which sections move until they stay; smaller values are for contacts that just open, where gap
and force are ε/√2 each."""

SOLVES = 7
"""Most solves."""

Optimum = Callable[[FloatArray], tuple[npt.ArrayLike, npt.ArrayLike]]
"""Parameters of all stages, shape (stages, parameters.size) ↦ unknowns and inputs of all stages at the optimum."""


@dataclass(frozen=True)
class Tightened:
    """An optimum in exact contact.

    Attributes:
        z: unknowns and forces of the last solve of each stage, shape (stages, size).
        inputs: stacked inputs of each stage, shape (stages, inputs.size).
        p: smoothing and abscissae of each stage, shape (stages, parameters).
        equilibria: equilibria of the exact law at these inputs, with error estimates.
        difference: largest distance of a tip or body between relaxed and exact law, over the length, or angle, rad.
        tolerance: bound on the sum of the difference and these errors.
        passing: stages that a rod reaches through an obstacle, on the straight way from the stage before, or to the
            first stage from the initial equilibrium.
    """

    z: FloatArray
    inputs: FloatArray
    p: FloatArray
    equilibria: tuple[Solution, ...]
    difference: float
    tolerance: float
    passing: tuple[int, ...] = ()

    @property
    def converged(self) -> bool:
        """Whether the exact law has equilibria at all inputs, which agree with the problem to the tolerance."""
        balanced = all(solution.converged for solution in self.equilibria)
        return balanced and self.difference + self.error_estimate <= self.tolerance

    @property
    def error_estimate(self) -> float:
        """Largest error estimate of the equilibria; infinite if one is unknown."""
        known = [solution.error_estimate for solution in self.equilibria]
        return max(np.inf if error is None else error for error in known)

    @property
    def message(self) -> str:
        """A sentence for the user."""
        for number, solution in enumerate(self.equilibria):
            if not solution.converged:
                return f"Stage {number} has no known equilibrium in exact contact: {solution.message}"
        known = f"rods in exact contact, known to {self.error_estimate:.2g},"
        told = f"{known} are within {self.difference:.2g} of the problem's"
        unstable = [number for number, solution in enumerate(self.equilibria) if solution.stable is False]
        note = f" Not stable: stages {', '.join(map(str, unstable))}." if unstable else ""
        if self.passing:
            note += (
                f" On the straight way to stages {', '.join(map(str, self.passing))} a rod goes through an obstacle."
            )
        if self.converged:
            return f"Tight: {told}.{note}"
        remedy = "sections" if self.difference > self.error_estimate else "modes of the model"
        return f"Not tight: {told}, but the tolerance is {self.tolerance:.2g}: take more {remedy}.{note}"


def tightened(
    contact: RelaxedContact,
    optimum: Optimum,
    stages: int = 1,
    *,
    near: Solution | None = None,
    tolerance: float | None = None,
) -> Tightened:
    """Solve a problem repeatedly as its relaxed contacts become exact, and compare the result with the exact law.

    The smoothing ε goes to zero in a few solves. After each solve the exact contacts are found at the inputs of each
    stage, and its sections move there, until both agree. Each stage is a separate equilibrium, on either side of a thin
    obstacle: see :attr:`Tightened.passing`.

    Args:
        contact: the model of the problem.
        optimum: function that solves the problem for given parameters of its stages, from its last optimum.
        stages: number of equilibria in the problem.
        near: an equilibrium of the scene, at whose contacts there are sections from the beginning.
        tolerance: bound on the difference and the errors of the equilibria; by default the tolerance of the scene.

    Raises:
        SceneError: ``optimum`` returns other shapes, or numbers that are not finite.
    """
    wanted = contact.model.scene.accuracy.tolerance if tolerance is None else tolerance
    first = contact.defaults if near is None else contact.moved_to(near, contact.defaults)
    moved = np.tile(first, (stages, 1))
    level = 0
    before = np.inf
    for _ in range(SOLVES):
        p = moved
        p[:, 0] = SMOOTHINGS[level]
        unknowns, controls = optimum(p)
        z = _of_stages("unknowns", unknowns, (stages, contact.size))
        inputs = _of_stages("inputs", controls, (stages, contact.inputs.size))
        optima = list(zip(z, inputs, p, strict=True))
        equilibria = [contact.exact(*of_stage) for of_stage in optima]
        difference = np.inf
        if all(solution.converged for solution in equilibria):
            relaxed = [contact.solution(*of_stage) for of_stage in optima]
            difference = max(map(pose_distance, relaxed, equilibria))
        moved = np.array(list(map(contact.moved_to, equilibria, p)))
        if level < LAST_SECTIONS:
            level += 1
        elif difference <= wanted:
            break
        elif np.array_equal(moved, p):
            # A difference that does not fall with the smoothing has another cause.
            if not difference < before / 2 or level + 1 == len(SMOOTHINGS):
                break
            level += 1
        before = difference
    judged = [with_notes(estimated_in_contact(solution)) if solution.converged else solution for solution in equilibria]
    ways = zip([near, *judged[:-1]], judged, strict=True)
    passing = [
        number
        for number, (start, end) in enumerate(ways)
        if start is not None and start.converged and end.converged and passes_through(start, end)
    ]
    return Tightened(z, inputs, p, tuple(judged), difference, wanted, tuple(passing))


def _of_stages(what: str, values: npt.ArrayLike, shape: tuple[int, int]) -> FloatArray:
    """Return the numbers of all stages as rows; refuse other shapes, and numbers that are not finite."""
    array = np.asarray(values, dtype=float)
    if 1 in shape and array.size == shape[0] * shape[1]:
        array = array.reshape(shape)
    if array.shape != shape:
        problem = f"returned {what} of shape {array.shape}, wanted are stages × {what}, {shape}"
        raise SceneError(Problem("optimum", problem, "transpose what the problem has in columns"))
    if not np.isfinite(array).all():
        problem = f"returned {what} that are not finite"
        raise SceneError(Problem("optimum", problem, "start nearer to an equilibrium, or bound the variables"))
    return array
