"""Arrows of the loads on concentric tubes, for their figures."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cosserat_casadi.loads.arrow import UNITS, Arrow, Sort
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.tubes.loads import COMPONENTS, TubeLoad
from cosserat_casadi.tubes.solution import TubeSolution

ALONG = 8
"""Arrows of a force per length on one tube."""


def load_arrows(solution: TubeSolution) -> list[Arrow]:
    """Arrows of all loads that are not zero, in world axes."""
    robot = solution.robot
    arrows: list[Arrow] = []
    for number, load in enumerate(robot.loads):
        start = robot.load_start(number)
        value = solution.inputs[start : start + COMPONENTS]
        for index, name in enumerate(robot.names):
            vector = load.shares[index] * value
            if load.follower:
                vector = solution.tips[name].rotation @ vector
            if np.any(vector):
                arrows += _arrows_on(solution, load, index, vector)
    return arrows


def _arrows_on(solution: TubeSolution, load: TubeLoad, tube: int, vector: FloatArray) -> Iterator[Arrow]:
    """Arrows of one load on one tube."""
    robot = solution.robot
    name = robot.names[tube]
    sort: Sort = "point"
    starts = [solution.tips[name].position]
    if load.is_moment:
        sort = "moment"
    elif load.spread:
        sort = "line"
        starts = _points(solution, float(robot.translations(solution.inputs)[tube]))
    label = f"{load.name} on {name}, {np.linalg.norm(vector):.3g} {UNITS[sort]}"
    for place in starts:
        yield Arrow(place, vector, sort, label)
        # One of them speaks for all.
        label = ""


def _points(solution: TubeSolution, reach: float) -> list[FloatArray]:
    """Points of the centre line up to a distance from the plate."""
    shape = solution.shape
    distances = np.linspace(0.0, reach, ALONG)
    columns = [np.interp(distances, shape.distance, column) for column in shape.position.T]
    return list(np.array(columns).T)
