"""Optimisation problems in exact contact: solved again and again as relaxed contacts become exact.

The smoothing of the pairs goes to zero in a few solves, each from the optimum before it, and the sections that may
touch move to the places of the exact contacts. Each end is held against the exact law.
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
"""Index of the value at which sections move until they stay; smaller ones are for contacts that just open, where gap
and force are ε/√2 each."""

SOLVES = 7
"""Most solves."""

Optimum = Callable[[FloatArray], tuple[npt.ArrayLike, npt.ArrayLike]]
"""Parameters of all stages, shape (stages, parameters.size) ↦ their unknowns and inputs at the optimum."""


@dataclass(frozen=True)
class Tightened:
    """An optimum in exact contact.

    Attributes:
        z: unknowns and forces of the last solve of each stage, shape (stages, size).
        inputs: stacked inputs of each, shape (stages, inputs.size).
        p: smoothing and abscissae of each, shape (stages, parameters).
        equilibria: of the exact law at these inputs, with estimates of their errors.
        difference: largest distance of a tip or body between the two, over the length, or angle, rad.
        tolerance: wanted of the difference and these errors together.
        passing: stages to which a rod goes through an obstacle, on the straight way from the stage before, or to the
            first from the equilibrium that the problem was started near.
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
        """Whether the exact law has equilibria at all inputs that are, to the tolerance, where the problem has them."""
        balanced = all(solution.converged for solution in self.equilibria)
        return balanced and self.difference + self.error_estimate <= self.tolerance

    @property
    def error_estimate(self) -> float:
        """Largest estimate of the errors of the equilibria; infinite where one is not known."""
        known = [solution.error_estimate for solution in self.equilibria]
        return max(np.inf if error is None else error for error in known)

    @property
    def message(self) -> str:
        """A sentence for the user."""
        for number, solution in enumerate(self.equilibria):
            if not solution.converged:
                return f"Stage {number} has no equilibrium in exact contact that was found: {solution.message}"
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
        return f"Not tight: {told}, where {self.tolerance:.2g} was asked for: take more {remedy}.{note}"


def tightened(
    contact: RelaxedContact,
    optimum: Optimum,
    stages: int = 1,
    *,
    near: Solution | None = None,
    tolerance: float | None = None,
) -> Tightened:
    """Solve a problem again and again as its relaxed contacts become exact, and hold its end against the exact law.

    The smoothing ε goes to zero in a few solves. After each the exact contacts are found at the inputs of each stage,
    and its sections move there; that goes on until the two agree. Each stage is an equilibrium by itself, on whichever
    side of a thin obstacle the problem has it: see :attr:`Tightened.passing`.

    Args:
        contact: the model of the problem.
        optimum: solves the problem for given parameters of its stages, from its last optimum.
        stages: equilibria in the problem.
        near: an equilibrium of the scene at whose contacts there are sections from the beginning.
        tolerance: of the difference and the errors of the equilibria; by default the tolerance of the scene.

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
    """The numbers of all stages, a row each; refuse other shapes, and numbers that are not finite."""
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
