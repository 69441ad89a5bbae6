"""How well a solution is resolved, from itself: no finer model is built.

Its modes: drop the last two and the last four of every component and see the tips move. Two at a time, since
symmetry may empty every other one. Geometric extrapolation of the two changes is the error that the modes it has
leave, a careful one where errors fall faster than that. Its grid: one look at a finer one.

Not all errors fall so regularly. Waves along a rod do not show in its last coefficients. The error of a rod with
supports falls in uneven steps: where the last two modes happen to do little, both the change that they make and its
ratio to the one before are small, and their product says far too little; for a free rod under strong loads it may do so
too. And tips are superconvergent: their change tells nothing of the sections between, which are farther off. So a look
is taken at modes that the solution lacks, and at how both move by them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, log

import numpy as np

from cosserat_casadi.accuracy.preview import FinerShift, Preview
from cosserat_casadi.equilibrium.answer_error import SLOWEST
from cosserat_casadi.maths.pose_change import change_size
from cosserat_casadi.model.required_modes import WAVES_FACTOR
from cosserat_casadi.rod.discretisation import Discretisation

MODES_SAFETY = 2.0
"""Factor on the extrapolated error of the modes."""

GRID_SAFETY = 1.5
"""Factor on the distance to a finer grid, which is not exact either."""

SUM_SAFETY = 2.0
"""Factor on the change by finer sums of layers, whose stiffness changes with them."""

FASTEST = 0.02
"""Smallest ratio of the errors with and without two more modes that is believed."""

FURTHER_MODES = 4
"""Modes and intervals added for a look at rods without waves, more than one uneven step of their error."""

SWEEPS = 1
"""Sweeps of a look at rods without supports: stiffness holds added modes, and a few per cent of the error are left."""

LOADED_SWEEPS = 2
"""Sweeps of a look at rods with supports or waves, where what follows the added modes moves them in turn."""

HIDDEN_SAFETY = 1.5
"""Factor on what that look finds."""

NEGLIGIBLE = 0.01
"""Share of the allowed error below which an extrapolated one is believed: ten times as much would not matter."""

UNKNOWN = 4
"""Further modes where the error is beyond all bounds and tells nothing."""

CLOSING = 3
"""Modes of an assembly that are always kept: with fewer its rods may not reach each other."""

TELLING = CLOSING + 4
"""Modes of an assembly from which on two less and four less are two solutions, whose errors tell how fast they fall."""


@dataclass(frozen=True)
class Resolution:
    """Pose error of a solution: of its tips, in two parts, and of all its sections.

    Attributes:
        preview: the solution.
        waves: whether the scene puts waves along its rods, so that the last coefficients may not show what follows.
        allowed: error of the modes that is allowed; with 0 no extrapolated one is negligible.
    """

    preview: Preview
    waves: bool = False
    allowed: float = 0.0

    @cached_property
    def ratio(self) -> float:
        """Share of the error that two modes more leave."""
        two_less = self._shift_without(2)
        four_less = self._shift_without(4)
        if not np.isfinite(two_less + four_less):
            return SLOWEST
        if four_less <= 0:
            # Not even four modes are felt, as in an unloaded rod.
            return FASTEST
        return float(np.clip(two_less / four_less, FASTEST, SLOWEST))

    @cached_property
    def modes_error(self) -> float:
        """Error that the number of modes leaves."""
        return max(self.extrapolated_error, self.hidden_error)

    @cached_property
    def hidden_error(self) -> float:
        """Error found by a look at modes that the solution lacks; 0 where the extrapolated one is negligible."""
        if self._sweeps == 0:
            return 0.0
        return HIDDEN_SAFETY * (1 + self._beyond) * change_size(self._look.tips)

    @cached_property
    def extrapolated_error(self) -> float:
        """The rest of a geometric series after the last two modes."""
        two_less = self._shift_without(2)
        # The last two modes carry e; all that would follow r e + r² e + … = e r / (1 − r).
        return MODES_SAFETY * two_less * self.ratio / (1 - self.ratio)

    @cached_property
    def grid_error(self) -> float:
        """Error that the intervals and the rotation integrator leave."""
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
        """Error that sums of layers leave."""
        return SUM_SAFETY * change_size(self.preview.sums_shift())

    @cached_property
    def tip_error(self) -> float:
        """Error of the watched poses and cables."""
        return self.modes_error + self.grid_error + self.sum_error

    @cached_property
    def shape_error(self) -> float:
        """Error of all sections, sections between nodes included; no smaller than the error of the tips."""
        between = HIDDEN_SAFETY * (1 + self._beyond) * change_size(self._look.shapes)
        return max(self.modes_error, between) + self.grid_error + self.sum_error

    def missing_modes(self, error: float, bound: float) -> int:
        """Further modes per component after which an error of the modes should be below a bound."""
        if not np.isfinite(error):
            return UNKNOWN
        if error <= bound:
            return 0
        # Every two modes leave the share ``ratio`` of the error: ratioⁿ error = bound.
        pairs = log(bound / error) / log(self.ratio)
        return 2 * ceil(pairs)

    @cached_property
    def _sweeps(self) -> int:
        """Sweeps of the look; 0 where what the tips do needs none."""
        if self.waves or self.preview.model.scene.supports:
            return LOADED_SWEEPS
        # A layer presses a part of an element, which few modes do not feel at all.
        if self.extrapolated_error < NEGLIGIBLE * self.allowed and not self.preview.model.discrete.pressed_rods:
            return 0
        return SWEEPS

    @cached_property
    def _beyond(self) -> float:
        """Change by modes beyond the modes of the look, over the change that the look tells."""
        return self.preview.model.discrete.share_of_more_modes(FURTHER_MODES)

    @cached_property
    def _look(self) -> FinerShift:
        """Change by modes that the solution lacks."""
        finer = {}
        for name, discretisation in self.preview.model.discretisation.items():
            finer[name] = self._looked_at(discretisation)
        return self.preview.finer_shift(finer, self._sweeps)

    def _looked_at(self, discretisation: Discretisation) -> Discretisation:
        """The finer discretisation of a rod at which a look is taken."""
        if self.waves:
            # Products of waves have twice their frequency.
            modes = tuple(WAVES_FACTOR * m for m in discretisation.modes)
            return replace(discretisation, modes=modes, nodes=WAVES_FACTOR * discretisation.nodes)
        modes = tuple(m + FURTHER_MODES for m in discretisation.modes)
        return replace(discretisation, modes=modes, nodes=discretisation.nodes + FURTHER_MODES)

    def _shift_without(self, count: int) -> float:
        """Largest change of the watched poses with so many modes less of every component."""
        assembly = self.preview.model.discrete.is_assembly
        least = CLOSING if assembly else 1
        fewer = {}
        for name, discretisation in self.preview.model.discretisation.items():
            # No component loses its last mode, and none gains one.
            kept = [max(min(m, least), m - count) for m in discretisation.modes]
            fewer[name] = tuple(kept)
        shift = self.preview.mode_shift(fewer)
        return change_size(shift)
