"""How far a state is from its targets: symbolically for an optimiser, in metres and radians for a person."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.rotation import quaternion_product
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model


@dataclass(frozen=True)
class Gap:
    """How far a target is missed.

    Attributes:
        what: the target in words.
        position: distance in m, of a curve the largest over its points.
        angle: angle between wanted and found orientation, rad; None where the orientation is free.
    """

    what: str
    position: float
    angle: float | None

    def within(self, length: float, tolerance: float) -> bool:
        """Whether it is closed: position relative to a length, and angle, to a tolerance."""
        return self.position <= tolerance * length and (self.angle is None or self.angle <= tolerance)


def length_of(model: Model, target: scenes.Target) -> float:
    """Length that a target's distance is measured by, m: that of its rod, for a body that of the longest rod."""
    lengths = {rod.name: rod.length for rod in model.scene.rods}
    return lengths[target.rod] if target.rod is not None else max(lengths.values())


def deviations(model: Model, x: Matrix, inputs: Matrix) -> Matrix:
    """Weighted deviations from all targets, without unit; half their sum of squares is what an optimiser lessens.

    Positions count relative to the rod's length. Orientations by the chord 2 sin(θ/2) of the angle θ between them,
    which is smooth at every angle. The points of a curve count together as much as one point.
    """
    parts = [np.sqrt(target.weight) * _deviation(model, target, x, inputs) for target in model.scene.targets]
    stacked: Matrix = ca.vertcat(*parts)
    return stacked


def gaps(solution: Solution) -> tuple[Gap, ...]:
    """How far a solution is from each of the targets of its scene."""
    return tuple(_gap(solution, target) for target in solution.model.scene.targets)


def _deviation(model: Model, target: scenes.Target, x: Matrix, inputs: Matrix) -> Matrix:
    length = length_of(model, target)
    if isinstance(target, scenes.CurveTarget):
        shape, count = model.shape[target.rod], len(target.at)
        points = [shape(x, inputs, X)[0] - ca.DM(point) for X, point in zip(target.at, target.points, strict=True)]
        deviation: Matrix = ca.vertcat(*points) / (length * np.sqrt(count))
        return deviation
    position, quaternion = _pose(model, target, x, inputs)
    moved = (position - ca.DM(target.position)) / length
    if isinstance(target, scenes.PositionTarget):
        return moved
    return ca.vertcat(moved, 2 * _turn(target, quaternion))


def _pose(model: Model, target: scenes.PoseTarget | scenes.PositionTarget, x: Matrix, inputs: Matrix) -> list[Matrix]:
    if target.rod is None:
        found = model.body[str(target.body)](x, inputs)
    elif target.at == 1.0:
        found = model.tip[target.rod](x, inputs)
    else:
        found = model.shape[target.rod](x, inputs, target.at)
    return list(found[:2])


def _turn(target: scenes.PoseTarget, quaternion: Matrix) -> ca.MX:
    """Vector part of the rotation from the wanted orientation to the found one: sin(θ/2) times its axis."""
    w, *vector = target.quaternion
    conjugate = ca.DM([w, *(-v for v in vector)])
    return quaternion_product(ca.MX(conjugate), ca.densify(ca.MX(quaternion)))[1:]


def _gap(solution: Solution, target: scenes.Target) -> Gap:
    if isinstance(target, scenes.CurveTarget):
        found = solution.pose(np.array(target.at), target.rod).position
        distances = np.linalg.norm(found - np.array(target.points), axis=1)
        return Gap(f"{len(target.at)} points along {target.rod}", float(distances.max()), None)
    if target.rod is None:
        what, pose = f"body {target.body}", solution.body(target.body)
    else:
        place = "tip" if target.at == 1.0 else f"section X = {target.at:g}"
        what, pose = f"{place} of {target.rod}", solution.pose(np.array([target.at]), target.rod)
    distance = float(np.linalg.norm(pose.position[0] - np.array(target.position)))
    if isinstance(target, scenes.PositionTarget):
        return Gap(what, distance, None)
    return Gap(what, distance, _angle(np.array(target.quaternion), pose.quaternion[0]))


def _angle(wanted: FloatArray, found: FloatArray) -> float:
    """Angle of the rotation between two unit quaternions, rad, in [0, π]."""
    vector = wanted[0] * found[1:] - found[0] * wanted[1:] - np.cross(wanted[1:], found[1:])
    return float(2 * np.arctan2(np.linalg.norm(vector), abs(wanted @ found)))
