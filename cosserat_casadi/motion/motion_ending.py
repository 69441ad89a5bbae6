"""Outcome of a motion, and the sentence about it for the user."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.constraint_projection import Closing
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.felt_modes import TWIST
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.one_sided import OneSided
from cosserat_casadi.motion.trajectory import MotionOutcome
from cosserat_casadi.numerics.integration import StepOutcome

NEARLY_TAUT = 1e-3
"""Gap of a cable, over the rod's length, or of a joint, below which it counts as about to become taut, or to stop."""

DEPENDENT = 1e-2
"""Independence of the constraints below which they end a motion: it falls with the square root of the time left."""

BEYOND_LIMITS = (MotionOutcome.PATH_VANISHED, MotionOutcome.BEYOND_MATERIAL, MotionOutcome.OUT_OF_PLANE)
"""Outcomes of motions that end in states which no rod can have."""

OUTCOMES = {
    StepOutcome.COMPLETED: MotionOutcome.COMPLETED,
    StepOutcome.STEP_TOO_SMALL: MotionOutcome.STEP_TOO_SMALL,
    StepOutcome.NOT_SOLVED: MotionOutcome.NOT_SOLVED,
    StepOutcome.NOT_FINITE: MotionOutcome.NOT_FINITE,
    StepOutcome.SINGULAR: MotionOutcome.STEP_TOO_SMALL,
    StepOutcome.INTERRUPTED: MotionOutcome.INTERRUPTED,
    StepOutcome.TOO_MANY_STEPS: MotionOutcome.TOO_MANY_STEPS,
    StepOutcome.STALLED: MotionOutcome.CONTACT_UNSETTLED,
    StepOutcome.GUARDED: MotionOutcome.STEP_TOO_SMALL,
}


def outcome_of(history: History) -> MotionOutcome:
    """Determine the outcome of a motion; if a step was not solved, by the reason that the last state shows."""
    outcome = OUTCOMES[history.outcome]
    if outcome not in (MotionOutcome.STEP_TOO_SMALL, MotionOutcome.NOT_SOLVED):
        return outcome
    if snapping(history):
        return MotionOutcome.SNAPPED
    return MotionOutcome.SINGULAR_CONSTRAINT if independence(history) < DEPENDENT else outcome


def independence(history: History) -> float:
    """Independence of the constraints at the end of a motion, with columns scaled by displacements."""
    model = history.model
    rows = Closing(model).rows
    jacobian, _ = model.jacobian(history.end.x, history.legs[-1].piece.at(history.end.time).value)
    by_displacement = jacobian.full() / displacements(model)
    return independence_of(by_displacement[np.ix_(rows, np.flatnonzero(model.discrete.unknowns.differential))])


def independence_of(derivatives: FloatArray) -> float:
    """Independence of rows: 0 for linearly dependent ones, at most 1; infinite without rows.

    It is the smallest singular value over the largest, after rows are scaled to unit length.

    Args:
        derivatives: derivatives of constraints by coordinates, shape (m, n).
    """
    count, coordinates = derivatives.shape
    if count == 0:
        return float("inf")
    lengths = np.linalg.norm(derivatives, axis=1)
    if count > coordinates or not np.all(lengths > 0.0):
        return 0.0
    sizes = np.linalg.svd(derivatives / lengths[:, None], compute_uv=False)
    return float(sizes[-1] / sizes[0])


def snapping(history: History) -> list[str]:
    """Names of the cables that are nearly taut, and of the joints close to a stop, at the end of a motion."""
    model = history.model
    end = history.at(history.end.time)
    sided = OneSided(model)
    if not sided.pairs:
        return []
    gaps = sided.gaps(end.x, end.inputs)
    return [pair.name for pair, gap in zip(sided.pairs, gaps, strict=True) if abs(gap) <= NEARLY_TAUT]


def message_of(history: History, outcome: MotionOutcome) -> str:
    """Write the sentence of the outcome, with time and step size if the motion ended early."""
    if outcome in (MotionOutcome.COMPLETED, MotionOutcome.UNRESOLVED, *BEYOND_LIMITS):
        stopped = f" An event stopped it at t = {history.end.time:.6g} s." if history.stopped is not None else ""
        return f"{outcome.value}{stopped}"
    if outcome is MotionOutcome.CONTACT_UNSETTLED:
        return f"{outcome.value} {unsettled(history)}"
    reached = f"t = {history.end.time:.6g} s, with a step of {history.next_size:.3g} s"
    if outcome is MotionOutcome.SNAPPED:
        return f"{outcome.value} Reached: {reached}; the cable or joint is {', '.join(snapping(history))}."
    violent = f"{outcome.value} Reached: {reached}; the largest acceleration there is that of {most_violent(history)}."
    return violent + whirled(history)


def unsettled(history: History) -> str:
    """Write a sentence that says where contact did not settle."""
    restart = history.legs[-1].restart
    if restart.stalled is not None:
        return restart.stalled
    last = [event for leg in history.legs for event in leg.restart.events][-1]
    return (
        f"At t = {history.end.time:.6g} s {last.owner!r} touches {last.obstacle!r} and lifts off over and over about "
        f"X = {last.place:.4g}."
    )


def whirled(history: History) -> str:
    """Write a sentence on rods without rotary inertia if a motion ends in a blow on them, or as it begins; else "".

    Such a rod resists rotation about its axis only by the mass beside its chord, which a nearly straight rod lacks.
    """
    leg = history.legs[-1]
    if leg.integration.steps:
        return ""
    without = {name for name, rod in history.model.discrete.rods.items() if rod.properties.rotary_inertia is None}
    if leg.start.massless > 0 and without:
        names = ", ".join(repr(name) for name in sorted(without))
        return f" {names} can spin about the tangent without resistance: give rotary_inertia, kg m."
    struck = {event.owner for event in leg.restart.events if event.kind == "impact"}
    rods = history.model.discrete.rods
    light = [repr(name) for name in rods if name in struck & without and TWIST in rods[name].properties.admitted]
    if not light:
        return ""
    return f" A blow spins {', '.join(light)} about the tangent without resistance: give rotary_inertia, kg m."


def most_violent(history: History) -> str:
    """Name the rod, or the body, whose accelerations displace it most at the end of a motion."""
    model = history.model
    accelerations = np.nan_to_num(np.abs(history.end.a), nan=np.inf) * displacements(model)
    largest = {}
    for block, entries in model.discrete.unknowns.of_kind(BlockKind.STRAIN, BlockKind.POSE):
        kind = "rod " if block.kind is BlockKind.STRAIN else ""
        largest[f"{kind}{block.owner}"] = float(accelerations[entries].max(initial=0.0))
    return max(largest, key=lambda owner: largest[owner])
