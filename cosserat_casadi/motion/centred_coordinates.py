"""Coordinates in which a rod that flies free is integrated: the pose of its centred frame, not of its base.

About its base a free rod is strongly nonlinear: a small strain next to the base swings all the rest, and a shape that
moves next to no mass is a sum of large motions that cancel. About a frame in its middle strains move the rod by little,
and hardly move its mean. So steps are longer, a Jacobian serves more steps, and Newton's method needs fewer iterations.
What the integrator sees is x = φ(y) put into the equations of motion; all other code sees x.

The origin of the centred frame is the centre of mass, its axes are about the mean of all sections' axes. Of the
sections' quaternions Q_k in the axes of the base, Q̄ is the mean by the weights 6 X (1 − X). To first order in small
strains of a uniform rod it turns with the mean motion: of deflections u that bend the rod, ∫ (X − ½) u dX is ½ ∫ X (1 −
X) θ dX with the turns θ = u' of the sections. A rod that is coiled may have a mean of norm zero. With the part of Q̄
along the quaternion Q_m of the middle replaced by one,

    U = Q̄ + (1 − Q_m·Q̄) Q_m,

the norm is never below one: U = Q_m (1, m) with the mean m of the vector parts of Q_m* Q_k. See docs/theory.md, section
11.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.rotation import quaternion_conjugate, quaternion_product, rotate
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.floating_frames import FloatingFrame
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.contact_forces import BaseOfSteps, PushedResidual
from cosserat_casadi.motion.kernel_residual import KernelResidual
from cosserat_casadi.motion.momentum import flies_alone
from cosserat_casadi.motion.one_sided import OneSided
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries, RepeatedCall, repeated
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations, Residual
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
"""Numbers of the centred frame in the axes of the base: centre of mass, 3, mean quaternion, 4, middle quaternion, 4."""

ORDERS = 3
"""Number of time derivatives that are transformed, counted from the zeroth: positions, rates and accelerations."""


def can_be_centred(model: Model) -> bool:
    """Whether a scene consists of one free rod of fixed length, without cables that may go slack or exact friction.

    Tensions of cables are unknowns of the model, and a length that is an input would enter the frame with its rates.
    Steps with friction of exact contact are taken in the unknowns of the model.
    """
    if not flies_alone(model) or OneSided(model).pairs or model.scene.rubs_exactly:
        return False
    (name,) = model.discrete.rods
    return model.discrete.layout.of_rod(name, "length") is None


class CentredCoordinates:
    """The map x = φ(y): y is x, except that the pose of the centred frame replaces the pose of the base.

    While something touches, contact forces are appended to the unknowns of the model; φ leaves them as they are.

    Args:
        model: model of one rod that flies free, see :func:`can_be_centred`.
        libraries: shared objects that contain :attr:`in_iterations` and :attr:`derivatives`.
    """

    def __init__(self, model: Model, libraries: Libraries = INTERPRETED) -> None:
        self._libraries = libraries
        ((_, entries),) = model.discrete.unknowns.of_kind(BlockKind.POSE)
        self._model = model
        self._pose = np.arange(entries.start, entries.stop)
        self._size = model.size
        self._strains = np.delete(np.arange(model.size), self._pose)
        functions = _Functions(model)
        self._functions = functions
        self._base = repeated(functions.base, libraries.residual)
        self._position = functions.position.expand()
        self._centred = RepeatedCall(functions.centred)

    @property
    def in_iterations(self) -> list[ca.Function]:
        """The functions that every step calls."""
        return [self._functions.base, self._composed]

    @property
    def derivatives(self) -> ca.Function:
        """(y, v, a) ↦ derivative of the base's unknowns with respect to y, 7×size, and its first and second rate."""
        return self._functions.derivatives

    def to_model(self, instant: Instant) -> Instant:
        """State in the unknowns of the model, from a state in these coordinates."""
        own = instant.first(self._size)
        base = self._base(own.x, own.v, own.a).reshape(ORDERS, POSE_SIZE)
        parts = [instant.x.copy(), instant.v.copy(), instant.a.copy()]
        for part, of_base in zip(parts, base, strict=True):
            part[self._pose] = of_base
        x, v, a = parts
        return Instant(instant.time, x, v, a)

    def positions_of_model(self, positions: FloatArray) -> FloatArray:
        """Unknowns of the model at T times, from positions in these coordinates, shape (T, size) each."""
        x = positions.copy()
        x[:, self._pose] = evaluated(self._position, positions)[0][:, :, 0]
        return x

    def from_model(self, instant: Instant) -> Instant:
        """State in these coordinates, from a state in the unknowns of the model."""
        x, v, a = instant.x.copy(), instant.v.copy(), instant.a.copy()
        x[self._pose] = self._centred(x[: self._size])
        still = np.zeros_like(v)
        derivative, _, _ = self._jet(Instant(instant.time, x, still, still))
        by_base = derivative[:, self._pose]
        by_strains = derivative[:, self._strains]
        v[self._pose] = np.linalg.solve(by_base, instant.v[self._pose] - by_strains @ v[self._strains])
        _, rate, _ = self._jet(Instant(instant.time, x, v, still))
        turning = rate @ v[: self._size]
        a[self._pose] = np.linalg.solve(by_base, instant.a[self._pose] - by_strains @ a[self._strains] - turning)
        return Instant(instant.time, x, v, a)

    def equations(self, plain: MotionEquations) -> MotionEquations:
        """The equations of motion in these coordinates; no row changes its value.

        With Φ = ∂φ/∂y their derivatives are K Φ + C Φ̇ + M Φ̈, C Φ + 2 M Φ̇ and M Φ.

        Args:
            plain: in the unknowns of the model.
        """

        def jacobians(
            t: float, y: FloatArray, v: FloatArray, a: FloatArray
        ) -> tuple[FloatArray, FloatArray, FloatArray]:
            instant = Instant(t, y, v, a)
            at = self.to_model(instant)
            stiffness, damping, mass = plain.jacobians(t, at.x, at.v, at.a)
            value, rate, acceleration = self._jet(instant)
            by_stiffness, by_damping, by_mass = (matrix[:, self._pose] for matrix in (stiffness, damping, mass))
            for matrix in (stiffness, damping, mass):
                matrix[:, self._pose] = 0.0
            own = slice(0, self._size)
            # Φ is the identity but for the rows of the base, and Φ̇ and Φ̈ have rows of the base alone.
            stiffness[:, own] += by_stiffness @ value + by_damping @ rate + by_mass @ acceleration
            damping[:, own] += by_damping @ value + 2.0 * by_mass @ rate
            mass[:, own] += by_mass @ value
            return stiffness, damping, mass

        return replace(plain, residual=self._residual(plain.residual), jacobians=jacobians, rates_of_last=None)

    def _residual(self, plain: Residual) -> Residual:
        """A residual in these coordinates: one function of the coordinates, where its parts are known."""
        if isinstance(plain, KernelResidual):
            return replace(plain, call=self._dynamics)
        if not (isinstance(plain, PushedResidual) and isinstance(plain.rows, KernelResidual)):
            raise TypeError("equations in centred coordinates are those of a model, with the forces of contacts or not")
        rows = replace(plain.rows, call=self._dynamics)
        return replace(plain, rows=rows, base=BaseOfSteps(self._place, int(self._pose[0])))

    @cached_property
    def _place(self) -> RepeatedCall:
        """Unknowns of the base alone, from y."""
        return RepeatedCall(self._position)

    @cached_property
    def _dynamics(self) -> RepeatedCall:
        """(y, v, a, inputs, inputs_rate, inputs_acceleration) ↦ residual of the model."""
        return repeated(self._composed, self._libraries.residual)

    @property
    def _composed(self) -> ca.Function:
        dynamics = self._model.inverse_dynamics
        *_, value, rate, acceleration = dynamics.mx_in()
        y = [ca.MX.sym(word, self._size) for word in ("y", "v", "a")]
        x, v, a = (
            self._with_base(own, base)
            for own, base in zip(y, ca.vertsplit(self._functions.base(*y), POSE_SIZE), strict=True)
        )
        rows = dynamics(x, v, a, value, rate, acceleration)
        return ca.Function("centred_dynamics", [*y, value, rate, acceleration], [ca.densify(rows)])

    def _with_base(self, own: ca.MX, base: ca.MX) -> ca.MX:
        """Unknowns of the model, or their rates, from the unknowns of the steps and those of the base, size×1."""
        order = np.arange(self._size)
        order[self._pose] = self._size + np.arange(POSE_SIZE)
        return ca.vertcat(own, base)[order.tolist()]

    def _jet(self, instant: Instant) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The rows of Φ, Φ̇ and Φ̈ that belong to the base, shape (7, size) each."""
        own = instant.first(self._size)
        value, rate, acceleration = self._derivatives.matrices(own.x, own.v, own.a)
        return value, rate, acceleration

    @cached_property
    def _derivatives(self) -> RepeatedCall:
        return repeated(self.derivatives, self._libraries.jacobians, ORDERS, as_scalars=False)


class _Functions:
    """CasADi functions of the centred coordinates of a model.

    Args:
        model: model of one rod that flies free.
    """

    def __init__(self, model: Model) -> None:
        unknowns = model.discrete.unknowns
        ((name, rod),) = model.discrete.rods.items()
        ((_, pose),) = unknowns.of_kind(BlockKind.POSE)
        (frame,) = model.discrete.frames.values()
        strains = unknowns.strain(name)
        kernels = BaseKernels(frame)
        self._symbols = [ca.MX.sym(word, model.size) for word in ("y", "v", "a")]
        q, q_rate, q_acceleration = (symbol[strains] for symbol in self._symbols)
        self._seen = SeenFromBase(rod, frame_weights(rod), q, StrainRates(q_rate, q_acceleration))
        poses = [symbol[pose] for symbol in self._symbols]
        self._states = [ca.vertcat(own, seen) for own, seen in zip(poses, self._seen.values, strict=True)]
        self._kernels = kernels
        self._places = _places(pose, strains, model.size)

    @cached_property
    def base(self) -> ca.Function:
        """(y, v, a) ↦ unknowns of the base, their rates and their accelerations, stacked, 21×1."""
        orders = self._kernels.base(*self._states)
        return ca.Function("centred_base", self._symbols, [ca.densify(ca.vertcat(*orders))])

    @cached_property
    def position(self) -> ca.Function:
        """Unknowns of the base alone, 7×1, from y."""
        y, *rates = self._symbols
        at_rest = ca.substitute([self.base(*self._symbols)[:POSE_SIZE]], rates, [ca.MX(*y.shape)] * len(rates))
        return ca.Function("position", [y], at_rest)

    @cached_property
    def derivatives(self) -> ca.Function:
        """(y, v, a) ↦ derivatives of the base's unknowns with y, 7×size, and their rates."""
        by_state, by_state_rate, by_state_acceleration = self._kernels.derivatives(*self._states)
        seen = self._seen.variations
        own = ca.DM.eye(POSE_SIZE)
        none = ca.DM(*own.shape)
        value = ca.diagcat(own, seen.value) @ self._places
        rate = ca.diagcat(none, seen.rate) @ self._places
        acceleration = ca.diagcat(none, seen.acceleration) @ self._places
        orders = [
            by_state @ value,
            by_state_rate @ value + by_state @ rate,
            by_state_acceleration @ value + 2 * (by_state_rate @ rate) + by_state @ acceleration,
        ]
        return ca.Function("centred_derivatives", self._symbols, [ca.densify(order) for order in orders])

    @cached_property
    def centred(self) -> ca.Function:
        """Unknowns of the model ↦ unknowns of the centred frame, 7×1."""
        x = self._symbols[0]
        centred = self._kernels.centred(self._states[0][:POSE_SIZE], self._seen.values[0])
        return ca.Function("centred", [x], [ca.densify(centred)])


def _places(pose: slice, strains: slice, size: int) -> ca.DM:
    """Selection matrix of the pose, then of the strain coordinates, among all unknowns, sparse, (7 + n)×size."""
    columns = [*range(pose.start, pose.stop), *range(strains.start, strains.stop)]
    pattern = ca.Sparsity.triplet(len(columns), size, list(range(len(columns))), columns)
    return ca.DM(pattern, 1.0)


@dataclass(frozen=True)
class FrameWeights:
    """Weights with which the nodes of a rod enter its centred frame.

    Attributes:
        centre: weights of the tangents at the nodes in the centre of mass, shape (M,), m.
        mean: weights of the quaternions at the nodes in their mean, shape (M,); their sum is one.
        middle: index of the node next to the middle.
    """

    centre: FloatArray
    mean: FloatArray
    middle: int


def frame_weights(rod: DiscreteRod) -> FrameWeights:
    """Weights of the nodes of a rod in its centred frame."""
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
        """Motion of the rod relative to its base."""
        return RodMotion(shape(self.rod, self.q, self.rod.properties.ratio), self.rates)

    @cached_property
    def values(self) -> tuple[Matrix, Matrix, Matrix]:
        """Centre of mass, Q̄ and Q_m, stacked, and their first and second rates, 11×1 each."""
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
        """Derivative of :attr:`values` with respect to the strain coordinates, with its rates, 11×n each."""
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
        """Variations of the fields of the rod without loads and mass."""
        massless = SectionMasses(np.zeros(self.rod.grid.size), {})
        unloaded = InverseGeometricModel(Statics(self.motion.shape, []))
        return MotionTangent(Tangent(unloaded, True), RodInertia(self.motion, massless), floating=False)


def _spun(spins: Matrix, quaternions: Matrix) -> Matrix:
    """Rate ½ ω Q of the quaternion in each column, 4×k."""
    real = ca.DM.zeros(1, spins.shape[1])
    return quaternion_product(ca.vertcat(real, spins / 2), quaternions)


def _by_turns(quaternions: Matrix, weights: FloatArray) -> Matrix:
    """Derivative of a weighted sum of quaternions with respect to the rotations δθ of its nodes: δQ = ½ δθ Q, 4×3M."""
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
    """Product of a matrix, given with its rates, and the jet of the turns: value, rate and acceleration."""
    value, rate, acceleration = operators
    return (
        value @ turns.value,
        value @ turns.rate + rate @ turns.value,
        value @ turns.acceleration + 2 * (rate @ turns.rate) + acceleration @ turns.value,
    )


@dataclass(frozen=True)
class BaseKernels:
    """Functions between the unknowns of the base and those of the centred frame.

    The unknowns of both frames are (p − p₀)/ℓ and Q − Q₀ with one start pose (p₀, Q₀).

    Attributes:
        frame: floating frame of the base: its start pose and its length ℓ.
    """

    frame: FloatingFrame

    @cached_property
    def base(self) -> ca.Function:
        """(centred frame and its pose in the base, 18×1, two rates) ↦ unknowns of the base and two rates, 7×1 each."""
        state, rate, acceleration = self._symbols
        value, first, second = self._orders(self._base_of(state))
        return ca.Function("base", [state, rate, acceleration], ca.cse([value, first, second]))

    @cached_property
    def derivatives(self) -> ca.Function:
        """Arguments of :attr:`base` ↦ derivative of the base's unknowns by the 18 numbers, 7×18, and its two rates."""
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
        """An expression of the state, with its first and second time derivative."""
        state, rate, acceleration = self._symbols
        first = ca.jtimes(value, state, rate)
        second = ca.jtimes(first, ca.vertcat(state, rate), ca.vertcat(rate, acceleration))
        return value, first, second
