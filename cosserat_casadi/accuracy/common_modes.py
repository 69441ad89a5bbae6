"""One discretisation for many cases, refined where the estimated error is largest (docs/theory.md, section 10).

The search begins with the discretisation that the first case needs. All cases are solved on it with error estimates;
the modes and intervals that the worst answers lack are added, until all cases are within their tolerance. On a richer
discretisation a case begins at its answer on the last one, so that it keeps its equilibrium and takes two or three
Newton steps.

The correction that estimates the error of an answer also gives the modes and intervals that it lacks: the missing
coordinates of a settled correction are the amplitudes of the missing modes. The mode whose addition reduces the change
by the other missing modes most is added, until this change is small.
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
from cosserat_casadi.scene.accuracy import MOST_FIBRES

MODES_SHARE = 0.6
"""Share of the tolerance for the error by modes that are still missing."""

GRID_SHARE = 0.25
"""Share of the tolerance for the error by the grid."""

MOST_ADDED = ((100.0, 3), (10.0, 2))
"""Errors over the tolerance, and the most modes that a strain gains in one step above each; one mode below.

A nearer answer tells its missing modes better, and a superfluous mode would cost relatively more.
"""

MOST_GROWTH = 1.5
"""Largest factor on the intervals in one step, plus one interval: the errors that predict them are rough."""

NEXT_ORDER = {"magnus4": "magnus6"}
"""Rotation integrator that is chosen if many more intervals would be needed."""

WORST = 3
"""Number of cases with the largest errors that are refined at once."""

FAR = 3.0
"""Error over the tolerance that counts as far above it."""

ENOUGH_FAR = 6
"""Number of cases far above the tolerance after which a discretisation is abandoned for the other cases."""

AIM = 0.5
"""Share of the tolerance at which a refinement aims: another round costs more than a superfluous mode."""

WELL_WITHIN = 0.5
"""Share of its tolerance below which the error of a case must be to spare a new solve on more modes."""

MOST_ROUNDS = 12
"""Most discretisations that are tried."""

FEW_MODES, FEW_NODES = 2, 6
"""First modes and intervals if the first case has no equilibrium."""

THIN_MODES, MORE_NODES = 3, 1.5
"""First modes beside thin obstacles, and factor on the intervals that these ask for."""

Values = Mapping[str, npt.ArrayLike]


@dataclass(frozen=True)
class LoadCase:
    """A scene at some inputs.

    Attributes:
        scene: scene with modes and nodes to choose, unless it fixes them.
        inputs: inputs by name.
        parameters: parameters by name; None for a scene without any.
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
        # Scenes are compared by identity: their hashes cost as much as a solve, and the cases keep the scenes alive.
        if id(scene) not in self._models:
            self._models[id(scene)] = build(scene, on_elements_of(scene, self.chosen))
        return self._models[id(scene)]


@dataclass
class CommonModes:
    """A search for one discretisation that serves many cases.

    Attributes:
        cases: cases in the order in which they were added; at least one.
        progress: receives the number of solves.
        settles: whether rods that snap to obstacles along the load path relax there; in the first case they do.
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
        """Indices of the cases without an equilibrium."""
        return sorted(self._failed | self._hopeless)

    def added(self, cases: Iterable[LoadCase]) -> list[int]:
        """Add cases and return their indices."""
        first = len(self.cases)
        self.cases += cases
        return list(range(first, len(self.cases)))

    def error(self, answers: Answers, number: int) -> float:
        """Estimated error of a case, which is solved if necessary; -inf without an equilibrium.

        A case with an error well within its tolerance on fewer modes is not solved again: that error is a bound.
        """
        if number not in answers.solutions:
            if number in self._failed or number in self._hopeless:
                return -np.inf
            if number in self._well_within:
                return self._well_within[number]
        return _estimate(self._answer(answers, number))

    def worst(self, answers: Answers) -> tuple[int, float]:
        """Index and error of the case with the largest error, which is solved on this discretisation."""
        while True:
            errors = [self.error(answers, number) for number in range(len(self.cases))]
            number = int(np.argmax(errors))
            if number in answers.solutions or np.isneginf(errors[number]):
                return number, errors[number]
            # A bound from fewer modes is not enough: the error here may be below the errors of other cases.
            self._answer(answers, number)

    def locked(self, answers: Answers) -> tuple[str, ...]:
        """Names of the inputs that move nothing in the first case on this discretisation, but would on more modes."""
        first = self._answer(answers, 0)
        if not first.converged or first.model.scene.touches_exactly:
            return ()
        return locked_inputs(first)

    def refined(self, more: Callable[[Answers], Iterable[list[int]]] = lambda answers: ()) -> Answers:
        """Answers on a discretisation with all cases within their tolerance, or on the last one that was tried.

        Args:
            more: function that adds cases, batch after batch, once all before are within the tolerance; none by
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
        """Cases above the tolerance in the first batch that has any, the worst first."""
        # One batch after the other, since adding cases uses the answers of the cases before.
        for batch in chain((hardest, range(len(self.cases))), more(answers)):
            beyond = self._beyond(answers, batch)
            if beyond:
                return beyond
        return []

    def _beyond(self, answers: Answers, numbers: Iterable[int]) -> list[int]:
        """Cases above their tolerance, the worst first; a few cases far above it suffice to tell the missing modes."""
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
        """The discretisation that a case with an error above its tolerance needs."""
        solution = answers.solutions[number]
        if solution.model.scene.touches_exactly:
            # Its elements end at contacts, so that its missing modes are not those of the free rod.
            return with_more_modes(answers.chosen)
        return enough_for(solution, AIM * self._tolerance(number))

    def _answer(self, answers: Answers, number: int) -> Solution:
        """The answer of a case, which is solved if necessary."""
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
        """Start of a solve: the case's answer on fewer modes, else the first case's answer, else the unloaded scene."""
        case = self.cases[number]
        last = self._last.get(number)
        if last is not None:
            return last if case.scene.touches_exactly else prolong(last, model)
        if number == 0 or case.scene is not self.cases[0].scene or case.parameters is not None:
            return None
        # The first case may not have been solved on these modes, if it was well within its tolerance on fewer.
        first = self._answer(answers, 0)
        return first if first.converged else None

    def _unloaded(self, number: int, model: Model) -> Start:
        """The unloaded scene as a start; given as unknowns, so that rods that snap along the path do not relax."""
        if number == 0 or self.settles or model.scene.touches_exactly or not has_barriers(model.scene):
            return None
        return np.zeros(model.size)

    def _solved_on(self, model: Model, case: LoadCase, start: Start = None) -> Solution:
        self._solves += 1
        if self.progress is not None:
            self.progress(self._solves, max(self._solves, 2 * len(self.cases)))
        accuracy = case.scene.accuracy
        # In most scenes only the tips count, which are cheaper to estimate than shapes and wrenches.
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
            # A search for this case alone would take longer than all other cases together.
            return discretise(case.scene, THIN_MODES, ceil(MORE_NODES * layer_nodes(scene)))
        own = solve_rods(scene, case.inputs)
        if not own.converged:
            return discretise(case.scene, FEW_MODES, FEW_NODES)
        if not case.parameters:
            # It is an answer of this case, from which its next solve begins.
            self._last[0] = own
        return own.model.discretisation

    def _unlocked(self, chosen: Chosen) -> Chosen:
        """A discretisation with at least one degree of freedom more than constraints."""
        while not has_freedom(Answers(chosen).model_of(self.cases[0])):
            chosen = with_more_modes(chosen)
        return chosen

    def _regained(self, answers: Answers) -> list[int]:
        """Cases with an equilibrium on these modes, but none on fewer."""
        failed = [number for number in sorted(self._failed) if number not in answers.solutions]
        return [number for number in failed if self._answer(answers, number).converged]

    def _lost(self, chosen: Chosen) -> bool:
        """Whether a case without an equilibrium has one on more modes; a case without one there either is given up."""
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
    """Estimated error, of the shape if the scene asks for it; -inf without an equilibrium."""
    if not solution.converged:
        return -np.inf
    shape = solution.model.scene.accuracy.shape
    error = solution.shape_error_estimate if shape else solution.error_estimate
    return float("inf") if error is None or np.isnan(error) else float(error)


def enough_for(solution: Solution, tolerance: float) -> Chosen:
    """The discretisation of an answer plus the modes and intervals that its error asks for.

    Args:
        solution: a converged solution with an estimated error above the tolerance.
        tolerance: wanted error.
    """
    settled, correction = believed_correction(solution)
    if not settled:
        # The missing modes are unknown, but the error is large: more of everything.
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
        missing: coordinates of the missing modes, shape (missing,).
        error: change by these modes.
        bound: bound on the change by modes and intervals that are still missing.
    """

    solution: Solution
    missing: FloatArray
    error: float
    bound: float

    def made_up(self) -> Chosen:
        """The discretisation with all needed modes and intervals."""
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
        """Discretisations with one more mode of a strain, for modes in the correction of the answer."""
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
        """The missing coordinates, with zeros for modes of a discretisation, shape (missing,)."""
        richer = self.solution.model.discrete.richer
        has = richer.discrete.existing({name: own.modes for name, own in chosen.items()})
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
        """A rod's discretisation with enough intervals for the change by the grid to be within its share."""
        growth = (by_grid / (GRID_SHARE * self.bound)) ** (1 / POWERS[own.transport])
        if growth > MOST_GROWTH and own.transport in NEXT_ORDER:
            return replace(own, nodes=own.nodes + 1, transport=NEXT_ORDER[own.transport])
        growth = min(growth, MOST_GROWTH)
        # The error of sums of layers and of fibres is part of the change by the grid.
        sections = ceil(own.sections * growth)
        finer = replace(own, nodes=max(ceil(own.nodes * growth), own.nodes + 1), sections=sections)
        return finer if own.fibres >= MOST_FIBRES else finer.with_more_fibres()
