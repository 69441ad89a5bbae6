"""One discretisation for many cases, refined where the estimated error is largest (docs/theory.md, section 10).

It begins with what the first case needs. All cases are solved on it, each with the estimate of its error; where that is
largest, modes and intervals are added that the answer lacks, until no case is beyond its tolerance. On a richer
discretisation a case begins at its answer on the last one, so that it stays the same equilibrium and takes two or three
Newton steps.

The modes and intervals that an answer lacks are told by the correction that tells its error: the missing coordinates of
a settled correction say how much there would be of each mode that the answer lacks. A mode is added where that lessens
most what the rest of them would still change, until little is left of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain
from math import ceil

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.coarsen import POWERS, alike_rods
from cosserat_casadi.accuracy.fixing import Chosen, on_elements_of, union
from cosserat_casadi.accuracy.levels import is_thin, layer_nodes
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.equilibrium.answer_error import (
    believed_correction,
    change_with_following,
    inverse_jacobian,
    richer_balance,
    safety_for,
    watched_error,
)
from cosserat_casadi.equilibrium.locking import has_freedom, locked_inputs
from cosserat_casadi.equilibrium.metrics import prolong
from cosserat_casadi.equilibrium.smooth_passage import has_barriers
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import Start, solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.parameters import parameter_layout
from cosserat_casadi.numerics.progress import CountProgress
from cosserat_casadi.rod.discretisation import Discretisation

MODES_SHARE = 0.6
"""Share of the tolerance that modes which are still missing may leave."""

GRID_SHARE = 0.25
"""Share of the tolerance that the grid may leave."""

MOST_ADDED = ((100.0, 3), (10.0, 2))
"""Errors over the tolerance, and the modes that a strain may gain in one step beyond each; one below them.

The nearer an answer is, the better is known which modes it lacks, and the more a mode to spare would weigh.
"""

MOST_GROWTH = 1.5
"""Factor by which intervals grow at most in one step, beyond one more: the errors that foresee them are rough."""

NEXT_ORDER = {"magnus4": "magnus6"}
"""Rotation integrator that takes over where many more intervals would be needed."""

WORST = 3
"""Cases with the largest errors whose lack is made up at once."""

FAR = 3.0
"""Error over the tolerance that is far beyond it."""

ENOUGH_FAR = 6
"""Cases far beyond the tolerance after which a discretisation is left, and others are not solved on it."""

AIM = 0.5
"""Share of the tolerance that is aimed at: a round with a new discretisation costs more than a mode to spare."""

WELL_WITHIN = 0.5
"""Share of its tolerance within which the error of a case must be so that it is not solved again on more modes."""

MOST_ROUNDS = 12
"""Discretisations that are tried at most."""

FEW_MODES, FEW_NODES = 2, 6
"""Modes and intervals to begin with where the first case has no equilibrium."""

THIN_MODES, MORE_NODES = 3, 1.5
"""Modes to begin with beside thin obstacles, and the factor on the intervals that these ask for."""

Values = Mapping[str, npt.ArrayLike]


@dataclass(frozen=True)
class LoadCase:
    """A scene at some inputs.

    Attributes:
        scene: whose modes and nodes are to be chosen, unless it fixes them.
        inputs: by name.
        parameters: by name; None where the scene has none.
    """

    scene: scenes.Scene
    inputs: Values
    parameters: Values | None = None


@dataclass
class Answers:
    """Answers of cases on one discretisation."""

    chosen: Chosen
    solutions: dict[int, Solution] = field(default_factory=dict)
    _models: dict[int, Model] = field(default_factory=dict)

    def model_of(self, case: LoadCase) -> Model:
        """The model of a case; cases of one scene share it."""
        scene = case.scene
        # By identity: hashes of scenes cost as much as a solve, and the cases keep the scenes alive.
        if id(scene) not in self._models:
            self._models[id(scene)] = build(scene, on_elements_of(scene, self.chosen))
        return self._models[id(scene)]


@dataclass
class CommonModes:
    """A search for one discretisation that serves many cases.

    Attributes:
        cases: in the order in which they were made; at least one.
        progress: told how many solves are done.
        settles: whether rods that snap to obstacles as loads grow are let settle there; in the first case they are.
    """

    cases: list[LoadCase]
    progress: CountProgress | None = None
    settles: bool = True
    _solves: int = 0
    _last: dict[int, Solution] = field(default_factory=dict)
    _well_within: dict[int, float] = field(default_factory=dict)
    _failed: set[int] = field(default_factory=set)
    _hopeless: set[int] = field(default_factory=set)

    @property
    def without_equilibrium(self) -> list[int]:
        """Numbers of the cases for which no equilibrium was found."""
        return sorted(self._failed | self._hopeless)

    def added(self, cases: Iterable[LoadCase]) -> list[int]:
        """Add cases; return their numbers."""
        first = len(self.cases)
        self.cases += cases
        return list(range(first, len(self.cases)))

    def error(self, answers: Answers, number: int) -> float:
        """Estimated error of a case, which is solved where it was not; -inf without an equilibrium.

        A case whose error is well within its tolerance on fewer modes is not solved again: that error is a bound.
        """
        if number not in answers.solutions:
            if number in self._failed or number in self._hopeless:
                return -np.inf
            if number in self._well_within:
                return self._well_within[number]
        return _estimate(self._answer(answers, number))

    def worst(self, answers: Answers) -> tuple[int, float]:
        """Number and error of the case with the largest error, which is solved on this discretisation."""
        while True:
            errors = [self.error(answers, number) for number in range(len(self.cases))]
            number = int(np.argmax(errors))
            if number in answers.solutions or np.isneginf(errors[number]):
                return number, errors[number]
            # A bound from fewer modes: what it is here may be less than that of others.
            self._answer(answers, number)

    def locked(self, answers: Answers) -> tuple[str, ...]:
        """Names of the inputs that move nothing in the first case on this discretisation, and would on more modes."""
        first = self._answer(answers, 0)
        if not first.converged or first.model.scene.touches_exactly:
            return ()
        return locked_inputs(first)

    def refined(self, more: Callable[[Answers], Iterable[list[int]]] = lambda answers: ()) -> Answers:
        """Answers on a discretisation on which no case is beyond its tolerance; on the last that was tried without.

        Args:
            more: adds cases, batch after batch, once those before are within the tolerance on a discretisation; none by
                default.
        """
        chosen = self._unlocked(self._first())
        hardest: list[int] = []
        for _ in range(MOST_ROUNDS):
            answers = Answers(chosen)
            beyond = self._first_beyond(answers, hardest, more)
            if not beyond:
                beyond = self._beyond(answers, self._regained(answers))
            if beyond:
                hardest = list(dict.fromkeys([*beyond[: 2 * WORST], *hardest]))[: 4 * WORST]
                chosen = self._unlocked(union(self._enough(answers, number) for number in beyond[:WORST]))
            elif self._lost(chosen) or self.locked(answers):
                chosen = with_more_modes(chosen)
            else:
                break
        return answers

    def _first_beyond(
        self, answers: Answers, hardest: list[int], more: Callable[[Answers], Iterable[list[int]]]
    ) -> list[int]:
        """Cases beyond the tolerance of the first batch that has any, the worst first."""
        # One batch after the other: what adds cases looks at the answers at those before.
        for batch in chain((hardest, range(len(self.cases))), more(answers)):
            beyond = self._beyond(answers, batch)
            if beyond:
                return beyond
        return []

    def _beyond(self, answers: Answers, numbers: Iterable[int]) -> list[int]:
        """Cases beyond their tolerance, the worst first; far beyond it a few say enough of what modes are missing."""
        beyond: dict[int, float] = {}
        far = 0
        for number in numbers:
            excess = self.error(answers, number) / self._tolerance(number)
            if excess > 1.0:
                beyond[number] = excess
            far += excess > FAR
            if far == ENOUGH_FAR:
                break
        return sorted(beyond, key=lambda number: -beyond[number])

    def _tolerance(self, number: int) -> float:
        return self.cases[number].scene.accuracy.tolerance

    def _enough(self, answers: Answers, number: int) -> Chosen:
        """The discretisation that a case needs whose error exceeds its tolerance."""
        solution = answers.solutions[number]
        if solution.model.scene.touches_exactly:
            # Its elements end at contacts: what it lacks is not what the free rod lacks.
            return with_more_modes(answers.chosen)
        return enough_for(solution, AIM * self._tolerance(number))

    def _answer(self, answers: Answers, number: int) -> Solution:
        """The answer of a case, which is solved where it was not."""
        if number not in answers.solutions:
            solution = self._solved(answers, number)
            answers.solutions[number] = solution
            if solution.converged:
                self._failed.discard(number)
            else:
                self._failed.add(number)
            error = _estimate(solution)
            if 0.0 <= error <= WELL_WITHIN * self._tolerance(number):
                self._well_within[number] = error
        return answers.solutions[number]

    def _solved(self, answers: Answers, number: int) -> Solution:
        case = self.cases[number]
        model = answers.model_of(case)
        start = self._start(answers, number, model)
        solution = None if start is None else self._solved_on(model, case, start)
        if solution is None or not solution.converged:
            solution = self._solved_on(model, case, self._unloaded(number, model))
        if solution.converged:
            self._last[number] = solution
        return solution

    def _start(self, answers: Answers, number: int, model: Model) -> Start:
        """Where a solve begins: at the case's answer on fewer modes, else at the first case's, else unloaded."""
        case = self.cases[number]
        last = self._last.get(number)
        if last is not None:
            return last if case.scene.touches_exactly else prolong(last, model)
        if number == 0 or case.scene is not self.cases[0].scene or case.parameters is not None:
            return None
        # On more modes the first case, which is well within its tolerance, may not have been solved yet.
        first = self._answer(answers, 0)
        return first if first.converged else None

    def _unloaded(self, number: int, model: Model) -> Start:
        """The unloaded scene as a start; as zeros, from which rods that snap on the way are not let settle."""
        if number == 0 or self.settles or not has_barriers(model.scene):
            return None
        return np.zeros(model.size)

    def _solved_on(self, model: Model, case: LoadCase, start: Start = None) -> Solution:
        self._solves += 1
        if self.progress is not None:
            self.progress(self._solves, max(self._solves, 2 * len(self.cases)))
        accuracy = case.scene.accuracy
        # Of most scenes the tips alone count, which are estimated with less effort than shapes and wrenches.
        tips_alone = not accuracy.shape and not case.scene.touches_exactly
        solution = solve(model, case.inputs, parameters=case.parameters, start=start, estimate_error=not tips_alone)
        if not tips_alone or not solution.converged:
            return solution
        return replace(solution, error_estimate=watched_error(solution))

    def _first(self) -> Chosen:
        """The discretisation that the first case needs."""
        case = self.cases[0]
        scene = case.scene
        if case.parameters:
            scene = parameter_layout(scene).set_in(scene, case.parameters)
        if is_thin(scene):
            # A search for this case alone would take longer than all others together.
            return discretise(case.scene, THIN_MODES, ceil(MORE_NODES * layer_nodes(scene)))
        own = solve_rods(scene, case.inputs)
        if not own.converged:
            return discretise(case.scene, FEW_MODES, FEW_NODES)
        if not case.parameters:
            # It is an answer of this case already, from which the next one begins.
            self._last[0] = own
        return own.model.discretisation

    def _unlocked(self, chosen: Chosen) -> Chosen:
        """A discretisation with at least one degree of freedom more than constraints."""
        while not has_freedom(Answers(chosen).model_of(self.cases[0])):
            chosen = with_more_modes(chosen)
        return chosen

    def _regained(self, answers: Answers) -> list[int]:
        """Cases that have an equilibrium on these modes and had none on fewer."""
        failed = [number for number in sorted(self._failed) if number not in answers.solutions]
        return [number for number in failed if self._answer(answers, number).converged]

    def _lost(self, chosen: Chosen) -> bool:
        """Whether a case without an equilibrium has one on more modes; one that has none there either is given up."""
        richer = Answers(with_more_modes(with_more_modes(chosen)))
        lost = []
        for number in sorted(self._failed):
            case = self.cases[number]
            model = richer.model_of(case)
            if self._solved_on(model, case, self._unloaded(number, model)).converged:
                lost.append(number)
        self._hopeless |= self._failed.difference(lost)
        self._failed = set(lost)
        return bool(lost)


def _estimate(solution: Solution) -> float:
    """Estimated error, of the shape where the scene asks for that; -inf without an equilibrium."""
    if not solution.converged:
        return -np.inf
    shape = solution.model.scene.accuracy.shape
    error = solution.shape_error_estimate if shape else solution.error_estimate
    return float("inf") if error is None or np.isnan(error) else float(error)


def enough_for(solution: Solution, tolerance: float) -> Chosen:
    """The discretisation of an answer with the modes and intervals added that its error asks for.

    Args:
        solution: a converged one, whose estimated error is above the tolerance.
        tolerance: wanted error.
    """
    settled, correction = believed_correction(solution)
    if not settled:
        # What the answer lacks is not known, but it is far from right: more of everything.
        return with_more_modes(with_more_modes(solution.model.discretisation))
    return _Lack(solution, correction.missing, correction.change, tolerance / safety_for(solution.model)).made_up()


def with_more_modes(chosen: Chosen) -> Chosen:
    """A discretisation with one more mode of every strain, and two more intervals."""
    more = {}
    for name, own in chosen.items():
        modes = tuple(count + 1 for count in own.modes)
        more[name] = replace(own, modes=modes, nodes=own.nodes + 2)
    return more


@dataclass(frozen=True)
class _Lack:
    """Modes and intervals that an answer lacks.

    Attributes:
        solution: the answer.
        missing: how much there would be of the modes that it lacks, shape (missing,).
        error: change that these modes make.
        bound: on the change that modes and intervals make which are still missing.
    """

    solution: Solution
    missing: FloatArray
    error: float
    bound: float

    def made_up(self) -> Chosen:
        """The discretisation with the modes and intervals that are needed."""
        chosen: Chosen = dict(self.solution.model.discretisation)
        by_grid = self._change(np.zeros_like(self.missing))
        enough = max(MODES_SHARE * self.bound, 1.1 * by_grid)
        left = self._change(self.missing)
        while left > enough:
            trials = [(self._change(self._left_by(trial)), trial) for trial in self._with_one_more(chosen)]
            if not trials:
                break
            left, chosen = min(trials, key=lambda trial: trial[0])
        if by_grid > GRID_SHARE * self.bound:
            chosen = {name: self._finer(own, by_grid) for name, own in chosen.items()}
        if chosen == self.solution.model.discretisation:
            return with_more_modes(chosen)
        return chosen

    def _with_one_more(self, chosen: Chosen) -> list[Chosen]:
        """Discretisations with one more mode of a strain, where the answer's correction has such a mode."""
        trials: list[Chosen] = []
        present = self.solution.model.discretisation
        most_added = next((most for excess, most in MOST_ADDED if self.error > excess * self.bound), 1)
        for names in alike_rods(self.solution.model):
            for component, count in enumerate(chosen[names[0]].modes):
                if count == present[names[0]].modes[component] + most_added:
                    continue
                trial = dict(chosen)
                for name in names:
                    modes = list(chosen[name].modes)
                    modes[component] += 1
                    trial[name] = replace(chosen[name], modes=tuple(modes))
                trials.append(trial)
        return trials

    def _left_by(self, chosen: Chosen) -> FloatArray:
        """The missing coordinates, which a discretisation has set to zero, shape (missing,)."""
        richer = self.solution.model.discrete.richer
        has = np.zeros(richer.discrete.size, dtype=bool)
        for name, rod in richer.discrete.rods.items():
            first = richer.discrete.unknowns.strain(name).start
            for (component, columns), modes in zip(rod.columns.items(), chosen[name].modes, strict=True):
                has[first + columns.start : first + columns.stop] = rod.degrees(component) < modes
        return np.where(has[~richer.known], 0.0, self.missing)

    def _change(self, missing: FloatArray) -> float:
        """Change of the watched poses by a finer grid and by missing modes, which the unknowns of the answer follow."""
        none = np.zeros(self.solution.model.size)
        balance = richer_balance(self.solution, none, missing)
        return change_with_following(self.solution, balance, -self._inverse @ balance.residual)

    @cached_property
    def _inverse(self) -> FloatArray:
        return inverse_jacobian(self.solution)

    def _finer(self, own: Discretisation, by_grid: float) -> Discretisation:
        """A rod's discretisation with so many intervals that the change by the grid is within its share."""
        growth = (by_grid / (GRID_SHARE * self.bound)) ** (1 / POWERS[own.transport])
        if growth > MOST_GROWTH and own.transport in NEXT_ORDER:
            return replace(own, nodes=own.nodes + 1, transport=NEXT_ORDER[own.transport])
        growth = min(growth, MOST_GROWTH)
        # What sums of layers leave is part of the change by the grid.
        sections = ceil(own.sections * growth)
        return replace(own, nodes=max(ceil(own.nodes * growth), own.nodes + 1), sections=sections)
