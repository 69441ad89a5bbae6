"""The error of an answer at any inputs, from modes and intervals that its model lacks (docs/theory.md, section 10).

Elasticity dominates the balance of high modes. So the stiffness alone, applied to the residual of a richer model, gives
the step of each missing mode; the Jacobian of the answer tells how its own unknowns follow. A few such sweeps converge
to Newton's correction with the richer model, without a richer Jacobian or a richer solve. If sweeps do not settle,
Newton's steps on the richer model follow; if these do not settle either, the error is unknown, and counts as the whole
length.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from cosserat_casadi.equilibrium.blindness import TurnedElements
from cosserat_casadi.equilibrium.load_path import column
from cosserat_casadi.equilibrium.metrics import ROUNDING, distance_of_poses
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.maths.pose_change import change_size
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discretise import ADDED_MODES_IN_LAYERS
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.model.watched import SAMPLES, WatchedNumbers, watched_cables
from cosserat_casadi.numerics.neutral import regular_inverse
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.scene import Scene

Answer = TypeVar("Answer", bound=Equilibrium[Any])

SAFETY = 1.2
"""Safety factor on the change by a richer model, which is not exact either."""

FIRST_LOOK = 2.0
"""Safety factor on the change by a first sweep, which may be only two thirds of the error."""

MOST_SWEEPS = 4
"""Sweeps after which Newton's method on the richer model takes over."""

MOST_STEPS = 6
"""Newton's steps on the richer model after which the error counts as unknown."""

SETTLED = 0.2
"""Relative difference of the changes by two successive sweeps or steps below which the last change is believed."""

SETTLED_IN_LAYERS = 0.1
"""SETTLED for scenes with contact layers, whose stiffness changes with each sweep."""

CONTRACTING = 0.5
"""Largest ratio of two successive steps of the missing modes with which a correction is believed."""

SHORTEST = 1e-10
"""Length of a step of the missing modes, as strain times length, below which it is rounding: ten times Newton's."""

SLOWEST = 0.7
"""Largest ratio of errors, or of the coefficients of a strain, with and without two more modes that is believed."""

UNKNOWN = 1.0
"""Error of an answer whose corrections do not settle: the whole length."""

NO_WRENCH = 1e-6
"""Least wrench, in units of EI/ℓ, to which the error of a wrench is relative."""

SMALL_PART = 0.01
"""Share of a whole wrench, in units of EI/ℓ, below which the error of its force or moment is relative to that share."""

THINNER = 1e-3
"""Relative change of the widths for a difference of residuals; its error of second order is as small."""

WAY = 1e-3
"""Share of the change of the unknowns at which poses are compared: the whole change may bend rods far."""


@dataclass(frozen=True)
class AnswerError:
    """Estimated errors of an answer.

    Attributes:
        watched: error of the poses of tips and bodies, as distance over the length and as angle in rad, and of the
            lengths of cables over the length; for held rods at sections between the ends too.
        shape: error of the poses of all sections, between the nodes too; no smaller than the error of the watched
            poses.
        wrench: relative error of the forces and moments of bases, supports and joints, and of unknown tensions.
    """

    watched: float
    shape: float
    wrench: float


@dataclass(frozen=True)
class Correction:
    """A correction of an answer after a sweep, or after a step of Newton's method on the richer model.

    Attributes:
        known: change of the unknowns of the answer, shape (n,).
        missing: coordinates of the missing modes, shape (missing,).
        change: change of the watched poses and lengths.
        contracts: whether the step of the missing modes is at most half of the step before, and was so before the
            unknowns of the answer followed. Modes bounce off a wall, which is not in their stiffness: poses then settle
            by chance.
        rests: whether the last step of the missing modes is a small part of their total change.
        settled: whether the missing modes rest, and the correction before this one had about the same change.
    """

    known: FloatArray
    missing: FloatArray
    change: float
    contracts: bool = True
    rests: bool = False
    settled: bool = False


@dataclass(frozen=True)
class RicherBalance:
    """Steps, residual and poses of the richer model at a corrected answer.

    Attributes:
        step: elastic step of the unknowns of the answer, shape (n,).
        missing_step: elastic step of the coordinates of the missing modes, shape (missing,).
        residual: residual in the unknowns of the answer, shape (n,).
        poses: watched poses and lengths.
    """

    step: FloatArray
    missing_step: FloatArray
    residual: FloatArray
    poses: WatchedNumbers


def with_error_estimate(solution: Solution) -> Solution:
    """A solution with estimates of its errors; its message warns of an error above the tolerance.

    A solution that is not an equilibrium is returned unchanged, and so is one with an estimate, which is a better one.
    """
    if not solution.converged or solution.error_estimate is not None:
        return solution
    return with_notes(estimated(solution))


def estimated(solution: Solution) -> Solution:
    """An equilibrium with the estimates of its errors and an unchanged message."""
    error = answer_error(solution)
    return replace(
        solution,
        error_estimate=error.watched,
        shape_error_estimate=error.shape,
        wrench_error_estimate=error.wrench,
    )


def with_notes(solution: Answer) -> Answer:
    """A solution with notes in its message on an error above the tolerance and on friction that is left out."""
    return replace(solution, message=solution.message + _tolerance_note(solution) + _friction_note(solution))


FRICTION_OF_CONTACT = (
    " Friction acts in motion and on paths. With friction, many shapes could be in equilibrium; this answer is without."
)
"""A sentence on an equilibrium of rods that rub on obstacles, or on each other."""

FRICTION_OF_JOINTS = " Friction of joints acts in motion alone, and is left out."
"""A sentence on equilibria of scenes with joints that rub."""

FRICTION_OF_BODIES = " Friction of bodies and disks acts in motion alone, and is left out."
"""A sentence on equilibria and paths of scenes in which bodies or disks rub on obstacles."""

FRICTION_IN_MOTION = (
    " Friction of exact contact between rods, and by a table of coefficients, acts in motion alone, and is left out."
)
"""A sentence on equilibria and paths of scenes with such friction."""


def left_out_friction(scene: Scene) -> str:
    """A sentence on friction of joints, which acts in motion alone; empty without such friction."""
    return FRICTION_OF_JOINTS if any(joint.rubs for joint in scene.joints) else ""


def left_out_on_paths(scene: Scene) -> str:
    """Sentences on friction that acts in motion alone, which paths leave out; empty without such friction."""
    of_bodies = any(obstacle.rubs and (obstacle.bodies or obstacle.disks) for obstacle in scene.obstacles)
    of_tables = any(
        obstacle.rubs and obstacle.presses_rods and not obstacle.rubs_on_paths for obstacle in scene.obstacles
    )
    of_rods = any(pair.rubs and pair.exact for pair in scene.rod_contacts)
    exact = FRICTION_IN_MOTION if of_tables or of_rods else ""
    return exact + left_out_friction(scene) + (FRICTION_OF_BODIES if of_bodies else "")


def _friction_note(solution: Equilibrium[Any]) -> str:
    """Sentences for an equilibrium of a scene in which something rubs; empty for other answers."""
    if not solution.converged or not isinstance(solution, Solution):
        return ""
    scene = solution.model.scene
    if solution.contacts and scene.touches_exactly:
        return (FRICTION_OF_CONTACT if scene.rubs_along_exact_paths else "") + left_out_on_paths(scene)
    if not (solution.contacts and scene.rubs and solution.model.inputs.memory is None):
        return left_out_friction(scene)
    of_bodies = all(touch.of_body for touch in solution.contacts)
    return (FRICTION_OF_BODIES if of_bodies else FRICTION_OF_CONTACT) + left_out_friction(scene)


def _tolerance_note(solution: Equilibrium[Any]) -> str:
    """A sentence for an answer whose estimated error is above the tolerance; empty for other answers."""
    if solution.within_tolerance is not False or not solution.converged:
        return ""
    error = solution.judged_error
    if error == UNKNOWN:
        return f" Its error is not known, and may be as large as the rod; {solution.remedy}"
    tolerance = solution.model.scene.accuracy.tolerance
    return (
        f" Its estimated error, {error:.2g} of the length, is above the tolerance of {tolerance:g}; {solution.remedy}"
    )


def answer_error(solution: Solution) -> AnswerError:
    """Estimate the error of an equilibrium of its model.

    Args:
        solution: a converged solution, at any inputs and parameters.
    """
    believed, correction = believed_correction(solution)
    if not believed:
        return AnswerError(UNKNOWN, UNKNOWN, UNKNOWN)
    safety = _safety_of(solution, correction)
    watched = safety * (correction.change + _rest_of_series(solution, correction)) + ROUNDING
    corrected = _richer_answer(solution, correction)
    shape_change = _shape_change(solution, corrected)
    # Wrenches of clamps follow the strains, which oscillate with the shape.
    with_rest = safety * (1.0 + _share_beyond(solution, correction, corrected, shape_change))
    shape = with_rest * shape_change + ROUNDING
    wrench = with_rest * _wrench_change(solution, corrected, correction) + ROUNDING
    return AnswerError(watched, max(shape, watched), wrench)


def watched_error(solution: Solution) -> float:
    """Estimate the error of the watched poses and lengths alone, at less cost.

    Args:
        solution: a converged solution, at any inputs and parameters.
    """
    believed, correction = believed_correction(solution)
    if not believed:
        return UNKNOWN
    return _safety_of(solution, correction) * (correction.change + _rest_of_series(solution, correction)) + ROUNDING


def _safety_of(solution: Solution, correction: Correction) -> float:
    """Safety factor on the change by a believed correction."""
    return safety_for(solution.model) if correction.settled else FIRST_LOOK


def safety_for(model: Model) -> float:
    """Safety factor on the change by a richer model, with the change by further modes where layers press rods."""
    return SAFETY * (1.0 + model.discrete.share_of_more_modes(ADDED_MODES_IN_LAYERS))


def believed_correction(solution: Solution) -> tuple[bool, Correction]:
    """Whether a correction is believed, and the last correction: by sweeps, else by Newton's steps on the richer model.

    No correction is believed if the missing modes cannot resolve the waves in elements that loads roll up.
    """
    settles, correction = _settled_correction(solution)
    if not settles:
        return False, correction
    elements = TurnedElements(solution.model.discrete.richer)
    return not elements.hide_waves(solution.x, correction.missing), correction


def _settled_correction(solution: Solution) -> tuple[bool, Correction]:
    """Whether corrections settle, and the last correction."""
    # A first sweep that leaves the answer within its tolerance need not be repeated.
    enough = enough_for(solution.model)
    settled = settled_for(solution.model)
    # Far from an answer the equations overflow: such corrections are not settled.
    with np.errstate(all="ignore"):
        for corrections in (_sweeps(solution), _newton_steps(solution)):
            before = np.inf
            for correction in corrections:
                if not np.isfinite(correction.change):
                    break
                rests = correction.contracts and correction.rests
                if rests and abs(correction.change - before) <= settled * correction.change:
                    return True, replace(correction, settled=True)
                if correction.contracts and correction.change <= enough:
                    return True, correction
                before = correction.change
    return False, correction


def settled_for(model: Model) -> float:
    """Relative difference of two successive changes below which the last change is believed."""
    return SETTLED_IN_LAYERS if model.discrete.has_layers else SETTLED


def enough_for(model: Model) -> float:
    """Change below which the first sweep is believed: the estimate that it gives is within the tolerance.

    Layers are so nonlinear that the first sweep may show only half of the change: with them it is not believed.
    """
    if model.discrete.has_layers:
        return ROUNDING
    return max(model.scene.accuracy.tolerance / FIRST_LOOK, ROUNDING)


def _sweeps(solution: Solution) -> Iterator[Correction]:
    """Corrections by elastic steps of the missing modes, each followed by a step of the unknowns of the answer.

    They end with the first step of the missing modes that does not contract.
    """
    model = solution.model
    inverse = inverse_jacobian(solution)
    known = np.zeros(model.size)
    missing = np.zeros(model.discrete.richer.missing_size)
    before = None
    bounced = False
    for _ in range(MOST_SWEEPS):
        lacking = richer_balance(solution, known, missing)
        missing_step = lacking.missing_step
        if before is not None and not _contracts(before, missing_step):
            return
        known = known + lacking.step
        missing = missing + missing_step
        balance = richer_balance(solution, known, missing)
        following = _following(solution, inverse, balance.residual)
        known = known + following
        # The next elastic step tells whether the missing modes bounce after their first step. The step after a bounce
        # may be short by chance, and is not believed either.
        bounces = before is None and not _contracts(missing_step, balance.missing_step)
        change = change_with_following(solution, balance, following)
        rests = _rests(solution, missing, missing_step)
        yield Correction(known, missing, change, contracts=not (bounces or bounced), rests=rests)
        before = missing_step
        bounced = bounces


def inverse_jacobian(solution: Solution) -> FloatArray:
    """Pseudo-inverse of the Jacobian at an answer, shape (n, n); variations that symmetry makes neutral do not move."""
    return regular_inverse(solution.model.path_jacobian(solution.x, solution.inputs, 1.0).full())


def _following(solution: Solution, inverse: FloatArray, residual: FloatArray) -> FloatArray:
    """Step by which the unknowns of an answer follow missing modes; its second part uses the answer's equations.

    In C the solver leaves an older Jacobian, and the second part makes up for its age.

    Args:
        solution: the answer.
        inverse: inverse of its Jacobian.
        residual: residual of the richer model in these unknowns, shape (n,).
    """
    first = -inverse @ residual
    left = residual + column(solution.model.path_residual(solution.x + first, solution.inputs, 1.0))
    return first - inverse @ left


def _contracts(before: FloatArray, step: FloatArray) -> bool:
    """Whether a step of the missing modes is at most half as long as the step before it, or rounding."""
    longest = max(CONTRACTING * float(np.linalg.norm(before)), SHORTEST)
    return bool(np.linalg.norm(step) <= longest)


def _rests(solution: Solution, missing: FloatArray, step: FloatArray) -> bool:
    """Whether the last step of the missing modes is a small part of all of them, or rounding."""
    longest = max(settled_for(solution.model) * float(np.linalg.norm(missing)), SHORTEST)
    return bool(np.linalg.norm(step) <= longest)


def richer_balance(solution: Solution, known: FloatArray, missing: FloatArray) -> RicherBalance:
    """Steps, residual and poses of the richer model at an answer with corrected unknowns and missing coordinates."""
    model = solution.model
    balance = column(model.richer_balance(solution.x, known, missing, solution.inputs))
    ends = np.cumsum([model.size, len(missing), model.size])
    step, missing_step, residual, poses = np.split(balance, ends)
    return RicherBalance(step, missing_step, residual, _watched_numbers(solution, poses))


def _watched_numbers(solution: Solution, poses: FloatArray) -> WatchedNumbers:
    """Watched poses and lengths from their column."""
    return WatchedNumbers.of_column(poses, len(watched_cables(solution.model.discrete)))


def watched_at(solution: Solution, x: FloatArray) -> WatchedNumbers:
    """Watched poses and lengths at unknowns x of the answer's model."""
    return _watched_numbers(solution, column(solution.model.watched(x, solution.inputs)))


def change_with_following(solution: Solution, balance: RicherBalance, following: FloatArray) -> float:
    """Largest change of a watched pose or length by a correction that ends with a step of the unknowns.

    The last step is evaluated on the answer's own modes and grid: the difference to richer ones is of second order.
    """
    before = watched_at(solution, solution.x)
    after = watched_at(solution, solution.x + following)
    return change_size(balance.poses.moved(before, after).change_from(before))


def richer_unknowns(
    solution: Solution, known: FloatArray | float = 0.0, missing: FloatArray | float = 0.0
) -> FloatArray:
    """Unknowns of the richer model: the answer's with a correction, and missing coordinates."""
    richer = solution.model.discrete.richer
    unknowns = np.zeros(richer.discrete.size)
    unknowns[richer.known] = solution.x + known
    unknowns[~richer.known] = missing
    return unknowns


def _newton_steps(solution: Solution) -> Iterator[Correction]:
    """Corrections by Newton's method on the richer model."""
    richer = solution.model.discrete.richer
    model = solution.model.richer
    unknowns = richer_unknowns(solution)
    before = None
    for _ in range(MOST_STEPS):
        residual = column(model.path_residual(unknowns, solution.inputs, 1.0))
        jacobian = model.path_jacobian(unknowns, solution.inputs, 1.0).full()
        if not np.all(np.isfinite(jacobian)):
            return
        step = -regular_inverse(jacobian) @ residual
        unknowns = unknowns + step
        missing, missing_step = unknowns[~richer.known], step[~richer.known]
        correction = _corrected(solution, unknowns[richer.known] - solution.x, missing)
        contracts = before is not None and _contracts(before, missing_step)
        yield replace(correction, contracts=contracts, rests=_rests(solution, missing, missing_step))
        before = missing_step


def _corrected(solution: Solution, known: FloatArray, missing: FloatArray) -> Correction:
    """A correction with the largest change of a watched pose or length; infinite where one is not finite."""
    poses = richer_balance(solution, known, missing).poses
    change = change_size(poses.change_from(watched_at(solution, solution.x)))
    return Correction(known, missing, change)


def _rest_of_series(solution: Solution, correction: Correction) -> float:
    """Change by modes beyond those of the richer model, whose highest degrees a first look does not know enough."""
    if not correction.settled or correction.change <= ROUNDING:
        return 0.0
    both = (correction, _without_last(solution, correction))
    whole, fewer = (richer_balance(solution, own.known, own.missing).poses for own in both)
    return change_size(whole.change_from(fewer)) * _sum_beyond(solution, correction)


def _share_beyond(solution: Solution, correction: Correction, corrected: Solution, change: float) -> float:
    """Share of a change of the shape, which waves between watched sections too, that modes beyond those would add."""
    if not correction.settled or change <= ROUNDING:
        return 0.0
    fewer = _richer_answer(solution, _without_last(solution, correction))
    return _shape_change(fewer, corrected) * _sum_beyond(solution, correction) / change


def _without_last(solution: Solution, correction: Correction) -> Correction:
    """A correction without the two highest degrees."""
    is_last = solution.model.discrete.richer.is_among_last
    return replace(correction, missing=np.where(is_last, 0.0, correction.missing))


def _sum_beyond(solution: Solution, correction: Correction) -> float:
    """Sum r + r² + … of what degrees beyond those of the richer model give, over what its two highest degrees give.

    The coefficients of each strain fall from two degrees to the next two as its highest four do: of two degrees one may
    be empty by symmetry. r is what the next two degrees of all strains would be, over what the highest two are.
    """
    richer = solution.model.discrete.richer
    squares = richer_unknowns(solution, correction.known, correction.missing) ** 2
    last, before = np.bincount(richer.degree_pairs, squares, 2 * richer.strain_count + 2)[:-2].reshape(-1, 2).T
    fall = np.divide(last, before, out=np.full(len(last), SLOWEST**2), where=last < SLOWEST**2 * before)
    ratio = float(np.sqrt(last @ fall / last.sum())) if last.any() else 0.0
    return ratio / (1 - ratio)


def _richer_answer(solution: Solution, correction: Correction) -> Solution:
    """The corrected answer as a solution of the richer model."""
    unknowns = richer_unknowns(solution, correction.known, correction.missing)
    return replace(solution, model=solution.model.richer, x=unknowns)


def _shape_change(solution: Solution, corrected: Solution) -> float:
    """Largest displacement over the length, or rotation angle (rad), of all sections of all rods."""
    changes = [0.0]
    for name in solution.model.discrete.rods:
        length = solution.model.length(name, solution.inputs)
        changes.append(distance_of_poses(solution.pose(SAMPLES, name), corrected.pose(SAMPLES, name), length))
    return max(changes)


def _wrench_change(solution: Solution, corrected: Solution, correction: Correction) -> float:
    """Largest relative change of a wrench: of the bases of rods, and of multipliers and tensions among the unknowns."""
    changes = [0.0]
    discrete = solution.model.discrete
    # The residual that Newton's method has left is also an error of wrenches that are zero.
    left = solution.residual_norm * (1 + float(np.linalg.norm(solution.x)))
    for _, entries in discrete.unknowns.of_kind(BlockKind.MULTIPLIER, BlockKind.TENSION, BlockKind.STOP):
        changes.append(_relative_change(solution.x[entries], correction.known[entries], left))
    for rod in discrete.rods.values():
        moment, force = _base_wrench_in_units(solution, rod)
        new_moment, new_force = _base_wrench_in_units(corrected, rod)
        whole = float(np.linalg.norm([*moment, *force]))
        # A small moment beside a large force is not accurate to all of its digits, and vice versa.
        least = max(NO_WRENCH, SMALL_PART * whole)
        changes.append(_relative_change(moment, new_moment - moment, left, least))
        changes.append(_relative_change(force, new_force - force, left, least))
    return max(changes)


def _base_wrench_in_units(solution: Solution, rod: DiscreteRod) -> tuple[FloatArray, FloatArray]:
    """Moment in EI/ℓ and force in EI/ℓ² of the clamp of a rod, shapes (3,)."""
    wrench = solution.base_wrench(rod.properties.name)
    moment = wrench.moment / rod.energy_unit
    force = wrench.force * rod.length / rod.energy_unit
    return moment, force


def _relative_change(values: FloatArray, difference: FloatArray, left: float, least: float = NO_WRENCH) -> float:
    """Norm of a difference plus the residual, over the norm of the values or the least norm that counts."""
    size = max(float(np.linalg.norm(values)), least)
    return (float(np.linalg.norm(difference)) + left) / size


def layer_error(solution: Solution) -> float | None:
    """Estimated change of the watched poses and lengths to zero widths of contact; None without smooth contact.

    Layers push by a law F(g/w) of the gap over the width. With thinner layers and a stiffness in proportion to 1/w, the
    gap under the same force is smaller in proportion: to first order the answer moves in proportion to the width. So
    its derivative by the logarithm of all widths is its distance from the answer with zero widths. It follows from the
    equations at the answer, dx = −J⁻¹ ∂r/∂(log w) by the implicit function theorem, without a solve.

    Args:
        solution: the end of a solve. There is no estimate without an equilibrium, or if friction remembers a path.

    Returns:
        distance over the length or angle in rad, whichever is largest; None without an estimate.
    """
    model = solution.model
    if not solution.converged or not model.discrete.has_layers or model.inputs.memory is not None:
        return None
    thinner = kept_with(model, "_thinner_layers", lambda: Model(model.discrete.with_layers(1.0 - THINNER)))
    arguments = (solution.x, solution.inputs, 1.0)
    residual_change = column(thinner.path_residual(*arguments)) - column(model.path_residual(*arguments))
    change = -inverse_jacobian(solution) @ residual_change / THINNER
    before, after = (watched_at(solution, x) for x in (solution.x, solution.x + WAY * change))
    estimate = SAFETY * change_size(after.change_from(before)) / WAY
    return float(estimate) if np.isfinite(estimate) else np.inf
