"""The equations of motion of a model as functions of time and state, with the compiled calls that evaluate them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.repeated_call import RepeatedCall


@dataclass(frozen=True)
class KernelResidual:
    """Inverse dynamics while the inputs follow their paths: (t, x, v, a) ↦ F, shape (n,).

    A loop in C does not call this function: it writes the arguments of the call in place.

    Attributes:
        call: inverse dynamics as a function of (x, v, a, inputs, inputs_rate, inputs_acceleration).
        inputs_at: t ↦ inputs, their rates and accelerations.
        moves: whether the inputs change.
        cubics: a time, s, and coefficients of inputs, rates and accelerations in powers of the time since then,
            shape (4, 3 inputs); None if inputs are not cubic polynomials.
    """

    call: RepeatedCall
    inputs_at: Callable[[float], Sequence[FloatArray]]
    moves: bool
    cubics: tuple[float, FloatArray] | None = None

    def __call__(self, t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """F, shape (n,)."""
        return self.call(x, v, a, *self.inputs_at(t))


@dataclass(frozen=True)
class KernelJacobians:
    """Derivatives of inverse dynamics in machine code: (t, x, v, a) ↦ stiffness, damping, mass, shape (n, n) each.

    Attributes:
        call: the derivatives as a function of the arguments of inverse dynamics.
        inputs_at: t ↦ inputs, their rates and accelerations.
    """

    call: RepeatedCall
    inputs_at: Callable[[float], Sequence[FloatArray]]

    def __call__(
        self, t: float, x: FloatArray, v: FloatArray, a: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The matrices."""
        stiffness, damping, mass = self.call.matrices(x, v, a, *self.inputs_at(t))
        return stiffness, damping, mass
