"""Equations of motion for the time integrator: an implicit system of second order, with constraints.

F(t, x, v, a) = 0 with v = dx/dt and a = d²x/dt² for the differential entries of x; of the algebraic entries
(multipliers, tensions) only the values enter. F is linear in a. With constraints between positions the index is 3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray

Residual = Callable[[float, FloatArray, FloatArray, FloatArray], FloatArray]
"""(t, x, v, a) ↦ F, shape (n,)."""


@dataclass(frozen=True)
class Instant:
    """A state of motion at one time; v and a of algebraic entries are zero.

    Attributes:
        time: time t, s.
        x: unknowns, shape (n,).
        v: rates of the unknowns, shape (n,), 1/s.
        a: accelerations of the unknowns, shape (n,), 1/s².
    """

    time: float
    x: FloatArray
    v: FloatArray
    a: FloatArray

    def first(self, size: int) -> Instant:
        """The state of the first unknowns, without the forces of contacts that are appended to them."""
        return Instant(self.time, self.x[:size], self.v[:size], self.a[:size])


@dataclass(frozen=True)
class Linearisation:
    """The derivatives of F; the columns of algebraic entries are zero in damping and mass.

    Attributes:
        stiffness: K = ∂F/∂x, shape (n, n).
        damping: C = ∂F/∂v, shape (n, n), s.
        mass: M = ∂F/∂a, shape (n, n), s².
    """

    stiffness: FloatArray
    damping: FloatArray
    mass: FloatArray

    @property
    def finite(self) -> bool:
        """Whether every entry is a finite number."""
        matrices = (self.stiffness, self.damping, self.mass)
        return all(bool(np.all(np.isfinite(matrix))) for matrix in matrices)


Jacobians = Callable[[float, FloatArray, FloatArray, FloatArray], tuple[FloatArray, FloatArray, FloatArray]]
"""(t, x, v, a) ↦ ∂F/∂x, ∂F/∂v, ∂F/∂a, each of shape (n, n)."""


@dataclass(frozen=True)
class MotionEquations:
    """Square equations F(t, x, v, a) = 0 of n unknowns.

    Attributes:
        differential: mask of the entries of x with rates and accelerations; the others are algebraic, shape (n,).
        residual: (t, x, v, a) ↦ F, shape (n,).
        jacobians: (t, x, v, a) ↦ ∂F/∂x, ∂F/∂v, ∂F/∂a, each of shape (n, n).
        residuals: F at s instants at once, (t (s,), x (s, n), v (s, n), a (s, n)) ↦ (s, n); None if that is no faster
            than one at a time.
        rates_of_last: (t, x, v) ↦ rates, and second rates at zero acceleration, of constraints in the last rows, shape
            (m,) each; None if all constraints are differentiated along the motion by a polynomial.
        kinks: ascending times of kinks of F in t that steps may pass, s.
        eliminated: indices of entries whose rows depend on no other such entry, such as flows of branches; they are
            eliminated from the linear systems of a step.
    """

    differential: npt.NDArray[np.bool_]
    residual: Residual
    jacobians: Jacobians
    residuals: Callable[[FloatArray, FloatArray, FloatArray, FloatArray], FloatArray] | None = None
    rates_of_last: Callable[[float, FloatArray, FloatArray], tuple[FloatArray, FloatArray]] | None = None
    kinks: tuple[float, ...] = ()
    eliminated: npt.NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return len(self.differential)

    def residual_at(self, instant: Instant) -> FloatArray:
        """Evaluate F at an instant, shape (n,); entries that overflow are not finite."""
        with np.errstate(all="ignore"):
            return self.residual(instant.time, instant.x, instant.v, instant.a)

    def residual_of_stages(self, times: FloatArray, x: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """Evaluate F at s instants, shape (s, n), for times of shape (s,) and x, v and a of shape (s, n)."""
        with np.errstate(all="ignore"):
            if self.residuals is not None:
                return self.residuals(times, x, v, a)
            rows = np.empty(x.shape)
            for i, time in enumerate(times.tolist()):
                rows[i] = self.residual(time, x[i], v[i], a[i])
            return rows

    def linearised(self, instant: Instant) -> Linearisation:
        """Evaluate the derivatives of F at an instant."""
        with np.errstate(all="ignore"):
            stiffness, damping, mass = self.jacobians(instant.time, instant.x, instant.v, instant.a)
        return Linearisation(stiffness, damping, mass)
