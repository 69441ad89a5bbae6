"""Arrows of the loads on concentric tubes, for their figures."""

from __future__ import annotations

import numpy as np

from cosserat_casadi.loads.load import UNITS, Arrow, Sort
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.tubes.robot import Robot
from cosserat_casadi.tubes.tube_loads import TubeLoad
from cosserat_casadi.tubes.tube_solution import TubeSolution

ALONG = 8
"""Number of arrows of a force per length on one tube."""


def load_arrows(solution: TubeSolution) -> list[Arrow]:
    """Arrows of all loads that are not zero, in world axes."""
    arrows: list[Arrow] = []
    for load, index in borne_loads(solution.robot):
        starts, vector = arrows_on(solution, load, index)
        if not np.any(vector):
            continue
        sort = sort_of(load)
        # One of them speaks for all.
        label = f"{load.name} on {solution.robot.names[index]}, {np.linalg.norm(vector):.3g} {UNITS[sort]}"
        arrows += [Arrow(start, vector, sort, "" if number else label) for number, start in enumerate(starts)]
    return arrows


def borne_loads(robot: Robot) -> list[tuple[TubeLoad, int]]:
    """Loads, each with the index of a tube that bears it."""
    return [(load, index) for load in robot.loads for index in load.bearers]


def sort_of(load: TubeLoad) -> Sort:
    """Kind of vector that the arrows of a load represent."""
    if load.is_moment:
        return "moment"
    return "line" if load.spread else "point"


def arrows_on(solution: TubeSolution, load: TubeLoad, tube: int) -> tuple[list[FloatArray], FloatArray]:
    """Places of the arrows of one load on one tube, and their vector, world axes; none if the housing bears it."""
    robot = solution.robot
    vector = float(load.shares[tube]) * solution.inputs[robot.layout.slices[load.name]]
    if load.follower:
        vector = _frame(solution, load, tube) @ vector
    reach = _reach(solution, load, tube)
    if load.spread:
        return [_point(solution, distance) for distance in np.linspace(0.0, reach, ALONG)], vector
    if load.is_beside_tip:
        return [_point(solution, reach)] if reach > 0.0 else [], vector
    return [solution.tips[robot.names[tube]].position], vector


def _reach(solution: TubeSolution, load: TubeLoad, tube: int) -> float:
    """Distance from the plate to the point where a load acts on a tube, or a distributed one ends, m."""
    return float(solution.robot.translations(solution.inputs)[tube]) - float(load.from_tip)


def _point(solution: TubeSolution, distance: float) -> FloatArray:
    """Point of the centre line at a distance from the plate."""
    (point,), _ = solution.shape.between(np.array([distance]))
    return np.asarray(point)


def _frame(solution: TubeSolution, load: TubeLoad, tube: int) -> FloatArray:
    """Rotation of a tube where a load acts on it, shape (3, 3)."""
    robot = solution.robot
    if not load.is_beside_tip:
        return solution.tips[robot.names[tube]].rotation
    shape = solution.shape
    reach = _reach(solution, load, tube)
    station = int(np.argmin(np.abs(shape.distance - reach)))
    half = shape.angles[station, tube] / 2
    turn = quaternion_to_matrix(np.array([np.cos(half), 0.0, 0.0, np.sin(half)]))
    return np.asarray(quaternion_to_matrix(shape.quaternion[station]) @ turn)
