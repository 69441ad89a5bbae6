"""The centred frame of a rod: its origin is the centre of mass, its axes are about the mean of all sections' axes.

Of the sections' quaternions Q_k in the axes of the base, Q̄ is the mean by the weights 6 X (1 − X). To first order in
small strains of a uniform rod it turns with the mean motion: of deflections u that bend the rod, ∫ (X − ½) u dX is
½ ∫ X (1 − X) θ dX with the turns θ = u' of the sections. A rod that is coiled may have a mean of norm zero. With the
part of Q̄ along the quaternion Q_m of the middle replaced by one,

    U = Q̄ + (1 − Q_m·Q̄) Q_m,

the norm is never below one: U = Q_m (1, m) with the mean m of the vector parts of Q_m* Q_k. See docs/theory.md,
section 11.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product, rotate
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.floating_frames import FloatingFrame
from cosserat_casadi.rod.igm import InverseGeometricModel
from cosserat_casadi.rod.inertia import RodInertia, SectionMasses, section_masses
from cosserat_casadi.rod.kinematics import shape
from cosserat_casadi.rod.motion_matrices import Jet
from cosserat_casadi.rod.motion_tangent import MotionTangent
from cosserat_casadi.rod.rod_motion import RodMotion, StrainRates
from cosserat_casadi.rod.statics import Statics
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.rod.tangent import Tangent

SEEN_SIZE = 11
"""Entries of what the base sees: centre of mass, 3, mean of the quaternions, 4, and quaternion of the middle, 4."""


@dataclass(frozen=True)
class FrameWeights:
    """Weights of the nodes in a centred frame.

    Attributes:
        centre: of the tangents at the nodes in the centre of mass, shape (M,).
        mean: of the quaternions at the nodes in their mean, shape (M,); their sum is one.
        middle: the node next to the middle.
    """

    centre: FloatArray
    mean: FloatArray
    middle: int


def frame_weights(rod: DiscreteRod) -> FrameWeights:
    """The weights of a rod's nodes."""
    X = known(rod.grid.nodes)
    lengths = known(rod.node_lengths)
    masses = section_masses(rod)
    mass = lengths
    if masses is not None and np.any(known(masses.mass)):
        mass = lengths * known(masses.mass)
    # Tangents are integrated to positions.
    centre = rod.grid.integration_matrix.T @ (mass / mass.sum())
    mean = lengths * X * (1.0 - X)
    middle = int(np.argmin(np.abs(X - 0.5)))
    return FrameWeights(centre, mean / mean.sum(), middle)


@dataclass(frozen=True)
class SeenFromBase:
    """Pose of a rod's centred frame in the axes of its base: the centre of mass (m), Q̄ and Q_m, with their rates.

    Attributes:
        rod: the rod.
        weights: weights of its nodes.
        q: strain coordinates, n×1.
        rates: rates of the strain coordinates.
    """

    rod: DiscreteRod
    weights: FrameWeights
    q: Matrix
    rates: StrainRates

    @cached_property
    def motion(self) -> RodMotion:
        """The rod as its base sees it."""
        return RodMotion(shape(self.rod, self.q, self.rod.properties.ratio), self.rates)

    @cached_property
    def values(self) -> tuple[Matrix, Matrix, Matrix]:
        """Centre of mass, Q̄ and Q_m beneath each other, and their first and second rates, 11×1 each."""
        motion = self.motion
        centre = ca.DM(self.weights.centre)
        mean = ca.DM(self.weights.mean)
        tangents = (motion.shape.tangent, motion.tangent_rate, motion.tangent_acceleration)
        parts = zip(tangents, self._quaternions, strict=True)
        middle = self.weights.middle
        one, two, three = (ca.vertcat(t @ centre, Q @ mean, Q[:, middle]) for t, Q in parts)
        return one, two, three

    @cached_property
    def variations(self) -> Jet:
        """Derivatives of :attr:`values` with the strain coordinates, with rates, 11×n each."""
        turns = self._tangent.section_rotation
        tangents = self._tangent.section_tangent
        centre = ca.kron(ca.DM.eye(3), ca.DM(self.weights.centre).T)
        of_mean = [_by_turns(Q, self.weights.mean) for Q in self._quaternions]
        at_middle = np.zeros(self.rod.grid.size)
        at_middle[self.weights.middle] = 1.0
        of_middle = [_by_turns(Q, at_middle) for Q in self._quaternions]
        value, rate, acceleration = (
            ca.vertcat(centre @ by_tangents, mean, middle)
            for by_tangents, mean, middle in zip(
                tangents.orders, _products(of_mean, turns), _products(of_middle, turns), strict=True
            )
        )
        return Jet(value, rate, acceleration)

    @cached_property
    def _quaternions(self) -> tuple[Matrix, Matrix, Matrix]:
        """Quaternions at the nodes with their rates, 4×M: Q̇ = ½ ω Q."""
        motion = self.motion
        value = motion.shape.quaternion
        rate = _spun(motion.angular_velocity, value)
        acceleration = _spun(motion.angular_acceleration, value) + _spun(motion.angular_velocity, rate)
        return value, rate, acceleration

    @cached_property
    def _tangent(self) -> MotionTangent:
        """Variations of the rod's fields, without loads and without mass."""
        massless = SectionMasses(np.zeros(self.rod.grid.size), {})
        unloaded = InverseGeometricModel(Statics(self.motion.shape, []))
        return MotionTangent(Tangent(unloaded, True), RodInertia(self.motion, massless), floating=False)


def _spun(spins: Matrix, quaternions: Matrix) -> Matrix:
    """½ ω Q of each column, 4×k."""
    real = ca.DM.zeros(1, spins.shape[1])
    return quaternion_product(ca.vertcat(real, spins / 2), quaternions)


def _by_turns(quaternions: Matrix, weights: FloatArray) -> Matrix:
    """Derivative of weighted quaternions with the stacked turns δθ of the nodes, 4×3M: δQ = ½ δθ Q."""
    nodes = len(weights)
    halves = ca.DM(weights / 2.0).T
    blocks = []
    for axis in range(3):
        turn = ca.DM.zeros(4, nodes)
        turn[axis + 1, :] = 1.0
        product = quaternion_product(turn, quaternions)
        blocks.append(product * ca.repmat(halves, 4, 1))
    return ca.horzcat(*blocks)


def _products(operators: list[Matrix], turns: Jet) -> tuple[Matrix, Matrix, Matrix]:
    """The jet of a product: of operators that have rates with the variations of the turns."""
    value, rate, acceleration = operators
    return (
        value @ turns.value,
        value @ turns.rate + rate @ turns.value,
        value @ turns.acceleration + 2 * (rate @ turns.rate) + acceleration @ turns.value,
    )


@dataclass(frozen=True)
class BaseKernels:
    """Functions from a centred frame, and what the base sees, to the unknowns of the base.

    The unknowns of both frames are (p − p₀)/ℓ and Q − Q₀ of the same start.

    Attributes:
        frame: the start and the length of the base.
    """

    frame: FloatingFrame

    @cached_property
    def base(self) -> ca.Function:
        """(centred frame and its pose in the base, 18×1, their two rates) ↦ unknowns of the base and rates, 7×1."""
        state, rate, acceleration = self._symbols
        value, first, second = self._orders(self._base_of(state))
        return ca.Function("base", [state, rate, acceleration], ca.cse([value, first, second]))

    @cached_property
    def derivatives(self) -> ca.Function:
        """Arguments of :attr:`base` ↦ the derivative of the base's unknowns with the state, 7×18, with its rates."""
        state, rate, acceleration = self._symbols
        jacobian = ca.densify(ca.jacobian(self._base_of(state), state))
        orders = [ca.reshape(order, 7, state.numel()) for order in self._orders(ca.vec(jacobian))]
        return ca.Function("base_derivatives", [state, rate, acceleration], ca.cse(orders))

    @cached_property
    def centred(self) -> ca.Function:
        """(unknowns of the base, centred frame in the base) ↦ unknowns of that frame, 7×1: inverse of :attr:`base`."""
        base = ca.SX.sym("base", 7)
        seen = ca.SX.sym("seen", SEEN_SIZE)
        quaternion = ca.DM(self.frame.start.quaternion) + base[3:]
        mean = self._turn(seen)
        shift = rotate(quaternion / ca.norm_2(quaternion), seen[:3]) / self.frame.length
        turned = quaternion_product(quaternion, mean) - ca.DM(self.frame.start.quaternion)
        return ca.Function("centred", [base, seen], [ca.vertcat(base[:3] + shift, turned)])

    @cached_property
    def _symbols(self) -> tuple[ca.SX, ca.SX, ca.SX]:
        size = 7 + SEEN_SIZE
        return ca.SX.sym("state", size), ca.SX.sym("rate", size), ca.SX.sym("acceleration", size)

    def _base_of(self, state: ca.SX) -> ca.SX:
        centred = state[:7]
        seen = state[7:]
        start = ca.DM(self.frame.start.quaternion)
        quaternion = quaternion_product(start + centred[3:], quaternion_conjugate(self._turn(seen)))
        shift = rotate(quaternion / ca.norm_2(quaternion), seen[:3]) / self.frame.length
        return ca.vertcat(centred[:3] - shift, quaternion - start)

    @staticmethod
    def _turn(seen: ca.SX) -> ca.SX:
        """Quaternion of the centred frame in the axes of the base, of norm one, 4×1."""
        mean = seen[3:7]
        middle = seen[7:]
        turn = mean + (1 - ca.dot(middle, mean)) * middle
        return turn / ca.norm_2(turn)

    def _orders(self, value: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """A function of the state, and its first and second rate."""
        state, rate, acceleration = self._symbols
        first = ca.jtimes(value, state, rate)
        second = ca.jtimes(first, ca.vertcat(state, rate), ca.vertcat(rate, acceleration))
        return value, first, second
