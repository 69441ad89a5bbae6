"""Equilibria of concentric tubes while one input moves, through folds and back, and the ends of snaps.

At a fold of the path the robot loses its hold: an input that moves on makes it snap. It comes to rest at the next
stable equilibrium of the path at the same inputs, beyond the next fold. See docs/tubes.md.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.load_path import input_path
from cosserat_casadi.equilibrium.solution import SolvedPoses, rotations
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import ArcSettings, Curve
from cosserat_casadi.numerics.events import DETERMINANT
from cosserat_casadi.numerics.progress import Progress
from cosserat_casadi.numerics.trace import PathOutcome, trace
from cosserat_casadi.paths.equilibrium_path import InputChange, InputPath, PathEvent, path_along, path_events
from cosserat_casadi.tubes.robot import Robot, Values, robot_of
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.tube_solution import TubeSolution, tip_error
from cosserat_casadi.tubes.tube_solve import doubled, model_of, solution_at, solution_near, solve_at, solve_tubes

TURNING = ArcSettings(longest=0.1, load_factor_change=0.05)
"""Limits of a path over a rotation or a load; angles at the tips count in rad, the input as a share of its change."""

SLIDING = ArcSettings(longest=0.05, load_factor_change=0.02, min_cosine=0.0, max_distance=5.0)
"""Limits of a path over a translation.

Such a path has corners where the order of the tubes' ends changes: short steps can pass these.
"""

WORDS = {
    PathOutcome.CONVERGED: "The path reached the input's value.",
    PathOutcome.NO_START: "No path: at the inputs of the scene no equilibrium was found.",
    PathOutcome.TURNED_BACK: "The path led back: the input would have to move the other way.",
    PathOutcome.UNRESOLVED: "The path was followed, but its error is above the tolerance: allow a larger one.",
}
"""Sentences for outcomes of paths of tubes that the general sentences do not fit."""


@dataclass(frozen=True)
class TubeEvent:
    """A point of a path at which the robot snaps, or branches meet.

    Attributes:
        kind: "limit" or "bifurcation".
        value: value of the input at the event.
        solution: the neutral equilibrium at the event.
        position: index of the first point of the path that lies beyond it.
        snaps_to: the stable equilibrium at the same inputs to which the robot snaps; None if it does not snap here, or
            the path does not reach one.
    """

    kind: str
    value: float
    solution: TubeSolution
    position: int
    snaps_to: TubeSolution | None

    @property
    def released_energy(self) -> float | None:
        """Energy that the snap releases, J."""
        if self.snaps_to is None:
            return None
        return self.solution.energy - self.snaps_to.energy


@dataclass(frozen=True, repr=False, kw_only=True)
class TubePath(InputPath[TubeFunctions, TubeEvent]):
    """Equilibria of concentric tubes along one input, from one value to another.

    The error estimate covers the input's values at events, relative to its change, and the tips, between events too.
    """

    @property
    def robot(self) -> Robot:
        """The tubes."""
        return self.model.robot

    @property
    def unit(self) -> str:
        """Unit of the input."""
        return _unit_of(self.robot, self.name)

    @property
    def values(self) -> FloatArray:
        """The input at the points of the path, shape (k,)."""
        return self.all_inputs[:, self.robot.input_index(self.name)]

    @cached_property
    def solutions(self) -> tuple[TubeSolution, ...]:
        """The equilibria at the points of the path."""
        # Every point of the path is already corrected.
        return tuple(solution_at(self.model, *point, found=True) for point in zip(self.all_inputs, self.x, strict=True))

    @property
    def stable(self) -> npt.NDArray[np.bool_] | None:
        """Whether each point is stable, shape (k,); None if the loads have no potential."""
        if not self.robot.has_energy:
            return None
        return np.array([solution.stable for solution in self.solutions], dtype=np.bool_)

    @property
    def energy(self) -> FloatArray:
        """Energy at each point, shape (k,), J, see :attr:`TubeSolution.energy`."""
        return np.array([solution.energy for solution in self.solutions])

    def tip(self, tube: str | None = None) -> SolvedPoses:
        """Poses of a tube's tip at the k points of the path; see :meth:`TubeSolution.tip`."""
        tips = [solution.tip(tube) for solution in self.solutions]
        quaternions = np.array([tip.quaternion for tip in tips]).reshape(-1, 4)
        return SolvedPoses(np.array([tip.position for tip in tips]).reshape(-1, 3), rotations(quaternions), quaternions)


def _unit_of(robot: Robot, name: str) -> str:
    index = robot.input_index(name)
    return next(entry.unit for entry, span in robot.layout if index < span.stop)


def usual_limits(robot: Robot, name: str) -> ArcSettings:
    """Limits of a path over an input: limits for a translation, or limits for a rotation or a load."""
    return SLIDING if _unit_of(robot, name) == "m" else TURNING


def follow_tubes(
    subject: scenes.Scene | TubeFunctions,
    name: str,
    to: npt.ArrayLike,
    values: Values = None,
    *,
    first: TubeSolution | None = None,
    settings: ArcSettings | None = None,
    progress: Progress | None = None,
) -> TubePath:
    """Follow the equilibrium of concentric tubes while one input moves to a value; see the public ``follow``.

    The default limits are those for a rotation and a load, or for a translation.

    Raises:
        SceneError: the scene has no tubes, an input is unknown or out of its range, or does not move; the equilibrium
            to begin at is of another robot, or stands beside values.
    """
    scene = subject if isinstance(subject, scenes.Scene) else subject.scene
    robot = robot_of(scene)
    if np.size(to) != 1:
        remedy = "name one number of a load, such as push.force.z"
        raise SceneError(Problem(name, f"must be one number, got {np.size(to)}", remedy))
    if first is not None:
        _check_first(robot, first, values)
        values = first.inputs
    start = robot.packed(values)
    index = robot.input_index(name)
    end = robot.packed({**dict(zip(robot.columns, start, strict=True)), name: to})
    if end[index] == start[index]:
        raise SceneError(Problem(name, f"is {end[index]:g} where the path begins", "give another value to go to"))

    def followed(steps: int) -> TubePath:
        return _followed(model_of(robot, steps), name, start, end, first, settings, progress)

    if isinstance(subject, TubeFunctions):
        return followed(subject.steps)
    # The steps of a solve are known to suffice by comparison with half as many.
    steps = max(solve_tubes(scene, start).model.steps, solve_tubes(scene, end).model.steps) // 2
    path, error = doubled(
        followed,
        steps,
        _difference,
        robot.tolerance,
        lambda _, rough, fine: not fine.converged and fine.outcome is rough.outcome,
    )
    path = replace(path, error_estimate=error)
    if path.converged and not (error is not None and error <= robot.tolerance):
        return replace(path, outcome=PathOutcome.UNRESOLVED, message=WORDS[PathOutcome.UNRESOLVED])
    return path


def _check_first(robot: Robot, first: TubeSolution, values: Values) -> None:
    """Refuse an equilibrium at which a path of a robot cannot begin.

    Raises:
        SceneError: it is of another robot, or the path would begin at other inputs too.
    """
    if values is not None:
        raise SceneError(Problem("first", "stands beside values", "its inputs are where the path begins"))
    if first.robot.columns != robot.columns:
        problem = "has tubes or loads with other names"
        raise SceneError(Problem("first", problem, f"inputs of the scene: {', '.join(robot.columns)}"))


def _difference(rough: TubePath, fine: TubePath) -> float | None:
    """Largest difference of events, ends and points between from a finer path; None if the events differ."""
    kinds = [[event.kind for event in path.events] for path in (rough, fine)]
    if not (rough.converged and fine.converged) or kinds[0] != kinds[1]:
        return None
    errors = [tip_error(rough.solutions[-1], fine.solutions[-1])]
    way = abs(fine.values[-1] - fine.values[0])
    for event, exact in zip(rough.events, fine.events, strict=True):
        errors += [abs(event.value - exact.value) / way, tip_error(event.solution, exact.solution)]
    # Tubes that are turned by a full turn are as little twisted at the end as at the beginning, but more between.
    for index, _, x in rough.between_events(fine):
        if x is None:
            return None
        found = rough.solutions[index]
        errors.append(tip_error(found, solution_at(fine.model, found.inputs, x, found=True)))
    return float(max(errors))


def _followed(
    model: TubeFunctions,
    name: str,
    start: FloatArray,
    end: FloatArray,
    at_start: TubeSolution | None,
    limits: ArcSettings | None,
    progress: Progress | None,
) -> TubePath:
    """The path of a model while one input moves.

    Args:
        model: the robot.
        name: name of the input.
        start: inputs at factor 0.
        end: inputs at factor 1.
        at_start: an equilibrium to begin at; None for the equilibrium of a solve.
        limits: limits of the path; None for the limits of the kind of the input.
        progress: receives the largest reached share of the change.
    """
    first = solve_at(model, start) if at_start is None else solution_near(model, start, at_start.x)
    path = path_along(
        InputChange(model, name, start, end - start),
        TubePath,
        PathOutcome.NO_START,
        message=WORDS[PathOutcome.NO_START],
        factor=np.zeros(0),
        x=np.zeros((0, model.size)),
        events=(),
    )
    if not first.converged:
        return path
    usual = usual_limits(path.robot, name)
    curve = Curve(input_path(model, first.x, start, end), DETERMINANT, limits or usual)
    traced = trace(curve, progress=progress)
    outcome = traced.outcome or PathOutcome.MAX_STEPS
    y = np.array([point.y for point in traced.points]).reshape(-1, model.size + 1)
    path = replace(path, outcome=outcome, message=WORDS.get(outcome, outcome.value), factor=y[:, -1], x=y[:, :-1])
    events = path_events(traced, np.ones(model.size))
    return replace(path, events=tuple(_event(path, event) for event in events))


def _event(path: TubePath, event: PathEvent) -> TubeEvent:
    """An event of the path with its equilibrium and the end of the snap."""
    inputs = path.inputs(event.factor)
    at_event = solution_at(path.model, inputs, event.x, found=True)
    snaps_to = None
    if event.kind == "limit" and path.solutions[event.position - 1].stable:
        snaps_to = _next_stable(path, at_event.inputs, event)
    return TubeEvent(event.kind, float(inputs[path.robot.input_index(path.name)]), at_event, event.position, snaps_to)


def _next_stable(path: TubePath, inputs: FloatArray, event: PathEvent) -> TubeSolution | None:
    """The first stable equilibrium of a path after an event at the inputs of the event."""
    beyond = path.factor[event.position :] - event.factor
    solutions = path.solutions[event.position :]
    for index in range(1, len(beyond)):
        before, after = beyond[index - 1], beyond[index]
        if before * after > 0.0 or not solutions[index].stable:
            continue
        share = 0.0 if after == before else -before / (after - before)
        start = solutions[index - 1].x + share * (solutions[index].x - solutions[index - 1].x)
        reached = solution_near(path.model, inputs, start)
        if reached.converged and reached.stable:
            return reached
    return None
