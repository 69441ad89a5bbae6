"""All equilibria of concentric tubes at given inputs.

The angles at the tips determine the robot, and a common rotation of all of them rotates the whole robot. The remaining
n − 1 angles between the tips, on a torus, are mapped to the n − 1 angles between the drives. This map has degree one,
like that of tubes that do not twist: for all inputs the signs of its determinant sum to one over all equilibria. A
drive that makes a full turn returns to its angle. So equilibria that are twisted by a further full turn count too: each
point of the torus belongs to one of them.

For two tubes the map is a function of one angle, whose rises and falls an adaptive scan separates. For more tubes
Newton's method starts from the points of ever finer grids until a grid finds nothing new and the signs sum to one.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.metrics import SAFETY
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.events import bracketed_zero
from cosserat_casadi.numerics.progress import Progress, Report
from cosserat_casadi.result import Result
from cosserat_casadi.tubes.loaded_model import LoadedTubeModel
from cosserat_casadi.tubes.robot import Robot, Values, robot_of
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.tube_model import TubeModel
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.tubes.tube_solve import (
    MOST_STEPS,
    error_beside,
    finer_than,
    judged,
    loaded_from,
    moved_to,
    solution_near,
    solve_at,
    solve_tubes,
)

Searched = TypeVar("Searched", bound=TubeFunctions)

MOST_TUBES = 4
"""Largest number of tubes for the search, as the starts of Newton's method grow exponentially with it."""

PAIR = 2

TURN = 2 * np.pi

FIRST_ANGLE = 0.1234
"""Start of scans and grids, rad, at which no symmetric robot has an equilibrium."""

FIRST_INTERVALS = 48
"""Number of initial intervals of a full turn in the scan of two tubes."""

AGREES = 0.01
"""Largest error, rad, of the cubic through the ends of an interval for the drives at its middle."""

MOST_EVALUATIONS = 20_000
"""Most angles at which the scan of two tubes evaluates before it gives up."""

GRIDS = {3: (8, 16, 32), 4: (6, 9, 12)}
"""Points along each angle of the grids of starts, by the number of tubes."""

SAME = 1e-6
"""Difference of angles at the tips, rad, up to which they belong to one equilibrium."""


@dataclass(frozen=True, repr=False)
class TubeEquilibria(Result):
    """The equilibria of concentric tubes at equal inputs.

    Attributes:
        robot: the tubes.
        solutions: the equilibria, by increasing energy.
        complete: whether the search ended properly: it settled within its budget, all equilibria are within tolerance,
            and the signs of their determinants sum to one. Two of opposite signs could still be missing. It is always
            false under loads, where the search follows the equilibria without loads.
    """

    robot: Robot
    solutions: tuple[TubeSolution, ...]
    complete: bool

    @property
    def stable(self) -> tuple[TubeSolution, ...]:
        """The stable equilibria."""
        return tuple(solution for solution in self.solutions if solution.stable)

    @property
    def message(self) -> str:
        """A sentence for the user."""
        if self.robot.loads and self.solutions:
            return "The search followed equilibria from no loads to the full loads: others may be missing."
        if self.complete:
            return (
                "The search for all equilibria of these inputs has settled, and the signs of their determinants add up "
                "to one: no single one is missing."
            )
        if not self.solutions:
            return "No equilibrium was found, though one exists: the search ended before it settled."
        return (
            "Equilibria were found, but others may be missing: the search ended before it settled with determinants "
            "whose signs add up to one, within tolerance."
        )


def all_equilibria(scene: scenes.Scene, values: Values = None) -> TubeEquilibria:
    """Find every equilibrium of concentric tubes.

    Args:
        scene: a scene with tubes.
        values: inputs by name, such as "inner.rotation" or "push.force", with the scene's values for the others; or all
            inputs, rotation and translation of each tube, rad and m, and the loads.

    Raises:
        SceneError: the scene has no tubes or too many, or an input is unknown or out of its range.
    """
    robot = robot_of(scene)
    at = robot.packed(values)
    if robot.size > MOST_TUBES:
        problem = f"the search for all equilibria takes at most {MOST_TUBES} tubes, and the scene has {robot.size}"
        raise SceneError(Problem("tubes", problem, "solve it without --all"))
    # As many steps as one of them needs are a beginning for the others.
    steps = solve_tubes(scene, at).model.steps
    without_loads = _resolved(TubeModel(robot, steps), at, _searched)
    if not robot.loads:
        return without_loads
    starts = without_loads.solutions
    return _resolved(LoadedTubeModel(robot, steps), at, lambda model, inputs: _under_loads(model, inputs, starts))


def tubes_at_rest(
    subject: scenes.Scene | TubeFunctions,
    values: Values = None,
    *,
    start: TubeSolution | FloatArray | None = None,
    parameters: Values = None,
    stable: bool = False,
    estimate_error: bool = True,
    progress: Progress | None = None,
    report: Report | None = None,
) -> TubeSolution:
    """Solve for the equilibrium of a scene with tubes to its tolerance, or of a model with its steps.

    Args:
        subject: the scene or the model.
        values: inputs, as in :func:`solve_tubes`.
        start: for a model, a solution whose inputs are followed to these, or unknowns near the equilibrium; by default,
            and if that fails, straight tubes.
        parameters: for a model, parameters by name or stacked; by default the scene's.
        stable: whether a stable equilibrium is wanted, as in :func:`cosserat_casadi.solve`.
        estimate_error: for a model, whether its error is estimated by the equilibrium with twice its steps.
        progress: not called, as the search takes a moment.
        report: not called.

    Raises:
        SceneError: a value is refused, or a stable equilibrium is wanted for loads without an energy.
    """
    if isinstance(subject, scenes.Scene):
        return stable_tubes(subject, values) if stable else solve_tubes(subject, values)
    subject = subject.at(parameters)
    inputs = subject.pack(values)
    if stable:
        # The unknowns do not depend on the steps.
        start = stable_tubes(subject.scene, inputs).x
    found = None
    if isinstance(start, TubeSolution):
        found = moved_to(subject, start, inputs)
    elif start is not None:
        found = solution_near(subject, inputs, start)
    if found is None or not found.converged:
        found = solve_at(subject, inputs)
    if not estimate_error:
        return found
    return replace(found, error_estimate=error_beside(found, finer_than(found), SAFETY))


def stable_tubes(scene: scenes.Scene, values: Values = None) -> TubeSolution:
    """Find the equilibrium of :func:`solve_tubes`, or if it is unstable the stable one of least energy, if any.

    Args:
        scene: a scene with tubes.
        values: as in :func:`solve_tubes`.

    Raises:
        SceneError: as for :func:`all_equilibria`, and for loads without an energy.
    """
    if not robot_of(scene).has_energy:
        problem = "the loads have no energy, which would tell what is stable"
        raise SceneError(Problem("--stable", problem, "leave it out"))
    solution = solve_tubes(scene, values)
    if solution.stable:
        return solution
    return next(iter(all_equilibria(scene, values).stable), solution)


Search = tuple[list[FloatArray], bool]
"""Unknowns of each equilibrium of a model, shape (size,), and whether the search settled."""


def _resolved(model: Searched, at: FloatArray, search: Callable[[Searched, FloatArray], Search]) -> TubeEquilibria:
    """Find equilibria by a search of a model, or of finer ones until all equilibria are within tolerance."""
    while True:
        found, settled = search(model, at)
        finer = type(model)(model.robot, 2 * model.steps)
        solutions = [_refined(model, finer, at, x) for x in found]
        # More steps would find the same ones again, and no others.
        resolved = all(solution.converged for solution in solutions)
        if resolved or finer.steps >= MOST_STEPS:
            complete = settled and resolved and _is_whole(solutions)
            by_energy = sorted(solutions, key=lambda solution: solution.energy)
            return TubeEquilibria(model.robot, tuple(by_energy), complete)
        model = finer


def _under_loads(model: LoadedTubeModel, at: FloatArray, starts: Sequence[TubeSolution]) -> Search:
    """Follow the equilibria without loads to equilibria under loads, which need not be all."""
    found: list[TubeSolution] = []
    for start in starts:
        end = loaded_from(model, at, start)
        if end.converged and all(_differ(end, known) for known in found):
            found.append(end)
    return [solution.x for solution in found], False


def _differ(one: TubeSolution, other: TubeSolution) -> bool:
    """Whether two equilibria differ; a quaternion and its opposite are one frame."""
    size = one.robot.size
    sign = np.sign(one.x[size:] @ other.x[size:])
    turned = np.abs(one.angles - other.angles)
    others = np.abs(one.x[size:] - sign * other.x[size:])
    return bool(np.concatenate([turned, others]).max() > SAME)


def _refined(model: TubeFunctions, finer: TubeFunctions, inputs: FloatArray, x: FloatArray) -> TubeSolution:
    """Solve for the equilibrium of a finer model near one of a model, with its error estimate."""
    rough = solution_near(model, inputs, x)
    fine = solution_near(finer, inputs, x)
    return judged(fine, error_beside(rough, fine))


def _is_whole(solutions: list[TubeSolution]) -> bool:
    """Whether equilibria differ, and the signs of their determinants sum to one."""
    differ = all(_differ(one, other) for one, other in itertools.combinations(solutions, 2))
    return differ and _degree(solution.stability.determinant for solution in solutions) == 1


def _degree(determinants: Iterator[float]) -> int:
    return int(sum(np.sign(determinant) for determinant in determinants))


def _searched(model: TubeModel, inputs: FloatArray) -> Search:
    """Look for every equilibrium of a model."""
    if model.tube_count == 1:
        # One tube does not twist.
        return [model.robot.rotations(inputs).copy()], True
    if model.tube_count > PAIR:
        return _of_more_tubes(model, inputs)
    pair = _Pair(model, inputs)
    readings, settled = _readings(pair)
    found: list[FloatArray] = []
    for before, after in itertools.pairwise(readings):
        found += [pair.tips(angle) for angle in _roots(pair, before, after)]
    return found, settled


# Two tubes


@dataclass(frozen=True)
class _Reading:
    """Reading of the scan of two tubes at one angle between the tips.

    Attributes:
        angle: angle between the tips, rad.
        missed: angle between the drives less that of the inputs, rad.
        slope: derivative of ``missed`` by the angle.
    """

    angle: float
    missed: float
    slope: float


@dataclass(frozen=True)
class _Pair:
    """Two tubes at given inputs."""

    model: TubeModel
    inputs: FloatArray

    def read(self, angle: float) -> _Reading:
        """Evaluate the drives for an angle between the tips."""
        jacobian, residual = self.model.jacobian([0.0, angle], self.inputs)
        missed = float(residual[1] - residual[0])
        slope = float(jacobian[1, 1] - jacobian[0, 1])
        return _Reading(angle, missed, slope)

    def tips(self, angle: float) -> FloatArray:
        """Angles at both tips, after a common rotation with which the first drive is met."""
        together = np.array([0.0, angle])
        residual = np.ravel(self.model.residual(together, self.inputs).full())
        return np.asarray(together - residual[0])


def _readings(pair: _Pair) -> tuple[list[_Reading], bool]:
    """Take readings over one turn of the tips, so close that a cubic between neighbours predicts those in between.

    Returns:
        The readings, and whether they are that close everywhere.
    """
    angles = FIRST_ANGLE + np.linspace(0.0, TURN, FIRST_INTERVALS + 1)
    first, *later = [pair.read(float(angle)) for angle in angles]
    kept = [first]
    pending = list(reversed(later))
    evaluations = len(angles)
    while pending:
        before = kept[-1]
        after = pending[-1]
        middle = pair.read((before.angle + after.angle) / 2)
        evaluations += 1
        if _foreseen(before, middle, after) or evaluations > MOST_EVALUATIONS:
            kept += [middle, pending.pop()]
        else:
            pending.append(middle)
    return kept, evaluations <= MOST_EVALUATIONS


def _foreseen(before: _Reading, middle: _Reading, after: _Reading) -> bool:
    """Whether the cubic through two readings predicts the reading in the middle."""
    width = after.angle - before.angle
    missed = (before.missed + after.missed) / 2 + width * (before.slope - after.slope) / 8
    change = 1.5 * (after.missed - before.missed) - width * (before.slope + after.slope) / 4
    return abs(missed - middle.missed) <= AGREES and abs(change - width * middle.slope) <= AGREES


def _roots(pair: _Pair, before: _Reading, after: _Reading) -> list[float]:
    """Angles between two readings at which the drives are met, up to full turns."""
    ends = [before, after]
    if (before.slope > 0.0) != (after.slope > 0.0):
        # It rises and falls in between: each of the two parts goes one way.
        angle = bracketed_zero(
            lambda angle: pair.read(angle).slope, (before.angle, before.slope), (after.angle, after.slope)
        )
        ends = [before, pair.read(angle), after]
    roots = []
    for start, end in itertools.pairwise(ends):
        low, high = sorted((start.missed / TURN, end.missed / TURN))
        for turns in range(int(np.floor(low)) + 1, int(np.floor(high)) + 1):
            root = _crossing(pair, start, end, TURN * turns)
            # A drive that is off by full turns is met by tips that are off by as many.
            roots.append(root - TURN * turns)
    return roots


def _crossing(pair: _Pair, start: _Reading, end: _Reading, level: float) -> float:
    """Find the angle at which ``missed`` has a given level, between readings on both sides of it."""

    def above(angle: float) -> float:
        return pair.read(angle).missed - level

    return bracketed_zero(above, (start.angle, start.missed - level), (end.angle, end.missed - level))


# More tubes


def _of_more_tubes(model: TubeModel, inputs: FloatArray) -> Search:
    found: list[FloatArray] = []
    for points in GRIDS[model.tube_count]:
        before = len(found)
        for start in _starts(model, inputs, points):
            end = solution_near(model, inputs, start)
            if end.converged and all(np.abs(end.x - known).max() > SAME for known in found):
                found.append(end.x)
        determinants = (float(np.linalg.det(model.jacobian(x, inputs)[0].full())) for x in found)
        if len(found) == before and _degree(determinants) == 1:
            return found, True
    return found, False


def _starts(model: TubeModel, inputs: FloatArray, points: int) -> Iterator[FloatArray]:
    """Angles at the tips on a grid, rotated together and by full turns to meet the drives as nearly as possible."""
    angles = FIRST_ANGLE + TURN / points * np.arange(points)
    for between in itertools.product(angles, repeat=model.tube_count - 1):
        tips = np.array([0.0, *between])
        missed = np.ravel(model.residual(tips, inputs).full())
        tips -= missed[0]
        yield tips - TURN * np.round((missed - missed[0]) / TURN)
