"""Error estimate of a solution without building a finer model.

Modes: drop the last two and the last four of every component and compute the changes of the tips. They are dropped in
pairs, since symmetry may make every other mode zero. Geometric extrapolation of the two changes is the error by the
number of modes, a cautious one if errors fall faster. Grid: one evaluation on a finer grid.

Not all errors fall so regularly. Waves along a rod do not show in its last coefficients. The error of a rod with
supports falls in uneven steps: if the last two modes happen to have a small effect, both their change and its ratio to
the change before are small, and their product is far too small; for a free rod under strong loads it may be so too. And
tips are superconvergent: their change does not tell the error of the sections between, which is larger. So changes of
tips and sections by missing modes are computed too, called the look.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, log

import numpy as np

from cosserat_casadi.accuracy.preview import FinerShift, Preview
from cosserat_casadi.equilibrium.answer_error import SLOWEST
from cosserat_casadi.equilibrium.metrics import largest_turn
from cosserat_casadi.maths.pose_change import change_size
from cosserat_casadi.model.required_modes import WAVES_FACTOR, modes_for_turn
from cosserat_casadi.rod.discretisation import Discretisation

MODES_SAFETY = 2.0
"""Safety factor on the extrapolated error of the modes."""

GRID_SAFETY = 1.5
"""Safety factor on the distance from a finer grid, which is not exact either."""

SUM_SAFETY = 2.0
"""Safety factor on the change by finer sums of layers, whose stiffness changes with them."""

FASTEST = 0.02
"""Smallest ratio of the errors with and without two more modes that is believed."""

FURTHER_MODES = 4
"""Modes and intervals that a look adds to rods without waves, more than one uneven step of their error."""

SWEEPS = 1
"""Sweeps of a look at rods without supports: stiffness dominates added modes, and the error is exact to a few per
cent."""

LOADED_SWEEPS = 2
"""Sweeps of a look at rods with supports or waves, in which unknowns that follow the added modes move these in turn."""

HIDDEN_SAFETY = 1.5
"""Safety factor on the change by that look."""

NEGLIGIBLE = 0.01
"""Share of the allowed error below which an extrapolated error is believed: ten times as much would be allowed."""

UNKNOWN = 4
"""Further modes for an error that is above all bounds and tells nothing."""

CLOSING = 3
"""Least modes of an assembly: with fewer its rods may not reach each other."""

TELLING = CLOSING + 4
"""Least modes of an assembly for which two less and four less give different solutions, and so a rate of
convergence."""


@dataclass(frozen=True)
class Resolution:
    """Pose errors of a solution: error of its tips, in two parts, and of all its sections.

    Attributes:
        preview: the solution.
        waves: whether the scene makes waves along its rods, so that the last coefficients may not show the missing
            ones.
        allowed: allowed error of the modes; with 0 no extrapolated error is negligible.
    """

    preview: Preview
    waves: bool = False
    allowed: float = 0.0

    @cached_property
    def ratio(self) -> float:
        """Ratio of the errors with and without two more modes."""
        two_less = self._shift_without(2)
        four_less = self._shift_without(4)
        if not np.isfinite(two_less + four_less):
            return SLOWEST
        if four_less <= 0:
            # Not even four modes have an effect, as in an unloaded rod.
            return FASTEST
        return float(np.clip(two_less / four_less, FASTEST, SLOWEST))

    @cached_property
    def modes_error(self) -> float:
        """Error by the number of modes."""
        return max(self.extrapolated_error, self.hidden_error)

    @cached_property
    def hidden_error(self) -> float:
        """Error by a look at missing modes; 0 if the extrapolated error is negligible."""
        if self._sweeps == 0:
            return 0.0
        return HIDDEN_SAFETY * (1 + self._beyond) * change_size(self._look.tips)

    @cached_property
    def extrapolated_error(self) -> float:
        """Remainder of a geometric series after the last two modes."""
        two_less = self._shift_without(2)
        # The last two modes change the tips by e; all further ones by r e + r² e + … = e r / (1 − r).
        return MODES_SAFETY * two_less * self.ratio / (1 - self.ratio)

    @cached_property
    def grid_error(self) -> float:
        """Error by the intervals and the rotation integrator."""
        modes = {}
        finer = {}
        for name, discretisation in self.preview.model.discretisation.items():
            nodes = discretisation.nodes
            modes[name] = discretisation.modes
            finer[name] = replace(discretisation, nodes=nodes + nodes // 3 + 2)
        shift = self.preview.grid_shift(self.preview.reference.x, modes, finer)
        return GRID_SAFETY * change_size(shift)

    @cached_property
    def sum_error(self) -> float:
        """Error by sums of layers."""
        return SUM_SAFETY * change_size(self.preview.sums_shift())

    @cached_property
    def fibre_error(self) -> float:
        """Error by sums of laws over the fibres of sections."""
        return SUM_SAFETY * change_size(self.preview.fibres_shift())

    @cached_property
    def tip_error(self) -> float:
        """Error of the watched poses and cables."""
        return self.modes_error + self._error_but_modes

    @cached_property
    def _error_but_modes(self) -> float:
        """Error by the intervals and by sums."""
        return self.grid_error + self.sum_error + self.fibre_error

    @cached_property
    def shape_error(self) -> float:
        """Error of all sections, sections between nodes included; no smaller than the error of the tips."""
        between = HIDDEN_SAFETY * (1 + self._beyond) * change_size(self._look.shapes)
        return max(self.modes_error, between) + self._error_but_modes

    def missing_modes(self, error: float, bound: float) -> int:
        """Further modes per component after which an error of the modes should be below a bound."""
        if not np.isfinite(error):
            return UNKNOWN
        if error <= bound:
            return 0
        # Every two modes multiply the error by ``ratio``: ratioⁿ error = bound.
        pairs = log(bound / error) / log(self.ratio)
        return 2 * ceil(pairs)

    @cached_property
    def _sweeps(self) -> int:
        """Sweeps of the look; 0 if the tips need none."""
        if self.waves or self.preview.model.scene.supports:
            return LOADED_SWEEPS
        is_negligible = self.extrapolated_error < NEGLIGIBLE * self.allowed
        if not is_negligible:
            return SWEEPS
        # A layer presses a part of an element, and products of waves are short: few modes do not show these at all.
        is_hidden = self._product_modes or self.preview.model.discrete.pressed_rods
        return SWEEPS if is_hidden else 0

    @cached_property
    def _product_modes(self) -> int:
        """Modes that show products of waves along an element that turns more than once; 0 without such an element."""
        return WAVES_FACTOR * modes_for_turn(largest_turn(self.preview.reference))

    @cached_property
    def _beyond(self) -> float:
        """Change by modes beyond the modes of the look, over the change by the look."""
        return self.preview.model.discrete.share_of_more_modes(FURTHER_MODES)

    @cached_property
    def _look(self) -> FinerShift:
        """Change by missing modes."""
        grids = self.preview.model.discretisation
        return self.preview.finer_shift({name: self._looked_at(own) for name, own in grids.items()}, self._sweeps)

    def _looked_at(self, discretisation: Discretisation) -> Discretisation:
        """The finer discretisation of a rod for the look."""
        if self.waves:
            # Products of waves have twice their frequency.
            modes = tuple(WAVES_FACTOR * m for m in discretisation.modes)
            return replace(discretisation, modes=modes, nodes=WAVES_FACTOR * discretisation.nodes)
        modes = tuple(max(m + FURTHER_MODES, self._product_modes) for m in discretisation.modes)
        return replace(discretisation, modes=modes, nodes=max(discretisation.nodes, *modes) + FURTHER_MODES)

    def _shift_without(self, count: int) -> float:
        """Largest change of the watched poses with ``count`` modes less in every component."""
        assembly = self.preview.model.discrete.is_assembly
        least = CLOSING if assembly else 1
        fewer = {}
        for name, discretisation in self.preview.model.discretisation.items():
            # Every component keeps one mode, and none gains one.
            fewer[name] = tuple(max(min(m, least), m - count) for m in discretisation.modes)
        shift = self.preview.mode_shift(fewer)
        return change_size(shift)
