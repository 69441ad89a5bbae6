"""Forward sweeps of a motion: velocities and accelerations of the sections.

Both are the exact time derivatives of the discrete rotations and positions of kinematics.py. All vectors belong to the
motion in the world, with coordinates in the axes that the base has at the instant: a rate is never the rate of a
coordinate. An interval that turns by exp(Ω^) adds R b to the angular velocity, b = T Ω̇, and with the section at its
beginning that turns at ω it adds ω × R b + R ḃ to the angular acceleration. See docs/theory.md, section 11.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property

import casadi as ca

from cosserat_casadi.maths.calls import KEPT
from cosserat_casadi.maths.magnus import IncrementRates
from cosserat_casadi.maths.numbers import Scalar
from cosserat_casadi.maths.rotation import cross, hat
from cosserat_casadi.maths.typing import Matrix, check_shape
from cosserat_casadi.rod.kinematics import Shape
from cosserat_casadi.rod.section_kernel import RATES
from cosserat_casadi.rod.strain import DiscreteRod, Ratio
from cosserat_casadi.rod.transport import ARGUMENTS, IntervalKernels, interval_kernels, interval_turns


@dataclass(frozen=True)
class FrameMotion:
    """Velocities and accelerations of a frame relative to the world, in axes of the frame or the world.

    Attributes:
        velocity: velocity of its origin, 3×1, m/s.
        angular_velocity: 3×1, rad/s.
        acceleration: acceleration of its origin, 3×1, m/s².
        angular_acceleration: 3×1, rad/s².
    """

    velocity: Matrix
    angular_velocity: Matrix
    acceleration: Matrix
    angular_acceleration: Matrix

    def __post_init__(self) -> None:
        for rate in RATES:
            check_shape(rate, getattr(self, rate), 3, 1)

    def in_axes(self, axes_R_world: Matrix) -> FrameMotion:
        """This motion with coordinates in other axes; the argument is the rotation into these, 3×3."""
        return FrameMotion(*(axes_R_world @ getattr(self, rate) for rate in RATES))

    def at(self, arm: Matrix) -> FrameMotion:
        """Motion of a point that is fixed to the frame at an arm from its origin, 3×1, m, in the motion's axes."""
        added = cross(self.angular_velocity, arm)
        turned = cross(self.angular_acceleration, arm) + cross(self.angular_velocity, added)
        return replace(self, velocity=self.velocity + added, acceleration=self.acceleration + turned)

    def damped(self, rate: Scalar) -> FrameMotion:
        """The motion with r̈ + α ṙ in place of the accelerations, and ω̇ + α ω, with α in 1/s."""
        return replace(
            self,
            acceleration=self.acceleration + rate * self.velocity,
            angular_acceleration=self.angular_acceleration + rate * self.angular_velocity,
        )


AT_REST = FrameMotion(ca.DM(3, 1), ca.DM(3, 1), ca.DM(3, 1), ca.DM(3, 1))
"""Motion of a frame at rest: sparse zeros, which cost nothing."""


@dataclass(frozen=True)
class StrainRates:
    """Rates of a rod's strain coordinates, and of its length if it is free.

    Attributes:
        velocity: q̇, n×1, 1/s.
        acceleration: q̈, n×1, 1/s².
        ratio_rate: rate of the length relative to the reference length, 1×1, 1/s; None for a fixed length.
        ratio_acceleration: its second derivative, 1×1, 1/s²; None for a fixed length.
    """

    velocity: Matrix
    acceleration: Matrix
    ratio_rate: Ratio = None
    ratio_acceleration: Ratio = None

    def damped(self, rate: Scalar) -> StrainRates:
        """The rates with q̈ + α q̇ in place of q̈, and the ratio of the length in this way too, with α in 1/s."""
        by_ratio = self.ratio_acceleration
        if self.ratio_rate is not None and by_ratio is not None:
            by_ratio = by_ratio + rate * self.ratio_rate
        return replace(self, acceleration=self.acceleration + rate * self.velocity, ratio_acceleration=by_ratio)


NO_CHANGE = ca.DM(1, 1)
"""Ratio of lengths for rates of strains at fixed length: zero removes the intrinsic strain from the rates."""


VELOCITIES = {"acceleration": "velocity", "angular_acceleration": "angular_velocity"}
"""Velocity that damping in proportion to mass adds to each acceleration, times α."""

SPINS = ("angular_velocity", "angular_acceleration")
"""Further arguments of a kernel of an interval in motion: ω and ω̇ of the section at which it begins."""


@dataclass(frozen=True)
class MotionKernels:
    """Functions of one interval in motion.

    Their arguments are the Taylor coefficients of the turn, Ω and the factors of the derivatives, as for an interval at
    rest, the rates of the coefficients, and the rotation of the section at which the interval begins.
    """

    intervals: IntervalKernels

    @cached_property
    def rates(self) -> ca.Function:
        """The map (turn, …, rotation, turn_rate, turn_acceleration) ↦ (R b, R ḃ), b = T Ω̇, in the axes of the base."""
        interval = _MovingInterval(self.intervals)
        rotation = interval.at_rest.rotation
        increment = interval.increment
        outputs = [rotation @ increment.spin, rotation @ increment.spin_rate]
        return interval.function("rates", [], outputs, ["spin", "spin_rate"])

    @cached_property
    def variation(self) -> ca.Function:
        """First and second rate of A, the derivative of the interval's δθ by its turn, base axes, 3×size each.

        (turn, …, rotation, turn_rate, turn_acceleration, ω, α) ↦ (Ȧ, Ä), with ω and α of the section at which the
        interval begins: A = X J with J = ∂Ω/∂turn and X = R T, so that Ẋ = ω^ X + R Ṫ and
        Ẍ = (α^ + ω^ ω^) X + 2 ω^ R Ṫ + R T̈.
        """
        interval = _MovingInterval(self.intervals)
        omega = ca.SX.sym("omega", 3)
        alpha = ca.SX.sym("alpha", 3)
        value, turned, twice_turned = (interval.at_rest.rotation @ order for order in interval.increment.tangent)
        spin = hat(omega)
        first = spin @ value + turned
        second = (hat(alpha) + spin @ spin) @ value + 2 * (spin @ turned) + twice_turned
        by_turn, by_turn_rate, by_turn_acceleration = interval.by_turn
        outputs = [
            first @ by_turn + value @ by_turn_rate,
            second @ by_turn + 2 * (first @ by_turn_rate) + value @ by_turn_acceleration,
        ]
        return interval.function("motion_variation", [omega, alpha], outputs, ["A_rate", "A_acceleration"])


class _MovingInterval:
    """One interval in symbols, with the rates of its turn."""

    def __init__(self, kernels: IntervalKernels) -> None:
        self._kernels = kernels
        self.at_rest = kernels.symbols
        self._turn_rate = ca.SX.sym("turn_rate", kernels.size)
        self._turn_acceleration = ca.SX.sym("turn_acceleration", kernels.size)

    @cached_property
    def by_turn(self) -> tuple[ca.SX, ca.SX, ca.SX]:
        """∂Ω/∂turn and its two rates, 3×size each."""
        value = ca.jacobian(self._kernels.rotation_vector, self.at_rest.turn)
        first = self._rate(value)
        return value, first, self._rate(first)

    @cached_property
    def increment(self) -> IncrementRates:
        """The rotation of the interval in motion."""
        first = self._rate(self._kernels.rotation_vector)
        return IncrementRates(self.at_rest.increment, first, self._rate(first))

    def function(self, name: str, more: list[ca.SX], outputs: list[ca.SX], names: list[str]) -> ca.Function:
        """A CasADi function of the symbols of this interval, its rates and further symbols."""
        symbols = [*self.at_rest.listed[:-1], self._turn_rate, self._turn_acceleration, *more]
        results = [ca.sparsify(output) for output in ca.cse(outputs)]
        arguments = [*ARGUMENTS[:-1], "turn_rate", "turn_acceleration", *SPINS[: len(more)]]
        return ca.Function(name, symbols, results, arguments, names, KEPT)

    def _rate(self, value: ca.SX) -> ca.SX:
        """Time derivative of a function of the turn and its rate, in the shape of the function."""
        state = ca.vertcat(self.at_rest.turn, self._turn_rate)
        direction = ca.vertcat(self._turn_rate, self._turn_acceleration)
        rate = ca.jtimes(ca.vec(value), state, direction)
        return ca.reshape(rate, *value.shape)


def motion_kernels(rod: DiscreteRod) -> MotionKernels:
    """The kernels that fit a rod's turning axes and its integration method."""
    return _motion_kernels(interval_kernels(rod))


@cache
def _motion_kernels(intervals: IntervalKernels) -> MotionKernels:
    """The functions that all models share, so that they are generated once."""
    return MotionKernels(intervals)


@dataclass(frozen=True)
class RodMotion:
    """Velocities and accelerations of a rod's sections, in the axes of its base.

    Attributes:
        shape: the rod's shape.
        rates: rates of its strain coordinates.
        base: motion of its base relative to the world, in base axes.
    """

    shape: Shape
    rates: StrainRates
    base: FrameMotion = AT_REST

    @property
    def rod(self) -> DiscreteRod:
        """The rod."""
        return self.shape.rod

    @property
    def damped(self) -> RodMotion:
        """The motion for inertia: with damping α in proportion to mass, −ρA (r̈ + α ṙ) is one force of inertia.

        Accelerations of sections are linear in q̈ and in the acceleration of the base: α times the rates, added to
        these, turns each r̈ into r̈ + α ṙ, and each d̈ into d̈ + α ḋ.
        """
        rate = self.rod.properties.mass_damping
        if rate is None:
            return self
        return replace(self, rates=self.rates.damped(rate), base=self.base.damped(rate))

    @cached_property
    def turn_rates(self) -> tuple[Matrix, Matrix]:
        """First and second rate of the Taylor coefficients of the turns, size×intervals each, rad/s and rad/s²."""
        first = interval_turns(self.rod, self.rates.velocity, self._ratio_rate)
        second = interval_turns(self.rod, self.rates.acceleration, self._ratio_acceleration)
        return first, second

    @cached_property
    def section_angular_velocity(self) -> Matrix:
        """ω of the distinct sections, 3×(intervals + 1), rad/s."""
        return _swept(self.base.angular_velocity, self._spins[0])

    @cached_property
    def section_angular_acceleration(self) -> Matrix:
        """ω̇ of the distinct sections, 3×(intervals + 1), rad/s²."""
        spin, spin_rate = self._spins
        begins = self.section_angular_velocity[:, :-1]
        return _swept(self.base.angular_acceleration, cross(begins, spin) + spin_rate)

    @cached_property
    def angular_velocity(self) -> Matrix:
        """ω at the nodes, 3×M, rad/s."""
        return self._at_nodes(self.section_angular_velocity)

    @cached_property
    def angular_acceleration(self) -> Matrix:
        """ω̇ at the nodes, 3×M, rad/s²."""
        return self._at_nodes(self.section_angular_acceleration)

    @cached_property
    def stretch_rate(self) -> Matrix:
        """ℓ R Γ̇ at the nodes, 3×M, m/s: the part of the tangent's rate by shear and extension."""
        return self._stretched(self.rates.velocity, self._ratio_rate)

    @cached_property
    def tangent_rate(self) -> Matrix:
        """ṫ = ω × t + ℓ R Γ̇ at the nodes, 3×M, m/s."""
        return cross(self.angular_velocity, self.shape.tangent) + self.stretch_rate

    @cached_property
    def tangent_acceleration(self) -> Matrix:
        """ẗ = ω̇ × t + ω × (ω × t) + 2 ω × ℓ R Γ̇ + ℓ R Γ̈ at the nodes, 3×M, m/s²."""
        omega = self.angular_velocity
        stretch_acceleration = self._stretched(self.rates.acceleration, self._ratio_acceleration)
        along = cross(self.angular_acceleration, self.shape.tangent) + stretch_acceleration
        # ω × (ω × t + ℓ R Γ̇) + ω × ℓ R Γ̇.
        return along + cross(omega, self.tangent_rate + self.stretch_rate)

    @cached_property
    def velocity(self) -> Matrix:
        """Velocities of the nodes in the world, 3×M, m/s."""
        return self._integrated(self.base.velocity, self.tangent_rate)

    @cached_property
    def acceleration(self) -> Matrix:
        """Accelerations of the nodes in the world, 3×M, m/s²."""
        return self._integrated(self.base.acceleration, self.tangent_acceleration)

    def undamped(self, rate: str) -> Matrix:
        """A rate of the nodes without damping by mass, 3×M, for forces other than the rod's own inertia."""
        field: Matrix = getattr(self, rate)
        damping = self.rod.properties.mass_damping
        if damping is None or rate not in VELOCITIES:
            return field
        velocity: Matrix = getattr(self, VELOCITIES[rate])
        return field - damping * velocity

    def at(self, node: int) -> FrameMotion:
        """Motion of the section of a node, without damping in proportion to mass."""
        return FrameMotion(*(self.undamped(rate)[:, node] for rate in RATES))

    def director_rate(self, axis: int) -> Matrix:
        """ḋ = ω × d of one director at the nodes, 3×M, 1/s."""
        return cross(self.angular_velocity, self.shape.directors[axis])

    def director_acceleration(self, axis: int) -> Matrix:
        """d̈ = ω̇ × d + ω × (ω × d) of one director at the nodes, 3×M, 1/s²."""
        director = self.shape.directors[axis]
        centripetal = cross(self.angular_velocity, self.director_rate(axis))
        return cross(self.angular_acceleration, director) + centripetal

    @property
    def _ratio_rate(self) -> Matrix:
        return NO_CHANGE if self.rates.ratio_rate is None else self.rates.ratio_rate

    @property
    def _ratio_acceleration(self) -> Matrix:
        return NO_CHANGE if self.rates.ratio_acceleration is None else self.rates.ratio_acceleration

    @cached_property
    def _spins(self) -> tuple[Matrix, Matrix]:
        """R b and R ḃ of every interval, 3×intervals each."""
        count = len(self.rod.grid.left_ends)
        if not self.rod.properties.turning_axes:
            return ca.DM(3, count), ca.DM(3, count)
        kernel = motion_kernels(self.rod).rates.map(count)
        spin, spin_rate = kernel(*self.shape.interval_arguments, *self.turn_rates)
        return spin, spin_rate

    def _at_nodes(self, sections: Matrix) -> Matrix:
        if sections.shape[1] == 1:
            return ca.repmat(sections, 1, self.rod.grid.size)
        return self.shape.at_nodes(sections)

    def _stretched(self, coordinates: Matrix, ratio: Matrix) -> Matrix:
        """Directors times ℓ and the linear strains of coordinates, 3×M, m."""
        strain = self.rod.strain_rows(coordinates, (3, 4, 5), ratio)
        total: Matrix = ca.DM(3, self.rod.grid.size)
        for director, row in zip(self.shape.directors, strain, strict=True):
            if row is not None and row.nnz():
                total = total + self.shape.scale(director, self.rod.length * row)
        return total

    def _integrated(self, base: Matrix, rate: Matrix) -> Matrix:
        """A field of positions or rates, 3×M, from its value at the base, 3×1, and its derivative along X, 3×M."""
        grid = self.rod.grid
        along = grid.integrated(rate)
        # The velocity of a base that only turns has no entries, and CasADi writes invalid C for a repetition of none.
        return along if base.nnz() == 0 else ca.repmat(base, 1, grid.size) + along


def _swept(base: Matrix, added: Matrix) -> Matrix:
    """Cumulative sums from the base, 3×(intervals + 1), of increments by each interval, 3×intervals."""
    rows: list[Matrix] = []
    for start, row in zip(ca.vertsplit(base), ca.vertsplit(added), strict=True):
        # A component that is always zero stays sparse: a planar rod turns about one axis.
        if row.nnz() == 0 and start.nnz() == 0:
            rows.append(ca.DM(1, row.shape[1] + 1))
            continue
        # Made dense first: CasADi 3.8.2 sums a sparse MX wrongly.
        rows.append(ca.cumsum(ca.densify(ca.horzcat(start, row)), 1))
    return ca.vertcat(*rows)
