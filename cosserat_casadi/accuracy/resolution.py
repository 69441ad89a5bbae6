"""How well a solution is resolved, told by itself: no finer model is built.

Its modes: drop the last two and the last four of every component and see the tips move. Two at a time, since
symmetry may empty every other one. Geometric extrapolation of the two changes is the error that the modes it has
leave, a careful one because spectral errors fall faster than that. Its grid: one look at a finer one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, log

import numpy as np

from cosserat_casadi.accuracy.preview import Preview
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.discretisation import Discretisation

CAREFUL, CAREFUL_GRID = 2.0, 1.5
"""Factors on the extrapolated error of the modes, and on the distance to a finer grid, which is not exact either."""

FASTEST, SLOWEST = 0.02, 0.7
"""Ratios of the errors with two modes more and without that are believed."""

UNKNOWN = 4
"""Further modes where the error is beyond all bounds and tells nothing."""

CLOSING = 3
"""Modes of an assembly below which nothing is told: with fewer its rods may not reach each other."""


@dataclass(frozen=True)
class Resolution:
    """Error of a solution's tips, position over length and rotation entries, in two parts.

    Attributes:
        preview: the solution.
    """

    preview: Preview

    @cached_property
    def ratio(self) -> float:
        """Share of the error that two modes more leave."""
        two, four = self._without(2), self._without(4)
        if not np.isfinite(two + four):
            return SLOWEST
        return float(np.clip(two / four, FASTEST, SLOWEST)) if four > 0 else FASTEST

    @cached_property
    def modes_error(self) -> float:
        """Error that the number of modes leaves."""
        return CAREFUL * self._without(2) * self.ratio / (1 - self.ratio)

    @cached_property
    def grid_error(self) -> float:
        """Error that the intervals and the rotation integrator leave."""
        modes = {name: d.modes for name, d in self._discretisation.items()}
        finer = {name: replace(d, nodes=d.nodes + d.nodes // 3 + 2) for name, d in self._discretisation.items()}
        return CAREFUL_GRID * _size(self.preview.grid_shift(self.preview.witness.x, modes, finer))

    def modes_lacking(self, bound: float) -> int:
        """Further modes per component after which the error of the modes should be below a bound."""
        error = self.modes_error
        if not np.isfinite(error):
            return UNKNOWN
        return 2 * ceil(log(bound / error) / log(self.ratio)) if error > bound else 0

    @property
    def _discretisation(self) -> dict[str, Discretisation]:
        return self.preview.model.discretisation

    def _without(self, count: int) -> float:
        least = CLOSING if self.preview.model.discrete.is_assembly else 1
        fewer = {n: tuple(max(min(m, least), m - count) for m in d.modes) for n, d in self._discretisation.items()}
        return _size(self.preview.mode_shift(fewer))


def _size(shift: FloatArray) -> float:
    """Largest change; infinite where a coarser model was so far off that it could not be foreseen."""
    return float(np.abs(shift).max()) if np.all(np.isfinite(shift)) else float("inf")
