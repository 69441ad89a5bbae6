"""A step of a collocation method: its stages, and the motion at any time in it.

The unknowns of the stages are accelerations of the differential entries, a_j, and values of the algebraic ones. Their
polynomial of degree s − 1 through the stages, integrated twice from the start of the step, is the motion in it:
x(t₀ + θh) = x₀ + θh v₀ + h² Σ_j a_j ∫₀^θ ∫₀^σ ℓ_j, and v its derivative. E. Hairer, S. P. Nørsett, G. Wanner, *Solving
Ordinary Differential Equations I*, 2nd ed., Springer 1993, section II.7.
"""

from __future__ import annotations

import operator
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
    """The instants at which a step collocates, as arrays.

    Attributes:
        times: times t₀ + c_i h, shape (s,), s.
        x: unknowns, shape (s, n).
        v: rates, shape (s, n), 1/s.
        a: accelerations, shape (s, n), 1/s².
    """

    times: FloatArray
    x: FloatArray
    v: FloatArray
    a: FloatArray


@dataclass(frozen=True)
class StepPolynomial:
    """The motion in a step, by the unknowns of its stages.

    Attributes:
        method: the collocation method.
        differential: mask of the entries with accelerations, shape (n,).
        start: state at the start, with the acceleration of the step before.
        size: step size h, s.
        unknowns: accelerations of differential entries, and values of algebraic ones, at the stages, shape (s, n).
    """

    method: Collocation
    differential: npt.NDArray[np.bool_]
    start: Instant
    size: float
    unknowns: FloatArray

    @property
    def accelerations(self) -> FloatArray:
        """Accelerations at the stages, zero for algebraic entries, shape (s, n), 1/s²."""
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
        """State at the end, at its time, s; if the last stage is not the end, accelerations are extrapolated too."""
        at_end = self.method.values_at(1.0) @ self.unknowns
        straight_on = self.start.x + self.size * self.start.v
        curved = straight_on + self.size**2 * (self.method.position_weights @ self.accelerations)
        velocity = self.start.v + self.size * (self.method.weights @ self.accelerations)
        return self._instant(time, curved, velocity, at_end)

    def at_share(self, share: float, time: float) -> Instant:
        """State of the polynomial at a share θ of the step, with the corresponding time, s."""
        values = self.method.values_at(share) @ self.unknowns
        moved = self.method.double_integrals_at(share) @ self.accelerations
        displacement = share * self.size * self.start.v + self.size**2 * moved
        velocity = self.start.v + self.size * (self.method.integrals_at(share) @ self.accelerations)
        return self._instant(time, self.start.x + displacement, velocity, values)

    def _instant(self, time: float, x: FloatArray, v: FloatArray, values: FloatArray) -> Instant:
        """Make a state of positions and velocities of differential entries, and values of the polynomial of all."""
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
        end: state at the end of the step.
        error: estimated error of the step over its tolerance; nan if it was not estimated.
        iterations: number of Newton iterations of the accepted step.
        residual: largest entry of F at the stages before the last correction.
        contraction: ratio of the last two corrections; 0 after a single one.
    """

    end: Instant
    error: float
    iterations: int
    residual: float
    contraction: float

    def at(self, time: float) -> Instant:
        """State at a time of the step; it is exact at both ends of the step, and extrapolated outside.

        Positions have an error of order s + 2 in h, velocities of s + 1, accelerations and algebraic entries of s.
        """
        if time == self.end.time:
            return self.end
        return self.at_share((time - self.start.time) / self.size, time)


@dataclass(frozen=True, eq=False)
class StepRows(Sequence[TimeStep]):
    """Consecutive steps of n unknowns, as arrays; the record of a single step is made on demand.

    Attributes:
        method: the collocation method, with s stages.
        differential: mask of the entries with accelerations, shape (n,).
        begins: x, v and a at the start of each of k steps, shape (k, 3, n).
        ends: x, v and a at the end of each step, shape (k, 3, n).
        unknowns: unknowns of the stages of each step, shape (k, s, n).
        facts: times at start and end, and size, s, error, iterations, residual and contraction of each step,
            shape (k, 7).
    """

    method: Collocation
    differential: npt.NDArray[np.bool_]
    begins: FloatArray
    ends: FloatArray
    unknowns: FloatArray
    facts: FloatArray

    @classmethod
    def of(cls, steps: Sequence[TimeStep]) -> StepRows:
        """Convert steps of one method, at least one, to arrays."""
        if isinstance(steps, StepRows):
            return steps
        begins = np.array([[step.start.x, step.start.v, step.start.a] for step in steps])
        ends = np.array([[step.end.x, step.end.v, step.end.a] for step in steps])
        facts = [
            (one.start.time, one.end.time, one.size, one.error, one.iterations, one.residual, one.contraction)
            for one in steps
        ]
        unknowns = np.array([step.unknowns for step in steps])
        return cls(steps[0].method, steps[0].differential, begins, ends, unknowns, np.array(facts))

    @classmethod
    def joined(cls, blocks: Sequence[StepRows]) -> StepRows:
        """Join blocks of steps of one method."""
        parts = zip(*((block.begins, block.ends, block.unknowns, block.facts) for block in blocks), strict=True)
        return cls(blocks[0].method, blocks[0].differential, *map(np.concatenate, parts))

    @property
    def end_times(self) -> FloatArray:
        """Times at the end of each step, shape (k,), s."""
        return self.facts[:, 1]

    def __len__(self) -> int:
        return len(self.facts)

    def __getitem__(self, number: Any) -> Any:
        begun, ended, size, error, iterations, *last = self.facts[operator.index(number)].tolist()
        start, end = Instant(begun, *self.begins[number]), Instant(ended, *self.ends[number])
        unknowns = self.unknowns[number]
        return TimeStep(self.method, self.differential, start, size, unknowns, end, error, int(iterations), *last)


@dataclass(frozen=True, eq=False)
class HeldTimes:
    """T times in the steps that hold them, with the motion there by their polynomials, as of :meth:`TimeStep.at`.

    Attributes:
        steps: of n unknowns.
        numbers: which of the steps holds each time, shape (T,).
        times: shape (T,), s.
    """

    steps: StepRows
    numbers: npt.NDArray[np.intp]
    times: FloatArray

    @property
    def _shares(self) -> FloatArray:
        return np.asarray((self.times - self.steps.facts[self.numbers, 0]) / self.steps.facts[self.numbers, 2])

    def positions(self) -> FloatArray:
        """Positions and algebraic entries, shape (T, n)."""
        x, v = self.steps.begins[self.numbers, :2].swapaxes(0, 1)
        sizes = self.steps.facts[self.numbers, 2, None]
        moved = self._summed(self.steps.method.double_integrals_at)
        x = x + self._shares[:, None] * sizes * v + sizes**2 * moved
        if not np.all(self.steps.differential):
            x = np.where(self.steps.differential, x, self._summed(self.steps.method.values_at))
        return self._with_ends(x, 0)

    def rates(self) -> tuple[FloatArray, FloatArray]:
        """Velocities, 1/s, and accelerations, 1/s², zero of algebraic entries, shape (T, n) each."""
        gained = self.steps.facts[self.numbers, 2, None] * self._summed(self.steps.method.integrals_at)
        rates = self.steps.begins[self.numbers, 1] + gained, self._summed(self.steps.method.values_at)
        v, a = (np.where(self.steps.differential, each, 0.0) for each in rates)
        return self._with_ends(v, 1), self._with_ends(a, 2)

    def _summed(self, weights: Callable[[FloatArray], FloatArray]) -> FloatArray:
        return np.asarray(np.einsum("ts,tsn->tn", weights(self._shares), self.steps.unknowns[self.numbers]))

    def _with_ends(self, values: FloatArray, order: int) -> FloatArray:
        # The end of a step may have been put right.
        at_end = np.flatnonzero(self.times == self.steps.facts[self.numbers, 1])
        values[at_end] = self.steps.ends[self.numbers[at_end], order]
        return values


@dataclass(frozen=True)
class CarriedStep:
    """Data, other than the state, that a step takes over from the steps before it.

    Attributes:
        begun: start time of the stretch with these equations, s.
        size: size of the step before, s.
        unknowns: unknowns of the stages of the step before, as in :class:`TimeStep`, shape (s, n).
        wanted: size of the next step, s.
        error: estimated error of the step before over its tolerance; nan without error control.
        longest: longest step of the stretch, s.
        linearised_at: state at which the present Jacobian was evaluated; None if the next step evaluates one.
    """

    begun: float
    size: float
    unknowns: FloatArray
    wanted: float
    error: float
    longest: float
    linearised_at: Instant | None


def extrapolated(method: Collocation, step: TimeStep | CarriedStep, size: float) -> FloatArray:
    """Extrapolate the unknowns of the stages of a next step of size h from the step before, shape (s, n)."""
    shares = 1.0 + method.nodes * (size / step.size)
    return method.values_at(shares) @ step.unknowns


def restricted(step: TimeStep, time: float) -> TimeStep:
    """Cut a step at a time in it: its polynomial is kept, with values at the stages of the shorter step."""
    share = (time - step.start.time) / step.size
    unknowns = step.method.values_at(share * step.method.nodes) @ step.unknowns
    return replace(step, size=time - step.start.time, unknowns=unknowns, end=step.at(time))
