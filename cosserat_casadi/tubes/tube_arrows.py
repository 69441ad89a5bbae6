"""Arrows of the loads on concentric tubes, for their figures."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cosserat_casadi.loads.arrow import UNITS, Arrow, Sort
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.tubes.tube_loads import COMPONENTS, TubeLoad
from cosserat_casadi.tubes.tube_solution import TubeSolution

ALONG = 8
"""Arrows of a force per length on one tube."""


def load_arrows(solution: TubeSolution) -> list[Arrow]:
    """Arrows of all loads that are not zero, in world axes."""
    robot = solution.robot
    arrows: list[Arrow] = []
    for number, load in enumerate(robot.loads):
        start = robot.load_start(number)
        value = solution.inputs[start : start + COMPONENTS]
        for index in range(robot.size):
            vector = load.shares[index] * value
            if load.follower:
                vector = _frame(solution, load, index) @ vector
            if np.any(vector):
                arrows += _arrows_on(solution, load, index, vector)
    return arrows


def _arrows_on(solution: TubeSolution, load: TubeLoad, tube: int, vector: FloatArray) -> Iterator[Arrow]:
    """Arrows of one load on one tube."""
    robot = solution.robot
    name = robot.names[tube]
    sort: Sort = "point"
    reach = float(robot.translations(solution.inputs)[tube]) - load.from_tip
    starts = [solution.tips[name].position]
    if load.from_tip > 0.0:
        # The housing bears what acts in it.
        starts = [_point(solution, reach)] if reach > 0.0 else []
    if load.is_moment:
        sort = "moment"
    elif load.spread:
        sort = "line"
        starts = [_point(solution, distance) for distance in np.linspace(0.0, reach, ALONG)]
    label = f"{load.name} on {name}, {np.linalg.norm(vector):.3g} {UNITS[sort]}"
    for place in starts:
        yield Arrow(place, vector, sort, label)
        # One of them speaks for all.
        label = ""


def _point(solution: TubeSolution, distance: float) -> FloatArray:
    """Point of the centre line at a distance from the plate."""
    shape = solution.shape
    return np.array([np.interp(distance, shape.distance, column) for column in shape.position.T])


def _frame(solution: TubeSolution, load: TubeLoad, tube: int) -> FloatArray:
    """Rotation of a tube where a load acts on it, shape (3, 3)."""
    robot = solution.robot
    if load.from_tip == 0.0:
        return solution.tips[robot.names[tube]].rotation
    shape = solution.shape
    reach = float(robot.translations(solution.inputs)[tube]) - load.from_tip
    station = int(np.argmin(np.abs(shape.distance - reach)))
    half = shape.angles[station, tube] / 2
    turn = quaternion_to_matrix(np.array([np.cos(half), 0.0, 0.0, np.sin(half)]))
    return np.asarray(quaternion_to_matrix(shape.quaternion[station]) @ turn)
