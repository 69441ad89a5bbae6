"""Nonlinear least squares with unknowns shared by all blocks of data, and unknowns of single blocks ("own" here).

A Levenberg–Marquardt method with bounds. The Jacobian is a block arrow: rows of block b see the shared unknowns and the
block's. Unknowns of the blocks are eliminated block by block with orthogonal transformations, which is the Schur
complement of the normal equations without their squared condition; the remaining rows are dense in the shared unknowns.
J. J. Moré, *The Levenberg–Marquardt algorithm*, Lecture Notes in Mathematics 630, 1978 (scaling by the columns); H. B.
Nielsen, *Damping parameter in Marquardt's method*, DTU 1999 (damping); C. Kanzow, N. Yamashita, M. Fukushima, J.
Comput. Appl. Math. 172, 2004 (projection on bounds).

A kink is a surface of unknowns where residuals are continuous but derivatives jump. If a step across a kink fails, a
step along the kink follows. If no step along it reduces the sum, and the sum rises to both sides, it is a minimum. Two
states on either side of a kink have linear models r₁ + J₁ (x − x₁) and r₂ + J₂ (x − x₂), which are equal on it: so
J₁ − J₂ = u gᵀ has rank one, g is normal to the kink, and uᵀ times the difference of both models is zero there.
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
"""Weight of the row that keeps a step on a kink, over the rows of the block."""

MOST_ITERATIONS = 200
"""Most steps that are tried."""

DECREASE = 1e-13
"""Predicted decrease of half the sum of squares at which to stop: about the square of a step in standard deviations."""

RELATIVE_DECREASE = 1e-14
"""Predicted decrease over half the sum of squares at which to stop."""

FIRST_DAMPING = 1e-3
"""Damping of the first step relative to the squares of the columns."""

MOST_RATIO = 1.5
"""Largest ratio by which one step may change a positive unknown, as a linear model could make a modulus vanish."""

BACK_OFF = 10.0
"""Growth factor of the damping after a step at which the evaluation fails."""

HARDLY_DAMPED = 1e-12
"""Damping so small that it changes a step only in directions on which no datum depends."""

LARGEST_DAMPING = 1e12
"""Damping beyond which a step is too small to change anything."""

SUFFICIENT = 1e-4
"""Least share of the predicted decrease for a step to be accepted."""

MOST_SETS = 100
"""Most active sets of bounds that one step tries; the sum of squares falls with each set."""

ROUNDING = 1e-9
"""Predicted decrease of half the sum of squares, squared standard deviations, that evaluation errors may hide."""

MEETING = 1e-4
"""Difference of both sides of a kink, relative to one more than half the sum of squares, up to which it is known."""


class FitState(Protocol):
    """Residuals of a problem at some unknowns, with the data that its Jacobian needs.

    Attributes:
        residual: differences in standard deviations, block by block, shape (m,).
    """

    @property
    def residual(self) -> FloatArray:
        """Differences in standard deviations, shape (m,)."""


StateType = TypeVar("StateType", bound=FitState)


class BlockResiduals(Protocol[StateType]):
    """Residuals of blocks.

    Attributes:
        offsets: first row of each block, followed by the number of rows, shape (blocks + 1,).
    """

    @property
    def offsets(self) -> npt.NDArray[np.int64]:
        """First row of each block, followed by the number of rows, shape (blocks + 1,)."""

    def at(self, shared: FloatArray, own: FloatArray, near: StateType) -> StateType | None:
        """Evaluate the state at shared unknowns, (n,), and unknowns of blocks, (blocks, k); None if that fails."""

    def jacobian(self, state: StateType) -> FloatArray:
        """Derivatives of each residual by the shared unknowns, then by those of its block, shape (m, n + k)."""


@dataclass(frozen=True)
class Limits:
    """Bounds and priors of some unknowns.

    Attributes:
        lower: least values, shape (n,).
        upper: largest values, shape (n,).
        mean: expected values, shape (n,); arbitrary without a prior.
        weight: reciprocal of the standard deviation of the prior, shape (n,); 0 without a prior.
        ratios: whether an unknown is positive and changes by ratios, like a modulus, so that one step changes it by at
            most MOST_RATIO; shape (n,).
    """

    lower: FloatArray
    upper: FloatArray
    mean: FloatArray
    weight: FloatArray
    ratios: npt.NDArray[np.bool_]

    def with_blocks(self, own: Limits, blocks: int) -> Limits:
        """Append limits of the unknowns of each block to those of the shared unknowns."""
        pairs = zip(astuple(self), astuple(own), strict=True)
        return Limits(*(np.concatenate([of_shared, np.tile(of_own, blocks)]) for of_shared, of_own in pairs))

    def clipped(self, values: FloatArray) -> FloatArray:
        """Clip values to their range."""
        return np.clip(values, self.lower, self.upper)

    def expected(self, values: FloatArray) -> FloatArray:
        """Expected values, or ``values`` without a prior, both clipped to the bounds."""
        return self.clipped(np.where(self.weight > 0.0, self.mean, values))

    def within_step(self, values: FloatArray) -> Limits:
        """Limits with bounds narrowed to one step from these values."""
        lower = np.where(self.ratios, values / MOST_RATIO, -np.inf)
        upper = np.where(self.ratios, values * MOST_RATIO, np.inf)
        return replace(self, lower=np.maximum(lower, self.lower), upper=np.minimum(upper, self.upper))

    def residual(self, values: FloatArray) -> FloatArray:
        """Differences from the expected values, in standard deviations, shape as the values."""
        return (values - self.mean) * self.weight

    def at_end(self, values: FloatArray) -> npt.NDArray[np.bool_]:
        """Mask of the unknowns at an end of their range, shape as the values."""
        return (values <= self.lower) | (values >= self.upper)

    def held(self, values: FloatArray, gradient: FloatArray) -> npt.NDArray[np.bool_]:
        """Mask of the unknowns at a bound that the descent would cross, shape as the values."""
        at_lower = (values <= self.lower) & (gradient > 0)
        at_upper = (values >= self.upper) & (gradient < 0)
        return at_lower | at_upper


class FitOutcome(Enum):
    """Outcome of a fit."""

    CONVERGED = "No step makes the misfit smaller."
    AT_KINK = "The misfit is least where its derivatives jump."
    MAX_ITERATIONS = "The iterations ran out before the misfit was least."
    STALLED = (
        "No step along which equilibria can be followed makes the misfit smaller, though its gradient is not zero."
    )


@dataclass(frozen=True)
class Fit(Generic[StateType]):
    """Result of a fit.

    Attributes:
        shared: shared unknowns, shape (n,).
        own: unknowns of each block, shape (blocks, k).
        state: state of the problem there.
        cost: half the sum of the costs of residuals and priors.
        iterations: number of steps tried.
        outcome: outcome of the fit.
        beyond: the state on the other side of a kink that steps from here have met; None without a kink.
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

    All N = n + blocks · k unknowns are one vector: shared unknowns, then those of each block in turn.

    Attributes:
        residual: residuals, shape (m,).
        derivatives: derivatives of each row by the shared unknowns, then by those of its block, shape (m, n + k).
        offsets: first row of each block, followed by the number of rows, shape (blocks + 1,).
        shared: number n of shared unknowns.
        weights: weights of the priors, shape (N,).
        prior_residual: residuals of the priors, shape (N,).
        held: mask of the unknowns that must not change, shape (N,).
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
        """Select the unknowns of each block, shape (blocks, k), from all unknowns, shape (N,)."""
        return values[self.shared :].reshape(len(self.offsets) - 1, self.own)

    @property
    def column_sizes(self) -> FloatArray:
        """Norms of the columns with their priors, for unknowns of blocks the mean over all blocks, shape (N,)."""
        squares = np.sum(self.derivatives**2, axis=0)
        blocks = len(self.offsets) - 1
        of_blocks = np.tile(squares[self.shared :] / blocks, blocks)
        return np.asarray(np.sqrt(np.concatenate([squares[: self.shared], of_blocks]) + self.weights**2))

    @cached_property
    def _triangles(self) -> list[FloatArray]:
        """Triangular factor of each block, of [its unknowns, shared unknowns, residual], which replaces its rows."""
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
        """Eliminate the unknowns of blocks; return the rows of [shared, residual], and rows for each block's unknowns.

        Args:
            damping: damping of the unknowns, of which that of the blocks counts here, shape (N,).
        """
        n, k = self.shared, self.own
        if not k:
            return np.vstack(self._triangles), []
        left = []
        eliminations = []
        for triangle, of_block in zip(self._triangles, self.of_blocks(damping), strict=True):
            # Unknowns that no row sees, or that a bound holds, would make the system singular: each gets its own row.
            unseen = ~np.any(triangle[:, :k], axis=0)
            added = np.zeros((k, k + n + 1))
            added[:, :k] = np.diag(np.where(unseen, 1.0, of_block))
            whole = _triangle(np.vstack([triangle, added]))
            eliminations.append(whole[:k])
            left.append(whole[k:, k:])
        return np.vstack(left), eliminations

    def step(self, damping: FloatArray) -> FloatArray:
        """Solve for the change of the unknowns with the least damped sum, shape (N,).

        Args:
            damping: damping of the unknowns, shape (N,), positive.
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
        """Gradient of half the sum of squares after these changes of the unknowns, shape (N,)."""
        by_row = (self.residual + self._change(changes))[:, None] * self.derivatives
        gradient = self.weights * (self.prior_residual + self.weights * changes)
        gradient[: self.shared] += by_row[:, : self.shared].sum(axis=0)
        if self.own:
            gradient[self.shared :] += np.add.reduceat(by_row[:, self.shared :], self.offsets[:-1], axis=0).ravel()
        return gradient

    def with_changes(self, changes: FloatArray, held: npt.NDArray[np.bool_]) -> ArrowStep:
        """Return the problem after some unknowns have changed, and are held there.

        Args:
            changes: changes of the unknowns, shape (N,); zero for free unknowns.
            held: mask of the unknowns that are held, shape (N,).
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
        """Add a row for each kink between this problem and another one, which keeps steps on the kink.

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
        """Decrease of half the sum of squares by changes of the unknowns, in the linear model."""
        of_data = _decrease(self.residual, self._change(changes))
        return of_data + _decrease(self.prior_residual, self.weights * changes)

    def _change(self, changes: FloatArray) -> FloatArray:
        """Change of the residual by the linear model, shape (m,)."""
        n = self.shared
        of_rows = np.repeat(self.of_blocks(changes), np.diff(self.offsets), axis=0)
        return np.asarray(self.derivatives[:, :n] @ changes[:n] + np.sum(self.derivatives[:, n:] * of_rows, axis=1))


def _decrease(residual: FloatArray, change: FloatArray) -> float:
    """Decrease of half the sum of squares of a residual by a change."""
    return -float(change @ (residual + change / 2))


def _triangle(rows: FloatArray) -> FloatArray:
    """Triangular factor R of rows = Q R, with at least as many rows as columns."""
    triangle = np.asarray(np.linalg.qr(rows, mode="r"))
    missing = rows.shape[1] - len(triangle)
    if missing > 0:
        triangle = np.vstack([triangle, np.zeros((missing, rows.shape[1]))])
    return triangle


@dataclass
class BoundedStep:
    """The step within bounds that minimises a damped linear least-squares problem.

    Unknowns that a step would take beyond a bound stop there, and the others minimise the sum for these values, instead
    of being merely clipped. An unknown whose gradient points back from its bound is released. The sum falls with each
    such active set. P. B. Stark, R. L. Parker, *Bounded-variable least-squares*, Computational Statistics 10, 1995;
    J. Nocedal, S. J. Wright, *Numerical Optimization*, Springer 2006, section 16.5.

    Attributes:
        arrow: the problem in the changes of the unknowns.
        values: present unknowns, shape (N,).
        box: bounds of the unknowns after the step.
        damping: damping of the unknowns, shape (N,).
    """

    arrow: ArrowStep
    values: FloatArray
    box: Limits
    damping: FloatArray

    def run(self) -> FloatArray:
        """Compute the unknowns after the step, shape (N,)."""
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
        """Minimise the sum for some held unknowns, without the bounds of the others; return the unknowns."""
        given = np.where(held, present - self.values, 0.0)
        step = self.arrow.with_changes(given, held).step(self.damping)
        return np.where(held, present, self.values + step)

    def _pulled_back(self, present: FloatArray, held: npt.NDArray[np.bool_]) -> int | None:
        """Index of the held unknown that the gradient pulls back most from its bound; None if none is pulled back."""
        changes = present - self.values
        gradient = self.arrow.gradient(changes) + self.damping**2 * changes
        back = held & ~self.box.held(present, gradient)
        pull = np.where(back, np.abs(gradient) / self.damping, 0.0)
        strongest = int(np.argmax(pull))
        return strongest if pull[strongest] > 0.0 else None

    def _to_first_end(self, present: FloatArray, wanted: FloatArray) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
        """Move towards wanted unknowns until the first one meets its bound; also return the mask of bounded ones."""
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
        state: state of the problem there.
        cost: half the sum of the costs of residuals and priors.
        sizes: largest norms of the columns so far, shape (N,).
        damping: damping relative to the squares of the columns.
        growth: factor on the damping if the next step fails.
        along: damping of steps along kinks.
        beyond: the state on the other side of a kink that steps from here have met; None without a kink.
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
        """Scales of the unknowns, shape (N,); 1 for an unknown on which no datum depends."""
        return np.where(self.sizes > 0, self.sizes, 1.0)

    def take(self, values: FloatArray, state: StateType, cost: float) -> None:
        """Move to another state."""
        self.values, self.state, self.cost = values, state, cost
        self.growth = 2.0


@dataclass(frozen=True)
class ArrowFit(Generic[StateType]):
    """A fit: problem, limits and loss.

    Attributes:
        problem: residuals of the problem.
        shared: limits of the shared unknowns, each entry of shape (n,).
        own: limits of the unknowns of a block, each of shape (k,), equal for all blocks.
        loss: cost of residuals.
        kinked: (state, state) ↦ mask of blocks whose derivatives jump in between, shape (blocks,); None without kinks.
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
        """Minimise the misfit within the bounds, from a start point.

        Args:
            shared: shared unknowns, shape (n,).
            own: unknowns of the blocks, shape (blocks, k).
            state: state of the problem there.
            progress: callback with the number of steps and the present cost.
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
        """Linearise the problem in the changes of the unknowns, with rows weighted by the loss."""
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
        """Split all unknowns into shared ones, shape (n,), and those of the blocks, shape (blocks, k)."""
        n = len(self.shared.lower)
        return values[:n], values[n:].reshape(len(self.problem.offsets) - 1, len(self.own.lower))

    def _cost(self, values: FloatArray, state: StateType) -> float:
        priors = self._limits.residual(values)
        return self.loss.cost(state.residual) + float(priors @ priors) / 2

    def _linearised(self, search: _Search[StateType]) -> ArrowStep:
        """Linearise the problem; the scales of the search grow with its columns."""
        arrow = self.linear(*self._parted(search.values), search.state)
        search.sizes = np.maximum(search.sizes, arrow.column_sizes)
        return arrow

    def _try_step(self, search: _Search[StateType], arrow: ArrowStep) -> FitOutcome | bool | None:
        """Try a step; return None if it is taken, an outcome if the search ends, False if the step fails."""
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
            # This is far beyond the range of the linear model: come back in fewer tries.
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
        """Try a step along kinks, beyond which a state is known; results as for :meth:`_try_step`.

        Args:
            search: the search, on this side.
            arrow: the linear problem on this side.
            there: unknowns on the other side, shape (N,).
            beyond: the state on the other side.
            blocks: mask of the blocks with a kink in between, shape (blocks,).
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
        # A number that is not finite is no decrease.
        if state is None or not search.cost - cost > SUFFICIENT * predicted:
            search.along *= BACK_OFF
            return False
        search.take(values, state, cost)
        search.along = max(search.along / BACK_OFF, 1e-15)
        return None

    def _stepped(self, search: _Search[StateType], arrow: ArrowStep, damping: float) -> FloatArray:
        """Compute the unknowns after the step with the least damped sum, shape (N,)."""
        box = self._limits.within_step(search.values)
        return BoundedStep(arrow, search.values, box, np.sqrt(damping) * search.scales).run()

    def _least_decrease(self, search: _Search[StateType]) -> float:
        """Predicted decrease below which the search has converged."""
        return max(DECREASE, RELATIVE_DECREASE * search.cost)

    def _more_damping(self, search: _Search[StateType], arrow: ArrowStep) -> FitOutcome | bool:
        """Increase the damping of the next step; return an outcome if the step would be too short to matter."""
        search.damping *= search.growth
        search.growth *= 2
        if search.damping > LARGEST_DAMPING:
            return self._ended(search, arrow)
        return False

    def _ended(self, search: _Search[StateType], arrow: ArrowStep) -> FitOutcome:
        """Outcome of a search whose steps fail, by the predicted decrease of a step within the bounds."""
        values = self._stepped(search, arrow, HARDLY_DAMPED)
        left = arrow.decrease(values - search.values)
        bound = max(ROUNDING, self._least_decrease(search))
        return FitOutcome.CONVERGED if left <= bound else FitOutcome.STALLED


def kink_row(here: FloatArray, there: FloatArray, change: FloatArray, scales: FloatArray) -> FloatArray:
    """Make the row of a linear model that is zero on the kink between two states, shape (1, 1 + n).

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
