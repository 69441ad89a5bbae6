"""One discretisation for ranges of inputs or for load cases, verified on all of them.

Ranges are not solved on a grid of points, but at corners and random points. Then the worst point climbs along the ends
of its inputs, and fresh points are tried, until all are within the tolerance (docs/theory.md, section 10).
"""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.common_modes import Answers, CommonModes, LoadCase, Values
from cosserat_casadi.accuracy.fixing import fixed_by_rod, on_elements_of, unfixed, with_accuracy
from cosserat_casadi.accuracy.levels import is_thin
from cosserat_casadi.accuracy.ranges import CaseRanges, Given, input_ranges, ranges_of_cases
from cosserat_casadi.accuracy.verified import Verified
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.load_cases import case_layout
from cosserat_casadi.numerics.progress import CountProgress
from cosserat_casadi.result import Shown

LOG = logging.getLogger(__name__)

SEED = 31
"""Seed of the random points, so that a choice can be repeated."""

SAMPLES = 16
"""Number of random corners, and of random points, that are solved; as many fresh points are tried in the end."""

SAMPLES_IN_CONTACT = 2
"""Random corners, random points and fresh points where a solve takes seconds: in exact contact, in which each point
needs a search for its contacts, and beside smooth obstacles so thin that they need many intervals. The ends of each
range alone are then not tried, and the worst point does not climb."""


@dataclass(frozen=True, repr=False)
class Choice(Shown):
    """A discretisation for ranges of inputs and parameters, or for load cases.

    Attributes:
        scene: the scene with this discretisation fixed, and the ranges that it was chosen for.
        model: model of that scene.
        ranges: ranges of the inputs and parameters that it was chosen for, entry by entry.
        solves: number of points of the ranges, or load cases, that were solved on it, or on fewer modes with an error
            well within the tolerance.
        error_estimate: the largest of their estimates; None if none has an equilibrium.
        worst: inputs and parameters of the point with that estimate.
        without_equilibrium: inputs and parameters of the points at which no equilibrium was found.
        locked: names of the inputs that move nothing on a discretisation that the scene fixes, but would on more modes.
        met: whether the error of all equilibria is within the tolerance, every given load case has an equilibrium, and
            no input is locked.
    """

    scene: scenes.Scene
    model: Model
    ranges: CaseRanges
    solves: int
    error_estimate: float | None
    worst: dict[str, FloatArray]
    without_equilibrium: tuple[dict[str, FloatArray], ...]
    locked: tuple[str, ...]
    met: bool

    @property
    def verified(self) -> Verified:
        """Ranges, solves and errors for an exported folder."""
        return Verified(
            self.ranges.described,
            self.solves,
            self.error_estimate,
            len(self.without_equilibrium),
            self.within_tolerance,
            self.locked,
        )

    @property
    def within_tolerance(self) -> bool | None:
        """Whether the tolerance is met; None with fixed modes and no given tolerance."""
        return self.met if self.scene.accuracy.binds else None


def choose(
    scene: scenes.Scene,
    ranges: Given | None = None,
    tolerance: float | None = None,
    progress: CountProgress | None = None,
    samples: int | None = None,
    *,
    cases: Sequence[Values] | None = None,
) -> Choice:
    """The smallest discretisation found that meets the tolerance over ranges, or in all given load cases.

    Modes, nodes and rotation that the scene fixes are kept and verified.

    Args:
        scene: a validated scene.
        ranges: pairs of lower and upper end by column, such as ``push.force.x``, or by the name of an input or a
            parameter; for all else see :func:`cosserat_casadi.accuracy.ranges.input_ranges`.
        tolerance: wanted error of the tip poses relative to length; the scene's own by default.
        progress: receives the number of solved points.
        samples: number of random corners, and of random points, in addition to the ends of each range alone and of all;
            by default 16. In exact contact and beside thin obstacles that rub by default 2, and the ends of each range
            alone are left out.
        cases: inputs and parameters by name, at least one case, instead of ranges; others keep the scene's values.

    Raises:
        SceneError: a range, a case or the tolerance is refused.
    """
    if cases is not None and ranges:
        raise SceneError(Problem("cases", "stand beside ranges", "give one of them"))
    if tolerance is not None:
        scene = with_accuracy(scene, tolerance=tolerance)
    if cases is None:
        search = _Search(scene, input_ranges(scene, ranges), progress)
        if samples is None:
            samples = SAMPLES_IN_CONTACT if search.takes_long else SAMPLES
        search.begin(samples)
    else:
        if not cases:
            raise SceneError(Problem("cases", "must have at least one case"))
        layout = case_layout(scene)
        rows = np.array([layout.pack(values) for values in cases])
        search = _Search(scene, ranges_of_cases(layout, rows), progress)
        search.add(rows)
    if scene.accuracy.fixed:
        answers = Answers(discretise(scene))
    elif cases is None:
        answers = search.modes.refined(search.more)
    else:
        answers = search.modes.refined()
    return search.verdict(answers, every=cases is not None)


@dataclass
class _Search:
    """Points of ranges, and the search for the discretisation that serves them.

    Attributes:
        scene: the scene, with its tolerance.
        ranges: the ranges of inputs and parameters.
        progress: receives the number of solved points.
        points: tried cases, in the order in which they were added.
        samples: number of random points of each sort.
    """

    scene: scenes.Scene
    ranges: CaseRanges
    progress: CountProgress | None
    points: list[FloatArray] = field(default_factory=list)
    samples: int = 0

    def __post_init__(self) -> None:
        self._random = np.random.default_rng(SEED)
        self._bare = unfixed(self.scene, self.scene.accuracy.tolerance)
        self.modes = CommonModes([], self.progress, settles=False)
        self.takes_long = self.scene.touches_exactly or is_thin(self.scene)

    def add(self, points: Iterable[FloatArray]) -> list[int]:
        """Add points and return their indices."""
        new = list(points)
        self.points += new
        return self.modes.added(self._case(point) for point in new)

    def _case(self, point: FloatArray) -> LoadCase:
        values = self.ranges.layout.unpack(point)
        names = self.ranges.layout.parameters.names
        parameters = {name: value for name, value in values.items() if name in names}
        inputs = {name: value for name, value in values.items() if name not in parameters}
        return LoadCase(self._bare, inputs, parameters or None)

    def begin(self, samples: int) -> None:
        """Add the scene's own case, random corners, the ends of each range alone and of all, and random points."""
        self.add([self._own_point])
        if self.ranges.moving.size:
            self.samples = samples
            # Corners, which usually have the largest errors, come first.
            ends = [] if self.takes_long else self._ends()
            self.add([*self._corners(), *ends, self.ranges.lower, self.ranges.upper, *self._inner()])

    def more(self, answers: Answers) -> Iterator[list[int]]:
        """Points to which the worst one climbs; then fresh random ones."""
        if not self.takes_long:
            yield self._climbed(answers)
        yield self.add(self._inner())

    @property
    def _own_point(self) -> FloatArray:
        """The scene's own case, moved into the ranges."""
        return np.clip(self.ranges.layout.default, self.ranges.lower, self.ranges.upper)

    def _ends(self) -> Iterable[FloatArray]:
        """Cases in which one entry is at an end."""
        for k in self.ranges.moving:
            for end in (self.ranges.lower, self.ranges.upper):
                case = self._own_point
                case[k] = end[k]
                yield case

    def _corners(self) -> Iterable[FloatArray]:
        """Random corners."""
        for _ in range(self.samples):
            upper = self._random.random(len(self.ranges.lower)) < 0.5
            yield np.where(upper, self.ranges.upper, self.ranges.lower)

    def _inner(self) -> Iterable[FloatArray]:
        """Random points between the ends."""
        for _ in range(self.samples):
            share = self._random.random(len(self.ranges.lower))
            yield self.ranges.lower + share * (self.ranges.upper - self.ranges.lower)

    def _climbed(self, answers: Answers) -> list[int]:
        """New points to which the worst one climbs, each entry moved to the end that raises the error."""
        errors = {number: self.modes.error(answers, number) for number in range(len(self.points))}
        worst = max(errors, key=lambda number: errors[number])
        point = self.points[worst]
        error = errors[worst]
        made: list[int] = []
        for k in self._random.permutation(self.ranges.moving):
            for end in (self.ranges.lower, self.ranges.upper):
                if point[k] == end[k]:
                    continue
                trial = point.copy()
                trial[k] = end[k]
                (number,) = self.add([trial])
                made.append(number)
                tried = self.modes.error(answers, number)
                if tried > error:
                    point, error = trial, tried
        return made

    def verdict(self, answers: Answers, *, every: bool) -> Choice:
        """The choice of a discretisation, with an answer at every point.

        Args:
            answers: answers on that discretisation.
            every: whether every point must have an equilibrium.
        """
        chosen = on_elements_of(self.scene, answers.chosen)
        worst, error = self.modes.worst(answers)
        unpack = self.ranges.layout.unpack
        failed = [unpack(self.points[number]) for number in self.modes.without_equilibrium]
        largest = error if np.isfinite(error) else None
        within = largest is not None and largest <= self.scene.accuracy.tolerance
        locked = self.modes.locked(answers)
        met = within and not locked and not (every and failed)
        LOG.info("%d points, largest error %.1e, %d without equilibrium", len(self.points), error, len(failed))
        fixed = fixed_by_rod(self.scene, chosen, self.ranges.described)
        return Choice(
            scene=fixed,
            model=build(fixed, chosen),
            ranges=self.ranges,
            solves=len(self.points),
            error_estimate=largest,
            worst=unpack(self.points[worst]),
            without_equilibrium=tuple(failed),
            locked=locked,
            met=met,
        )
