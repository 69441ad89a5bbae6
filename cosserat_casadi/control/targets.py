"""Kinds of targets: poses and positions to reach, the errors of a state, and their marks in figures."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar, final

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.pose_change import rotation_angles
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.system_functions import SystemFunctions
from cosserat_casadi.scene.families import Kind, Kinds, register
from cosserat_casadi.scene.target_records import TARGETS, FrameTarget, TargetRecord

RecordType = TypeVar("RecordType", bound=TargetRecord)
FrameType = TypeVar("FrameType", bound=FrameTarget)


@dataclass(frozen=True)
class TargetMiss:
    """Error of one target.

    Attributes:
        what: the target in words.
        position: distance, m; for a curve the largest over its points.
        angle: angle between the target's orientation and the actual one, rad; None for a free orientation.
        position_error: estimated error of the discrete model in that position, m; None if it was not estimated.
        angle_error: estimated error of the discrete model in that angle, rad; None if it was not estimated.
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
        """Whether the target is met, by its error and, if it was estimated, by the error of the model."""
        error_within = self.position_error is None or self.position_error <= tolerance * length
        return error_within and self.reached(length, tolerance)


def length_of(model: SystemFunctions, target: TargetRecord) -> float:
    """Length by which the distance of a target is divided, m: its rod's length; for bodies and tubes the longest."""
    lengths = model.lengths
    rod = getattr(target, "rod", None)
    if rod is None:
        return max(lengths.values())
    return lengths[rod]


class Target(Kind, ABC, Generic[RecordType]):
    """One kind of target. The methods take ``target``, the frozen record of the scene.

    Models and solutions are of rods, or of concentric tubes where the target is for a tip.
    """

    family = TARGETS
    kinds = Kinds(TARGETS)

    def wanted(self, target: RecordType) -> FloatArray:
        """Wanted position and quaternion, which a table of targets may vary, shape (7,); zeros by default."""
        return np.zeros(POSE_SIZE)

    @abstractmethod
    def error(self, target: RecordType, model: Any, wanted: Matrix, x: Matrix, inputs: Matrix) -> Matrix:
        """Dimensionless errors without the weight of the target, k×1; zero if it is met.

        Positions count relative to :func:`length_of`, orientations by the chord 2 sin(θ/2) of their angle θ.

        Args:
            target: the record, without the entries that :meth:`wanted` returns.
            model: the model.
            wanted: wanted position and quaternion, as in :meth:`wanted`, 7×1.
            x: unknowns.
            inputs: stacked inputs.
        """

    @abstractmethod
    def gap(self, target: RecordType, solution: Any) -> TargetMiss:
        """Error of the target in a solution."""

    def model_error(self, target: RecordType, solution: Any) -> float | None:
        """Estimated error of a solution at the target: of the position, over the length of the rod, and of angles, rad.

        Returns:
            the error, by default that of the shapes of all rods; None if it was not estimated.
        """
        error: float | None = solution.largest_error
        return error

    def points(self, target: RecordType) -> Sequence[Sequence[float]]:
        """Points that a figure marks, world axes, m; none by default."""
        return []


TARGET_KINDS = Target.kinds
"""Targets by the word of the scene format."""


class _OfFrame(Target[FrameType]):
    """Target for one section of a rod, or one body."""

    def wanted(self, target: Any) -> FloatArray:
        """Wanted position, and zeros for the orientation, shape (7,)."""
        return np.array([*target.position, 0.0, 0.0, 0.0, 0.0])

    def error(self, target: Any, model: SystemFunctions, wanted: Matrix, x: Matrix, inputs: Matrix) -> Matrix:
        """Distance over the length, 3×1."""
        position, _ = self._pose(target, model, x, inputs)
        return (position - wanted[:3]) / length_of(model, target)

    def gap(self, target: Any, solution: Equilibrium[Any]) -> TargetMiss:
        """The distance."""
        what, position, _ = self._reached(target, solution)
        return TargetMiss(what, math.dist(position, target.position), None)

    def model_error(self, target: Any, solution: Equilibrium[Any]) -> float | None:
        """Error of the shapes for an inner section; error of the tips for tips, and for bodies, which tips hold."""
        if target.rod is not None and target.at != 1.0:
            return solution.largest_error
        return solution.error_estimate

    def points(self, target: Any) -> Sequence[Sequence[float]]:
        """The wanted position, as one point."""
        return [target.position]

    def _pose(self, target: Any, model: Any, x: Matrix, inputs: Matrix) -> list[Matrix]:
        """Position and quaternion of the section or body of the target."""
        if target.rod is None:
            outputs = model.body[str(target.body)](x, inputs)
        elif target.at == 1.0:
            # The tip needs no interpolation.
            outputs = model.tip[target.rod](x, inputs)
        else:
            outputs = model.shape[target.rod](x, inputs, target.at)
        return list(outputs[:2])

    def _reached(self, target: Any, solution: Any) -> tuple[str, FloatArray, FloatArray]:
        """Name of the section or body of the target, its position and its quaternion."""
        if target.rod is None:
            what = f"body {target.body}"
            pose = solution.body(target.body)
        elif target.at == 1.0:
            what = f"tip of {target.rod}"
            pose = solution.tip(target.rod)
        else:
            what = f"section X = {target.at:g} of {target.rod}"
            pose = solution.pose(target.at, target.rod)
        return what, pose.position, pose.quaternion


@final
@register
class PositionOfFrame(_OfFrame[scenes.PositionTarget]):
    """A position; the orientation is free."""

    record = scenes.PositionTarget


@final
@register
class PoseOfFrame(_OfFrame[scenes.PoseTarget]):
    """A position and an orientation."""

    record = scenes.PoseTarget

    def wanted(self, target: scenes.PoseTarget) -> FloatArray:
        """Wanted position and quaternion, shape (7,)."""
        return np.array([*target.position, *target.quaternion])

    def error(
        self, target: scenes.PoseTarget, model: SystemFunctions, wanted: Matrix, x: Matrix, inputs: Matrix
    ) -> Matrix:
        """Distance over the length, and the chord of the angle along its axis, 6×1."""
        position, quaternion = self._pose(target, model, x, inputs)
        position_error = (position - wanted[:3]) / length_of(model, target)
        # A planar rod leaves entries of its quaternion structurally zero.
        actual = ca.densify(ca.MX(quaternion))
        # The vector part is sin(θ/2) times the axis of the rotation between the two.
        difference = quaternion_product(quaternion_conjugate(ca.MX(wanted[3:])), actual)
        return ca.vertcat(position_error, 2 * difference[1:])

    def gap(self, target: scenes.PoseTarget, solution: Equilibrium[Any]) -> TargetMiss:
        """The distance and the angle."""
        what, position, quaternion = self._reached(target, solution)
        distance = math.dist(position, target.position)
        angle = rotation_angles(np.array(target.quaternion), quaternion)
        return TargetMiss(what, distance, float(angle))


@final
@register
class PointsAlongRod(Target[scenes.CurveTarget]):
    """Points along a rod, which count together as much as one point."""

    record = scenes.CurveTarget

    def error(self, target: scenes.CurveTarget, model: Model, wanted: Matrix, x: Matrix, inputs: Matrix) -> Matrix:
        """Distances over the length, and over the square root of the number of points, 3k×1."""
        shape = model.shape[target.rod]
        differences = []
        for X, point in zip(target.at, target.points, strict=True):
            position = shape(x, inputs, X)[0]
            differences.append(position - ca.DM(point))
        stacked: Matrix = ca.vertcat(*differences)
        scaled: Matrix = stacked / (length_of(model, target) * np.sqrt(len(target.at)))
        return scaled

    def gap(self, target: scenes.CurveTarget, solution: Solution) -> TargetMiss:
        """The largest distance."""
        pose = solution.pose(np.array(target.at), target.rod)
        differences = pose.position - np.array(target.points)
        distances = np.linalg.norm(differences, axis=1)
        what = f"{len(target.at)} points along {target.rod}"
        return TargetMiss(what, float(distances.max()), None)

    def points(self, target: scenes.CurveTarget) -> Sequence[Sequence[float]]:
        """The wanted points."""
        return target.points


def wanted_poses(targets: Sequence[scenes.Target]) -> FloatArray:
    """Stack the wanted positions and quaternions of targets, 7 numbers for each, with zeros for free ones."""
    return np.concatenate([TARGET_KINDS[target.kind].wanted(target) for target in targets])


def weighted_errors(
    model: SystemFunctions,
    targets: Sequence[scenes.Target],
    wanted: Matrix,
    x: Matrix,
    inputs: Matrix,
) -> Matrix:
    """Weighted dimensionless errors of targets; an optimiser minimises half their sum of squares.

    Positions count relative to the rod's length, orientations by the chord 2 sin(θ/2) of the angle θ between them,
    which is smooth at every angle. The points of a curve together count as much as one point.

    Args:
        model: the model.
        targets: the targets, without their positions and orientations, except for the points of curves.
        wanted: wanted positions and orientations, as in :func:`wanted_poses`.
        x: unknowns.
        inputs: stacked inputs.
    """
    errors = []
    for i, target in enumerate(targets):
        pose = wanted[POSE_SIZE * i : POSE_SIZE * (i + 1)]
        error = TARGET_KINDS[target.kind].error(target, model, pose, x, inputs)
        errors.append(np.sqrt(target.weight) * error)
    stacked: Matrix = ca.vertcat(*errors)
    return stacked


def target_errors(solution: Equilibrium[Any], targets: Sequence[scenes.Target]) -> tuple[TargetMiss, ...]:
    """Errors of the targets in a solution, with the estimated error of the model there."""
    gaps = []
    for target in targets:
        mechanics = TARGET_KINDS[target.kind]
        gap = mechanics.gap(target, solution)
        error = mechanics.model_error(target, solution)
        if error is not None:
            angle_error = None if gap.angle is None else error
            gap = replace(gap, position_error=error * length_of(solution.model, target), angle_error=angle_error)
        gaps.append(gap)
    return tuple(gaps)
