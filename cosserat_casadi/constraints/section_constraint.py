"""Constraints that hold a section of a rod at a pose in another frame: the world, a body, the base of a carried rod.

A place of a body may replace the section: the body then takes the role of the rod's base.

The kinds of support and joint differ only in the directions that they hold. The residual and the
wrench are written once, as small expressions of poses and multipliers; CasADi differentiates them.
Docs/theory.md, section 8.

The multipliers are the force (unit EI/ℓ²) and the moment (unit EI/ℓ) on the section along the held directions, so
they are of the order of the dimensionless residual. The opposite wrench acts on the other frame.
Variations of poses are [δθ; δr] and wrenches [moment; force], the angular part first: their product is the work.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

import casadi as ca
import numpy as np

from cosserat_casadi.maths.calls import ONE_DIRECTION
from cosserat_casadi.maths.numbers import Scalar, is_symbolic
from cosserat_casadi.maths.pose import NumericPose, Pose
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product, quaternion_to_matrix, rotate
from cosserat_casadi.maths.typing import FloatArray, Matrix

KEPT_KERNELS = 128
"""Number of constraints whose kernels are kept for further models."""


@dataclass(frozen=True)
class HeldDirections:
    """Directions along and about which a section is held.

    Attributes:
        positions: unit vectors of the held displacements, shape (3, k).
        rotations: unit vectors of the held rotations, shape (3, m).
        turn_with_pose: whether the vectors are in the axes of the held pose and turn with it; else they are in the axes
            of the rod's base.
    """

    positions: FloatArray
    rotations: FloatArray
    turn_with_pose: bool = False

    @property
    def size(self) -> int:
        """Number of multipliers."""
        return int(self.positions.shape[1] + self.rotations.shape[1])

    @property
    def slides(self) -> bool:
        """Whether the section may move along the held pose, so that the wrench acts at the section."""
        return self.turn_with_pose and self.positions.shape[1] < 3


@dataclass(frozen=True)
class Coordinate:
    """A coordinate along which the held pose of a section moves.

    Attributes:
        axis: unit vector in the axes of the section, shape (3,).
        turns: whether the section turns about the axis, rad; else it slides along it, m.
    """

    axis: FloatArray
    turns: bool

    def moved(self, pose: Pose, value: Matrix, turn: Matrix | None) -> Pose:
        """A pose moved along the axis; ``turn`` takes the axis to the axis of the pose."""
        axis: Matrix = ca.DM(self.axis)
        if turn is not None:
            axis = rotate(turn, axis)
        if self.turns:
            return pose.then(Pose(ca.DM(3, 1), ca.vertcat(ca.cos(value / 2), ca.sin(value / 2) * axis)))
        return pose.then(Pose(value * axis, ca.DM([1, 0, 0, 0])))


class PoseVariations(NamedTuple):
    """Derivatives by the motions [δθ; δr] of the poses in a constraint, each with 6 columns.

    The section moves in the axes of the rod's base, the other two in world axes. The derivative by a coordinate has one
    column.
    """

    section: Matrix
    base: Matrix
    frame: Matrix
    coordinate: Matrix | None = None


class ConstraintPoses(NamedTuple):
    """The poses in a constraint.

    Attributes:
        section: the held section in the rod's base.
        base: the rod's base in the world.
        frame: the other frame in the world.
        coordinate: value of the constraint's coordinate, 1×1; None without one.
    """

    section: Pose
    base: Pose
    frame: Pose
    coordinate: Matrix | None = None

    @property
    def stacked(self) -> list[Matrix]:
        """Positions and quaternions, and the coordinate, as arguments of the kernels."""
        parts: list[Matrix] = []
        for pose in (self.section, self.base, self.frame):
            parts += [pose.position, pose.quaternion]
        return parts if self.coordinate is None else [*parts, self.coordinate]


@dataclass(frozen=True)
class HeldPose:
    """Pose and directions in which a section is held.

    Attributes:
        pose: pose of the section in the other frame.
        turn: quaternion that takes the directions of :class:`HeldDirections` to the held directions; None if these
            agree.
        coordinate: coordinate along which the pose moves; None for a fixed pose.
    """

    pose: Pose
    turn: Matrix | None
    coordinate: Coordinate | None = None

    @property
    def axes(self) -> Matrix | None:
        """Rotation from the directions of :class:`HeldDirections` to the held directions, 3×3; None without a turn."""
        return None if self.turn is None else quaternion_to_matrix(self.turn)

    def in_frame(self, poses: ConstraintPoses) -> Pose:
        """The held pose of the section in the other frame."""
        if self.coordinate is None or poses.coordinate is None:
            return self.pose
        return self.coordinate.moved(self.pose, poses.coordinate, self.turn)

    def seen_from(self, poses: ConstraintPoses) -> Pose:
        """The held pose of the section in the rod's base."""
        return poses.base.seen(poses.frame.then(self.in_frame(poses)))


@dataclass(frozen=True)
class SectionConstraint:
    """A section of a rod held at a pose in another frame.

    Attributes:
        length: ℓ of the rod, m.
        unit: EI/ℓ of the rod, J.
        at: abscissa of the section, a break of the rod's grid; ignored for a place of a body.
        held: the directions that are held.
        pose: pose of the section in the other frame that closes the constraint; expressions if parameters set it.
        turn: quaternion, 4×1, of the rotation that takes ``held``, in the axes of ``pose``, to the held directions;
            numbers or expressions; None if they agree.
        coordinate: coordinate along which the pose moves; None for a fixed pose.
    """

    length: float
    unit: float
    at: Scalar
    held: HeldDirections
    pose: NumericPose | Pose
    turn: Matrix | None = None
    coordinate: Coordinate | None = None

    @property
    def size(self) -> int:
        """Number of multipliers."""
        return self.held.size

    def residual(self, poses: ConstraintPoses) -> Matrix:
        """Residual of the constraint, size×1: displacements relative to the rod's length, then rotations, rad."""
        residual: Matrix = self._kernels.residual(*poses.stacked, *self._free_target)[0]
        return residual

    def residual_variation(self, poses: ConstraintPoses) -> PoseVariations:
        """Derivative of the residual by the poses, size×6 each."""
        _, *by_poses = self._kernels.residual(*poses.stacked, *self._free_target)
        return PoseVariations(*by_poses)

    def wrench_basis(self, poses: ConstraintPoses) -> Matrix:
        """Wrench on the section for a unit of each multiplier, base axes of the rod, 6×size."""
        return self._wrench_basis(poses, self._given_target)

    def _wrench_basis(self, poses: ConstraintPoses, target: HeldPose) -> Matrix:
        force = self.unit / self.length * self.held.positions
        moment = self.unit * self.held.rotations
        displacements = force.shape[1]
        basis = np.zeros((6, self.size))
        basis[3:, :displacements] = force
        basis[:3, displacements:] = moment
        # Sparse, so that directions along the axes of the base cost no product.
        in_given_axes = ca.sparsify(ca.DM(basis))
        if not self.held.turn_with_pose:
            return in_given_axes
        rotation = target.seen_from(poses).rotation
        if target.axes is not None:
            rotation = rotation @ target.axes
        return ca.diagcat(rotation, rotation) @ in_given_axes

    def wrench_variation(self, poses: ConstraintPoses, multipliers: Matrix) -> PoseVariations:
        """Derivative of the wrench on the section by the poses at fixed multipliers, base axes, 6×6 each."""
        if not self.held.turn_with_pose:
            zero = ca.DM(6, 6)
            return PoseVariations(zero, zero, zero)
        _, *by_poses = self._kernels.wrench(*poses.stacked, *self._free_target, multipliers)
        return PoseVariations(*by_poses)

    def reaction(self, poses: ConstraintPoses, multipliers: Matrix) -> Matrix:
        """Wrench on the other frame about its origin, world axes, 6×1."""
        reaction: Matrix = self._kernels.reaction(*poses.stacked, *self._free_target, multipliers)[0]
        return reaction

    def reaction_variation(self, poses: ConstraintPoses, multipliers: Matrix) -> tuple[Matrix, PoseVariations]:
        """Derivative of the reaction by the multipliers, 6×size, and by the poses, 6×6 each."""
        _, by_multipliers, *by_poses = self._kernels.reaction(*poses.stacked, *self._free_target, multipliers)
        return by_multipliers, PoseVariations(*by_poses)

    def on_body(self, poses: ConstraintPoses, multipliers: Matrix) -> Matrix:
        """Wrench on the body with the held place, about the origin of the body, world axes, 6×1."""
        wrench: Matrix = self._kernels.on_body(*poses.stacked, *self._free_target, multipliers)[0]
        return wrench

    def on_body_variation(self, poses: ConstraintPoses, multipliers: Matrix) -> tuple[Matrix, PoseVariations]:
        """Derivative of the wrench on the body by the multipliers, 6×size, and by the poses, 6×6 each."""
        _, by_multipliers, *by_poses = self._kernels.on_body(*poses.stacked, *self._free_target, multipliers)
        return by_multipliers, PoseVariations(*by_poses)

    @cached_property
    def _kernels(self) -> _Kernels:
        pose = None
        if isinstance(self.pose, NumericPose):
            pose = (_exact(self.pose.position), _exact(self.pose.quaternion))
        turn: Hashable = None
        if self.turn is not None:
            # An expression is an argument of the kernels.
            turn = "free" if is_symbolic(self.turn) else _exact(self.turn)
        held = (_exact(self.held.positions), _exact(self.held.rotations), self.held.turn_with_pose)
        coordinate = None
        if self.coordinate is not None:
            coordinate = (_exact(self.coordinate.axis), self.coordinate.turns)
        return _shared(_Kernels((self.length, self.unit, held, pose, turn, coordinate), self))

    @property
    def _given_target(self) -> HeldPose:
        """The pose and the directions in which the section is held, as expressions."""
        pose = self.pose if isinstance(self.pose, Pose) else self.pose.pose
        return HeldPose(pose, self.turn, self.coordinate)

    @property
    def _free_target(self) -> list[Matrix]:
        """The expressions of the held pose as arguments of the kernels; numbers of it are constants of the kernels."""
        arguments = [self.pose.position, self.pose.quaternion] if isinstance(self.pose, Pose) else []
        if is_symbolic(self.turn):
            arguments.append(self.turn)
        return arguments

    def target_symbols(self) -> tuple[HeldPose, list[ca.SX]]:
        """The target in the kernels, and its symbols."""
        target = self._given_target
        symbols = []
        if isinstance(self.pose, Pose):
            symbols = [ca.SX.sym("place_position", 3), ca.SX.sym("place_quaternion", 4)]
            target = replace(target, pose=Pose(*symbols))
        if is_symbolic(self.turn):
            symbols.append(ca.SX.sym("held_quaternion", 4))
            target = replace(target, turn=symbols[-1])
        return target, symbols

    def residual_of(self, poses: ConstraintPoses, target: HeldPose) -> Matrix:
        """Pᵀ (r − r_t)/ℓ and 2 Dᵀ vec(Q ⊗ Q_t*), or vec(Q_t* ⊗ Q) in the axes of the target."""
        section = poses.section
        held_to = target.seen_from(poses)
        back = quaternion_conjugate(held_to.quaternion)
        if self.held.turn_with_pose:
            displacement = held_to.rotation.T @ (section.position - held_to.position)
            turn = quaternion_product(back, section.quaternion)[1:]
        else:
            displacement = section.position - held_to.position
            turn = quaternion_product(section.quaternion, back)[1:]
        if target.axes is not None:
            displacement = target.axes.T @ displacement
            turn = target.axes.T @ turn
        along = ca.DM(self.held.positions).T @ displacement / self.length
        # The vector part of the quaternion is half of the remaining rotation, to first order.
        about = 2 * ca.DM(self.held.rotations).T @ turn
        return ca.vertcat(along, about)

    def wrench_of(self, poses: ConstraintPoses, target: HeldPose, multipliers: Matrix) -> Matrix:
        """The wrench on the section, base axes of the rod, 6×1."""
        return self._wrench_basis(poses, target) @ multipliers

    def reaction_of(self, poses: ConstraintPoses, target: HeldPose, multipliers: Matrix) -> Matrix:
        """The opposite of the wrench on the section, at the held pose, or at the section if it may slide."""
        wrench = self.wrench_of(poses, target, multipliers)
        moment = poses.base.rotation @ wrench[:3]
        force = poses.base.rotation @ wrench[3:]
        if self.held.slides:
            section = poses.base.then(poses.section)
            arm = section.position - poses.frame.position
        else:
            arm = poses.frame.rotation @ target.in_frame(poses).position
        moment_about_origin = ca.cross(arm, force) + moment
        return -ca.vertcat(moment_about_origin, force)

    def on_body_of(self, poses: ConstraintPoses, target: HeldPose, multipliers: Matrix) -> Matrix:
        """The wrench on the place of a body, about the origin of the body, world axes, 6×1."""
        wrench = self.wrench_of(poses, target, multipliers)
        moment = wrench[:3] + ca.cross(poses.section.position, wrench[3:])
        rotation = poses.base.rotation
        return ca.vertcat(rotation @ moment, rotation @ wrench[3:])


@dataclass(frozen=True)
class _Kernels:
    """The kernels of all constraints with one target.

    Attributes:
        law: constants of the kernels.
        constraint: one of these constraints.
    """

    law: tuple[Hashable, ...]
    constraint: SectionConstraint = field(compare=False)

    @property
    def _symbols(self) -> tuple[ConstraintPoses, list[ca.SX]]:
        return _symbols(has_coordinate=self.constraint.coordinate is not None)

    @cached_property
    def residual(self) -> ca.Function:
        """Poses ↦ residual and its variations."""
        poses, motions = self._symbols
        target, target_symbols = self.constraint.target_symbols()
        moved = self.constraint.residual_of(_moved(poses, motions), target)
        results = [self.constraint.residual_of(poses, target), *_at_rest(moved, motions, motions)]
        return ca.Function("constraint", [*poses.stacked, *target_symbols], ca.cse(results), ONE_DIRECTION)

    @cached_property
    def wrench(self) -> ca.Function:
        """Poses and multipliers ↦ wrench on the section and its variations by the poses."""
        return self._of_multipliers("constraint_wrench", SectionConstraint.wrench_of, with_multipliers=False)

    @cached_property
    def reaction(self) -> ca.Function:
        """Poses and multipliers ↦ reaction and its derivatives by the multipliers and the poses."""
        return self._of_multipliers("constraint_reaction", SectionConstraint.reaction_of, with_multipliers=True)

    @cached_property
    def on_body(self) -> ca.Function:
        """Poses and multipliers ↦ wrench on a body and its derivatives by the multipliers and the poses."""
        return self._of_multipliers("constraint_on_body", SectionConstraint.on_body_of, with_multipliers=True)

    def _of_multipliers(
        self,
        name: str,
        written: Callable[[SectionConstraint, ConstraintPoses, HeldPose, Matrix], Matrix],
        *,
        with_multipliers: bool,
    ) -> ca.Function:
        """Poses and multipliers ↦ a wrench and its derivatives, by the multipliers first if requested."""
        poses, motions = self._symbols
        target, target_symbols = self.constraint.target_symbols()
        multipliers = ca.SX.sym("multipliers", self.constraint.size)
        moved = written(self.constraint, _moved(poses, motions), target, multipliers)
        variables = [multipliers, *motions] if with_multipliers else motions
        results = [written(self.constraint, poses, target, multipliers), *_at_rest(moved, variables, motions)]
        return ca.Function(name, [*poses.stacked, *target_symbols, multipliers], ca.cse(results), ONE_DIRECTION)


@lru_cache(maxsize=KEPT_KERNELS)
def _shared(kernels: _Kernels) -> _Kernels:
    """The kept kernels with equal constants.

    A search for a discretisation builds many models of one scene, and writing the kernels takes longer than evaluating
    them.
    """
    return kernels


def _exact(matrix: Matrix | FloatArray) -> Hashable:
    """All digits of a matrix of numbers."""
    numbers = matrix if isinstance(matrix, np.ndarray) else ca.DM(matrix).full()
    return (numbers.shape, numbers.tobytes())


def _symbols(*, has_coordinate: bool) -> tuple[ConstraintPoses, list[ca.SX]]:
    """Symbols of the three poses, and of a coordinate, and of their motions."""
    names = ("section", "base", "frame")
    section, base, frame = (
        Pose(ca.SX.sym(f"{name}_position", 3), ca.SX.sym(f"{name}_quaternion", 4)) for name in names
    )
    motions = [ca.SX.sym(f"{name}_motion", 6) for name in names]
    if not has_coordinate:
        return ConstraintPoses(section, base, frame), motions
    coordinate = ca.SX.sym("coordinate")
    return ConstraintPoses(section, base, frame, coordinate), [*motions, ca.SX.sym("coordinate_motion")]


def _moved(poses: ConstraintPoses, motions: list[ca.SX]) -> ConstraintPoses:
    """The poses after small motions."""
    section, base, frame = motions[:3]
    coordinate = None if poses.coordinate is None else poses.coordinate + motions[3]
    moved = (poses.section.varied(section), poses.base.varied(base), poses.frame.varied(frame))
    return ConstraintPoses(*moved, coordinate)


def _at_rest(expression: Matrix, variables: list[ca.SX], motions: list[ca.SX]) -> list[Matrix]:
    """Derivatives of an expression by some variables at zero motions."""
    all_motions = ca.vertcat(*motions)
    rest = ca.DM.zeros(all_motions.numel())
    derivatives = [ca.jacobian(expression, variable) for variable in variables]
    at_rest = ca.substitute(derivatives, [all_motions], [rest])
    # Otherwise entries that are zero at rest would be instructions.
    return [ca.sparsify(derivative) for derivative in at_rest]
