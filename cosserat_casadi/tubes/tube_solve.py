"""Solve concentric tubes: one equilibrium at given inputs, with as many steps as its tolerance needs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.load_path import column, input_path
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.arclength import ArcSettings, Curve
from cosserat_casadi.numerics.continuation import ContinuationResult, Path, PathPoint, follow
from cosserat_casadi.numerics.events import DETERMINANT
from cosserat_casadi.numerics.newton import Equations, NewtonSettings, newton
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.trace import PathOutcome, trace
from cosserat_casadi.tubes.loaded_model import LoadedTubeModel
from cosserat_casadi.tubes.robot import Robot, Values, robot_of
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.tube_model import TubeModel
from cosserat_casadi.tubes.tube_solution import TubeSolution, tip_error

Found = TypeVar("Found")

FEWEST_STEPS = 2
"""Initial number of steps of a piece."""

LOADING = ArcSettings(longest=0.1, load_factor_change=0.05)
"""Limits of a path over the loads; angles at the tips count in rad, loads by the load factor."""

ENOUGH_STEPS = 32
"""Steps of a piece at which the search for an equilibrium that was not found ends."""

MOST_STEPS = 256
"""Largest number of steps of a piece."""


def model_of(robot: Robot, steps: int) -> TubeFunctions:
    """Make the model of a robot with a number of steps; under loads the frame at the tip is also unknown."""
    if robot.loads:
        return LoadedTubeModel(robot, steps)
    return TubeModel(robot, steps)


def solve_tubes(scene: scenes.Scene, values: Values = None) -> TubeSolution:
    """Find the equilibrium of tubes that are bent from straight ones at these inputs, and then loaded.

    A robot is in this equilibrium if its curvature grew at these inputs; a robot whose drives were turned there may be
    in another one. The result says whether it is stable; :func:`all_equilibria` finds other equilibria.

    Args:
        scene: a scene with tubes.
        values: inputs by name, such as "inner.rotation" or "push.force", with the scene's values for the others; or all
            inputs, rotation and translation of each tube, rad and m, and the loads.

    Raises:
        SceneError: the scene has no tubes, or an input is unknown or out of its range.
    """
    robot = robot_of(scene)
    return solve_inputs(TubeModels(robot), robot.packed(values))


class TubeModels:
    """Models of a robot by their number of steps, each made once."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._made: dict[int, TubeFunctions] = {}

    def of(self, steps: int) -> TubeFunctions:
        """Return the model with a number of steps."""
        if steps not in self._made:
            self._made[steps] = model_of(self.robot, steps)
        return self._made[steps]


def solve_inputs(models: TubeModels, at: FloatArray) -> TubeSolution:
    """Solve as :func:`solve_tubes` does, with models that are reused for many sets of inputs.

    Args:
        models: models of the robot.
        at: all inputs, in their ranges.
    """
    found, error = doubled(
        lambda steps: solve_at(models.of(steps), at),
        FEWEST_STEPS,
        error_beside,
        models.robot.tolerance,
        lambda steps, coarse, fine: steps >= ENOUGH_STEPS and not coarse.converged and not fine.converged,
    )
    return judged(found, error)


def doubled(
    at: Callable[[int], Found],
    steps: int,
    error_of: Callable[[Found, Found], float | None],
    tolerance: float,
    lost: Callable[[int, Found, Found], bool],
) -> tuple[Found, float | None]:
    """Double the steps until a result differs from that of half the steps by less than a tolerance.

    Args:
        at: steps of a piece ↦ result.
        steps: initial number of steps.
        error_of: (coarse, fine) ↦ their difference; None if it has no meaning.
        tolerance: allowed difference.
        lost: (steps, coarse, fine) ↦ whether more steps are not worth trying.

    Returns:
        The last result, and its difference from the result of half the steps.
    """
    coarse = at(steps)
    while True:
        steps *= 2
        fine = at(steps)
        error = error_of(coarse, fine)
        agree = error is not None and error <= tolerance
        if agree or steps >= MOST_STEPS or lost(steps, coarse, fine):
            return fine, error
        coarse = fine


def error_beside(solution: TubeSolution, finer: TubeSolution, factor: float = 1.0) -> float | None:
    """Error of the tips of a solution against a finer one, by a factor; None if either is no equilibrium."""
    return factor * tip_error(solution, finer) if solution.converged and finer.converged else None


def judged(solution: TubeSolution, error: float | None) -> TubeSolution:
    """Add the error estimate to a solution, which is unresolved if it is above the tolerance, or unknown."""
    estimated = replace(solution, error_estimate=error)
    if estimated.converged and not estimated.within_tolerance:
        return estimated.unresolved()
    return estimated


def solve_at(model: TubeFunctions, inputs: FloatArray) -> TubeSolution:
    """Solve for the equilibrium reached from straight tubes as their curvature grows, and then their loads."""
    if isinstance(model, LoadedTubeModel):
        curved = solve_at(model.without_loads, inputs)
        return loaded_from(model, inputs, curved)
    path = Path(
        residual=lambda x, t: column(model.path_residual(x, inputs, t)),
        jacobian=lambda x, t: model.path_jacobian(x, inputs, t).full(),
        rate=lambda x, t: column(model.path_rate(x, inputs, t, np.zeros_like(inputs), 1.0)),
        # Straight tubes do not twist.
        start=model.robot.rotations(inputs).copy(),
    )
    end = _followed(path)
    return solution_at(model, inputs, end.x, found=end.outcome is Outcome.CONVERGED, iterations=end.iterations)


def _followed(path: Path) -> ContinuationResult:
    """Follow a path to its end, without jumps between branches that come close to each other.

    A robot with nearly opposed tubes may bend to either side, or stay between, which is unstable: a long step may reach
    any of the three. The determinant has one sign along a branch. A path that cannot keep the sign is followed without
    this condition: for exactly opposed tubes, by symmetry, it leads to the unstable equilibrium.
    """
    rough = follow(path)
    if rough.outcome is Outcome.CONVERGED and _sign(path, (rough.x, 1.0)) == _sign(path, (path.start, 0.0)):
        return rough
    careful = follow(replace(path, admits=lambda before, after: _sign(path, before) == _sign(path, after)))
    if careful.outcome is not Outcome.CONVERGED:
        return rough
    return careful


def _sign(path: Path, point: PathPoint) -> float:
    """Sign of the determinant at a point of a path."""
    jacobian = path.jacobian(*point)
    assert isinstance(jacobian, np.ndarray)
    return float(np.linalg.slogdet(jacobian)[0])


def loaded_from(model: LoadedTubeModel, inputs: FloatArray, curved: TubeSolution) -> TubeSolution:
    """Follow an equilibrium without loads as loads grow, through folds if there are any."""
    start = model.begin(curved.x, inputs)
    if not curved.converged:
        return solution_at(model, inputs, start, found=False)
    path = input_path(model, start, model.robot.without_loads(inputs), inputs)
    end = _followed(path)
    iterations = curved.iterations + end.iterations
    if end.outcome is Outcome.CONVERGED:
        return solution_at(model, inputs, end.x, found=True, iterations=iterations)
    # Where the robot snaps under its loads the way goes on beyond the folds.
    traced = trace(Curve(path, DETERMINANT, LOADING))
    if traced.outcome is PathOutcome.CONVERGED:
        return solution_at(model, inputs, traced.points[-1].x, found=True, iterations=iterations)
    return solution_at(model, inputs, end.x, found=False, iterations=iterations)


def moved_to(model: TubeFunctions, start: TubeSolution, inputs: FloatArray) -> TubeSolution:
    """Follow an equilibrium of a model at other inputs along the straight line to these inputs."""
    end = _followed(input_path(model, start.x, start.inputs, inputs))
    return solution_at(model, inputs, end.x, found=end.outcome is Outcome.CONVERGED, iterations=end.iterations)


def finer_than(solution: TubeSolution) -> TubeSolution:
    """Solve for the equilibrium near a solution with twice the steps."""
    return solution_near(model_of(solution.robot, 2 * solution.model.steps), solution.inputs, solution.x)


def solution_near(model: TubeFunctions, inputs: FloatArray, start: FloatArray) -> TubeSolution:
    """Solve for the equilibrium of a model by Newton's method from a start."""
    equations = Equations(
        residual=lambda x: column(model.residual(x, inputs)),
        jacobian=lambda x: model.jacobian(x, inputs)[0].full(),
    )
    end = newton(equations, start, NewtonSettings())
    return solution_at(model, inputs, end.x, found=end.outcome is Outcome.CONVERGED, iterations=end.iterations)


def solution_at(
    model: TubeFunctions, inputs: FloatArray, x: FloatArray, *, found: bool, iterations: int = 0
) -> TubeSolution:
    """Make the result of a search of a model, with the angle by which tubes miss their drives, without error estimate.

    Args:
        model: the robot.
        inputs: inputs of the robot.
        x: unknowns of the robot.
        found: whether the unknowns are an equilibrium.
        iterations: number of Newton steps of the search.
    """
    outcome = Outcome.CONVERGED if found else Outcome.LOAD_STALLED
    residual = model.residual(x, inputs).full()
    missed = float(np.abs(residual).max())
    return TubeSolution(model, inputs, x, outcome, outcome.value, missed, iterations)
