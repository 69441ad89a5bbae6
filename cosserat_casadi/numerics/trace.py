"""A curve of equilibria from load factor 0 to 1: steps, step control, events on the way, and the end.

A branch that crosses the curve leaves along a null vector of ∂g/∂y across it. A point at a small distance along it is
corrected onto the branch in the plane across that vector: E. L. Allgower, K. Georg, *Introduction to Numerical
Continuation Methods*, SIAM 2003, chapter 8. See docs/theory.md, section 12.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import ArcPoint, Curve
from cosserat_casadi.numerics.events import Arc, Event, events_between
from cosserat_casadi.numerics.neutral import direction_in
from cosserat_casadi.numerics.outcome import LabelledOutcome
from cosserat_casadi.numerics.progress import Progress

GROWTH = 1.5
"""Factor on the step after a quick correction."""

SEPARATE = 1e-4
"""Step below which events that cannot be separated are left out."""

FARTHEST = -1.0
"""Load factor below which a path counts as running backwards."""

AWAY = 4
"""Number of steps after which a path that comes near its start counts as closed."""


Guard = Callable[[Arc, ArcPoint], ArcPoint | None]
"""A test that may end a step early."""


class PathOutcome(LabelledOutcome):
    """Outcomes of a path. Only CONVERGED has reached load factor 1."""

    CONVERGED = "The path reached its end, factor 1."
    NO_START = "No path: at factor 0 there is no equilibrium to start from."
    LOAD_STALLED = "The path could not be followed further: the step fell below its limit."
    MAX_STEPS = "The path was not followed further: the steps ran out before factor 1."
    TURNED_BACK = "The path led back: its factor fell below -1."
    CLOSED = "The path is closed: it came back to its start without reaching factor 1."
    NO_BIFURCATION = "No branch: the path ended before the chosen bifurcation."
    NO_BRANCH = "No branch: none was found at the bifurcation."
    CONTACT_UNSETTLED = "The path could not be followed further: the search found no set of contacts to go on with."
    UNRESOLVED = (
        "The path of the discrete model reached its end, but the rod is not resolved to the tolerance asked for: "
        "fix more modes and nodes, or allow a larger tolerance."
    )
    PATH_VANISHED = (
        "The rod cannot follow the path of the discrete model: it bends so far that a tendon has no length left along "
        "it."
    )
    BEYOND_MATERIAL = (
        "The rod cannot follow the path of the discrete model: a strain, or the pressure in a chamber, is beyond "
        "where its law holds."
    )
    OUT_OF_PLANE = (
        "The rod cannot follow the path of the discrete model: a joint or a support leaves the plane that its rods "
        "bend in."
    )


@dataclass
class Trace:
    """The computed part of a curve.

    Attributes:
        points: accepted points in the order of travel.
        events: special points in the order of travel.
        outcome: outcome of the path; None while it is followed.
        branch: index of the first point on the crossing branch; None on the first curve.
        corner: arclength just behind the last corner.
    """

    points: list[ArcPoint]
    events: list[Event] = field(default_factory=list)
    outcome: PathOutcome | None = None
    branch: int | None = None
    corner: float = -np.inf


def trace(curve: Curve, *, branch: int = 0, progress: Progress | None = None, guard: Guard | None = None) -> Trace:
    """Follow a curve from the start of its path, at load factor 0, until the load factor first reaches 1.

    Args:
        curve: the curve.
        branch: number of the bifurcation, counted from 1, at which to leave along the crossing branch; negative for the
            other half of that branch, 0 to go straight on.
        progress: receives the largest load factor reached, in [0, 1].
        guard: guard of the steps, as in :func:`extend`.
    """
    # The start has no point before it: that the load grows decides which way is forward.
    unloaded = np.append(curve.path.start, 0.0)
    growing_load = np.append(np.zeros_like(curve.path.start), 1.0)
    first = curve.point(unloaded, growing_load, 0.0)
    if first is None:
        return Trace([], outcome=PathOutcome.NO_START)
    traced = Trace([first])
    step = curve.settings.first
    largest = 0.0
    for _ in range(curve.settings.steps):
        # A path is left once: on the branch it goes straight on.
        leave_at = branch if traced.branch is None else 0
        step = extend(curve, traced, step, leave_at, guard)
        reached = min(traced.points[-1].load_factor, 1.0)
        largest = max(largest, reached)
        if progress is not None:
            progress(largest)
        if traced.outcome is not None:
            return traced
    traced.outcome = PathOutcome.MAX_STEPS
    return traced


def extend(curve: Curve, traced: Trace, step: float, leave_at: int, guard: Guard | None = None) -> float:
    """Try one step and add its points and events to a trace.

    Args:
        curve: the curve.
        traced: the computed part of the curve.
        step: arclength to try.
        leave_at: number of the bifurcation, as ``branch`` of :func:`trace`.
        guard: (step, its end) ↦ the point at which to stop within it, by default its end; None if the step is too long
            to decide.

    Returns:
        the step to try next.
    """
    limits = curve.settings
    current = traced.points[-1]
    step = curve.bounded(current, step)
    advance = curve.advance(current, step)
    if advance is None and step <= SEPARATE and current.length > traced.corner + SEPARATE:
        behind = curve.round_corner(current)
        if behind is not None:
            traced.points.append(behind)
            traced.corner = behind.length
            traced.outcome = _outcome(traced, step, bifurcation_missing=leave_at != 0)
            return step
    if advance is None:
        return _halved(traced, step, limits.shortest)
    point, corrections = advance
    arc = Arc(curve, current, point)
    events = events_between(arc)
    if events is None and step > SEPARATE:
        return _halved(traced, step, limits.shortest)

    # A step may pass the load factor 1; the path beyond does not count.
    end = _end(arc)
    if guard is not None:
        guarded = guard(arc, end)
        if guarded is None:
            return _halved(traced, step, limits.shortest)
        end = guarded
    # In a very short step events that stay together are left out: the path is worth more than they.
    passed = [event for event in events or [] if event.point.length <= end.length]
    departure = _departure(traced, passed, abs(leave_at))
    if departure is not None:
        # The curve beyond the bifurcation does not belong to the branch.
        _leave(curve, traced, passed[: departure + 1], 1 if leave_at > 0 else -1)
        return limits.first
    traced.points.append(end)
    traced.events += passed
    traced.outcome = _outcome(traced, step, bifurcation_missing=leave_at != 0)
    if corrections <= limits.grow_below:
        step *= GROWTH
    return step


def _halved(traced: Trace, step: float, shortest: float) -> float:
    """Halve a refused step; the path ends if it becomes too short."""
    half = step / 2
    if half < shortest:
        traced.outcome = PathOutcome.LOAD_STALLED
    return half


def _end(arc: Arc) -> ArcPoint:
    """Find the end of a step, or the point within it at which the load factor reaches 1."""
    if arc.end.load_factor < 1.0:
        return arc.end
    share = (1.0 - arc.start.load_factor) / (arc.end.load_factor - arc.start.load_factor)
    grows = min(arc.start.load_factor_rate, arc.end.load_factor_rate) > 0.0
    # Next to a limit point the load factor may pass 1 twice.
    near = arc.at(share * arc.step) if grows else arc.zero(lambda point: point.load_factor - 1.0)
    if near is None:
        return arc.end
    # At the load factor 1 to the last digit, so that the end is the equilibrium asked for.
    x = arc.curve.at(near.x, 1.0)
    if x is None:
        return near
    y = np.append(x, 1.0)
    length = near.length + float(near.tangent @ (y - near.y))
    return arc.curve.point(y, near.tangent, length) or near


def _departure(traced: Trace, passed: list[Event], number: int) -> int | None:
    """Index, among the events of a step, of the bifurcation at which to leave.

    Args:
        traced: the computed part of the curve.
        passed: events of the step.
        number: number of the bifurcation along the curve, counted from 1; 0 for none.

    Returns:
        the index; None if that bifurcation is not in the step.
    """
    if not number:
        return None
    before = sum(event.kind == "bifurcation" for event in traced.events)
    indices = [i for i, event in enumerate(passed) if event.kind == "bifurcation"]
    in_step = number - before
    if not 0 < in_step <= len(indices):
        return None
    return indices[in_step - 1]


def _leave(curve: Curve, traced: Trace, passed: list[Event], side: int) -> None:
    """Leave a path at the last of these events onto one half of the branch that crosses there."""
    bifurcation = passed[-1]
    traced.events += passed
    # The branch begins at the bifurcation itself, which belongs to both curves.
    traced.points.append(bifurcation.point)
    first = switch(curve, bifurcation.point, bifurcation.multiplicity, side)
    if first is None:
        traced.outcome = PathOutcome.NO_BRANCH
        return
    traced.branch = len(traced.points)
    traced.points.append(first)


def _outcome(traced: Trace, step: float, *, bifurcation_missing: bool) -> PathOutcome | None:
    """Outcome of the path at its last point; None if it goes on."""
    first = traced.points[0]
    last = traced.points[-1]
    if last.load_factor >= 1.0:
        if bifurcation_missing:
            return PathOutcome.NO_BIFURCATION
        return PathOutcome.CONVERGED
    if last.load_factor < FARTHEST:
        return PathOutcome.TURNED_BACK
    # A step may jump over the start itself, and a curve may cross itself there in another direction.
    near_start = float(np.linalg.norm(last.y - first.y)) < step
    same_direction = last.tangent @ first.tangent > 0.0
    if near_start and same_direction and last.length > AWAY * step:
        return PathOutcome.CLOSED
    return None


DISTANCES = (0.02, 0.05, 0.01, 0.1, 0.002)
"""Distances from the bifurcation at which the branch is sought, in order."""


def switch(curve: Curve, bifurcation: ArcPoint, multiplicity: int, side: int = 1) -> ArcPoint | None:
    """Find the first point of the branch that crosses at a bifurcation, with its tangent away from it.

    On side 1 of the branch the largest strain coordinate of the null vector grows; side −1 is the other half. If
    symmetry makes a whole circle of branches, the one nearest to the first such coordinate is taken.

    Args:
        curve: the curve.
        bifurcation: point at which to leave it.
        multiplicity: dimension of the null space across the curve.
        side: half of the branch, 1 or −1.

    Returns:
        the point; None if no distance leads to one.
    """
    derivative = curve.derivative(bifurcation.y)
    direction = side * crossing_direction(derivative, bifurcation.tangent, multiplicity)
    for distance in DISTANCES:
        guess = bifurcation.y + distance * direction
        corrected = curve.correct(guess, direction)
        # A correction as long as the distance may lead back to the curve.
        if corrected is None or np.linalg.norm(corrected[0] - guess) > distance:
            continue
        y, _ = corrected
        # The chord, not the null vector: where the factor turns the branch has left the null vector already.
        point = curve.point(y, y - bifurcation.y, bifurcation.length + distance)
        if point is not None:
            return point
    return None


def crossing_direction(derivative: FloatArray, tangent: FloatArray, multiplicity: int) -> FloatArray:
    """Choose the direction in the null space of ∂g/∂y across the tangent that is nearest to its largest unknown.

    Args:
        derivative: ∂g/∂y, shape (n, n + 1).
        tangent: shape (n + 1,).
        multiplicity: dimension of the null space across the tangent.

    Returns:
        the unit vector, shape (n + 1,), along which that unknown grows.
    """
    bordered = np.vstack([derivative, tangent])
    _, _, rows = np.linalg.svd(bordered)
    basis = rows[-multiplicity:].T
    unknowns = len(tangent) - 1
    return direction_in(basis, unknowns)
