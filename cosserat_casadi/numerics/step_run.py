"""State of an integration in time: the last instant, the present Jacobian, and the work so far."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.collocation import Collocation
from cosserat_casadi.numerics.coupled_stages import CoupledStages, solve_coupled_stages
from cosserat_casadi.numerics.guards import Guards, crossing, remembering
from cosserat_casadi.numerics.integration import Integration, IntegrationCost, Settle, StepOutcome, StepSettings
from cosserat_casadi.numerics.motion_equations import Instant, Linearisation, MotionEquations
from cosserat_casadi.numerics.stage_newton import NewtonBounds, StageOutcome, StageSolution, solve_stages
from cosserat_casadi.numerics.step import CarriedStep, StepPolynomial, StepRows, TimeStep, extrapolated, restricted
from cosserat_casadi.numerics.step_control import MOST_ITERATIONS, estimated_error, overlooked_error
from cosserat_casadi.numerics.step_matrices import StepMatrices, step_matrices

RESOLVED_TIME = 16.0 * float(np.finfo(np.float64).eps)
"""Smallest step, over the time, that is resolved despite the rounding of the time."""

MOST_LENGTHS = 8
"""Most sizes that are tried for a step that ends at the zero of a guard."""

NEARBY = 1e-3
"""Distance before the end of a step, over its size, at which a guard is evaluated for its rate."""

AT_START = 1e-10
"""Share of a step at its start within which a zero of a guard counts as one at the start."""

CLOSED = 1e-9
"""Largest dimensionless residual of a constraint that counts as closed."""

ON_GUARD = 1e-13
"""Value of a guard that counts as zero."""

ROUNDED = 1e-11
"""Value of a guard that counts as zero if no other size of the step reduces it, as Newton's method leaves as much."""

NEARER = 0.5
"""Least ratio of a guard's values at consecutive sizes at which the guard counts as no nearer to zero."""

MOST_LASTING = 100.0
"""Largest factor on the error of a short step, as the error of Newton's method in short steps counts too."""

FEW_ITERATIONS = 4
"""Most iterations of a step whose Jacobian also serves the next step; a new one costs as much as more iterations."""

ITERATIONS_OF_GIVEN_STEP = 30
"""Most Newton iterations, with one Jacobian, of a step of prescribed size, which no shorter step may replace."""


@dataclass
class StepRun:
    """State of an integration, which changes from one step to the next.

    Attributes:
        equations: the equations.
        method: the collocation method.
        settings: settings of the steps.
        start: state at the start of the motion.
        stop: end time of the motion, s.
        steps: the steps taken one by one.
        rows: blocks of the later steps, which other code has taken.
        size: size of the step to be tried next, s.
        bounds: weights of an error, and stopping criteria of Newton's method.
        linearisation: the present Jacobian; None if the next step needs a new one.
        fresh: whether that Jacobian was evaluated after the last instant.
        matrices: the present linear systems; None if there are none for the Jacobian.
        cost: numbers so far, including refused steps.
        longest: longest step so far, s.
        before: data for the first step from steps up to the start; None if there are none.
        memory: data for the next step after the last one.
        linearised_at: state at which the present Jacobian was evaluated.
        guards: values that must not become negative; None without guards.
        settled: instant from which to go on, in place of the end of the last step; None for the end of that step.
        guard: index of the guard that came to zero; None if none did.
    """

    equations: MotionEquations
    method: Collocation
    settings: StepSettings
    start: Instant
    stop: float
    guards: Guards | None = None
    settled: Settle | None = None
    guard: int | None = None
    steps: list[TimeStep] = field(default_factory=list)
    rows: list[StepRows] = field(default_factory=list)
    size: float = 0.0
    linearisation: Linearisation | None = None
    fresh: bool = False
    matrices: StepMatrices | None = None
    cost: IntegrationCost = field(default_factory=IntegrationCost)
    longest: float = 0.0
    before: CarriedStep | None = None
    memory: CarriedStep | None = None
    linearised_at: Instant | None = None

    def __post_init__(self) -> None:
        differential = self.equations.differential
        weights = np.zeros(self.equations.size)
        weights[differential] = 1.0 / self.settings.tolerance[differential]
        iterations = MOST_ITERATIONS if self.settings.size is None else ITERATIONS_OF_GIVEN_STEP
        self.bounds = NewtonBounds(weights, self.settings.newton, iterations)
        self.memory = self.before
        if self.guards is not None:
            self.guards = remembering(self.guards)
        if self.before is None:
            return
        self.longest = self.before.longest
        self.linearised_at = self.before.linearised_at
        if self.linearised_at is not None:
            self.linearisation = self.equations.linearised(self.linearised_at)

    @property
    def begun(self) -> float:
        """Start time of the stretch with these equations, s: the start, unless a motion continues there."""
        return self.start.time if self.before is None else self.before.begun

    @property
    def now(self) -> Instant:
        """The last instant that was reached."""
        steps: Sequence[TimeStep] = self.rows[-1] if self.rows else self.steps
        return steps[-1].end if steps else self.start

    def result(self, outcome: StepOutcome) -> Integration:
        """Make the result of the integration."""
        steps: Sequence[TimeStep] = tuple(self.steps)
        if self.rows:
            before = [StepRows.of(steps)] if steps else []
            steps = StepRows.joined([*before, *self.rows])
        statistics = replace(self.cost, steps=len(steps))
        return Integration(self.start, steps, outcome, self.size, statistics, self.guard, self.memory)

    def renew_jacobian(self) -> None:
        """Make the next step evaluate a new Jacobian."""
        self.linearisation = None
        self.matrices = None

    def solve(self) -> StageSolution | StepOutcome:
        """Solve the equations of a step of the present size, or return how the motion ends if no other is tried."""
        solution = self._solve_with_jacobian()
        if isinstance(solution, StepOutcome) and not self.fresh:
            # The Jacobian may be too old: the same step gets one of its own.
            self.renew_jacobian()
            solution = self._solve_with_jacobian()
        if isinstance(solution, StepOutcome):
            # A shorter step has its middle elsewhere.
            self.renew_jacobian()
        return solution

    def solve_coupled(self, guess: FloatArray) -> StageSolution | None:
        """Solve the equations with a Jacobian at each stage, damped; None if that fails too.

        Args:
            guess: first iterate of the stages, shape (s, n).
        """
        stages = CoupledStages(self.equations, self.method, self.now, self.size)
        solution = solve_coupled_stages(stages, guess, self.bounds)
        count = solution.iterations
        jacobians = count * self.method.stages
        self.cost += IntegrationCost(iterations=count, jacobians=jacobians, factorisations=count)
        return solution if solution.outcome is StageOutcome.CONVERGED else None

    def _solve_with_jacobian(self) -> StageSolution | StepOutcome:
        """Solve with the present Jacobian, or a new one if there is none."""
        guess = self.guess()
        linearisation = self.linearisation
        if linearisation is None:
            self.linearised_at = self._middle(guess)
            linearisation = self.equations.linearised(self.linearised_at)
            self.linearisation = linearisation
            self.cost += IntegrationCost(jacobians=1)
            self.fresh = True
        if not linearisation.finite:
            return StepOutcome.NOT_SOLVED if self._finite_here() else StepOutcome.NOT_FINITE
        if self.matrices is None or self.matrices.step != self.size:
            of_unknowns = (self.equations.differential, self.equations.eliminated)
            self.matrices = step_matrices(self.method, self.size, linearisation, *of_unknowns)
            self.cost += IntegrationCost(factorisations=1)
        if self.matrices is None:
            return StepOutcome.SINGULAR
        share = min(1.0, self.size / self.settings.drifting) if self.settings.drifting else 1.0
        bounds = replace(self.bounds, error=share * self.bounds.error)
        solution = solve_stages(self.equations, self.matrices, self.now, guess, bounds)
        self.cost += IntegrationCost(iterations=solution.iterations)
        if solution.outcome is StageOutcome.CONVERGED:
            return solution
        return StepOutcome.NOT_SOLVED if self._finite_here() else StepOutcome.NOT_FINITE

    def _finite_here(self) -> bool:
        """Whether F is finite at the start of the step and straight on from it, so that iterates cause a failure."""
        now = self.now
        straight_on = Instant(now.time + self.size, now.x + self.size * now.v, now.v, now.a)
        residuals = [self.equations.residual_at(instant) for instant in (now, straight_on)]
        return bool(np.isfinite(residuals).all())

    def guess(self) -> FloatArray:
        """First iterate of the stages, from the polynomial of the step before, or from the start."""
        last = self.steps[-1] if self.steps else self.before
        if last is not None:
            return extrapolated(self.method, last, self.size)
        unknowns = np.where(self.equations.differential, self.start.a, self.start.x)
        return np.tile(unknowns, (self.method.stages, 1))

    def _middle(self, guess: FloatArray) -> Instant:
        """State in the middle of the step by the first iterate, where a Jacobian is nearest to those of all stages."""
        time = self.now.time + self.size / 2.0
        return StepPolynomial(self.method, self.equations.differential, self.now, self.size, guess).at_share(0.5, time)

    def error_of(self, solution: StageSolution, after_a_jump: bool) -> float:
        """Estimate the error over tolerance of the step that was solved last."""
        if self.matrices is None:
            return float("nan")
        error = estimated_error(self.matrices, self.now, solution.unknowns, self.bounds, after_a_jump)
        error = max(error, self._overlooked(solution, self.matrices))
        # Over a very short step a small error of position is a large one of velocity, which the motion goes on with.
        return error * float(np.clip(self.settings.lasting / self.size, 1.0, MOST_LASTING))

    def _overlooked(self, solution: StageSolution, matrices: StepMatrices) -> float:
        """Estimate the error over tolerance by kinks of the equations in time between the stages."""
        end = self.now.time + self.size
        kinks = self.equations.kinks
        inside = kinks[bisect_right(kinks, self.now.time) : bisect_left(kinks, end)]
        if not inside:
            return 0.0
        middle = self._middle(solution.unknowns)
        pace = max(self.size, self.longest)
        return overlooked_error(self.equations, matrices, self.now.time, middle, inside, self.bounds, pace)

    def accept(self, solution: StageSolution, end: float, error: float, wanted: float) -> None:
        """Accept a step, and decide whether its Jacobian serves the next one.

        Args:
            solution: solution of its stages.
            end: end time of the step, s.
            error: estimated error over tolerance; nan without error control.
            wanted: size of the next step, s.
        """
        differential = self.equations.differential
        now = self.now
        arrived = StepPolynomial(self.method, differential, now, self.size, solution.unknowns).arrival(end)
        step = TimeStep(
            method=self.method,
            differential=differential,
            start=now,
            size=self.size,
            unknowns=solution.unknowns,
            end=arrived,
            error=error,
            iterations=solution.iterations,
            residual=solution.residual,
            contraction=solution.contraction,
        )
        self.add(step)
        self.longest = max(self.longest, self.size)
        self.fresh = False
        if solution.iterations > FEW_ITERATIONS:
            self.renew_jacobian()
        # A step that is tried after this one, and interrupted, leaves no trace.
        linearised_at = None if self.linearisation is None else self.linearised_at
        self.memory = CarriedStep(self.begun, self.size, step.unknowns, wanted, error, self.longest, linearised_at)

    def add(self, step: TimeStep) -> None:
        """Append an accepted step, after the correction of its end."""
        if self.settled is not None:
            step = replace(step, end=self.settled(step))
        self.steps.append(step)

    def stopped_by_guard(self) -> bool:
        """Whether a guard fell through zero in the last step; the step is then retaken to end there."""
        if self.guards is None:
            return False
        whole = self.steps[-1]
        found = crossing(whole, self.guards)
        if found is None:
            return False
        time, self.guard = found
        self.steps.pop()
        wanted = self.size
        begin = self.now.time
        shortest = max(RESOLVED_TIME * max(abs(begin), abs(self.stop)), AT_START * whole.size)
        if time - begin > shortest:
            self._step_to(restricted(whole, time), self.guard)
        self.size = wanted
        return True

    def _open(self, step: TimeStep) -> bool:
        """Whether the end of a step violates constraints."""
        rows = self.equations.residual_at(step.end)[~self.equations.differential]
        return not float(np.abs(rows).max(initial=0.0)) <= CLOSED

    def _step_to(self, cut: TimeStep, guard: int) -> None:
        """Take a step that ends at the zero of a guard.

        Args:
            cut: part of a longer step up to about that time; it is kept if no step is found that ends on the guard,
                unless it violates the constraints: then the first step that was found is kept.
            guard: index of the guard.
        """
        assert self.guards is not None
        time = cut.end.time
        stands = cut
        last: tuple[float, float] | None = None
        for _ in range(MOST_LENGTHS):
            self.size = time - cut.start.time
            solution = self.solve()
            if isinstance(solution, StepOutcome):
                break
            self.accept(solution, time, cut.error, self.size)
            step = self.steps[-1]
            value = float(self.guards(step.end)[guard])
            is_nearer = last is None or abs(value) < NEARER * abs(last[1])
            if abs(value) <= (ON_GUARD if is_nearer else ROUNDED):
                return
            self.steps.pop()
            if stands is cut and self._open(cut):
                stands = step
            if last is None:
                earlier = time - NEARBY * step.size
                last = earlier, float(self.guards(step.at(earlier))[guard])
            elif not is_nearer:
                break
            # A step as short as the rounding of time has no time before its end.
            if time == last[0]:
                break
            # The state at the end of a step does not change with its length as it does along the step.
            rate = (value - last[1]) / (time - last[0])
            last = time, value
            following = time - value / rate if rate < 0.0 else time
            latest = min(2.0 * cut.end.time - cut.start.time, self.stop)
            # What needs a change of the time below its rounding, or another step altogether, is not found so.
            if not cut.start.time < following < latest or following == time:
                break
            time = following
        if stands is cut:
            self.add(cut)
        else:
            self.steps.append(stands)
