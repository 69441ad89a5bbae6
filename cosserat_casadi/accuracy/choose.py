"""One discretisation for ranges of inputs, chosen where the error is largest and verified all over them.

No grid is solved. The choice begins with what the scene's own inputs need. On it corners and random points of the
ranges are solved, each with the estimate of its error; where that is largest, modes and intervals are added that the
answer lacks. Then the worst point climbs along the ends of its inputs, and fresh points are tried, until none is beyond
the tolerance (docs/theory.md, section 10).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.enough_modes import Chosen, enough_for, with_more_modes
from cosserat_casadi.accuracy.ranges import CaseRanges, Given, input_ranges
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.accuracy.tune import unfixed, with_accuracy
from cosserat_casadi.accuracy.verified import Verified
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise, with_discretisation
from cosserat_casadi.model.unknowns import BlockKind

SEED = 31
"""Of the random points, so that a choice can be repeated."""

SAMPLES = 16
"""Random corners that are solved, and random points too; as many fresh points are tried in the end."""

WORST = 3
"""Points with the largest errors whose lack is made up at once."""

MOST_ROUNDS = 12
"""Discretisations that are tried at most."""

CLIMBS = 1
"""Times that the worst point climbs through all of its inputs."""

Progress = Callable[[int, int], None]
"""Told how many of how many solves are done; the total may grow."""


@dataclass(frozen=True)
class Choice:
    """A discretisation for ranges of inputs and parameters.

    Attributes:
        scene: the scene with this discretisation fixed, and the ranges that it was chosen for.
        model: of that scene.
        ranges: what it was chosen for, entry by entry.
        solves: points of the ranges that were solved on it.
        error_estimate: the largest of their estimates; None where none has an equilibrium.
        worst: inputs and parameters of the point with that estimate.
        without_equilibrium: inputs and parameters of the points at which no equilibrium was found.
        met: whether the error is within the tolerance wherever there is an equilibrium.
    """

    scene: scenes.Scene
    model: Model
    ranges: CaseRanges
    solves: int
    error_estimate: float | None
    worst: dict[str, FloatArray]
    without_equilibrium: tuple[dict[str, FloatArray], ...]
    met: bool

    @property
    def verified(self) -> Verified:
        """What a folder says of it."""
        return Verified(self.ranges.described, self.solves, self.error_estimate, len(self.without_equilibrium))


def choose(
    scene: scenes.Scene,
    ranges: Given | None = None,
    tolerance: float | None = None,
    progress: Progress | None = None,
    samples: int = SAMPLES,
) -> Choice:
    """The smallest discretisation found that keeps the tolerance all over ranges of inputs and parameters.

    Modes, nodes and rotation that the scene fixes stay as they are, and are verified over the ranges.

    Args:
        scene: a validated scene.
        ranges: pairs of lower and upper end by column, such as ``push.force.x``, or by the name of an input or a
            parameter; for all else see :func:`cosserat_casadi.accuracy.ranges.input_ranges`.
        tolerance: wanted error of the tip poses relative to length; the scene's own by default.
        progress: told how many points are solved.
        samples: random corners that are tried, and as many random points, beside the ends of each range.

    Raises:
        SceneError: a range or the tolerance is refused.
    """
    taken = input_ranges(scene, ranges)
    if tolerance is not None:
        scene = with_accuracy(scene, tolerance=tolerance)
    search = _Search(scene, taken, progress, samples)
    answers = search.of(discretise(scene)) if scene.accuracy.fixed else search.refined()
    return search.verified(answers)


@dataclass
class _Answers:
    """Answers at points of the ranges on one discretisation.

    Attributes:
        model: the scene on it.
        solutions: by the number of the point.
    """

    model: Model
    solutions: dict[int, Solution] = field(default_factory=dict)


@dataclass
class _Search:
    """One search for a discretisation.

    Attributes:
        scene: whose tolerance is wanted.
        ranges: over which.
        progress: told how many points are solved.
        samples: random corners, and random points.
        points: cases that are tried, in the order in which they were made.
    """

    scene: scenes.Scene
    ranges: CaseRanges
    progress: Progress | None
    samples: int
    points: list[FloatArray] = field(default_factory=list)
    _solved: int = 0
    _hard: set[int] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._random = np.random.default_rng(SEED)
        self._bare = unfixed(self.scene, self.tolerance)
        self.points = [self._own_point, *self._ends(), *self._corners(self.samples), *self._inner(self.samples)]

    @property
    def tolerance(self) -> float:
        """Wanted error."""
        return self.scene.accuracy.tolerance

    # Points

    @property
    def _own_point(self) -> FloatArray:
        """The scene's own case, moved into the ranges."""
        return np.clip(self.ranges.layout.default, self.ranges.lower, self.ranges.upper)

    def _ends(self) -> Iterable[FloatArray]:
        """Cases in which one entry is at an end; then all of them at the lower ends, and at the upper ones."""
        for k in self.ranges.moving:
            for end in (self.ranges.lower, self.ranges.upper):
                case = self._own_point
                case[k] = end[k]
                yield case
        yield self.ranges.lower
        yield self.ranges.upper

    def _corners(self, count: int) -> Iterable[FloatArray]:
        """Random corners."""
        for _ in range(count):
            upper = self._random.random(len(self.ranges.lower)) < 0.5
            yield np.where(upper, self.ranges.upper, self.ranges.lower)

    def _inner(self, count: int) -> Iterable[FloatArray]:
        """Random points between the ends."""
        for _ in range(count):
            share = self._random.random(len(self.ranges.lower))
            yield self.ranges.lower + share * (self.ranges.upper - self.ranges.lower)

    # Answers

    def _error(self, answers: _Answers, point: int) -> float:
        """Estimated error at a point, which is solved where it was not; -inf without an equilibrium."""
        if point not in answers.solutions:
            answers.solutions[point] = self._solved_at(answers.model, self.points[point])
        return _estimate(answers.solutions[point], self.scene)

    def _solved_at(self, model: Model, case: FloatArray) -> Solution:
        self._solved += 1
        if self.progress is not None:
            self.progress(self._solved, max(self._solved, 2 * len(self.points)))
        values = self.ranges.layout.unpack(case)
        names = self.ranges.layout.parameters.names
        parameters = {name: value for name, value in values.items() if name in names}
        inputs = {name: value for name, value in values.items() if name not in parameters}
        return solve(model, inputs, parameters=parameters or None)

    def of(self, chosen: Chosen) -> _Answers:
        """Answers on a discretisation, none so far."""
        return _Answers(build(self._bare, chosen))

    # Search

    def refined(self) -> _Answers:
        """Answers on a discretisation that keeps the tolerance at all points and at fresh ones; on the last without."""
        chosen = self._unlocked(self._first())
        hardest: list[int] = []
        for _ in range(MOST_ROUNDS):
            answers = self.of(chosen)
            beyond = self._beyond(answers, hardest) or self._beyond(answers, range(len(self.points)))
            if not beyond:
                beyond = self._beyond(answers, self._climbed(answers))
            if not beyond:
                beyond = self._beyond(answers, self._added(self._inner(self.samples)))
            if not beyond:
                lost = self._lost(answers, chosen)
                if not lost:
                    break
                chosen = with_more_modes(chosen)
                continue
            hardest = list(dict.fromkeys([*beyond[: 2 * WORST], *hardest]))[: 4 * WORST]
            needed = [enough_for(answers.solutions[point], self.tolerance) for point in beyond[:WORST]]
            chosen = self._unlocked(union(needed))
        return answers

    def _first(self) -> Chosen:
        """What the scene's own inputs need."""
        own = solve_rods(self._bare)
        return own.model.discretisation if own.converged else discretise(self._bare, 2, 6)

    def _unlocked(self, chosen: Chosen) -> Chosen:
        """A discretisation with at least one degree of freedom more than constraints."""
        while freedom(build(self._bare, chosen)) <= 0:
            chosen = with_more_modes(chosen)
        return chosen

    def _beyond(self, answers: _Answers, points: Iterable[int]) -> list[int]:
        """The points beyond the tolerance, the worst first."""
        errors = {point: self._error(answers, point) for point in points}
        beyond = [point for point, error in errors.items() if error > self.tolerance]
        return sorted(beyond, key=lambda point: -errors[point])

    def _climbed(self, answers: _Answers) -> list[int]:
        """New points to which the worst one climbs, each entry moved to the end that raises the error."""
        errors = {point: self._error(answers, point) for point in answers.solutions}
        worst = max(errors, key=lambda point: errors[point])
        case = self.points[worst]
        error = errors[worst]
        made: list[int] = []
        for k in self._random.permutation(self.ranges.moving):
            for end in (self.ranges.lower, self.ranges.upper):
                if case[k] == end[k]:
                    continue
                trial = case.copy()
                trial[k] = end[k]
                (point,) = self._added([trial])
                made.append(point)
                tried = self._error(answers, point)
                if tried > error:
                    case, error = trial, tried
        return made

    def _added(self, cases: Iterable[FloatArray]) -> list[int]:
        """Numbers of new points."""
        first = len(self.points)
        self.points += cases
        return list(range(first, len(self.points)))

    def _lost(self, answers: _Answers, chosen: Chosen) -> list[int]:
        """Points without an equilibrium that have one on more modes."""
        failed = [point for point, solution in answers.solutions.items() if not solution.converged]
        fresh = [point for point in failed if point not in self._hard]
        if not fresh:
            return []
        richer = self.of(with_more_modes(with_more_modes(chosen))).model
        lost = [point for point in fresh if self._solved_at(richer, self.points[point]).converged]
        # Without an equilibrium on more modes either: not looked at again.
        self._hard.update(point for point in fresh if point not in lost)
        return lost

    # Verdict

    def verified(self, answers: _Answers) -> Choice:
        """The record of a discretisation, with an answer at every point."""
        chosen = answers.model.discretisation
        errors = [self._error(answers, point) for point in range(len(self.points))]
        unpack = self.ranges.layout.unpack
        failed = [unpack(self.points[k]) for k, solution in answers.solutions.items() if not solution.converged]
        worst = int(np.argmax(errors))
        largest = errors[worst] if np.isfinite(errors[worst]) else None
        with_ranges = with_choice(self.scene, chosen, self.ranges)
        return Choice(
            scene=with_ranges,
            model=build(with_ranges, chosen),
            ranges=self.ranges,
            solves=len(errors),
            error_estimate=largest,
            worst=unpack(self.points[worst]),
            without_equilibrium=tuple(failed),
            met=largest is not None and largest <= self.tolerance,
        )


def freedom(model: Model) -> int:
    """Degrees of freedom less constraints: a model that has none is locked, whatever acts; 1 without constraints."""
    unknowns = model.discrete.unknowns
    constraints = unknowns.count(BlockKind.MULTIPLIER, BlockKind.TENSION)
    if not constraints:
        return 1
    # The quaternion of a frame has a number more than its rotation has degrees of freedom.
    frames = sum(min(block.size, 6) for block, _ in unknowns.of_kind(BlockKind.POSE))
    return unknowns.count(BlockKind.STRAIN) + frames - constraints


def union(several: Iterable[Chosen]) -> Chosen:
    """The least discretisation of every rod with all the modes and intervals of several."""
    first, *others = several
    joined = dict(first)
    for other in others:
        for name, own in joined.items():
            modes = tuple(map(max, own.modes, other[name].modes))
            nodes = max(own.nodes, other[name].nodes)
            # Names of the Magnus methods sort by their order.
            transport = max(own.transport, other[name].transport)
            joined[name] = replace(own, modes=modes, nodes=nodes, transport=transport)
    return joined


def with_choice(scene: scenes.Scene, chosen: Chosen, ranges: CaseRanges) -> scenes.Scene:
    """The scene with a discretisation fixed, and what it was chosen for; as it is where it fixes its own."""
    if scene.accuracy.fixed:
        return scene
    fixed = with_discretisation(scene, chosen)
    return with_accuracy(fixed, chosen_for=list(ranges.described) or None)


def _estimate(solution: Solution, scene: scenes.Scene) -> float:
    """Estimated error, of the shape where the scene asks for that; -inf without an equilibrium."""
    if not solution.converged:
        return -np.inf
    error: Any = solution.shape_error_estimate if scene.accuracy.shape else solution.error_estimate
    return float("inf") if error is None or np.isnan(error) else float(error)
