"""How far a state is from its targets: symbolically for an optimiser, in metres and radians for a person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.pose_change import rotation_angles
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.scene.families import without_mechanics
from cosserat_casadi.scene.targets import TARGETS


@dataclass(frozen=True)
class Gap:
    """Error of one target: how far it is missed.

    Attributes:
        what: the target in words.
        position: distance in m, of a curve the largest over its points.
        angle: angle between the target's orientation and the actual one, rad; None where the orientation is free.
        position_error: estimated error of the discrete model that the distance was measured on, m; None where it was
            not estimated.
        angle_error: likewise of the angle, rad.
    """

    what: str
    position: float
    angle: float | None
    position_error: float | None = None
    angle_error: float | None = None

    def reached(self, length: float, tolerance: float) -> bool:
        """Whether the discrete model meets the target: position relative to a length, and angle, to a tolerance."""
        angle_reached = self.angle is None or self.angle <= tolerance
        return angle_reached and self.position <= tolerance * length

    def within(self, length: float, tolerance: float) -> bool:
        """Whether the target is met: the gap and, where it was estimated, the error of the model that it is of."""
        error_within = self.position_error is None or self.position_error <= tolerance * length
        return error_within and self.reached(length, tolerance)


def length_of(model: Model, target: scenes.Target) -> float:
    """Length that a target's distance is measured by, m: that of its rod, for a body that of the longest rod."""
    lengths = {rod.name: rod.length for rod in model.scene.rods}
    if target.rod is None:
        return max(lengths.values())
    return lengths[target.rod]


def wanted_poses(targets: Sequence[scenes.Target]) -> FloatArray:
    """Positions and quaternions that targets ask for, 7 numbers for each; zeros for what a target leaves free."""
    poses = np.zeros((len(targets), POSE_SIZE))
    for pose, target in zip(poses, targets, strict=True):
        if not isinstance(target, scenes.CurveTarget):
            pose[:3] = target.position
        if isinstance(target, scenes.PoseTarget):
            pose[3:] = target.quaternion
    return poses.ravel()


def weighted_errors(
    model: Model,
    targets: Sequence[scenes.Target],
    wanted: Matrix,
    x: Matrix,
    inputs: Matrix,
) -> Matrix:
    """Weighted errors of targets, without unit; half their sum of squares is what an optimiser lessens.

    Positions count relative to the rod's length. Orientations by the chord 2 sin(θ/2) of the angle θ between them,
    which is smooth at every angle. The points of a curve count together as much as one point.

    Args:
        model: the model.
        targets: what is to be where; their positions and orientations are not read, but for the points of curves.
        wanted: these, as in :func:`wanted_poses`.
        x: unknowns.
        inputs: stacked inputs.
    """
    errors = []
    for i, target in enumerate(targets):
        pose = wanted[POSE_SIZE * i : POSE_SIZE * (i + 1)]
        error = _error(model, target, pose, x, inputs)
        errors.append(np.sqrt(target.weight) * error)
    stacked: Matrix = ca.vertcat(*errors)
    return stacked


def target_errors(solution: Solution, targets: Sequence[scenes.Target]) -> tuple[Gap, ...]:
    """How far a solution is from each of the targets, and how far the model itself may be off there."""
    gaps = []
    for target in targets:
        gap = _gap(solution, target)
        error = model_error(solution, target)
        if error is not None:
            angle_error = None if gap.angle is None else error
            gap = replace(gap, position_error=error * length_of(solution.model, target), angle_error=angle_error)
        gaps.append(gap)
    return tuple(gaps)


def model_error(solution: Solution, target: scenes.Target) -> float | None:
    """Estimated error of a solution where a target is: position relative to the length of the rod, and rad.

    Returns:
        None where it was not estimated.
    """
    is_curve = isinstance(target, scenes.CurveTarget)
    # A body is where the tips of its rods are; of sections in between only the shape's estimate speaks.
    if is_curve or (target.rod is not None and target.at != 1.0):
        return solution.shape_error_estimate
    return solution.error_estimate


def _error(model: Model, target: scenes.Target, wanted: Matrix, x: Matrix, inputs: Matrix) -> Matrix:
    """Error of one target without its weight: 3 numbers, 6 with an orientation, 3k for k points of a curve."""
    if target.kind not in ("pose", "position", "curve"):
        raise without_mechanics(TARGETS, target.kind)
    length = length_of(model, target)
    if isinstance(target, scenes.CurveTarget):
        error = _curve_error(model, target, x, inputs)
        scaled: Matrix = error / (length * np.sqrt(len(target.at)))
        return scaled
    position, quaternion = _pose(model, target, x, inputs)
    position_error = (position - wanted[:3]) / length
    if isinstance(target, scenes.PositionTarget):
        return position_error
    return ca.vertcat(position_error, 2 * _half_rotation(wanted[3:], quaternion))


def _curve_error(model: Model, target: scenes.CurveTarget, x: Matrix, inputs: Matrix) -> Matrix:
    """Differences from the points of a curve, m, shape (3k,)."""
    shape = model.shape[target.rod]
    differences = []
    for X, point in zip(target.at, target.points, strict=True):
        position = shape(x, inputs, X)[0]
        differences.append(position - ca.DM(point))
    stacked: Matrix = ca.vertcat(*differences)
    return stacked


def _pose(
    model: Model,
    target: scenes.PoseTarget | scenes.PositionTarget,
    x: Matrix,
    inputs: Matrix,
) -> list[Matrix]:
    """Position and quaternion of what a target is for."""
    if target.rod is None:
        outputs = model.body[str(target.body)](x, inputs)
    elif target.at == 1.0:
        # The tip needs no interpolation.
        outputs = model.tip[target.rod](x, inputs)
    else:
        outputs = model.shape[target.rod](x, inputs, target.at)
    return list(outputs[:2])


def _half_rotation(wanted: Matrix, quaternion: Matrix) -> Matrix:
    """Vector part of the rotation from the wanted orientation to the actual one: sin(θ/2) times its axis."""
    conjugate = quaternion_conjugate(ca.MX(wanted))
    # A planar rod leaves entries of its quaternion structurally zero.
    actual = ca.densify(ca.MX(quaternion))
    difference = quaternion_product(conjugate, actual)
    return difference[1:]


def _gap(solution: Solution, target: scenes.Target) -> Gap:
    if isinstance(target, scenes.CurveTarget):
        return _curve_gap(solution, target)
    if target.rod is None:
        what = f"body {target.body}"
        pose = solution.body(target.body)
    else:
        section = "tip" if target.at == 1.0 else f"section X = {target.at:g}"
        what = f"{section} of {target.rod}"
        pose = solution.pose(np.array([target.at]), target.rod)
    difference = pose.position[0] - np.array(target.position)
    distance = float(np.linalg.norm(difference))
    if isinstance(target, scenes.PositionTarget):
        return Gap(what, distance, None)
    angles = rotation_angles(np.array([target.quaternion]), pose.quaternion)
    return Gap(what, distance, float(angles[0]))


def _curve_gap(solution: Solution, target: scenes.CurveTarget) -> Gap:
    pose = solution.pose(np.array(target.at), target.rod)
    differences = pose.position - np.array(target.points)
    distances = np.linalg.norm(differences, axis=1)
    what = f"{len(target.at)} points along {target.rod}"
    return Gap(what, float(distances.max()), None)
