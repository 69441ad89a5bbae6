"""Coordinates in which a rod that flies free is integrated: the pose of its centred frame, not of its base.

About its base a free rod is strongly nonlinear: a small strain next to the base swings all the rest, and a shape that
moves next to no mass is a sum of large motions that cancel. About a frame in its middle strains move the rod by
little, and hardly move its mean. So steps are longer, a Jacobian serves more steps, and Newton's method needs fewer
iterations. What the integrator sees is x = φ(y) put into the equations of motion; all other code sees x.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.unknowns import BlockKind
from cosserat_casadi.motion.centred_frame import BaseKernels, SeenFromBase, frame_weights
from cosserat_casadi.motion.contact_forces import BaseOfSteps, PushedResidual
from cosserat_casadi.motion.kernel_residual import KernelResidual
from cosserat_casadi.motion.momentum import flies_alone
from cosserat_casadi.motion.one_sided import OneSided
from cosserat_casadi.motion.repeated_call import INTERPRETED, Libraries, RepeatedCall, repeated
from cosserat_casadi.numerics.motion_equations import Instant, MotionEquations, Residual
from cosserat_casadi.rod.rod_motion import StrainRates

ORDERS = 3
"""Positions, rates and accelerations."""


def can_be_centred(model: Model) -> bool:
    """Whether a scene is one free rod without slack cables or exact friction, and of a length that is no input.

    Tensions of cables are unknowns of the model, and a length that is an input would enter the frame with its rates.
    Steps with friction of exact contact are taken in the unknowns of the model.
    """
    if not flies_alone(model) or OneSided(model).pairs or model.scene.rubs_exactly:
        return False
    (name,) = model.discrete.rods
    return model.discrete.layout.of_rod(name, "length") is None


class CentredCoordinates:
    """The map x = φ(y): y is x but for the entries of the base, in whose place the centred frame's stand.

    Forces of contacts, which stand behind the unknowns of the model while something touches, are equal in both.

    Args:
        model: of one rod that flies free, see :func:`can_be_centred`.
        libraries: shared objects that have :attr:`in_iterations` and :attr:`derivatives`.
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
        """(y, v, a) ↦ derivatives of the base's unknowns with y, 7×size, and their rates."""
        return self._functions.derivatives

    def to_model(self, instant: Instant) -> Instant:
        """A state in the unknowns of the model, from one in these coordinates."""
        own = self._own(instant)
        base = self._base(own.x, own.v, own.a).reshape(ORDERS, POSE_SIZE)
        parts = [instant.x.copy(), instant.v.copy(), instant.a.copy()]
        for part, of_base in zip(parts, base, strict=True):
            part[self._pose] = of_base
        x, v, a = parts
        return Instant(instant.time, x, v, a)

    def positions_of_model(self, positions: FloatArray) -> FloatArray:
        """Unknowns of the model at T times, from those in these coordinates, shape (T, size) each."""
        x = positions.copy()
        x[:, self._pose] = evaluated(self._position, positions)[0][:, :, 0]
        return x

    def from_model(self, instant: Instant) -> Instant:
        """A state in these coordinates, from one in the unknowns of the model."""
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
        """Unknowns of the model, or their rates, from unknowns of the steps and of the base."""
        order = np.arange(self._size)
        order[self._pose] = self._size + np.arange(POSE_SIZE)
        return ca.vertcat(own, base)[order.tolist()]

    def _own(self, instant: Instant) -> Instant:
        """A state without the forces of contacts."""
        if len(instant.x) == self._size:
            return instant
        own = slice(0, self._size)
        return Instant(instant.time, instant.x[own], instant.v[own], instant.a[own])

    def _jet(self, instant: Instant) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Rows of the base in Φ, Φ̇ and Φ̈, shape (7, size) each."""
        own = self._own(instant)
        value, rate, acceleration = self._derivatives.matrices(own.x, own.v, own.a)
        return value, rate, acceleration

    @cached_property
    def _derivatives(self) -> RepeatedCall:
        return repeated(self.derivatives, self._libraries.jacobians, ORDERS, as_scalars=False)


class _Functions:
    """The functions of the coordinates of a model, over its size.

    Args:
        model: of one rod that flies free.
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
        """(y, v, a) ↦ unknowns of the base, their rates and accelerations beneath each other, 21×1."""
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
    """Rows of the pose, then of the strains, among all unknowns, sparse, (7 + n)×size."""
    columns = [*range(pose.start, pose.stop), *range(strains.start, strains.stop)]
    pattern = ca.Sparsity.triplet(len(columns), size, list(range(len(columns))), columns)
    return ca.DM(pattern, 1.0)
