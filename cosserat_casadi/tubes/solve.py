"""Solve concentric tubes: one equilibrium at given inputs, with as many steps as its tolerance needs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.continuation import Path, follow
from cosserat_casadi.numerics.newton import Equations, NewtonSettings, newton
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.tubes.model import TubeModel
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.solution import TubeOutcome, TubeSolution, tip_error

FEWEST_STEPS = 2
"""Steps of a piece that the search begins with."""

MOST_STEPS = 256
"""Steps of a piece beyond which it gives up."""


def solve_tubes(scene: scenes.Scene, values: Mapping[str, float] | npt.ArrayLike | None = None) -> TubeSolution:
    """Find the equilibrium that the tubes have when they are bent, at these inputs, from straight ones.

    It is the one that a robot has which was curved where it is; one that was turned there may be in another. Whether it
    is stable it says itself; :func:`all_equilibria` finds the others.

    Args:
        scene: a scene with tubes.
        values: inputs by name, such as "inner.rotation", where those left out keep the scene's value; or all of them,
            rotation and translation of each tube, rad and m.

    Raises:
        SceneError: the scene has no tubes, or an input is unknown or out of its range.
    """
    robot = robot_of(scene)
    at = robot.packed(values)
    steps = FEWEST_STEPS
    found = solve_at(TubeModel(robot, steps), at)
    while True:
        steps *= 2
        finer = solve_at(TubeModel(robot, steps), at)
        error = None
        if found.converged and finer.converged:
            error = tip_error(found, finer)
        resolved = error is not None and error <= robot.tolerance
        if resolved or steps >= MOST_STEPS:
            return judged(finer, error)
        found = finer


def judged(solution: TubeSolution, error: float | None) -> TubeSolution:
    """A solution with the estimate of its error, and its outcome by that."""
    outcome = solution.outcome
    if solution.converged and (error is None or error > solution.robot.tolerance):
        outcome = TubeOutcome.UNRESOLVED
    return replace(solution, outcome=outcome, error_estimate=error)


def solve_at(model: TubeModel, inputs: FloatArray) -> TubeSolution:
    """The equilibrium of a model that straight tubes lead to, while their curvature grows."""
    path = Path(
        residual=lambda x, t: np.ravel(model.residual(x, inputs, t).full()),
        jacobian=lambda x, t: model.jacobian(x, inputs, t)[0].full(),
        rate=lambda x, t: np.ravel(model.load_rate(x, inputs, t).full()),
        # Straight tubes do not twist.
        start=inputs[::2].copy(),
    )
    end = follow(path)
    return solution_at(model, inputs, end.x, found=end.outcome is Outcome.CONVERGED)


def solution_near(model: TubeModel, inputs: FloatArray, start: FloatArray) -> TubeSolution:
    """The equilibrium of a model that Newton's method leads to from a start."""
    equations = Equations(
        residual=lambda x: np.ravel(model.residual(x, inputs, 1.0).full()),
        jacobian=lambda x: model.jacobian(x, inputs, 1.0)[0].full(),
    )
    end = newton(equations, start, NewtonSettings())
    return solution_at(model, inputs, end.x, found=end.outcome is Outcome.CONVERGED)


def solution_at(model: TubeModel, inputs: FloatArray, x: FloatArray, *, found: bool) -> TubeSolution:
    """Where a search of a model has ended, with the angle that the tubes miss their drives by; its error not estimated.

    Args:
        model: the robot.
        inputs: shape (2 n,).
        x: angles at the tips, shape (n,), rad.
        found: whether they are an equilibrium.
    """
    outcome = TubeOutcome.NOT_FOUND
    if found:
        outcome = TubeOutcome.CONVERGED
    residual = model.residual(x, inputs, 1.0).full()
    missed = float(np.abs(residual).max())
    return TubeSolution(model, inputs, x, outcome, missed, None)
