"""Inverse dynamics and its derivatives, as called repeatedly by the steps of a motion.

They run in CasADi's virtual machine, or as machine code that motion_compiler.py has compiled.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import kept_with
from cosserat_casadi.motion.repeated_call import Libraries, RepeatedCall
from cosserat_casadi.numerics.time_steps import Stepper, StepperAfter

MATRICES = 3
"""Number of derivatives of inverse dynamics: stiffness, damping, mass."""

JACOBIANS = "motion_jacobians"
"""Name of these derivatives in C, and of their files in the cache."""


@dataclass(frozen=True)
class StepKernels:
    """Functions of (x, v, a, inputs, inputs_rate, inputs_acceleration), with parameters appended to the inputs.

    Attributes:
        residual: ↦ residual of the equations of motion, shape (size,).
        jacobians: ↦ its derivatives with respect to x, v and a, each of shape (size, size).
        stepper: taker of the steps in machine code; None if Python takes them.
        derivatives: compiled call of the derivatives; None if CasADi's virtual machine runs them.
        stepper_after: function that steps in Python ask for a stepper that takes the rest; None without one.
    """

    residual: Callable[..., FloatArray]
    jacobians: Callable[..., list[FloatArray]]
    stepper: Stepper | None = None
    derivatives: RepeatedCall | None = None
    stepper_after: StepperAfter | None = None

    @property
    def library(self) -> str | None:
        """The shared object that contains the residual; None if CasADi's virtual machine runs it."""
        return self.residual.library if isinstance(self.residual, RepeatedCall) else None

    @property
    def libraries(self) -> Libraries:
        """The shared objects that contain the residual and the derivatives, with their companions."""
        return Libraries(self.library, None if self.derivatives is None else self.derivatives.library)


def interpreted_residual(model: Model) -> RepeatedCall:
    """Make inverse dynamics in CasADi's virtual machine."""
    return RepeatedCall(model.inverse_dynamics_in_scalars)


def dense_jacobians(model: Model, name: str = JACOBIANS) -> ca.Function:
    """Stiffness, damping and mass with all their entries, in the arguments of inverse dynamics."""
    function = model.dynamics_jacobian
    arguments = function.mx_in()
    matrices = [ca.densify(matrix) for matrix in function.call(arguments)[:MATRICES]]
    return ca.Function(name, arguments, matrices, function.name_in(), function.name_out()[:MATRICES])


def interpreted_derivatives(model: Model) -> ca.Function:
    """The function of :func:`dense_jacobians` for CasADi's virtual machine, written once."""
    return kept_with(model, "_dense_jacobians", lambda: dense_jacobians(model))


def interpreted_jacobians(model: Model) -> Callable[..., list[FloatArray]]:
    """Make the derivatives of inverse dynamics in CasADi's virtual machine; they are written at their first call.

    CasADi converts sparse matrices to arrays through lists, which takes a fifth of the time of the derivatives.
    """
    calls: list[RepeatedCall] = []

    def jacobians(*arguments: FloatArray) -> list[FloatArray]:
        if not calls:
            calls.append(RepeatedCall(interpreted_derivatives(model), MATRICES))
        began = time.process_time()
        matrices = calls[0].matrices(*arguments)
        fastest = fastest_derivatives(model)
        fastest[:] = [min([time.process_time() - began, *fastest])]
        return matrices

    return jacobians


def fastest_derivatives(model: Model) -> list[float]:
    """Least processor time of a call of the derivatives in CasADi's virtual machine, s; empty before the first call."""
    fastest: list[float] = kept_with(model, "_fastest_derivatives", list)
    return fastest


def interpreted(model: Model) -> StepKernels:
    """Kernels that CasADi's virtual machine runs."""
    return StepKernels(interpreted_residual(model), interpreted_jacobians(model))
