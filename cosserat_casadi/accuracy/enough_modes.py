"""The modes and intervals that an answer lacks, from the correction that tells its error (docs/theory.md, section 10).

The missing coordinates of a settled correction say how much there would be of each mode that the answer lacks. A mode
is added where that lessens most what the rest of them would still change, until little is left of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

import numpy as np

from cosserat_casadi.accuracy.coarsen import POWERS, alike_rods
from cosserat_casadi.accuracy.fixing import Chosen
from cosserat_casadi.equilibrium.answer_error import (
    believed_correction,
    change_with_following,
    inverse_jacobian,
    richer_balance,
    safety_for,
)
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.maths.typing import FloatArray
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
