"""Equilibria of concentric tubes while one input moves, through folds and back, and where the robot snaps to.

Where the path turns the robot loses its hold: an input that moves on makes it snap. It comes to rest at the next stable
equilibrium that the path has at the same inputs, which lies beyond the next fold. See docs/tubes.md.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.load_path import input_path
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import ArcSettings, Curve
from cosserat_casadi.numerics.events import DETERMINANT, Event
from cosserat_casadi.numerics.progress import Progress
from cosserat_casadi.numerics.trace import PathOutcome, Trace, trace
from cosserat_casadi.result import Result
from cosserat_casadi.tubes.robot import Robot, Values, robot_of
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.tube_solution import TubeSolution, tip_error
from cosserat_casadi.tubes.tube_solve import MOST_STEPS, model_of, solution_at, solution_near, solve_at, solve_tubes

TURNING = ArcSettings(longest=0.1, load_factor_change=0.05)
"""Limits of a path over a rotation or a load; angles at the tips count in rad, the input as the share of its way."""

SLIDING = ArcSettings(longest=0.05, load_factor_change=0.02, min_cosine=0.0, max_distance=5.0)
"""Limits of a path over a translation.

It has a corner where the order of the tubes' ends changes: short steps, which may go round it.
"""

WORDS = {
    PathOutcome.CONVERGED: "The path reached the input's value.",
    PathOutcome.NO_START: "No path: at the inputs of the scene no equilibrium was found.",
    PathOutcome.TURNED_BACK: "The path led back: the input would have to move the other way.",
    PathOutcome.UNRESOLVED: "The path was followed, but its error is above the tolerance: allow a larger one.",
}
"""Sentences of paths of tubes, for outcomes whose general sentence does not fit."""


@dataclass(frozen=True)
class TubeEvent:
    """A place of a path at which the robot snaps, or where branches meet.

    Attributes:
        kind: "limit" or "bifurcation".
        value: of the input there.
        solution: the equilibrium there, which is neutral.
        position: index of the first point of the path that lies beyond it.
        snaps_to: the stable equilibrium at the same inputs that the robot snaps to; None where it does not lose its
            hold here, or the path has none farther on.
    """

    kind: str
    value: float
    solution: TubeSolution
    position: int
    snaps_to: TubeSolution | None

    @property
    def released_energy(self) -> float | None:
        """Energy that the snap sets free, J."""
        if self.snaps_to is None:
            return None
        return self.solution.energy - self.snaps_to.energy


@dataclass(frozen=True, repr=False)
class TubePath(Result):
    """Equilibria of concentric tubes along one input.

    Attributes:
        title: of the scene.
        name: of the input that moves.
        unit: of the input.
        outcome: how the path ended.
        values: of the input at k points in the order of travel, shape (k,).
        solutions: the equilibria at these points.
        events: limit points and bifurcations in the order of travel.
        error_estimate: estimated error of the events' values, relative to the input's way, and of the tips there and
            at the end; None where it was not estimated.
    """

    title: str
    name: str
    unit: str
    outcome: PathOutcome
    values: FloatArray
    solutions: tuple[TubeSolution, ...]
    events: tuple[TubeEvent, ...]
    error_estimate: float | None

    @property
    def converged(self) -> bool:
        """Whether the input's value was reached within tolerance."""
        return self.outcome is PathOutcome.CONVERGED

    @property
    def message(self) -> str:
        """A sentence for the user."""
        return WORDS.get(self.outcome, self.outcome.value)

    @property
    def stable(self) -> npt.NDArray[np.bool_] | None:
        """Whether each point is stable, shape (k,); None where the loads have no energy."""
        if self.solutions and not self.solutions[0].robot.has_energy:
            return None
        return np.array([solution.stable for solution in self.solutions], dtype=np.bool_)

    @property
    def energy(self) -> FloatArray:
        """Energy at each point, shape (k,), J, as :attr:`TubeSolution.energy`."""
        return np.array([solution.energy for solution in self.solutions])

    def tip(self, tube: str | None = None) -> FloatArray:
        """Positions of a tube's tip at each point, shape (k, 3), m; as :meth:`TubeSolution.tip`."""
        positions = [solution.tip(tube).position for solution in self.solutions]
        return np.array(positions).reshape(-1, 3)


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
    """Follow the equilibrium of concentric tubes while one input moves from its value to another.

    Args:
        subject: a scene with tubes, followed to its tolerance; or a model, which keeps its steps.
        name: of the input, such as "inner.rotation" or "push.force.z".
        to: its value at the end, in its unit.
        values: where the path begins, as in :func:`solve_tubes`.
        first: an equilibrium of the same tubes and loads to begin at instead, such as one of another path.
        settings: limits; by default those of a rotation and a load, or those of a translation.
        progress: receives the largest share of the way.

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
    way = _Way(robot, name, start, end, first, settings)
    if isinstance(subject, TubeFunctions):
        return way.followed(subject.steps, progress)
    # What a solve ends with has been found to be enough by half of its steps.
    steps = max(solve_tubes(scene, start).model.steps, solve_tubes(scene, end).model.steps) // 2
    rough = way.followed(steps, progress)
    while True:
        steps *= 2
        fine = way.followed(steps, progress)
        error = _difference(rough, fine)
        if not fine.converged and fine.outcome is rough.outcome:
            return fine
        if error is not None and error <= robot.tolerance:
            return replace(fine, error_estimate=error)
        if steps >= MOST_STEPS:
            outcome = fine.outcome
            if fine.converged:
                outcome = PathOutcome.UNRESOLVED
            return replace(fine, outcome=outcome, error_estimate=error)
        rough = fine


def _check_first(robot: Robot, first: TubeSolution, values: Values) -> None:
    """Refuse an equilibrium that a path of a robot cannot begin at.

    Raises:
        SceneError: it is of another robot, or the path would begin at other inputs too.
    """
    if values is not None:
        raise SceneError(Problem("first", "stands beside values", "its inputs are where the path begins"))
    if first.robot.columns != robot.columns:
        problem = "is of tubes or loads with other names"
        raise SceneError(Problem("first", problem, f"inputs of the scene: {', '.join(robot.columns)}"))


def _difference(rough: TubePath, fine: TubePath) -> float | None:
    """Largest error of events and end of a path beside a finer one; None where they do not correspond."""
    if not (rough.converged and fine.converged) or len(rough.events) != len(fine.events):
        return None
    errors = [tip_error(rough.solutions[-1], fine.solutions[-1])]
    way = abs(fine.values[-1] - fine.values[0])
    for event, exact in zip(rough.events, fine.events, strict=True):
        if event.kind != exact.kind:
            return None
        errors += [abs(event.value - exact.value) / way, tip_error(event.solution, exact.solution)]
    return float(max(errors))


@dataclass(frozen=True)
class _Way:
    """One input of a robot that moves.

    Attributes:
        robot: the tubes.
        name: of the input.
        start: inputs at factor 0.
        end: inputs at factor 1.
        at_start: an equilibrium to begin at; None for that of a solve.
        limits: of the path; None for those of the kind of the input.
    """

    robot: Robot
    name: str
    start: FloatArray
    end: FloatArray
    at_start: TubeSolution | None
    limits: ArcSettings | None

    @property
    def unit(self) -> str:
        """Unit of the input."""
        index = self.robot.input_index(self.name)
        return next(entry.unit for entry, span in self.robot.layout if index < span.stop)

    def inputs(self, factor: float) -> FloatArray:
        """All inputs at a factor."""
        return self.start + factor * (self.end - self.start)

    def value(self, factor: float) -> float:
        """The moving input at a factor."""
        return float(self.inputs(factor)[self.robot.input_index(self.name)])

    def followed(self, steps: int, progress: Progress | None) -> TubePath:
        """The path of the model with a number of steps."""
        model = model_of(self.robot, steps)
        if self.at_start is None:
            first = solve_at(model, self.start)
        else:
            first = solution_near(model, self.start, self.at_start.x)
        if not first.converged:
            return self._path(model, Trace([], outcome=PathOutcome.NO_START))
        path = input_path(model, first.x, self.start, self.end)
        usual = SLIDING if self.unit == "m" else TURNING
        traced = trace(Curve(path, DETERMINANT, self.limits or usual), progress=progress)
        return self._path(model, traced)

    def _path(self, model: TubeFunctions, traced: Trace) -> TubePath:
        factors = [point.load_factor for point in traced.points]
        solutions = [self._solution(model, point.x, point.load_factor) for point in traced.points]
        lengths = [point.length for point in traced.points]
        events = []
        for event in traced.events:
            position = int(np.searchsorted(lengths, event.point.length, side="right"))
            events.append(self._event(model, event, position, factors, solutions))
        return TubePath(
            title=self.robot.scene.title,
            name=self.name,
            unit=self.unit,
            outcome=traced.outcome or PathOutcome.MAX_STEPS,
            values=np.array([self.value(factor) for factor in factors]),
            solutions=tuple(solutions),
            events=tuple(events),
            error_estimate=None,
        )

    def _solution(self, model: TubeFunctions, x: FloatArray, factor: float) -> TubeSolution:
        # The path is corrected at each of its points.
        return solution_at(model, self.inputs(factor), x, found=True)

    def _event(
        self, model: TubeFunctions, event: Event, position: int, factors: list[float], solutions: list[TubeSolution]
    ) -> TubeEvent:
        factor = event.point.load_factor
        at_event = self._solution(model, event.point.x, factor)
        snaps_to = None
        if event.kind == "limit" and solutions[position - 1].stable:
            snaps_to = _next_stable(model, at_event.inputs, factor, factors[position:], solutions[position:])
        return TubeEvent(event.kind, self.value(factor), at_event, position, snaps_to)


def _next_stable(
    model: TubeFunctions, inputs: FloatArray, factor: float, factors: list[float], solutions: list[TubeSolution]
) -> TubeSolution | None:
    """The first stable equilibrium that a path comes to at a factor.

    Args:
        model: the robot.
        inputs: at the factor.
        factor: the factor.
        factors: of the points of the path from there on.
        solutions: the equilibria at these points.
    """
    for index in range(1, len(factors)):
        before = factors[index - 1] - factor
        after = factors[index] - factor
        if before * after > 0.0 or not solutions[index].stable:
            continue
        share = 0.0
        if after != before:
            share = -before / (after - before)
        start = solutions[index - 1].x + share * (solutions[index].x - solutions[index - 1].x)
        reached = solution_near(model, inputs, start)
        if reached.converged and reached.stable:
            return reached
    return None
