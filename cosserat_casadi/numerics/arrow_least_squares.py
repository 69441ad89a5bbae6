"""Nonlinear least squares with unknowns that all blocks of data share, and unknowns of single blocks ("own" here).

A Levenberg–Marquardt method with bounds. The Jacobian is a block arrow: rows of block b see the shared unknowns and the
block's. Unknowns of the blocks are eliminated block by block with orthogonal transformations, which is the Schur
complement of the normal equations without their squared condition; the remaining rows are dense in the shared unknowns.
J. J. Moré, *The Levenberg–Marquardt algorithm*, Lecture Notes in Mathematics 630, 1978 (scaling by the columns); H. B.
Nielsen, *Damping parameter in Marquardt's method*, DTU 1999 (damping); C. Kanzow, N. Yamashita, M. Fukushima, J.
Comput. Appl. Math. 172, 2004 (projection on bounds).

Where derivatives jump between a state and the one that a step leads to, a step that fails is followed by one along the
kink (numerics/kinks.py). Where none along it lessens the sum, and both sides rise from it, the sum is least.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from typing import Generic, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.kinks import kink_row
from cosserat_casadi.numerics.robust_loss import Loss

MOST_ITERATIONS = 200
"""Steps tried, at most."""

DECREASE = 1e-13
"""Predicted decrease of half the sum of squares at which to stop: a step in standard deviations is about its root."""

RELATIVE_DECREASE = 1e-14
"""Predicted decrease over half the sum of squares at which to stop."""

FIRST_DAMPING = 1e-3
"""Damping of the first step relative to the squares of the columns."""

MOST_RATIO = 1.5
"""Ratio by which one step may change a positive unknown: a linear model would let a modulus vanish."""

BACK_OFF = 10.0
"""Growth of the damping where a step leads to no state at all."""

HARDLY_DAMPED = 1e-12
"""Damping that leaves a step as it is, but for directions that no datum sees."""

LARGEST_DAMPING = 1e12
"""Damping beyond which a step is too small to change anything."""

SUFFICIENT = 1e-4
"""Share of the predicted decrease that a step must bring."""

MOST_SETS = 100
"""Sets of unknowns at their ends that one step is tried with; the sum of squares falls with each set."""

ROUNDING = 1e-9
"""Predicted decrease of half the sum of squares, in squared standard deviations, that evaluation errors may hide."""

MEETING = 1e-4
"""Difference of both sides of a kink, relative to one more than half the sum of squares, up to which it is known."""


class FitState(Protocol):
    """Residuals of a problem at some unknowns, with all that its Jacobian needs.

    Attributes:
        residual: differences in standard deviations, all blocks one after the other, shape (m,).
    """

    @property
    def residual(self) -> FloatArray:
        """Differences in standard deviations, shape (m,)."""


StateType = TypeVar("StateType", bound=FitState)


class BlockResiduals(Protocol[StateType]):
    """Residuals of blocks.

    Attributes:
        offsets: where the rows of each block begin, and at the end their number, shape (blocks + 1,).
    """

    @property
    def offsets(self) -> npt.NDArray[np.int64]:
        """Where the rows of each block begin, and at the end their number, shape (blocks + 1,)."""

    def at(self, shared: FloatArray, own: FloatArray, near: StateType) -> StateType | None:
        """The state at shared unknowns, (n,), and unknowns of the blocks, (blocks, k); None where evaluation fails."""

    def jacobians(self, state: StateType) -> tuple[FloatArray, FloatArray]:
        """Derivatives of the residual with the shared unknowns, (m, n), and with the row's block's, (m, k)."""


@dataclass(frozen=True)
class Limits:
    """Bounds and priors of some unknowns.

    Attributes:
        lower: least values, shape (n,).
        upper: largest values, shape (n,).
        mean: expected values, shape (n,); any where nothing is expected.
        weight: reciprocal of the standard deviation of the expected value, shape (n,); 0 where nothing is expected.
        ratios: whether an unknown is positive and its changes count by their ratio, as changes of a modulus do: then
            one step changes it by MOST_RATIO at most; shape (n,).
    """

    lower: FloatArray
    upper: FloatArray
    mean: FloatArray
    weight: FloatArray
    ratios: npt.NDArray[np.bool_]

    def clipped(self, values: FloatArray) -> FloatArray:
        """Values brought into their range."""
        return np.clip(values, self.lower, self.upper)

    def within_step(self, values: FloatArray) -> Limits:
        """Bounds and priors, narrowed to one step from these values, shape (n,) or (blocks, n)."""
        lower = np.where(self.ratios, values / MOST_RATIO, -np.inf)
        upper = np.where(self.ratios, values * MOST_RATIO, np.inf)
        return replace(self, lower=np.maximum(lower, self.lower), upper=np.minimum(upper, self.upper))

    def residual(self, values: FloatArray) -> FloatArray:
        """Differences from the expected values in standard deviations, shape as the values."""
        return (values - self.mean) * self.weight

    def at_end(self, values: FloatArray) -> npt.NDArray[np.bool_]:
        """Which unknowns are at an end of their range, shape as the values."""
        return (values <= self.lower) | (values >= self.upper)

    def held(self, values: FloatArray, gradient: FloatArray) -> npt.NDArray[np.bool_]:
        """Which unknowns are at a bound that the descent would cross, shape as the values."""
        at_lower = (values <= self.lower) & (gradient > 0)
        at_upper = (values >= self.upper) & (gradient < 0)
        return at_lower | at_upper


class FitOutcome(Enum):
    """How a fit ends."""

    CONVERGED = "No step lessens the misfit any more."
    AT_KINK = "The misfit is least where its derivatives jump."
    MAX_ITERATIONS = "The iterations ran out before the misfit was least."
    STALLED = "No step that can be followed lessens the misfit, though its gradient is not zero."


@dataclass(frozen=True)
class Fit(Generic[StateType]):
    """The end of a fit.

    Attributes:
        shared: shared unknowns, shape (n,).
        own: unknowns of each block, shape (blocks, k).
        state: what the problem knows there.
        cost: half the sum of what residuals and priors cost.
        iterations: steps tried.
        outcome: how it ended.
        beyond: the state on the other side of a kink that steps from here have met; None where they met none.
    """

    shared: FloatArray
    own: FloatArray
    state: StateType
    cost: float
    iterations: int
    outcome: FitOutcome
    beyond: StateType | None = None


@dataclass
class ArrowStep:
    """A weighted least-squares problem, linear in the changes of the unknowns.

    Attributes:
        residual: shape (m,).
        by_shared: shape (m, n).
        by_own: shape (m, k).
        offsets: shape (blocks + 1,).
        shared_prior: weights of the priors of the shared unknowns and their residuals, each of shape (n,).
        own_prior: weights of the priors of the unknowns of the blocks, shape (k,), and residuals, shape (blocks, k).
        shared_held: shared unknowns that must not change, shape (n,).
        own_held: own unknowns that must not change, shape (blocks, k).
    """

    residual: FloatArray
    by_shared: FloatArray
    by_own: FloatArray
    offsets: npt.NDArray[np.int64]
    shared_prior: tuple[FloatArray, FloatArray]
    own_prior: tuple[FloatArray, FloatArray]
    shared_held: npt.NDArray[np.bool_]
    own_held: npt.NDArray[np.bool_]

    @property
    def sizes(self) -> tuple[int, int]:
        """Number of shared unknowns, and number of unknowns of each block."""
        return self.by_shared.shape[1], self.by_own.shape[1]

    @cached_property
    def _triangles(self) -> list[FloatArray]:
        """Triangle of each block, of [its unknowns, shared unknowns, residual], which replaces its rows."""
        n, k = self.sizes
        by_shared = np.where(self.shared_held, 0.0, self.by_shared)
        if not k:
            return [_triangle(np.hstack([by_shared, self.residual[:, None]]))]
        triangles = []
        weights, prior_residuals = self.own_prior
        for block, held in enumerate(self.own_held):
            rows = slice(self.offsets[block], self.offsets[block + 1])
            own = np.where(held, 0.0, self.by_own[rows])
            data = np.hstack([own, by_shared[rows], self.residual[rows, None]])
            prior = np.zeros((k, k + n + 1))
            prior[:, :k] = np.diag(np.where(held, 0.0, weights))
            prior[:, -1] = prior_residuals[block]
            triangles.append(_triangle(np.vstack([data, prior])))
        return triangles

    def eliminated(self, own_damping: FloatArray) -> tuple[FloatArray, list[FloatArray]]:
        """The remaining rows of [shared, residual], and for each block the rows from which its unknowns follow.

        Args:
            own_damping: least rows of the unknowns of the blocks, shape (k,); zero for none.
        """
        n, k = self.sizes
        if not k:
            return np.vstack(self._triangles), []
        left = []
        eliminations = []
        for triangle in self._triangles:
            # What no row sees, or a bound holds, would take a row of the others with it: it gets one of its own.
            unseen = ~np.any(triangle[:, :k], axis=0)
            damping = np.zeros((k, k + n + 1))
            damping[:, :k] = np.diag(np.where(unseen, 1.0, own_damping))
            whole = _triangle(np.vstack([triangle, damping]))
            eliminations.append(whole[:k])
            left.append(whole[k:, k:])
        return np.vstack(left), eliminations

    def step(self, shared_damping: FloatArray, own_damping: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The change of shared unknowns, (n,), and of the blocks' unknowns, (blocks, k), with the least damped sum.

        Args:
            shared_damping: rows that are added to the shared unknowns, shape (n,), positive.
            own_damping: rows that are added to the unknowns of each block, shape (k,), positive.
        """
        n, k = self.sizes
        left, eliminations = self.eliminated(own_damping)
        weights, prior_residuals = self.shared_prior
        free_weights = np.where(self.shared_held, 0.0, weights)
        rows = np.vstack([left[:, :n], np.diag(free_weights), np.diag(shared_damping)])
        right = np.concatenate([left[:, n], prior_residuals, np.zeros(n)])
        # Unknowns differ by many orders of magnitude: unscaled, the small columns would pass for rounding.
        sizes = np.linalg.norm(rows, axis=0)
        shared = -np.linalg.lstsq(rows / sizes, right, rcond=None)[0] / sizes
        own = np.zeros(self.own_held.shape)
        for block, elimination in enumerate(eliminations):
            known = elimination[:, k : k + n] @ shared + elimination[:, -1]
            own[block] = -np.linalg.solve(elimination[:, :k], known)
        return shared, own

    def gradient(self, shared: FloatArray, own: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gradient of half the sum of squares, where the unknowns have changed.

        Args:
            shared: changes of the shared unknowns, shape (n,).
            own: changes of the unknowns of the blocks, shape (blocks, k).

        Returns:
            with the shared unknowns, shape (n,), and with the unknowns of the blocks, shape (blocks, k).
        """
        residual = self.residual + self._change(shared, own)
        shared_weights, shared_residual = self.shared_prior
        own_weights, own_residual = self.own_prior
        by_shared = self.by_shared.T @ residual + shared_weights * (shared_residual + shared_weights * shared)
        by_own = np.zeros_like(own)
        if own.size:
            by_own = np.add.reduceat(residual[:, None] * self.by_own, self.offsets[:-1], axis=0)
        return by_shared, by_own + own_weights * (own_residual + own_weights * own)

    def with_changes(
        self,
        shared: FloatArray,
        own: FloatArray,
        shared_held: npt.NDArray[np.bool_],
        own_held: npt.NDArray[np.bool_],
    ) -> ArrowStep:
        """The problem after some unknowns have changed by these amounts, and are held there.

        Args:
            shared: changes of the shared unknowns, shape (n,); zero for free unknowns.
            own: changes of the unknowns of the blocks, shape (blocks, k); zero for free unknowns.
            shared_held: shared unknowns that are held, shape (n,).
            own_held: own unknowns that are held, shape (blocks, k).
        """
        return replace(
            self,
            residual=self.residual + self._change(shared, own),
            shared_prior=(self.shared_prior[0], self.shared_prior[1] + self.shared_prior[0] * shared),
            own_prior=(self.own_prior[0], self.own_prior[1] + self.own_prior[0] * own),
            shared_held=shared_held,
            own_held=own_held,
        )

    def along_kinks(self, other: ArrowStep, changes: Pair, scales: Pair, blocks: npt.NDArray[np.bool_]) -> ArrowStep:
        """The problem with a row for each kink that parts it from another one, which keeps steps on the kink.

        Args:
            other: the problem on the other side of the kinks.
            changes: changes of the unknowns, from here to there.
            scales: sizes of the derivatives by the unknowns, shapes (n,) and (k,).
            blocks: whether a block has a kink in between, shape (blocks,).
        """
        n, k = self.sizes
        rows = []
        for block, is_kinked in enumerate(blocks):
            span = slice(self.offsets[block], self.offsets[block + 1])
            here, there = (
                np.hstack([own.residual[span, None], own.by_shared[span], own.by_own[span]]) for own in (self, other)
            )
            rows.append(here)
            if is_kinked:
                change = np.concatenate([changes[0], changes[1][block, :k]])
                rows[-1] = np.vstack([here, kink_row(here, there, change, np.concatenate(scales))])
        whole = np.vstack(rows)
        offsets = np.cumsum([0, *map(len, rows)])
        by_shared, by_own = np.split(whole[:, 1:], [n], axis=1)
        return replace(self, residual=whole[:, 0], by_shared=by_shared, by_own=by_own, offsets=offsets)

    def decrease(self, shared: FloatArray, own: FloatArray) -> float:
        """How much half the sum of squares falls, by the linear model, where the unknowns change."""
        falls = _decrease(self.residual, self._change(shared, own))
        falls += _decrease(self.shared_prior[1], self.shared_prior[0] * shared)
        return falls + _decrease(self.own_prior[1].ravel(), (self.own_prior[0] * own).ravel())

    def _change(self, shared: FloatArray, own: FloatArray) -> FloatArray:
        """Change of the residual by the linear model, shape (m,)."""
        return np.asarray(self.by_shared @ shared + np.sum(self.by_own * self._spread(own), axis=1))

    def _spread(self, own: FloatArray) -> FloatArray:
        """Own unknowns of each row's block, shape (m, k)."""
        return np.repeat(own, np.diff(self.offsets), axis=0)


def _without(held: Held, which: int, place: tuple[np.signedinteger, ...]) -> Held:
    """Held unknowns, less one."""
    fewer = (held[0].copy(), held[1].copy())
    fewer[which][place] = False
    return fewer


def _decrease(residual: FloatArray, change: FloatArray) -> float:
    """Half the sum of squares of a residual less that after a change."""
    return -float(change @ (residual + change / 2))


def _triangle(rows: FloatArray) -> FloatArray:
    """The triangle R of rows = Q R, square at least."""
    triangle = np.asarray(np.linalg.qr(rows, mode="r"))
    missing = rows.shape[1] - len(triangle)
    if missing > 0:
        triangle = np.vstack([triangle, np.zeros((missing, rows.shape[1]))])
    return triangle


Held = tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]]
"""Whether shared unknowns are held, shape (n,), and whether unknowns of the blocks are."""

Pair = tuple[FloatArray, FloatArray]
"""A number for each shared unknown, shape (n,), and for each unknown of the blocks, shape (blocks, k)."""


@dataclass
class BoundedStep:
    """The step within bounds that lessens a damped linear least-squares problem most.

    Unknowns that a step would take beyond an end stop there, and the others go where the sum is least with those at
    their ends: cut off alone, they would not go along. One that would rather come back from its end is let go. The sum
    falls with each such set of unknowns. P. B. Stark, R. L. Parker, *Bounded-variable least-squares*, Computational
    Statistics 10, 1995; J. Nocedal, S. J. Wright, *Numerical Optimization*, Springer 2006, section 16.5.

    Attributes:
        arrow: the problem in the changes of the unknowns.
        values: the unknowns now.
        boxes: limits after the step.
        damping: rows that are added to the unknowns.
    """

    arrow: ArrowStep
    values: Pair
    boxes: tuple[Limits, Limits]
    damping: Pair

    def run(self) -> Pair:
        """The unknowns after the step."""
        present = self.values
        held = (self.arrow.shared_held, self.arrow.own_held)
        for _ in range(MOST_SETS):
            wanted = self._free_step(present, held)
            clipped = (self.boxes[0].clipped(wanted[0]), self.boxes[1].clipped(wanted[1]))
            cut = (clipped[0] != wanted[0], clipped[1] != wanted[1])
            if not np.any(cut[0]) and not np.any(cut[1]):
                present = wanted
                pulled = self._pulled_back(present, held)
                if pulled is None:
                    break
                held = _without(held, *pulled)
                continue
            if self._sum(clipped) < self._sum(present):
                present = clipped
            else:
                # Only as far as the first end on the way, up to which the sum falls.
                present, cut = self._to_first_end(present, wanted)
            held = (held[0] | cut[0], held[1] | cut[1])
        return present

    def _free_step(self, present: Pair, held: Held) -> Pair:
        """Unknowns where the sum is least if some of them stay where they are, whatever the bounds of the rest."""
        changes = self._changes(present)
        given = (np.where(held[0], changes[0], 0.0), np.where(held[1], changes[1], 0.0))
        steps = self.arrow.with_changes(*given, *held).step(*self.damping)
        return (
            np.where(held[0], present[0], self.values[0] + steps[0]),
            np.where(held[1], present[1], self.values[1] + steps[1]),
        )

    def _pulled_back(self, present: Pair, held: Held) -> tuple[int, tuple[np.signedinteger, ...]] | None:
        """Place of the held unknown that the sum pulls back from its end most; None where the sum pulls none back."""
        changes = self._changes(present)
        gradients = self.arrow.gradient(*changes)
        strongest = 0.0
        place = None
        for which in range(2):
            damping = self.damping[which]
            gradient = gradients[which] + damping**2 * changes[which]
            back = held[which] & ~self.boxes[which].held(present[which], gradient)
            pull = np.where(back, np.abs(gradient) / damping, 0.0)
            if pull.size and pull.max() > strongest:
                strongest = float(pull.max())
                place = (which, np.unravel_index(int(np.argmax(pull)), pull.shape))
        return place

    def _to_first_end(self, present: Pair, wanted: Pair) -> tuple[Pair, Held]:
        """Unknowns on the way to wanted ones where the first unknown meets its end, and which unknowns meet theirs."""
        shares = []
        for box, start, end in zip(self.boxes, present, wanted, strict=True):
            ends = np.where(end > start, box.upper, box.lower)
            beyond = (end > box.upper) | (end < box.lower)
            share = np.full(start.shape, np.inf)
            np.divide(ends - start, end - start, out=share, where=beyond)
            shares.append(share)
        first = min(float(share.min(initial=np.inf)) for share in shares)
        met = (shares[0] <= first, shares[1] <= first)
        reached = tuple(
            box.clipped(np.where(at_end, end, start + first * (end - start)))
            for box, start, end, at_end in zip(self.boxes, present, wanted, met, strict=True)
        )
        return (reached[0], reached[1]), met

    def _sum(self, values: Pair) -> float:
        """Change of half the damped sum of squares."""
        changes = self._changes(values)
        damped = sum(np.sum((rows * change) ** 2) for rows, change in zip(self.damping, changes, strict=True))
        return float(damped) / 2 - self.arrow.decrease(*changes)

    def _changes(self, values: Pair) -> Pair:
        return values[0] - self.values[0], values[1] - self.values[1]


@dataclass
class _Search(Generic[StateType]):
    """State of the search, which changes from one step to the next.

    Attributes:
        shared: shape (n,).
        own: unknowns of the blocks, shape (blocks, k).
        state: what the problem knows there.
        cost: half the sum of all that residuals and priors cost.
        damping: relative to the squares of the columns.
        growth: factor on the damping where the next step fails.
        along: damping of steps along kinks.
        beyond: the state on the other side of a kink that steps from here have met; None where they met none.
        shared_scale: largest norms of the columns so far, shape (n,).
        own_scale: largest norms of the columns of the blocks' unknowns so far, shape (k,).
    """

    shared: FloatArray
    own: FloatArray
    state: StateType
    cost: float
    shared_scale: FloatArray
    own_scale: FloatArray
    damping: float = FIRST_DAMPING
    growth: float = 2.0
    along: float = FIRST_DAMPING
    beyond: StateType | None = None

    @property
    def scales(self) -> Pair:
        """Scales of the unknowns; what no datum sees has the scale 1."""
        shared = np.where(self.shared_scale > 0, self.shared_scale, 1.0)
        return shared, np.where(self.own_scale > 0, self.own_scale, 1.0)

    def take(self, shared: FloatArray, own: FloatArray, state: StateType, cost: float) -> None:
        """Go on from another state."""
        self.shared, self.own, self.state, self.cost = shared, own, state, cost
        self.growth = 2.0


@dataclass(frozen=True)
class ArrowFit(Generic[StateType]):
    """A fit to be made.

    Attributes:
        problem: its residuals.
        shared: limits of the shared unknowns, each entry of shape (n,).
        own: limits of the unknowns of the blocks, each of shape (k,), the same for all blocks.
        loss: what residuals cost.
        kinked: blocks whose derivatives jump between two states, shape (blocks,); by default none.
    """

    problem: BlockResiduals[StateType]
    shared: Limits
    own: Limits
    loss: Loss = field(default_factory=Loss)
    kinked: Callable[[StateType, StateType], npt.NDArray[np.bool_]] | None = None

    def run(
        self,
        shared: FloatArray,
        own: FloatArray,
        state: StateType,
        progress: Callable[[int, float], None] | None = None,
    ) -> Fit[StateType]:
        """Lessen the misfit from a start within the bounds.

        Args:
            shared: shared unknowns, shape (n,).
            own: unknowns of the blocks, shape (blocks, k).
            state: what the problem knows there.
            progress: told the number of steps and the present cost.
        """
        n, k = len(shared), own.shape[1]
        search = _Search(shared, own, state, self._cost(shared, own, state), np.zeros(n), np.zeros(k))
        outcome = FitOutcome.MAX_ITERATIONS
        tried = 0
        arrow = self.linear(search.shared, search.own, search.state)
        self._rescale(search, arrow)
        while tried < MOST_ITERATIONS:
            if progress is not None:
                progress(tried, search.cost)
            tried += 1
            ended = self._try_step(search, arrow)
            if ended is None:
                arrow = self.linear(search.shared, search.own, search.state)
                self._rescale(search, arrow)
            elif isinstance(ended, FitOutcome):
                outcome = ended
                break
        return Fit(search.shared, search.own, search.state, search.cost, tried, outcome, search.beyond)

    def linear(self, shared: FloatArray, own: FloatArray, state: StateType) -> ArrowStep:
        """The problem in the changes of the unknowns, its rows weighted by the loss."""
        by_shared, by_own = self.problem.jacobians(state)
        roots = np.sqrt(self.loss.weights(state.residual))
        residual = roots * state.residual
        by_shared = roots[:, None] * by_shared
        by_own = roots[:, None] * by_own
        shared_prior = (self.shared.weight, self.shared.residual(shared))
        own_prior = (self.own.weight, self.own.residual(own))
        free = ArrowStep(
            residual,
            by_shared,
            by_own,
            self.problem.offsets,
            shared_prior,
            own_prior,
            np.zeros(shared.shape, dtype=bool),
            np.zeros(own.shape, dtype=bool),
        )
        shared_gradient, own_gradient = free.gradient(np.zeros_like(shared), np.zeros_like(own))
        shared_held = self.shared.held(shared, shared_gradient)
        own_held = self.own.held(own, own_gradient)
        return replace(free, shared_held=shared_held, own_held=own_held)

    def _cost(self, shared: FloatArray, own: FloatArray, state: StateType) -> float:
        priors = np.concatenate([self.shared.residual(shared), self.own.residual(own).ravel()])
        return self.loss.cost(state.residual) + float(priors @ priors) / 2

    def _rescale(self, search: _Search[StateType], arrow: ArrowStep) -> None:
        """Let the scales of the unknowns grow with the columns; what no datum sees has the scale 1."""
        shared = np.sqrt(np.sum(arrow.by_shared**2, axis=0) + arrow.shared_prior[0] ** 2)
        search.shared_scale = np.maximum(search.shared_scale, shared)
        if search.own.size:
            blocks = len(search.own)
            own = np.sqrt(np.sum(arrow.by_own**2, axis=0) / blocks + arrow.own_prior[0] ** 2)
            search.own_scale = np.maximum(search.own_scale, own)

    def _try_step(self, search: _Search[StateType], arrow: ArrowStep) -> FitOutcome | bool | None:
        """Try a step; None where it was taken, an outcome where the search ends, False where it failed."""
        shared, own = self._stepped(search, arrow, search.damping)
        predicted = arrow.decrease(shared - search.shared, own - search.own)
        if predicted <= self._least_decrease(search):
            return self._ended(search, arrow)
        state = self.problem.at(shared, own, search.state)
        if state is not None and np.all(np.isfinite(state.residual)):
            cost = self._cost(shared, own, state)
            gain = (search.cost - cost) / predicted
            if gain > SUFFICIENT:
                search.take(shared, own, state, cost)
                # A kink that was met before is left behind.
                search.beyond = None
                search.damping *= max(0.1, 1 - (2 * gain - 1) ** 3)
                search.damping = max(search.damping, 1e-15)
                return None
            if self.kinked is not None:
                blocks = self.kinked(search.state, state)
                ended = self._try_along(search, arrow, (shared, own), state, blocks) if np.any(blocks) else False
                if ended is not False:
                    return ended
        elif search.damping < BACK_OFF * LARGEST_DAMPING:
            # Far beyond what the linear model can say: come back in fewer tries.
            search.damping *= BACK_OFF
        return self._more_damping(search, arrow)

    def _try_along(
        self,
        search: _Search[StateType],
        arrow: ArrowStep,
        there: Pair,
        beyond: StateType,
        blocks: npt.NDArray[np.bool_],
    ) -> FitOutcome | bool | None:
        """Try a step along kinks, of which a state is known on the other side; as :meth:`_try_step`.

        Args:
            search: the search, on this side.
            arrow: the linear problem on this side.
            there: unknowns on the other side.
            beyond: the state on the other side.
            blocks: which blocks have a kink in between, shape (blocks,).
        """
        search.beyond = beyond
        other = self.linear(*there, beyond)
        changes = (there[0] - search.shared, there[1] - search.own)
        kinked = arrow.along_kinks(other, changes, search.scales, blocks)
        shared, own = self._stepped(search, kinked, HARDLY_DAMPED)
        if arrow.decrease(shared - search.shared, own - search.own) <= max(ROUNDING, self._least_decrease(search)):
            back = (shared - there[0], own - there[1])
            parted = self._cost(*there, beyond) - other.decrease(*back) - search.cost
            rises = -sum(float(np.sum(part * change)) for part, change in zip(other.gradient(*back), back, strict=True))
            allowed = MEETING * (1.0 + search.cost)
            if arrow.decrease(*changes) > allowed:
                # From afar the linear models would meet where no kink is: come nearer, in fewer tries.
                search.damping *= BACK_OFF
                return False
            return FitOutcome.AT_KINK if abs(parted) <= allowed and rises >= 0.0 else False
        shared, own = self._stepped(search, kinked, search.along)
        predicted = arrow.decrease(shared - search.shared, own - search.own)
        state = self.problem.at(shared, own, search.state)
        cost = np.inf if state is None else self._cost(shared, own, state)
        # What is not finite is no decrease.
        if state is None or not search.cost - cost > SUFFICIENT * predicted:
            search.along *= BACK_OFF
            return False
        search.take(shared, own, state, cost)
        search.along = max(search.along / BACK_OFF, 1e-15)
        return None

    def _stepped(self, search: _Search[StateType], arrow: ArrowStep, damping: float) -> tuple[FloatArray, FloatArray]:
        """Shared unknowns, (n,), and the blocks' unknowns, (blocks, k), after the step with the least damped sum."""
        shared_scale, own_scale = search.scales
        root = np.sqrt(damping)
        step = BoundedStep(
            arrow,
            (search.shared, search.own),
            (self.shared.within_step(search.shared), self.own.within_step(search.own)),
            (root * shared_scale, root * own_scale),
        )
        return step.run()

    def _least_decrease(self, search: _Search[StateType]) -> float:
        """Predicted decrease below which there is nothing left to gain."""
        return max(DECREASE, RELATIVE_DECREASE * search.cost)

    def _more_damping(self, search: _Search[StateType], arrow: ArrowStep) -> FitOutcome | bool:
        """Let the next step be shorter; an outcome where it would be too short to change anything."""
        search.damping *= search.growth
        search.growth *= 2
        if search.damping > LARGEST_DAMPING:
            return self._ended(search, arrow)
        return False

    def _ended(self, search: _Search[StateType], arrow: ArrowStep) -> FitOutcome:
        """How a search ends whose steps bring nothing: by what a step within the bounds would bring."""
        shared, own = self._stepped(search, arrow, HARDLY_DAMPED)
        left = arrow.decrease(shared - search.shared, own - search.own)
        bound = max(ROUNDING, self._least_decrease(search))
        return FitOutcome.CONVERGED if left <= bound else FitOutcome.STALLED
