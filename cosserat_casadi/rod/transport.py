"""Rotation along the rod, from base to tip: R' = ℓ R K^, report (1.9), (1.10), (2.17).

The default integrates by products of exponentials: one Magnus increment between neighbouring nodes. A quaternion
is a unit quaternion to rounding, the cost grows with the number of nodes, and the derivative of the discrete
rotations is exact and cheap: δθ_{i+1} = δθ_i + R_i T(Ω_i) δΩ_i. The literal linear system of chapter 3 is the other
member, kept as the oracle.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths import magnus
from cosserat_casadi.maths.permuted import permuted_system
from cosserat_casadi.maths.rotation import quaternion_product, quaternion_rate_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.strain import StrainBasis


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
        """The map turn ↦ quaternion of the increment."""
        turn, omega = self._rotation_vector()
        return ca.Function(
            "increment", [turn], [magnus.increment_quaternion(omega)], ["turn"], ["quaternion"], {"never_inline": True}
        )

    @cached_property
    def pull(self) -> ca.Function:
        """The map (turn, body moment) ↦ (T ∂Ω/∂turn)ᵀ moment: the generalised moment of the interval."""
        turn, omega = self._rotation_vector()
        moment = ca.SX.sym("moment", 3)
        force = ca.cse(ca.jtimes(omega, turn, magnus.increment_tangent(omega).T @ moment, True))
        return ca.Function("pull", [turn, moment], [force], ["turn", "moment"], ["force"], {"never_inline": True})

    @cached_property
    def variation(self) -> ca.Function:
        """First and second derivatives of one interval: (turn, body moment) ↦ (E, T, W, H).

        E = ∂Ω/∂turn, 3×size; T with δ(exp Ω^) = (T δΩ)^ exp Ω^, 3×3; W = ∂(Tᵀ moment)/∂Ω, 3×3; H = the second
        derivative of Ω·(Tᵀ moment) with respect to the turn at fixed Tᵀ moment, size×size.
        """
        turn, omega = self._rotation_vector()
        moment, pulled = ca.SX.sym("moment", 3), ca.SX.sym("pulled", 3)
        vector = ca.SX.sym("vector", omega.sparsity())
        frame = ca.substitute(magnus.increment_tangent(vector), vector, omega)
        pull = magnus.increment_tangent(vector).T @ moment
        turning = ca.substitute(ca.jacobian(pull, vector), vector, omega)
        second = ca.triu2symm(ca.triu(ca.hessian(ca.dot(omega, pulled), turn)[0]))
        second = ca.substitute(second, pulled, frame.T @ moment)
        outputs = ca.cse([ca.jacobian(omega, turn), frame, turning, second])
        names = ["E", "T", "W", "H"]
        return ca.Function(
            "variation",
            [turn, moment],
            list(map(ca.sparsify, outputs)),
            ["turn", "moment"],
            names,
            {"never_inline": True},
        )

    def _rotation_vector(self) -> tuple[ca.SX, ca.SX]:
        turn = ca.SX.sym("turn", self.size)
        alphas = []
        for part in ca.vertsplit(turn, len(self.axes)) if self.axes else []:
            alpha = ca.SX(3, 1)
            for axis, entry in zip(self.axes, ca.vertsplit(part), strict=True):
                alpha[axis] = entry
            alphas.append(alpha)
        return turn, magnus.rotation_increment(alphas) if alphas else ca.SX(3, 1)


def interval_kernels(basis: StrainBasis) -> IntervalKernels:
    """The kernels that fit a rod's turning axes and its integration method."""
    return _kernels(basis.rod.turning_axes, basis.taylor_count)


@cache
def _kernels(axes: tuple[int, ...], count: int) -> IntervalKernels:
    """One set of functions for all models: what they share is generated once."""
    return IntervalKernels(axes, count)


def turn_matrix(basis: StrainBasis) -> FloatArray:
    """Matrix from q to the stacked turns of all intervals, shape (size·intervals, n)."""
    rows = []
    for matrices in basis.taylor_matrices:
        for axis in basis.rod.turning_axes:
            row = np.zeros((len(basis.grid.left_ends), basis.size))
            if axis in matrices:
                row[:, basis.columns[axis]] = matrices[axis]
            rows.append(row)
    return np.vstack(rows) if rows else np.zeros((0, basis.size))


def interval_turns(basis: StrainBasis, q: Matrix) -> Matrix:
    """Taylor coefficients of the turn of every interval, size×intervals, rad."""
    rows = []
    for intrinsic, matrices in zip(basis.intrinsic_taylor, basis.taylor_matrices, strict=True):
        for axis in basis.rod.turning_axes:
            row = ca.DM(intrinsic[:, axis]).T
            if axis in matrices:
                row = row + (ca.DM(matrices[axis]) @ q[basis.columns[axis]]).T
            rows.append(row)
    return ca.vertcat(*rows)


def transport(basis: StrainBasis, q: Matrix) -> Matrix:
    """Quaternions base_Q_section of the distinct sections, 4×(intervals + 1), the first the identity."""
    if not basis.rod.turning_axes:
        return ca.repmat(ca.DM([1, 0, 0, 0]), 1, len(basis.grid.left_ends) + 1)
    if basis.discretisation.transport == "permuted":
        return _permuted_transport(basis, q)
    return _product_of_increments(basis, q)


def _product_of_increments(basis: StrainBasis, q: Matrix) -> Matrix:
    kernels = interval_kernels(basis)
    count = len(basis.grid.left_ends)
    increments = kernels.increment.map(count)(interval_turns(basis, q))
    chain = _chain(kernels.increment.sparsity_out(0))
    identity = ca.DM([1, 0, 0, 0])
    start = ca.project(identity, kernels.increment.sparsity_out(0))
    return ca.horzcat(start, chain.mapaccum(count)(start, increments))


def _chain(pattern: ca.Sparsity) -> ca.Function:
    """One step of the product of quaternions that share a sparsity pattern closed under products."""
    rotation, increment = ca.SX.sym("rotation", pattern), ca.SX.sym("increment", pattern)
    product = ca.project(quaternion_product(rotation, increment), pattern)
    return ca.Function("chain", [rotation, increment], [product])


def _permuted_transport(basis: StrainBasis, q: Matrix) -> Matrix:
    """Literal solve of report (3.22) for Q' = ½ ℓ A(K) Q, element after element."""
    grid = basis.grid
    intrinsic = basis.rod.intrinsic_strain(grid.nodes)
    rates = []
    for axis in range(3):
        row = ca.DM(intrinsic[:, axis]).T
        if axis in basis.columns:
            row = row + (ca.DM(basis.at_nodes[axis]) @ q[basis.columns[axis]]).T
        rates.append(row)
    curvature = ca.vertcat(*rates)
    sections = [ca.DM([1, 0, 0, 0])]
    for e in range(grid.elements):
        width = grid.breaks[e + 1] - grid.breaks[e]
        nodes = range(e * (grid.intervals + 1), (e + 1) * (grid.intervals + 1))
        rate = [width * basis.rod.length / 2 * quaternion_rate_matrix(curvature[:, j]) for j in nodes]
        solution = permuted_system(rate, [ca.DM.zeros(4, 1)] * len(rate)).solve(sections[-1][:, -1])
        sections.append(solution[:, 1:])
    return ca.horzcat(*sections)
