"""Rotation along the rod, from base to tip: R' = ℓ R K^, report (1.9), (1.10), (2.17).

The default integrates by products of exponentials: one Magnus increment between neighbouring nodes. Quaternions have
norm 1 to rounding, the cost is in proportion to the number of nodes, and the derivative of the discrete rotations is
exact and cheap: δθ_{i+1} = δθ_i + R_i T(Ω_i) δΩ_i. The literal linear system of chapter 3 is the alternative, kept as a
reference for tests. See docs/theory.md section 4.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache

import casadi as ca

from cosserat_casadi.maths import magnus
from cosserat_casadi.maths.block_operators import unstack
from cosserat_casadi.maths.calls import KEPT
from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.maths.permuted import permuted_system
from cosserat_casadi.maths.rotation import quaternion_product, quaternion_rate_matrix, quaternion_to_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.rod.strain import DiscreteRod, Ratio, per_reference_length

ARGUMENTS = ["turn", "omega", "factors", "rotation", "moment"]
"""Arguments of the kernels of an interval: names of the members of :class:`IntervalSymbols`."""

IDENTITY = ca.DM([1, 0, 0, 0])
"""Quaternion of the base section."""


@dataclass(frozen=True)
class IntervalKernels:
    """Functions of one interval between neighbouring nodes, written once for a rod.

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
    def turn(self) -> ca.SX:
        """The symbol of ``turn``, which all kernels share."""
        return ca.SX.sym("turn", self.size)

    @cached_property
    def rotation_vector(self) -> ca.SX:
        """Rotation vector Ω of :attr:`turn`, 3×1."""
        if not self.axes:
            return ca.SX(3, 1)
        alphas = []
        for part in ca.vertsplit(self.turn, len(self.axes)):
            alpha = ca.SX(3, 1)
            for axis, entry in zip(self.axes, ca.vertsplit(part), strict=True):
                alpha[axis] = entry
            alphas.append(alpha)
        return magnus.rotation_increment(alphas)

    @cached_property
    def increment(self) -> ca.Function:
        """The map turn ↦ (quaternion, omega, factors): increment, its Ω, and the factors of its derivatives, 2×1."""
        omega = self.rotation_vector
        made = magnus.increment(omega)
        factors = ca.vertcat(made.half_sine, made.cubic)
        outputs = ca.cse([made.quaternion, ca.sparsify(omega), factors])
        names = ["quaternion", "omega", "factors"]
        return ca.Function("increment", [self.turn], outputs, ["turn"], names, KEPT)

    @cached_property
    def rotation_pattern(self) -> ca.Sparsity:
        """Sparsity of a rotation matrix of the rod, 3×3: a rod that turns about one axis has a sparse one."""
        # All products of increments have the pattern of one increment.
        pattern = self.increment.sparsity_out(0)
        quaternion = ca.SX.sym("quaternion", pattern)
        matrix = quaternion_to_matrix(quaternion)
        return ca.sparsify(matrix).sparsity()

    @cached_property
    def pull(self) -> ca.Function:
        """The map (turn, omega, factors, rotation, moment) ↦ (R T ∂Ω/∂turn)ᵀ moment: generalised moment of an interval.

        ``omega`` and ``factors`` are results of :attr:`increment`, ``rotation`` is the matrix R of the section at which
        the interval begins, ``moment`` is transmitted by the interval, 3×1, N m, base frame.
        """
        a = self.symbols
        omega = self.rotation_vector
        moment = a.rotation.T @ a.moment
        pulled = a.increment.pulled(moment)
        # Reverse mode: (∂Ω/∂turn)ᵀ pulled.
        force = ca.jtimes(omega, a.turn, pulled, True)
        return ca.Function("pull", a.listed, [ca.cse(force)], ARGUMENTS, ["force"], KEPT)

    @cached_property
    def variation(self) -> ca.Function:
        """First and second derivatives of one interval: (turn, omega, factors, rotation, moment) ↦ (A, V, H).

        A = R T ∂Ω/∂turn, 3×size: δθ of the interval in the base frame. The pull Aᵀ moment changes with the turn, R and
        the moment fixed, by Aᵀ V A + H: V of :meth:`magnus.Increment.stiffness` in the base frame, 3×3, and H, the
        second derivative of Ω·(Tᵀ Rᵀ moment) at fixed Tᵀ Rᵀ moment, size×size.
        """
        a = self.symbols
        omega = self.rotation_vector
        # V belongs to the increment in base axes: Ω turned by R.
        turned = replace(a.increment, omega=a.rotation @ a.increment.omega)
        stiffness = turned.stiffness(a.moment)
        # H holds Tᵀ Rᵀ moment fixed: a symbol while it is differentiated.
        pulled = ca.SX.sym("pulled", 3)
        force = ca.jtimes(omega, a.turn, pulled, True)
        upper = ca.triu(ca.jacobian(force, a.turn))
        moment = a.rotation.T @ a.moment
        second = ca.substitute(ca.triu2symm(upper), pulled, a.increment.pulled(moment))
        outputs = [ca.sparsify(output) for output in ca.cse([self._turning, stiffness, second])]
        return ca.Function("variation", a.listed, outputs, ARGUMENTS, ["A", "V", "H"], KEPT)

    @cached_property
    def turning(self) -> ca.Function:
        """A of :attr:`variation` alone: (turn, omega, factors, rotation) ↦ A."""
        turning = ca.sparsify(ca.cse(self._turning))
        return ca.Function("turning", self.symbols.listed[:-1], [turning], ARGUMENTS[:-1], ["A"], KEPT)

    @cached_property
    def turned(self) -> ca.Function:
        """The map (A, turn) ↦ A turn: δθ of an interval for one variation of its turn, 3×1; A of :attr:`turning`."""
        turning = ca.SX.sym("A", self.turning.sparsity_out(0))
        names = ["A", "turn"], ["turned"]
        return ca.Function("turned", [turning, self.turn], [turning @ self.turn], *names, self._kept_in_columns)

    @cached_property
    def pulled(self) -> ca.Function:
        """The map (A, V, H, turn, turned, moment) ↦ Aᵀ (moment + V turned) + H turn: variation of :attr:`pull`, size×1.

        It varies with the turn, with the δθ that follows from it, and with the moment; A, V, H as in :attr:`variation`.
        """
        names = ["A", "V", "H"]
        a, v, h = (ca.SX.sym(name, self.variation.sparsity_out(i)) for i, name in enumerate(names))
        turned, moment = ca.SX.sym("turned", 3), ca.SX.sym("moment", 3)
        force = a.T @ (moment + v @ turned) + h @ self.turn
        arguments = [a, v, h, self.turn, turned, moment]
        words = [*names, "turn", "turned", "moment"], ["force"]
        return ca.Function("pulled", arguments, [force], *words, self._kept_in_columns)

    @property
    def _kept_in_columns(self) -> dict[str, bool]:
        """Options of functions that columns call: about one axis they are shorter than a call."""
        return KEPT if len(self.axes) > 1 else {}

    @property
    def _turning(self) -> ca.SX:
        """R T ∂Ω/∂turn."""
        a = self.symbols
        rates = ca.jacobian(self.rotation_vector, a.turn)
        return (a.rotation @ a.increment.tangent) @ rates

    @cached_property
    def symbols(self) -> IntervalSymbols:
        """Symbols of the arguments of :attr:`pull` and :attr:`variation`."""
        omega_pattern = self.increment.sparsity_out(1)
        return IntervalSymbols(
            turn=self.turn,
            omega=ca.SX.sym("omega", omega_pattern),
            factors=ca.SX.sym("factors", 2),
            rotation=ca.SX.sym("rotation", self.rotation_pattern),
            moment=ca.SX.sym("moment", 3),
        )


@dataclass(frozen=True)
class IntervalSymbols:
    """Arguments of the kernels of one interval.

    Attributes:
        turn: Taylor coefficients of the turn.
        omega: rotation vector of the interval.
        factors: factors of the derivatives of its rotation.
        rotation: rotation of the section at which it begins, 3×3.
        moment: moment that the interval transmits, 3×1.
    """

    turn: ca.SX
    omega: ca.SX
    factors: ca.SX
    rotation: ca.SX
    moment: ca.SX

    @property
    def listed(self) -> list[ca.SX]:
        """All symbols in the order of ARGUMENTS."""
        return [getattr(self, name) for name in ARGUMENTS]

    @property
    def increment(self) -> magnus.Increment:
        """The rotation of the interval."""
        half_sine, cubic = ca.vertsplit(self.factors)
        return magnus.Increment(self.omega, half_sine, cubic)


def interval_kernels(rod: DiscreteRod) -> IntervalKernels:
    """The kernels that fit a rod's turning axes and its integration method."""
    return _kernels(rod.properties.turning_axes, rod.taylor_count)


@cache
def _kernels(axes: tuple[int, ...], count: int) -> IntervalKernels:
    """The functions that all models share, so that they are generated once."""
    return IntervalKernels(axes, count)


def interval_turns(rod: DiscreteRod, q: Matrix, ratio: Ratio = None) -> Matrix:
    """Taylor coefficients of the turn of every interval, size×intervals, rad."""
    intrinsic = as_matrix(rod.intrinsic_turn)
    varying = unstack(rod.turn_axes.times(q), intrinsic.shape[0])
    return per_reference_length(intrinsic, ratio) + varying


def largest_turn(rod: DiscreteRod, q: Matrix, ratio: Ratio = None) -> Matrix:
    """Largest turn of an interval, 1×1, rad: an upper bound on ∫|K| ds from the Taylor coefficients."""
    turns = interval_turns(rod, q, ratio)
    coefficients = ca.vertsplit(turns, len(rod.properties.turning_axes))
    total = ca.DM.zeros(1, turns.shape[1])
    for order, rows in enumerate(coefficients):
        size = ca.sqrt(ca.sum1(rows**2))
        # |τ|^order over −1/2 … 1/2.
        total = total + size / (2**order * (order + 1))
    return ca.mmax(total)


@dataclass(frozen=True)
class IntervalRotations:
    """Rotations of all intervals.

    Attributes:
        turn: Taylor coefficients, size×intervals, rad.
        quaternion: increments, 4×intervals.
        omega: rotation vectors, 3×intervals, rad.
        factors: factors of their derivatives, 2×intervals.
    """

    turn: Matrix
    quaternion: Matrix
    omega: Matrix
    factors: Matrix


def interval_rotations(rod: DiscreteRod, q: Matrix, ratio: Ratio = None) -> IntervalRotations:
    """Rotations of all intervals for given strain coordinates."""
    turns = interval_turns(rod, q, ratio)
    increment = interval_kernels(rod).increment.map(turns.shape[1])
    quaternion, omega, factors = increment(turns)
    return IntervalRotations(turns, quaternion, omega, factors)


def section_quaternions(
    rod: DiscreteRod, q: Matrix, intervals: IntervalRotations | None, ratio: Ratio = None
) -> Matrix:
    """Quaternions base_Q_section of the distinct sections, 4×(intervals + 1), the first the identity.

    Args:
        rod: matrices of the rod.
        q: strain coordinates.
        intervals: rotations of the intervals; None for a rod that does not turn, or to solve the literal system.
        ratio: length of the rod relative to the reference length.
    """
    if not rod.properties.turning_axes:
        return ca.repmat(IDENTITY, 1, len(rod.grid.left_ends) + 1)
    if intervals is None:
        return _permuted_transport(rod, q, ratio)
    # Quaternions of a rod that turns about one axis have two entries, and so have their products.
    pattern = interval_kernels(rod).increment.sparsity_out(0)
    start = ca.project(IDENTITY, pattern)
    count = intervals.quaternion.shape[1]
    chain = _chain(tuple(pattern.compress()), count)
    later = chain(start, intervals.quaternion)
    quaternions: Matrix = ca.horzcat(start, later)
    return quaternions


@lru_cache(maxsize=64)
def _chain(entries: tuple[int, ...], count: int) -> ca.Function:
    """Cumulative products of quaternions with a common pattern of ``entries`` that is closed under products."""
    pattern = ca.Sparsity.compressed(entries)
    rotation = ca.SX.sym("rotation", pattern)
    increment = ca.SX.sym("increment", pattern)
    product = ca.project(quaternion_product(rotation, increment), pattern)
    step = ca.Function("chain", [rotation, increment], [product])
    return step.mapaccum(count)


def _permuted_transport(rod: DiscreteRod, q: Matrix, ratio: Ratio) -> Matrix:
    """Literal solve of report (3.22) for Q' = ½ ℓ A(K) Q, element after element."""
    grid = rod.grid
    curvature = _curvature(rod, q, ratio)
    sections: list[Matrix] = [IDENTITY]
    for e in range(grid.elements):
        first = e * (grid.intervals + 1)
        width = grid.breaks[e + 1] - grid.breaks[e]
        rates = []
        for node in range(first, first + grid.intervals + 1):
            matrix = quaternion_rate_matrix(curvature[:, node])
            rates.append(width * rod.length / 2 * matrix)
        none = [ca.DM.zeros(4, 1)] * len(rates)
        # An element begins at the end of the element before it.
        begins = sections[-1][:, -1]
        solution = permuted_system(rates, none).solve(begins)
        sections.append(solution[:, 1:])
    return ca.horzcat(*sections)


def _curvature(rod: DiscreteRod, q: Matrix, ratio: Ratio) -> Matrix:
    """K at the nodes, per reference length, 3×M, 1/m."""
    rows = rod.strain_rows(q, range(3), ratio)
    return ca.vertcat(*[ca.DM.zeros(1, rod.grid.size) if row is None else row for row in rows])
