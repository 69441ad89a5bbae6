"""The equations of motion of a model as functions of time and state, with the calls behind them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.repeated_call import RepeatedCall


@dataclass(frozen=True)
class KernelResidual:
    """Inverse dynamics while the inputs follow their paths: (t, x, v, a) ↦ F, shape (n,).

    A loop in C does not call it: it writes the arguments of the call in place.

    Attributes:
        call: inverse dynamics of (x, v, a, inputs, inputs_rate, inputs_acceleration).
        inputs_at: t ↦ inputs, their rates and accelerations.
        moves: whether the inputs change.
        cubics: a time, s, and the coefficients of inputs, rates and accelerations in powers of the time since then,
            shape (4, 3 inputs); None where inputs are no such polynomials.
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
        call: the derivatives in the arguments of inverse dynamics.
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
