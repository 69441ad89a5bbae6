"""Inverse dynamics and its derivatives as the steps of a motion call them, over and over.

CasADi's virtual machine runs them, or machine code that motion_compiler.py has compiled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.motion.repeated_call import Libraries, RepeatedCall
from cosserat_casadi.numerics.time_steps import Stepper, StepperAfter

MATRICES = 3
"""Derivatives of inverse dynamics: stiffness, damping, mass."""

JACOBIANS = "motion_jacobians"
"""Name of these derivatives in C, and of their files in the cache."""


@dataclass(frozen=True)
class StepKernels:
    """Functions of (x, v, a, inputs, inputs_rate, inputs_acceleration), with parameters behind the inputs.

    Attributes:
        residual: ↦ residual of the equations of motion, shape (size,).
        jacobians: ↦ its derivatives with x, v and a, each of shape (size, size).
        stepper: takes the steps in machine code; None where Python takes them.
        derivatives: the call behind the derivatives in machine code; None where CasADi's virtual machine runs them.
        stepper_after: asked in steps of Python for a stepper that takes the rest; None where none is to come.
    """

    residual: Callable[..., FloatArray]
    jacobians: Callable[..., list[FloatArray]]
    stepper: Stepper | None = None
    derivatives: RepeatedCall | None = None
    stepper_after: StepperAfter | None = None

    @property
    def library(self) -> str | None:
        """The shared object that has the residual; None where CasADi's virtual machine runs it."""
        return self.residual.library if isinstance(self.residual, RepeatedCall) else None

    @property
    def libraries(self) -> Libraries:
        """The shared objects that have the residual, the derivatives, and all that is written beside them."""
        return Libraries(self.library, None if self.derivatives is None else self.derivatives.library)


def interpreted_residual(model: Model) -> RepeatedCall:
    """Inverse dynamics by CasADi's virtual machine."""
    return RepeatedCall(model.inverse_dynamics_in_scalars)


def dense_jacobians(model: Model, name: str = JACOBIANS) -> ca.Function:
    """Stiffness, damping and mass with all their entries, in the arguments of inverse dynamics."""
    function = model.dynamics_jacobian
    arguments = function.mx_in()
    matrices = [ca.densify(matrix) for matrix in function.call(arguments)[:MATRICES]]
    return ca.Function(name, arguments, matrices, function.name_in(), function.name_out()[:MATRICES])


def interpreted_derivatives(model: Model) -> ca.Function:
    """The function of :func:`dense_jacobians` for CasADi's virtual machine, written once."""
    function: ca.Function = kept_with(model, "_dense_jacobians", lambda: dense_jacobians(model))
    return function


def interpreted_jacobians(model: Model) -> Callable[..., list[FloatArray]]:
    """The derivatives of inverse dynamics by CasADi's virtual machine; they are written where they are first asked for.

    Sparse matrices of CasADi become arrays by way of lists, which takes a fifth of the time of the derivatives.
    """
    calls: list[RepeatedCall] = []

    def jacobians(*arguments: FloatArray) -> list[FloatArray]:
        if not calls:
            calls.append(RepeatedCall(interpreted_derivatives(model), MATRICES))
        return calls[0].matrices(*arguments)

    return jacobians


def interpreted(model: Model) -> StepKernels:
    """Kernels that CasADi's virtual machine runs."""
    return StepKernels(interpreted_residual(model), interpreted_jacobians(model))
