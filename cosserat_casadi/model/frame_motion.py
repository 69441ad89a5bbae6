"""Motions of frames: velocities from the rates of a position and a quaternion, and the jets of δθ = T δQ.

Only the direction of a quaternion counts, so that T has the norm in it: ω = T Q̇ is the angular velocity of Q / |Q|
whatever the norm does, and ω̇ = Ṫ Q̇ + T Q̈. Docs/theory.md, section 11.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.maths.numbers import Numbers, Scalar, any_symbolic, as_matrix, as_vector
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.floating_frames import FloatingFrame, turn_matrix
from cosserat_casadi.rod.motion_matrices import Jet, MotionMatrices
from cosserat_casadi.rod.rod_motion import FrameMotion


def _turn_jet() -> ca.Function:
    """(Q, Q̇, Q̈) ↦ (T, Ṫ, T̈), 3×4 each."""
    symbols = [ca.SX.sym(name, 4) for name in ("quaternion", "rate", "acceleration")]
    quaternion, rate, acceleration = symbols
    value = ca.SX(turn_matrix(quaternion))
    first = _along(value, quaternion, rate)
    state = ca.vertcat(quaternion, rate)
    second = _along(first, state, ca.vertcat(rate, acceleration))
    return ca.Function("turn_jet", symbols, ca.cse([value, first, second]))


def _along(matrix: ca.SX, state: ca.SX, direction: ca.SX) -> ca.SX:
    """Derivative of a matrix along a direction of its symbols."""
    return ca.reshape(ca.jtimes(ca.vec(matrix), state, direction), *matrix.shape)


TURN_JET = _turn_jet()


def _norm_rows() -> ca.Function:
    """(Q, Q̇, Q̈) ↦ ½ Q d²(Q·Q)/dt², 4×1, and its derivatives with respect to Q, Q̇ and Q̈."""
    symbols = [ca.SX.sym(name, 4) for name in ("quaternion", "rate", "acceleration")]
    quaternion, rate, acceleration = symbols
    rows = quaternion * (ca.dot(quaternion, acceleration) + ca.sumsqr(rate))
    derivatives = [ca.jacobian(rows, symbol) for symbol in symbols]
    return ca.Function("norm_rows", symbols, ca.cse([rows, *derivatives]))


NORM_ROWS = _norm_rows()


@dataclass(frozen=True)
class QuaternionMotion:
    """A quaternion of any norm with its rates.

    Attributes:
        quaternion: Q, 4×1.
        rate: Q̇, 4×1, 1/s.
        acceleration: Q̈, 4×1, 1/s².
    """

    quaternion: Matrix
    rate: Matrix
    acceleration: Matrix

    @cached_property
    def turn(self) -> Jet:
        """T with its rates, 3×4."""
        value, rate, acceleration = TURN_JET(self.quaternion, self.rate, self.acceleration)
        return Jet(value, rate, acceleration)

    @property
    def angular_velocity(self) -> Matrix:
        """ω = T Q̇, 3×1, rad/s, world axes."""
        return self.turn.value @ self.rate

    @property
    def angular_acceleration(self) -> Matrix:
        """ω̇ = Ṫ Q̇ + T Q̈, 3×1, rad/s², world axes."""
        return self.turn.rate @ self.rate + self.turn.value @ self.acceleration


@dataclass(frozen=True)
class FloatingFrameMotion:
    """Motion of a floating frame from its unknowns and their rates.

    Attributes:
        frame: the frame.
        quaternion: its quaternion with its rates.
        deviation_rate: rates of its unknowns, 7×1, 1/s.
        deviation_acceleration: 7×1, 1/s².
        norm_time: square of the time in which the norm of the quaternion returns to one, s².
    """

    frame: FloatingFrame
    quaternion: QuaternionMotion
    deviation_rate: Matrix
    deviation_acceleration: Matrix
    norm_time: float

    @cached_property
    def motion(self) -> FrameMotion:
        """Velocities and accelerations, world axes."""
        return FrameMotion(
            velocity=self.frame.length * self.deviation_rate[:3],
            angular_velocity=self.quaternion.angular_velocity,
            acceleration=self.frame.length * self.deviation_acceleration[:3],
            angular_acceleration=self.quaternion.angular_acceleration,
        )

    def motion_jet(self, axes_R_world: Matrix | None = None) -> Jet:
        """B, the motion [δθ; δr] of the frame with its unknowns, with its rates, 6×7 each; world axes or others."""
        orders = []
        for order, turn in enumerate(self.quaternion.turn.orders):
            shift: Matrix = self.frame.length * ca.DM.eye(3) if order == 0 else ca.DM(3, 3)
            if axes_R_world is not None:
                turn = axes_R_world @ turn
                shift = axes_R_world @ shift
            rotation_rows = ca.horzcat(ca.DM(3, 3), turn)
            position_rows = ca.horzcat(shift, ca.DM(3, 4))
            orders.append(ca.vertcat(rotation_rows, position_rows))
        value, rate, acceleration = orders
        return Jet(value, rate, acceleration)

    @cached_property
    def norm_rows(self) -> Matrix:
        """Inertia of the norm of the quaternion, τ² Q (Q·Q̈ + Q̇·Q̇), 7×1.

        No mechanics depends on the norm. With the term (Q·Q − 1) Q of the balance these rows make it oscillate about
        one like a mass on a spring, so that it is a coordinate like all others and not a constraint.
        """
        rows: Matrix = self.norm_time * NORM_ROWS(*self._quaternion)[0]
        return ca.vertcat(ca.DM(3, 1), rows)

    @cached_property
    def norm_matrices(self) -> MotionMatrices:
        """Derivatives of :attr:`norm_rows` by the unknowns of the frame and by their two rates, 7×7 each."""
        _, *derivatives = NORM_ROWS(*self._quaternion)
        blocks = [ca.diagcat(ca.DM(3, 3), self.norm_time * block) for block in derivatives]
        return MotionMatrices(*blocks)

    @property
    def _quaternion(self) -> tuple[Matrix, Matrix, Matrix]:
        return self.quaternion.quaternion, self.quaternion.rate, self.quaternion.acceleration


def body_inertia(body: scenes.Body) -> Numbers:
    """Inertia of a body about its centre of mass, body axes, shape (3, 3), kg m²."""
    if not any_symbolic(body.inertia):
        return body.inertia_matrix
    rows = [as_matrix(as_vector(row)).T for row in body.inertia if isinstance(row, tuple)]
    if rows:
        return ca.vertcat(*rows)
    moments = [moment for moment in body.inertia if not isinstance(moment, tuple)]
    return ca.diag(as_matrix(as_vector(moments)))


@dataclass(frozen=True)
class BodyInertia:
    """Inertia of a rigid body in motion, world axes.

    The kinetic energy is ½ m ṙ_c·ṙ_c + ½ ω·I ω, with I about the centre of mass.

    Attributes:
        mass: kg.
        centre_of_mass: centre of mass in body axes, shape (3,), m.
        inertia: about the centre of mass, body axes, shape (3, 3), kg m².
        rotation: world_R_body, 3×3.
        motion: motion of the body's origin.
    """

    mass: Scalar
    centre_of_mass: Numbers
    inertia: Numbers
    rotation: Matrix
    motion: FrameMotion

    @cached_property
    def arm(self) -> Matrix:
        """Centre of mass from the origin, 3×1, m."""
        return self.rotation @ as_matrix(self.centre_of_mass)

    @cached_property
    def world_inertia(self) -> Matrix:
        """I, 3×3, kg m²."""
        return self.rotation @ as_matrix(self.inertia) @ self.rotation.T

    @cached_property
    def velocity(self) -> Matrix:
        """Velocity of the centre of mass, 3×1, m/s."""
        return self.motion.velocity + ca.cross(self.motion.angular_velocity, self.arm)

    @cached_property
    def force(self) -> Matrix:
        """−m r̈ of the centre of mass, 3×1, N."""
        return -self.mass * (self.motion.acceleration + self._turning @ self.arm)

    @cached_property
    def moment(self) -> Matrix:
        """−(I ω̇ + ω × I ω), 3×1, N m."""
        omega = self.motion.angular_velocity
        spin = self.world_inertia @ omega
        return -(self.world_inertia @ self.motion.angular_acceleration + ca.cross(omega, spin))

    @cached_property
    def kinetic_energy(self) -> Matrix:
        """Kinetic energy, 1×1, J."""
        omega = self.motion.angular_velocity
        moving = self.mass * ca.sumsqr(self.velocity)
        turning = ca.bilin(self.world_inertia, omega, omega)
        return (moving + turning) / 2

    @cached_property
    def matrices(self) -> MotionMatrices:
        """Derivatives of minus the virtual work of the inertia by [δθ; δr], without those at fixed wrench, 6×6 each.

        See rod/motion_tangent.py, which has them for the sections of a rod: the second moments about the centre of mass
        are E = ½ tr(J) 1 − J, and with S = R E Rᵀ and R̈ = W R the operators are P₂ = I, P₁ = −2 ω^ S, P₀ = S Wᵀ − W S.
        """
        omega = self.motion.angular_velocity
        turning = self._turning
        spread = ca.trace(as_matrix(self.inertia)) / 2 * ca.DM.eye(3) - self.world_inertia
        p2 = self.world_inertia
        p1 = -2 * (hat(omega) @ spread)
        p0 = spread @ turning.T - turning @ spread
        value = ca.horzcat(-hat(self.arm), ca.DM.eye(3))
        rate = ca.horzcat(-hat(ca.cross(omega, self.arm)), ca.DM(3, 3))
        acceleration = ca.horzcat(-hat(turning @ self.arm), ca.DM(3, 3))
        pulled = self.mass * value.T
        no_shift = ca.DM(3, 3)
        return MotionMatrices(
            stiffness=pulled @ acceleration + ca.diagcat(p0, no_shift),
            damping=2 * (pulled @ rate) + ca.diagcat(p1, no_shift),
            mass=pulled @ value + ca.diagcat(p2, no_shift),
        )

    @cached_property
    def _turning(self) -> Matrix:
        """W = ω̇^ + ω^ ω^, 3×3, 1/s²: R̈ = W R."""
        spin = hat(self.motion.angular_velocity)
        return hat(self.motion.angular_acceleration) + spin @ spin
