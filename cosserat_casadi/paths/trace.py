"""A curve of equilibria from factor 0 to factor 1: steps, their control, the events on the way, the end."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from cosserat_casadi.numerics.arclength import ArcPoint, Curve, Plane
from cosserat_casadi.numerics.branches import switch
from cosserat_casadi.numerics.continuation import Progress
from cosserat_casadi.numerics.events import Arc, Event, events_between

GROWTH = 1.5
"""Factor on the step after a quick correction."""

SEPARATE = 1e-4
"""Step below which events that cannot be told apart are left out rather than looked at more closely."""

FARTHEST = -1.0
"""Factor below which a path counts as led back."""


class PathOutcome(Enum):
    """Every way a path can end. Only CONVERGED has reached factor 1."""

    CONVERGED = "The path reached factor 1."
    NO_START = "No path: at factor 0 there is no equilibrium to start from."
    LOAD_STALLED = "The path could not be followed further: the step fell below its limit."
    MAX_STEPS = "The path was not followed further: the steps ran out before factor 1."
    TURNED_BACK = "The path led back: its factor fell below -1."
    CLOSED = "The path is closed: it came back to its start without reaching factor 1."
    NO_BIFURCATION = "No branch: the path reached factor 1 before the bifurcation to leave at."
    NO_BRANCH = "No branch: none was found at the bifurcation."
    UNRESOLVED = (
        "The path of the discrete model reached its end, but the rod is not resolved to the tolerance asked for: "
        "fix more modes and nodes, or allow a larger tolerance."
    )

    @property
    def label(self) -> str:
        """The word of the result file."""
        return self.name.lower()


@dataclass
class Trace:
    """What was found along a curve.

    Attributes:
        points: accepted points in the order of travel.
        events: special points in the order of travel.
        outcome: how it ended; None while under way.
        branch: index of the first point on the crossing branch, None while on the first curve.
    """

    points: list[ArcPoint]
    events: list[Event] = field(default_factory=list)
    outcome: PathOutcome | None = None
    branch: int | None = None


def trace(curve: Curve, *, branch: int = 0, progress: Progress | None = None) -> Trace:
    """Follow a curve from the start of its path, at factor 0, until the factor first reaches 1.

    Args:
        curve: the curve.
        branch: number of the bifurcation, counted from 1, to leave at along the branch that crosses there; negative
            for the other half of that branch, 0 goes straight on.
        progress: told the largest factor reached, in [0, 1].
    """
    y = np.append(curve.path.start, 0.0)
    first = curve.point(y, np.append(np.zeros_like(curve.path.start), 1.0), 0.0)
    if first is None:
        return Trace([], outcome=PathOutcome.NO_START)
    found, step, best = Trace([first]), curve.settings.first, 0.0
    for _ in range(curve.settings.steps):
        step = _next(curve, found, step, leave=branch if found.branch is None else 0)
        best = max(best, min(found.points[-1].factor, 1.0))
        if progress is not None:
            progress(best)
        if found.outcome is not None:
            return found
    found.outcome = PathOutcome.MAX_STEPS
    return found


def _next(curve: Curve, found: Trace, step: float, *, leave: int) -> float:
    """Try one step and add what it finds; the step to try next."""
    here = found.points[-1]
    step = curve.bounded(here, step)
    advanced = curve.advance(here, step)
    events = None if advanced is None else events_between(Arc(curve, here, advanced[0]))
    if advanced is None or (events is None and step > SEPARATE):
        if step / 2 < curve.settings.shortest:
            found.outcome = PathOutcome.LOAD_STALLED
        return step / 2
    end = _end(Arc(curve, here, advanced[0]))
    passed = [event for event in events or [] if event.point.length <= end.length]
    position = _place_to_leave(found, passed, abs(leave))
    if position is not None:
        _leave(curve, found, passed[: position + 1], 1 if leave > 0 else -1)
        return curve.settings.first
    found.points.append(end)
    found.events += passed
    found.outcome = _outcome(found, step, missing=leave != 0)
    return step * (GROWTH if advanced[1] <= curve.settings.quick else 1.0)


def _end(arc: Arc) -> ArcPoint:
    """The end of a step, or the point within it at which the factor reaches 1."""
    if arc.end.factor < 1.0:
        return arc.end
    near = arc.zero(lambda point: point.factor - 1.0)
    if near is None:
        return arc.end
    level = np.append(np.zeros_like(near.x), 1.0)
    exact = arc.curve.correct(np.append(near.x, 1.0), Plane(level, 1.0))
    point = None if exact is None else arc.curve.point(np.append(exact[0][:-1], 1.0), near.tangent, near.length)
    return point or near


def _place_to_leave(found: Trace, passed: list[Event], number: int) -> int | None:
    """Which event of a step is the bifurcation of that number along the curve; None where it does not lie there."""
    if not number:
        return None
    before = sum(event.kind == "bifurcation" for event in found.events)
    places = [i for i, event in enumerate(passed) if event.kind == "bifurcation"]
    return places[number - before - 1] if before < number <= before + len(places) else None


def _leave(curve: Curve, found: Trace, passed: list[Event], side: int) -> None:
    """From the last of these events onto one half of the branch that crosses there."""
    event = passed[-1]
    found.events += passed
    found.points.append(event.point)
    first = switch(curve, event.point, event.multiplicity, side)
    if first is None:
        found.outcome = PathOutcome.NO_BRANCH
        return
    found.branch = len(found.points)
    found.points.append(first)


def _outcome(found: Trace, step: float, *, missing: bool) -> PathOutcome | None:
    """How the path ends at its last point; None where it goes on."""
    last, first = found.points[-1], found.points[0]
    if last.factor >= 1.0:
        return PathOutcome.NO_BIFURCATION if missing else PathOutcome.CONVERGED
    if last.factor < FARTHEST:
        return PathOutcome.TURNED_BACK
    back = float(np.linalg.norm(last.y - first.y)) < step and last.tangent @ first.tangent > 0.0
    return PathOutcome.CLOSED if back and last.length > 4 * step else None
