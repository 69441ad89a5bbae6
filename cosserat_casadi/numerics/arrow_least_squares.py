"""Nonlinear least squares with unknowns that all blocks of data share, and unknowns of single blocks ("own" here).

A Levenberg–Marquardt method with bounds. The Jacobian is a block arrow: rows of block b see the shared unknowns and the
block's. Unknowns of the blocks are eliminated block by block with orthogonal transformations, which is the Schur
complement of the normal equations without their squared condition; the remaining rows are dense in the shared unknowns.
J. J. Moré, *The Levenberg–Marquardt algorithm*, Lecture Notes in Mathematics 630, 1978 (scaling by the columns); H. B.
Nielsen, *Damping parameter in Marquardt's method*, DTU 1999 (damping); C. Kanzow, N. Yamashita, M. Fukushima, J.
Comput. Appl. Math. 172, 2004 (projection on bounds).

Where derivatives jump between a state and the one that a step leads to, a step that fails is followed by one along the
kink. Where none along it lessens the sum, and both sides rise from it, the sum is least. A kink is a surface in the
unknowns over which residuals are continuous and derivatives jump. Two states on either side of a kink have linear
models r₁ + J₁ (x − x₁) and r₂ + J₂ (x − x₂), which are equal on it: so J₁ − J₂ = u gᵀ has rank one, g is normal to the
kink, and uᵀ of the difference of both models is zero there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import astuple, dataclass, field, replace
from enum import Enum
from functools import cached_property
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.robust_loss import Loss

WEIGHT = 1e6
"""Weight of the row that keeps a step on a kink, relative to the rows of the block."""

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

    def jacobian(self, state: StateType) -> FloatArray:
        """Derivatives of each residual with the shared unknowns, then with those of its block, shape (m, n + k)."""


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

    def with_blocks(self, own: Limits, blocks: int) -> Limits:
        """Limits of shared unknowns, followed by limits of the unknowns of each block."""
        pairs = zip(astuple(self), astuple(own), strict=True)
        return Limits(*(np.concatenate([of_shared, np.tile(of_own, blocks)]) for of_shared, of_own in pairs))

    def clipped(self, values: FloatArray) -> FloatArray:
        """Values brought into their range."""
        return np.clip(values, self.lower, self.upper)

    def expected(self, values: FloatArray) -> FloatArray:
        """Expected values within their bounds; these values, within the bounds too, where nothing is expected."""
        return self.clipped(np.where(self.weight > 0.0, self.mean, values))

    def within_step(self, values: FloatArray) -> Limits:
        """Bounds and priors, narrowed to one step from these values."""
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

    All N = n + blocks · k unknowns stand in one row: shared unknowns, then those of one block after the other.

    Attributes:
        residual: shape (m,).
        derivatives: of each row with the shared unknowns, then with those of its block, shape (m, n + k).
        offsets: where the rows of each block begin, and at the end their number, shape (blocks + 1,).
        shared: number n of shared unknowns.
        weights: of the priors, shape (N,).
        prior_residual: residuals of the priors, shape (N,).
        held: unknowns that must not change, shape (N,).
    """

    residual: FloatArray
    derivatives: FloatArray
    offsets: npt.NDArray[np.int64]
    shared: int
    weights: FloatArray
    prior_residual: FloatArray
    held: npt.NDArray[np.bool_]

    @property
    def own(self) -> int:
        """Number k of unknowns of each block."""
        return int(self.derivatives.shape[1]) - self.shared

    def of_blocks(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Values of the unknowns of each block, shape (blocks, k), from values of all unknowns, shape (N,)."""
        return values[self.shared :].reshape(len(self.offsets) - 1, self.own)

    @property
    def column_sizes(self) -> FloatArray:
        """Norms of the columns with their priors, of unknowns of blocks the mean over all blocks, shape (N,)."""
        squares = np.sum(self.derivatives**2, axis=0)
        blocks = len(self.offsets) - 1
        of_blocks = np.tile(squares[self.shared :] / blocks, blocks)
        return np.asarray(np.sqrt(np.concatenate([squares[: self.shared], of_blocks]) + self.weights**2))

    @cached_property
    def _triangles(self) -> list[FloatArray]:
        """Triangle of each block, of [its unknowns, shared unknowns, residual], which replaces its rows."""
        n, k = self.shared, self.own
        by_shared = np.where(self.held[:n], 0.0, self.derivatives[:, :n])
        rows = np.hstack([self.derivatives[:, n:], by_shared, self.residual[:, None]])
        if not k:
            return [_triangle(rows)]
        triangles = []
        priors = zip(self.of_blocks(self.weights), self.of_blocks(self.prior_residual), strict=True)
        for block, (weights, prior_residual) in enumerate(priors):
            data = rows[self.offsets[block] : self.offsets[block + 1]]
            held = self.of_blocks(self.held)[block]
            data[:, :k][:, held] = 0.0
            prior = np.zeros((k, k + n + 1))
            prior[:, :k] = np.diag(np.where(held, 0.0, weights))
            prior[:, -1] = prior_residual
            triangles.append(_triangle(np.vstack([data, prior])))
        return triangles

    def eliminated(self, damping: FloatArray) -> tuple[FloatArray, list[FloatArray]]:
        """The remaining rows of [shared, residual], and for each block the rows from which its unknowns follow.

        Args:
            damping: rows that are added to the unknowns, of which those of the blocks count here, shape (N,).
        """
        n, k = self.shared, self.own
        if not k:
            return np.vstack(self._triangles), []
        left = []
        eliminations = []
        for triangle, of_block in zip(self._triangles, self.of_blocks(damping), strict=True):
            # What no row sees, or a bound holds, would take a row of the others with it: it gets one of its own.
            unseen = ~np.any(triangle[:, :k], axis=0)
            added = np.zeros((k, k + n + 1))
            added[:, :k] = np.diag(np.where(unseen, 1.0, of_block))
            whole = _triangle(np.vstack([triangle, added]))
            eliminations.append(whole[:k])
            left.append(whole[k:, k:])
        return np.vstack(left), eliminations

    def step(self, damping: FloatArray) -> FloatArray:
        """The change of the unknowns with the least damped sum, shape (N,).

        Args:
            damping: rows that are added to the unknowns, shape (N,), positive.
        """
        n, k = self.shared, self.own
        left, eliminations = self.eliminated(damping)
        free_weights = np.where(self.held, 0.0, self.weights)[:n]
        rows = np.vstack([left[:, :n], np.diag(free_weights), np.diag(damping[:n])])
        right = np.concatenate([left[:, n], self.prior_residual[:n], np.zeros(n)])
        # Unknowns differ by many orders of magnitude: unscaled, the small columns would pass for rounding.
        sizes = np.linalg.norm(rows, axis=0)
        changes = [-np.linalg.lstsq(rows / sizes, right, rcond=None)[0] / sizes]
        for elimination in eliminations:
            known = elimination[:, k : k + n] @ changes[0] + elimination[:, -1]
            changes.append(-np.linalg.solve(elimination[:, :k], known))
        return np.concatenate(changes)

    def gradient(self, changes: FloatArray) -> FloatArray:
        """Gradient of half the sum of squares where the unknowns have changed by these amounts, shape (N,)."""
        by_row = (self.residual + self._change(changes))[:, None] * self.derivatives
        gradient = self.weights * (self.prior_residual + self.weights * changes)
        gradient[: self.shared] += by_row[:, : self.shared].sum(axis=0)
        if self.own:
            gradient[self.shared :] += np.add.reduceat(by_row[:, self.shared :], self.offsets[:-1], axis=0).ravel()
        return gradient

    def with_changes(self, changes: FloatArray, held: npt.NDArray[np.bool_]) -> ArrowStep:
        """The problem after some unknowns have changed, and are held there.

        Args:
            changes: of the unknowns, shape (N,); zero for free unknowns.
            held: unknowns that are held, shape (N,).
        """
        return replace(
            self,
            residual=self.residual + self._change(changes),
            prior_residual=self.prior_residual + self.weights * changes,
            held=held,
        )

    def along_kinks(
        self, other: ArrowStep, changes: FloatArray, scales: FloatArray, blocks: npt.NDArray[np.bool_]
    ) -> ArrowStep:
        """The problem with a row for each kink that parts it from another one, which keeps steps on the kink.

        Args:
            other: the problem on the other side of the kinks.
            changes: changes of the unknowns, from here to there, shape (N,).
            scales: sizes of the derivatives by the unknowns, shape (N,).
            blocks: whether a block has a kink in between, shape (blocks,).
        """
        rows = []
        sizes = scales[: self.derivatives.shape[1]]
        for block, is_kinked in enumerate(blocks):
            span = slice(self.offsets[block], self.offsets[block + 1])
            here, there = (np.column_stack([side.residual[span], side.derivatives[span]]) for side in (self, other))
            if is_kinked:
                change = np.concatenate([changes[: self.shared], self.of_blocks(changes)[block]])
                here = np.vstack([here, kink_row(here, there, change, sizes)])
            rows.append(here)
        whole = np.vstack(rows)
        offsets = np.cumsum([0, *map(len, rows)])
        return replace(self, residual=whole[:, 0], derivatives=whole[:, 1:], offsets=offsets)

    def decrease(self, changes: FloatArray) -> float:
        """How much half the sum of squares falls, by the linear model, where the unknowns change."""
        of_data = _decrease(self.residual, self._change(changes))
        return of_data + _decrease(self.prior_residual, self.weights * changes)

    def _change(self, changes: FloatArray) -> FloatArray:
        """Change of the residual by the linear model, shape (m,)."""
        n = self.shared
        of_rows = np.repeat(self.of_blocks(changes), np.diff(self.offsets), axis=0)
        return np.asarray(self.derivatives[:, :n] @ changes[:n] + np.sum(self.derivatives[:, n:] * of_rows, axis=1))


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


@dataclass
class BoundedStep:
    """The step within bounds that lessens a damped linear least-squares problem most.

    Unknowns that a step would take beyond an end stop there, and the others go where the sum is least with those at
    their ends: cut off alone, they would not go along. One that would rather come back from its end is let go. The sum
    falls with each such set of unknowns. P. B. Stark, R. L. Parker, *Bounded-variable least-squares*, Computational
    Statistics 10, 1995; J. Nocedal, S. J. Wright, *Numerical Optimization*, Springer 2006, section 16.5.

    Attributes:
        arrow: the problem in the changes of the unknowns.
        values: the unknowns now, shape (N,).
        box: limits after the step.
        damping: rows that are added to the unknowns, shape (N,).
    """

    arrow: ArrowStep
    values: FloatArray
    box: Limits
    damping: FloatArray

    def run(self) -> FloatArray:
        """The unknowns after the step, shape (N,)."""
        present = self.values
        held = self.arrow.held
        for _ in range(MOST_SETS):
            wanted = self._free_step(present, held)
            clipped = self.box.clipped(wanted)
            cut = clipped != wanted
            if not np.any(cut):
                present = wanted
                pulled = self._pulled_back(present, held)
                if pulled is None:
                    break
                held = held & (np.arange(len(held)) != pulled)
                continue
            if self._sum(clipped) < self._sum(present):
                present = clipped
            else:
                # Only as far as the first end on the way, up to which the sum falls.
                present, cut = self._to_first_end(present, wanted)
            held = held | cut
        return present

    def _free_step(self, present: FloatArray, held: npt.NDArray[np.bool_]) -> FloatArray:
        """Unknowns where the sum is least if some of them stay where they are, whatever the bounds of the rest."""
        given = np.where(held, present - self.values, 0.0)
        step = self.arrow.with_changes(given, held).step(self.damping)
        return np.where(held, present, self.values + step)

    def _pulled_back(self, present: FloatArray, held: npt.NDArray[np.bool_]) -> int | None:
        """Place of the held unknown that the sum pulls back from its end most; None where the sum pulls none back."""
        changes = present - self.values
        gradient = self.arrow.gradient(changes) + self.damping**2 * changes
        back = held & ~self.box.held(present, gradient)
        pull = np.where(back, np.abs(gradient) / self.damping, 0.0)
        strongest = int(np.argmax(pull))
        return strongest if pull[strongest] > 0.0 else None

    def _to_first_end(self, present: FloatArray, wanted: FloatArray) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
        """Unknowns on the way to wanted ones where the first unknown meets its end, and which unknowns meet theirs."""
        ends = np.where(wanted > present, self.box.upper, self.box.lower)
        beyond = (wanted > self.box.upper) | (wanted < self.box.lower)
        shares = np.full(present.shape, np.inf)
        np.divide(ends - present, wanted - present, out=shares, where=beyond)
        first = float(shares.min(initial=np.inf))
        met = shares <= first
        reached = np.where(met, wanted, present + first * (wanted - present))
        return self.box.clipped(reached), met

    def _sum(self, values: FloatArray) -> float:
        """Change of half the damped sum of squares."""
        changes = values - self.values
        damped = self.damping * changes
        return float(damped @ damped) / 2 - self.arrow.decrease(changes)


@dataclass
class _Search(Generic[StateType]):
    """State of the search, which changes from one step to the next.

    Attributes:
        values: the unknowns, shape (N,).
        state: what the problem knows there.
        cost: half the sum of all that residuals and priors cost.
        sizes: largest norms of the columns so far, shape (N,).
        damping: relative to the squares of the columns.
        growth: factor on the damping where the next step fails.
        along: damping of steps along kinks.
        beyond: the state on the other side of a kink that steps from here have met; None where they met none.
    """

    values: FloatArray
    state: StateType
    cost: float
    sizes: FloatArray
    damping: float = FIRST_DAMPING
    growth: float = 2.0
    along: float = FIRST_DAMPING
    beyond: StateType | None = None

    @property
    def scales(self) -> FloatArray:
        """Scales of the unknowns, shape (N,); what no datum sees has the scale 1."""
        return np.where(self.sizes > 0, self.sizes, 1.0)

    def take(self, values: FloatArray, state: StateType, cost: float) -> None:
        """Go on from another state."""
        self.values, self.state, self.cost = values, state, cost
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
        values = np.concatenate([shared, own.ravel()])
        search = _Search(values, state, self._cost(values, state), np.zeros(len(values)))
        outcome = FitOutcome.MAX_ITERATIONS
        tried = 0
        arrow = self._linearised(search)
        while tried < MOST_ITERATIONS:
            if progress is not None:
                progress(tried, search.cost)
            tried += 1
            ended = self._try_step(search, arrow)
            if ended is None:
                arrow = self._linearised(search)
            elif isinstance(ended, FitOutcome):
                outcome = ended
                break
        return Fit(*self._parted(search.values), search.state, search.cost, tried, outcome, search.beyond)

    def linear(self, shared: FloatArray, own: FloatArray, state: StateType) -> ArrowStep:
        """The problem in the changes of the unknowns, its rows weighted by the loss."""
        roots = np.sqrt(self.loss.weights(state.residual))
        values = np.concatenate([shared, own.ravel()])
        free = ArrowStep(
            residual=roots * state.residual,
            derivatives=roots[:, None] * self.problem.jacobian(state),
            offsets=self.problem.offsets,
            shared=len(shared),
            weights=self._limits.weight,
            prior_residual=self._limits.residual(values),
            held=np.zeros(values.shape, dtype=bool),
        )
        return replace(free, held=self._limits.held(values, free.gradient(np.zeros_like(values))))

    @cached_property
    def _limits(self) -> Limits:
        """Limits of all unknowns, each entry of shape (N,)."""
        return self.shared.with_blocks(self.own, len(self.problem.offsets) - 1)

    def _parted(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Shared unknowns, shape (n,), and unknowns of the blocks, shape (blocks, k)."""
        n = len(self.shared.lower)
        return values[:n], values[n:].reshape(len(self.problem.offsets) - 1, len(self.own.lower))

    def _cost(self, values: FloatArray, state: StateType) -> float:
        priors = self._limits.residual(values)
        return self.loss.cost(state.residual) + float(priors @ priors) / 2

    def _linearised(self, search: _Search[StateType]) -> ArrowStep:
        """The problem in the changes of the unknowns; the scales of the search grow with its columns."""
        arrow = self.linear(*self._parted(search.values), search.state)
        search.sizes = np.maximum(search.sizes, arrow.column_sizes)
        return arrow

    def _try_step(self, search: _Search[StateType], arrow: ArrowStep) -> FitOutcome | bool | None:
        """Try a step; None where it was taken, an outcome where the search ends, False where it failed."""
        values = self._stepped(search, arrow, search.damping)
        predicted = arrow.decrease(values - search.values)
        if predicted <= self._least_decrease(search):
            return self._ended(search, arrow)
        state = self.problem.at(*self._parted(values), search.state)
        if state is not None and np.all(np.isfinite(state.residual)):
            cost = self._cost(values, state)
            gain = (search.cost - cost) / predicted
            if gain > SUFFICIENT:
                search.take(values, state, cost)
                # A kink that was met before is left behind.
                search.beyond = None
                search.damping *= max(0.1, 1 - (2 * gain - 1) ** 3)
                search.damping = max(search.damping, 1e-15)
                return None
            if self.kinked is not None:
                blocks = self.kinked(search.state, state)
                ended = self._try_along(search, arrow, values, state, blocks) if np.any(blocks) else False
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
        there: FloatArray,
        beyond: StateType,
        blocks: npt.NDArray[np.bool_],
    ) -> FitOutcome | bool | None:
        """Try a step along kinks, of which a state is known on the other side; as :meth:`_try_step`.

        Args:
            search: the search, on this side.
            arrow: the linear problem on this side.
            there: unknowns on the other side, shape (N,).
            beyond: the state on the other side.
            blocks: which blocks have a kink in between, shape (blocks,).
        """
        search.beyond = beyond
        other = self.linear(*self._parted(there), beyond)
        changes = there - search.values
        kinked = arrow.along_kinks(other, changes, search.scales, blocks)
        values = self._stepped(search, kinked, HARDLY_DAMPED)
        if arrow.decrease(values - search.values) <= max(ROUNDING, self._least_decrease(search)):
            back = values - there
            parted = self._cost(there, beyond) - other.decrease(back) - search.cost
            rises = -float(other.gradient(back) @ back)
            allowed = MEETING * (1.0 + search.cost)
            if arrow.decrease(changes) > allowed:
                # From afar the linear models would meet where no kink is: come nearer, in fewer tries.
                search.damping *= BACK_OFF
                return False
            return FitOutcome.AT_KINK if abs(parted) <= allowed and rises >= 0.0 else False
        values = self._stepped(search, kinked, search.along)
        predicted = arrow.decrease(values - search.values)
        state = self.problem.at(*self._parted(values), search.state)
        cost = np.inf if state is None else self._cost(values, state)
        # What is not finite is no decrease.
        if state is None or not search.cost - cost > SUFFICIENT * predicted:
            search.along *= BACK_OFF
            return False
        search.take(values, state, cost)
        search.along = max(search.along / BACK_OFF, 1e-15)
        return None

    def _stepped(self, search: _Search[StateType], arrow: ArrowStep, damping: float) -> FloatArray:
        """The unknowns after the step with the least damped sum, shape (N,)."""
        box = self._limits.within_step(search.values)
        return BoundedStep(arrow, search.values, box, np.sqrt(damping) * search.scales).run()

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
        values = self._stepped(search, arrow, HARDLY_DAMPED)
        left = arrow.decrease(values - search.values)
        bound = max(ROUNDING, self._least_decrease(search))
        return FitOutcome.CONVERGED if left <= bound else FitOutcome.STALLED


def kink_row(here: FloatArray, there: FloatArray, change: FloatArray, scales: FloatArray) -> FloatArray:
    """The row of a linear model that is zero on the kink between two states, shape (1, 1 + n).

    Args:
        here: residual and derivatives at one state, shape (m, 1 + n).
        there: residual and derivatives at the other state, shape (m, 1 + n).
        change: change of the unknowns, from here to there, shape (n,).
        scales: sizes of the derivatives by each unknown, shape (n,).
    """
    jump = here - there
    jump[:, 0] += there[:, 1:] @ change
    directions, sizes, _ = np.linalg.svd(jump[:, 1:] / scales)
    row = directions[:, :1].T @ jump
    if sizes[0] == 0.0:
        return np.zeros_like(row)
    return np.asarray(WEIGHT * float(np.linalg.norm(here[:, 1:] / scales)) / sizes[0] * row)
