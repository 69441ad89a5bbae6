"""The equations of motion of a model as one function of time and state, with the call behind it."""

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
    """

    call: RepeatedCall
    inputs_at: Callable[[float], Sequence[FloatArray]]
    moves: bool

    def __call__(self, t: float, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """F, shape (n,)."""
        return self.call(x, v, a, *self.inputs_at(t))
