"""A step of a collocation method, from its stages to any time in it.

The unknowns of the stages are accelerations of the differential entries, a_j, and values of the algebraic ones. Their
polynomial of degree s − 1 through the stages, integrated twice from the start of the step, is the motion in it:
x(t₀ + θh) = x₀ + θh v₀ + h² Σ_j a_j ∫₀^θ ∫₀^σ ℓ_j, and v its derivative. E. Hairer, S. P. Nørsett, G. Wanner, *Solving
Ordinary Differential Equations I*, 2nd ed., Springer 1993, section II.7.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import Collocation
from cosserat_casadi.numerics.motion_equations import Instant


@dataclass(frozen=True)
class Stages:
    """The instants at which a step collocates, side by side.

    Attributes:
        times: t₀ + c_i h, shape (s,), s.
        x: shape (s, n).
        v: shape (s, n), 1/s.
        a: shape (s, n), 1/s².
    """

    times: FloatArray
    x: FloatArray
    v: FloatArray
    a: FloatArray


@dataclass(frozen=True)
class StepPolynomial:
    """The motion in a step, as the unknowns of its stages determine it.

    Attributes:
        method: the collocation method.
        differential: which entries have accelerations, shape (n,).
        start: where the step begins, with the acceleration of the step before.
        size: h, s.
        unknowns: of the stages: accelerations of differential entries, values of algebraic ones, shape (s, n).
    """

    method: Collocation
    differential: npt.NDArray[np.bool_]
    start: Instant
    size: float
    unknowns: FloatArray

    @property
    def accelerations(self) -> FloatArray:
        """Accelerations at the stages, zero of algebraic entries, shape (s, n), 1/s²."""
        return np.where(self.differential, self.unknowns, 0.0)

    @property
    def stages(self) -> Stages:
        """The instants of the stages."""
        a = self.accelerations
        v = np.where(self.differential, self.start.v + self.size * (self.method.matrix @ a), 0.0)
        straight_on = self.start.x + self.size * self.method.nodes[:, None] * self.start.v
        curved = straight_on + self.size**2 * (self.method.matrix_squared @ a)
        x = np.where(self.differential, curved, self.unknowns)
        return Stages(self.start.time + self.method.nodes * self.size, x, v, a)

    def arrival(self, time: float) -> Instant:
        """The end, at its time, s; a method whose last stage is not the end extrapolates accelerations too."""
        at_end = self.method.values_at(1.0) @ self.unknowns
        straight_on = self.start.x + self.size * self.start.v
        curved = straight_on + self.size**2 * (self.method.position_weights @ self.accelerations)
        velocity = self.start.v + self.size * (self.method.weights @ self.accelerations)
        return self._instant(time, curved, velocity, at_end)

    def at_share(self, share: float, time: float) -> Instant:
        """The polynomial at a share θ of the step, and the time that belongs to it, s."""
        values = self.method.values_at(share) @ self.unknowns
        moved = self.method.double_integrals_at(share) @ self.accelerations
        displacement = share * self.size * self.start.v + self.size**2 * moved
        velocity = self.start.v + self.size * (self.method.integrals_at(share) @ self.accelerations)
        return self._instant(time, self.start.x + displacement, velocity, values)

    def _instant(self, time: float, x: FloatArray, v: FloatArray, values: FloatArray) -> Instant:
        """Positions and velocities of differential entries, and the values of the polynomial of all."""
        return Instant(
            time,
            np.where(self.differential, x, values),
            np.where(self.differential, v, 0.0),
            np.where(self.differential, values, 0.0),
        )


@dataclass(frozen=True)
class TimeStep(StepPolynomial):
    """One step of a motion.

    Attributes:
        end: where the step ends.
        error: estimated error of the step over its tolerance; nan where none was estimated.
        iterations: Newton iterations of the step as it was taken.
        residual: largest entry of F at the stages before the last correction.
        contraction: ratio of the last two corrections; 0 where there was but one.
    """

    end: Instant
    error: float
    iterations: int
    residual: float
    contraction: float

    def at(self, time: float) -> Instant:
        """The motion at a time of the step: exactly at the ends of the step, extrapolated outside.

        Positions have an error of order s + 2 in h, velocities of s + 1, accelerations and algebraic entries of s.
        """
        if time == self.end.time:
            return self.end
        return self.at_share((time - self.start.time) / self.size, time)


class HeldTimes:
    """T times in the steps that hold them, with the motion there by the polynomials of these steps.

    :meth:`TimeStep.at` computes the same numbers for one time.

    Args:
        steps: of one method and the same n unknowns.
        numbers: which of the steps holds each time, shape (T,).
        times: shape (T,), s.
    """

    def __init__(self, steps: Sequence[TimeStep], numbers: npt.NDArray[np.intp], times: FloatArray) -> None:
        used, self._step = np.unique(numbers, return_inverse=True)
        self._steps = [steps[number] for number in used.tolist()]
        self._method, self._differential = self._steps[0].method, self._steps[0].differential
        self._sizes = self._of_each([step.size for step in self._steps])
        self._shares = (times - self._of_each([step.start.time for step in self._steps])) / self._sizes
        self._at_end = times == self._of_each([step.end.time for step in self._steps])
        self._unknowns = self._of_each([step.unknowns for step in self._steps])

    def positions(self) -> FloatArray:
        """Positions and algebraic entries, shape (T, n)."""
        begin = self._of_each([step.start.x for step in self._steps])
        velocity = self._of_each([step.start.v for step in self._steps])
        moved = self._summed(self._method.double_integrals_at)
        displacement = (self._shares * self._sizes)[:, None] * velocity + self._sizes[:, None] ** 2 * moved
        x = np.where(self._differential, begin + displacement, self._summed(self._method.values_at))
        return self._with_ends(x, [step.end.x for step in self._steps])

    def rates(self) -> tuple[FloatArray, FloatArray]:
        """Velocities, 1/s, and accelerations, 1/s², zero of algebraic entries, shape (T, n) each."""
        gained = self._sizes[:, None] * self._summed(self._method.integrals_at)
        velocities = self._of_each([step.start.v for step in self._steps]) + gained
        v, a = (np.where(self._differential, each, 0.0) for each in (velocities, self._summed(self._method.values_at)))
        ends = [step.end for step in self._steps]
        return self._with_ends(v, [end.v for end in ends]), self._with_ends(a, [end.a for end in ends])

    def _of_each(self, values: Sequence[Any]) -> FloatArray:
        return np.array(values)[self._step]

    def _summed(self, weights: Callable[[FloatArray], FloatArray]) -> FloatArray:
        return np.asarray(np.einsum("ts,tsn->tn", weights(self._shares), self._unknowns))

    def _with_ends(self, values: FloatArray, ends: Sequence[FloatArray]) -> FloatArray:
        # The end of a step may have been put right.
        return np.where(self._at_end[:, None], self._of_each(ends), values)


@dataclass(frozen=True)
class CarriedStep:
    """Data that a step takes over from the steps before it, beside the state that they have reached.

    Attributes:
        begun: time at which the stretch of equal equations began, s.
        size: of the step before, s.
        unknowns: as in :class:`TimeStep`, of the step before, shape (s, n).
        wanted: size that the next step is to have, s.
        error: estimated error of the step before over its tolerance; nan where it was not controlled.
        longest: longest step of the stretch, s.
        linearised_at: where the Jacobian in use was evaluated; None where the next step evaluates one.
    """

    begun: float
    size: float
    unknowns: FloatArray
    wanted: float
    error: float
    longest: float
    linearised_at: Instant | None


def extrapolated(method: Collocation, step: TimeStep | CarriedStep, size: float) -> FloatArray:
    """Unknowns of the stages of a next step of size h, from the polynomial of the step before, shape (s, n)."""
    shares = 1.0 + method.nodes * (size / step.size)
    return method.values_at(shares) @ step.unknowns


def restricted(step: TimeStep, time: float) -> TimeStep:
    """The part of a step up to a time in it: the same polynomial, with its values at the stages of a shorter step."""
    share = (time - step.start.time) / step.size
    unknowns = step.method.values_at(share * step.method.nodes) @ step.unknowns
    return replace(step, size=time - step.start.time, unknowns=unknowns, end=step.at(time))
