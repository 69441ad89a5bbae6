"""Rotation along the rod, from base to tip: R' = ℓ R K^, report (1.9), (1.10), (2.17).

The default integrates by products of exponentials: one Magnus increment between neighbouring nodes. A quaternion
is a unit quaternion to rounding, the cost grows with the number of nodes, and the derivative of the discrete
rotations is exact and cheap: δθ_{i+1} = δθ_i + R_i T(Ω_i) δΩ_i. The literal linear system of chapter 3 is the other
member, kept as the oracle.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths import magnus
from cosserat_casadi.maths.blocks import unstack
from cosserat_casadi.maths.permuted import permuted_system
from cosserat_casadi.maths.rotation import quaternion_product, quaternion_rate_matrix, quaternion_to_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.strain import DiscreteRod, Ratio, drawn

ARGUMENTS = ["turn", "omega", "factors", "rotation", "moment"]

KEPT = {"never_inline": True}
"""Kernels stay functions when a model is expanded to scalars: generated code calls them in place of repeating them."""


@dataclass(frozen=True)
class IntervalKernels:
    """Functions of one interval between neighbouring nodes, made once for a rod.

    Their argument ``turn`` holds the Taylor coefficients of the turn of the interval: for l = 1, 2, … the
    components about the rod's turning axes, rad.

    Attributes:
        axes: the local axes about which the rod can turn.
        count: number of Taylor coefficients l.
    """

    axes: tuple[int, ...]
    count: int

    @property
    def size(self) -> int:
        """Entries of ``turn``."""
        return len(self.axes) * self.count

    @cached_property
    def increment(self) -> ca.Function:
        """The map turn ↦ (quaternion, omega, factors): increment, its Ω, and the factors of its derivatives, 2×1."""
        turn, omega = self._rotation_vector()
        made = magnus.increment(omega)
        outputs = [made.quaternion, ca.sparsify(omega), ca.vertcat(made.half_sine, made.cubic)]
        return ca.Function("increment", [turn], ca.cse(outputs), ["turn"], ["quaternion", "omega", "factors"], KEPT)

    @cached_property
    def rotation_pattern(self) -> ca.Sparsity:
        """Sparsity of a rotation matrix of the rod, 3×3: a rod that turns about one axis leaves that axis alone."""
        quaternion = ca.SX.sym("quaternion", self.increment.sparsity_out(0))
        return ca.sparsify(quaternion_to_matrix(quaternion)).sparsity()

    @cached_property
    def pull(self) -> ca.Function:
        """The map (turn, omega, factors, rotation, moment) ↦ (R T ∂Ω/∂turn)ᵀ moment: generalised moment of an interval.

        ``omega`` and ``factors`` are those of :attr:`increment`, ``rotation`` is the matrix R of the section at which
        the interval begins, ``moment`` what passes the interval, 3×1, N m, base frame.
        """
        symbols, made, rotation, moment = self._arguments()
        turn, omega = self._rotation_vector(symbols[0])
        force = ca.cse(ca.jtimes(omega, turn, made.pulled(rotation.T @ moment), True))
        return ca.Function("pull", symbols, [force], ARGUMENTS, ["force"], KEPT)

    @cached_property
    def variation(self) -> ca.Function:
        """First and second derivatives of one interval: (turn, omega, factors, rotation, moment) ↦ (A, V, H).

        A = R T ∂Ω/∂turn, 3×size: δθ of the interval in the base frame. The pull Aᵀ moment changes with the turn, R and
        the moment fixed, by Aᵀ V A + H: V of :meth:`magnus.Increment.stiffness` in the base frame, 3×3, and H, the
        second derivative of Ω·(Tᵀ Rᵀ moment) at fixed Tᵀ Rᵀ moment, size×size.
        """
        symbols, made, rotation, moment = self._arguments()
        turn, omega = self._rotation_vector(symbols[0])
        pulled = ca.SX.sym("pulled", 3)
        turning = (rotation @ made.tangent) @ ca.jacobian(omega, turn)
        stiffness = replace(made, omega=rotation @ made.omega).stiffness(moment)
        second = ca.triu2symm(ca.triu(ca.jacobian(ca.jtimes(omega, turn, pulled, True), turn)))
        second = ca.substitute(second, pulled, made.pulled(rotation.T @ moment))
        outputs = list(map(ca.sparsify, ca.cse([turning, stiffness, second])))
        return ca.Function("variation", symbols, outputs, ARGUMENTS, ["A", "V", "H"], KEPT)

    def _arguments(self) -> tuple[list[ca.SX], magnus.Increment, ca.SX, ca.SX]:
        """Symbols of the arguments, and from them the increment, the rotation at the beginning, the moment."""
        turn, omega = ca.SX.sym("turn", self.size), ca.SX.sym("omega", self.increment.sparsity_out(1))
        factors, rotation = ca.SX.sym("factors", 2), ca.SX.sym("rotation", self.rotation_pattern)
        moment = ca.SX.sym("moment", 3)
        made = magnus.Increment(omega, factors[0], factors[1])
        return [turn, omega, factors, rotation, moment], made, rotation, moment

    def _rotation_vector(self, turn: ca.SX | None = None) -> tuple[ca.SX, ca.SX]:
        """The turn, a new symbol unless given, and its rotation vector Ω."""
        turn = ca.SX.sym("turn", self.size) if turn is None else turn
        alphas = []
        for part in ca.vertsplit(turn, len(self.axes)) if self.axes else []:
            alpha = ca.SX(3, 1)
            for axis, entry in zip(self.axes, ca.vertsplit(part), strict=True):
                alpha[axis] = entry
            alphas.append(alpha)
        return turn, magnus.rotation_increment(alphas) if alphas else ca.SX(3, 1)


def interval_kernels(rod: DiscreteRod) -> IntervalKernels:
    """The kernels that fit a rod's turning axes and its integration method."""
    return _kernels(rod.properties.turning_axes, rod.taylor_count)


@cache
def _kernels(axes: tuple[int, ...], count: int) -> IntervalKernels:
    """One set of functions for all models: what they share is generated once."""
    return IntervalKernels(axes, count)


def interval_turns(rod: DiscreteRod, q: Matrix, ratio: Ratio = None) -> Matrix:
    """Taylor coefficients of the turn of every interval, size×intervals, rad."""
    axes = list(rod.properties.turning_axes)
    intrinsic = np.concatenate([taylor[:, axes].T for taylor in rod.intrinsic_taylor])
    fold, half = rod.turn_factors
    return drawn(ca.DM(intrinsic), ratio) + unstack(fold.T @ (half @ q), intrinsic.shape[0])


def largest_turn(rod: DiscreteRod, q: Matrix, ratio: Ratio = None) -> Matrix:
    """Largest turn of an interval between nodes, 1×1, rad: a bound on ∫|K| ds over it, from the Taylor coefficients."""
    axes, turns = len(rod.properties.turning_axes), interval_turns(rod, q, ratio)
    total = ca.DM.zeros(1, turns.shape[1])
    for order in range(turns.shape[0] // axes):
        rows = turns[order * axes : (order + 1) * axes, :]
        total = total + ca.sqrt(ca.sum1(rows**2)) / (2**order * (order + 1))
    return ca.mmax(total)


@dataclass(frozen=True)
class Increments:
    """Rotations of all intervals.

    Attributes:
        turn: Taylor coefficients, size×intervals, rad.
        quaternion: increments, 4×intervals.
        omega: rotation vectors, 3×intervals, rad.
        factors: of their derivatives, 2×intervals.
    """

    turn: Matrix
    quaternion: Matrix
    omega: Matrix
    factors: Matrix


def increments(rod: DiscreteRod, q: Matrix, ratio: Ratio = None) -> Increments:
    """Rotations of all intervals for given strain coordinates."""
    turns = interval_turns(rod, q, ratio)
    return Increments(turns, *interval_kernels(rod).increment.map(turns.shape[1])(turns))


def transport(rod: DiscreteRod, q: Matrix, steps: Increments | None, ratio: Ratio = None) -> Matrix:
    """Quaternions base_Q_section of the distinct sections, 4×(intervals + 1), the first the identity.

    Args:
        rod: matrices of the rod.
        q: strain coordinates.
        steps: rotations of the intervals; None for a rod that does not turn, or to solve the literal system.
        ratio: length of the rod relative to the reference length.
    """
    if not rod.properties.turning_axes:
        return ca.repmat(ca.DM([1, 0, 0, 0]), 1, len(rod.grid.left_ends) + 1)
    if steps is None:
        return _permuted_transport(rod, q, ratio)
    pattern = interval_kernels(rod).increment.sparsity_out(0)
    start = ca.project(ca.DM([1, 0, 0, 0]), pattern)
    later = _chain(pattern).mapaccum(steps.quaternion.shape[1])(start, steps.quaternion)
    quaternions: Matrix = ca.horzcat(start, later)
    return quaternions


def _chain(pattern: ca.Sparsity) -> ca.Function:
    """One step of the product of quaternions that share a sparsity pattern closed under products."""
    rotation, increment = ca.SX.sym("rotation", pattern), ca.SX.sym("increment", pattern)
    product = ca.project(quaternion_product(rotation, increment), pattern)
    return ca.Function("chain", [rotation, increment], [product])


def _permuted_transport(rod: DiscreteRod, q: Matrix, ratio: Ratio) -> Matrix:
    """Literal solve of report (3.22) for Q' = ½ ℓ A(K) Q, element after element."""
    grid = rod.grid
    intrinsic = rod.properties.intrinsic_strain(grid.nodes)
    rates = []
    for axis in range(3):
        row = drawn(ca.DM(intrinsic[:, axis]).T, ratio)
        if axis in rod.columns:
            row = row + (ca.DM(rod.at_nodes[axis]) @ q[rod.columns[axis]]).T
        rates.append(row)
    curvature = ca.vertcat(*rates)
    sections: list[Matrix] = [ca.DM([1, 0, 0, 0])]
    for e in range(grid.elements):
        width = grid.breaks[e + 1] - grid.breaks[e]
        nodes = range(e * (grid.intervals + 1), (e + 1) * (grid.intervals + 1))
        rate = [width * rod.properties.length / 2 * quaternion_rate_matrix(curvature[:, j]) for j in nodes]
        solution = permuted_system(rate, [ca.DM.zeros(4, 1)] * len(rate)).solve(sections[-1][:, -1])
        sections.append(solution[:, 1:])
    return ca.horzcat(*sections)
