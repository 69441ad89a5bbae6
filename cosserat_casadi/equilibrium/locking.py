"""Kinematic locking: modes for which constraints leave no motion that a load could cause (docs/theory.md, section 10).

Counting degrees of freedom against constraints is not enough: a platform on six legs of three bending modes each has
eighteen degrees of freedom more than constraints, and all of them leave the platform where it is. So the compliance of
each load, the motion of the watched poses by a small load, is compared with the compliance of a model with modes added.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from cosserat_casadi.equilibrium.answer_error import richer_unknowns
from cosserat_casadi.equilibrium.load_path import column
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.numerics.neutral import regular_inverse

LOCKED = 0.01
"""Share of the compliance on more modes below which the model counts as locked against a load."""

NONE = 1e-6
"""Compliance, relative to the largest of the same input, that counts as zero, as it may be on more modes too."""

STEP = 1e-5
"""Largest change of an unknown, in its unit, at which compliance is measured."""


def degrees_of_freedom(model: Model) -> int | None:
    """Degrees of freedom less constraints; None without constraints."""
    unknowns = model.discrete.unknowns
    constraints = unknowns.count(BlockKind.MULTIPLIER, BlockKind.TENSION)
    if not constraints:
        return None
    # The quaternion of a frame has one number more than its rotation has degrees of freedom.
    frames = sum(min(block.size, 6) for block, _ in unknowns.of_kind(BlockKind.POSE))
    return unknowns.count(BlockKind.STRAIN, BlockKind.COORDINATE) + frames - constraints


def has_freedom(model: Model) -> bool:
    """Whether there are more degrees of freedom than constraints: otherwise the model is locked under every load."""
    count = degrees_of_freedom(model)
    return count is None or count > 0


def locked_inputs(solution: Solution) -> tuple[str, ...]:
    """Names of the inputs, lengths excepted, that move nothing on the modes of a solution, but would on more modes.

    Args:
        solution: a converged solution.
    """
    model = solution.model
    if degrees_of_freedom(model) is None:
        return ()
    locked = []
    for (name, own), (_, more) in zip(
        _compliances(model, solution.x, solution.inputs),
        _compliances(model.richer, richer_unknowns(solution), solution.inputs),
        strict=True,
    ):
        moves = more > NONE * more.max(initial=0.0)
        if np.any(moves) and np.all(own[moves] < LOCKED * more[moves]):
            locked.append(name)
    return tuple(locked)


def _compliances(model: Model, x: FloatArray, inputs: FloatArray) -> Iterator[tuple[str, FloatArray]]:
    """Motion of the watched poses per unit of each entry of every input, by name; lengths are left out."""
    inverse = regular_inverse(model.path_jacobian(x, inputs, 1.0).full())
    responses = -inverse @ residual_by_inputs(model, x, inputs)
    for entry, span in model.inputs:
        if not entry.declared.moves:
            motions = [motion(model, x, inputs, responses[:, k]) for k in range(span.start, span.stop)]
            yield entry.name, np.array(motions)


def residual_by_inputs(model: Model, x: FloatArray, inputs: FloatArray) -> FloatArray:
    """Derivatives of the residual by the inputs, shape (size, inputs)."""
    units = np.eye(len(inputs))
    rates = [column(model.path_rate(x, inputs, 1.0, unit, 0.0)) for unit in units]
    return np.reshape(rates, (len(inputs), model.size)).T


def motion(model: Model, x: FloatArray, inputs: FloatArray, step: FloatArray) -> float:
    """Motion of the watched poses by a step of the unknowns, to first order: over the length, or in quaternions."""
    largest = float(np.abs(step).max(initial=0.0))
    share = STEP / max(largest, STEP)
    before, after = (column(model.watched(unknowns, inputs)) for unknowns in (x, x + share * step))
    return float(np.abs(after - before).max(initial=0.0)) / share


NOT_KNOWN = (
    "Whether constraints lock the modes that the scene fixes is not known: the test needs an equilibrium, and none "
    "was found at the scene's own inputs."
)
"""Sentence without an equilibrium at which locking could be tested."""


def locking_sentence(locked: Sequence[str]) -> str:
    """A sentence for inputs that move nothing on these modes; empty without such inputs."""
    if not locked:
        return ""
    return (
        f"The model is kinematically locked: its constraints leave its modes no motion by {', '.join(locked)}, though "
        "more modes would have one: leave modes out of the scene, or give more."
    )


def may_be_locked(model: Model) -> bool:
    """Whether the scene has constraints and fixed modes: modes chosen for the tolerance are not locked.

    False in exact contact too, where forces are inputs of another model for every arrangement.
    """
    scene = model.scene
    if scene.touches_exactly or not scene.accuracy.fixed_by_hand:
        return False
    return degrees_of_freedom(model) is not None


def locking_note(solution: Solution) -> str:
    """The sentence on locking; empty without an equilibrium."""
    if not solution.converged or not may_be_locked(solution.model):
        return ""
    return locking_sentence(locked_inputs(solution))


def with_locking_note(solution: Solution) -> Solution:
    """A solution with a note in its message if modes that the scene fixes are locked."""
    note = locking_note(solution)
    return replace(solution, message=f"{solution.message} {note}") if note else solution
