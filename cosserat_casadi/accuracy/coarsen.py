"""The cheapest discretisation whose tips stay within a bound of the tips of a reference solution.

Modes are dropped first: each strain component of each rod keeps as few as its effect on the tips allows, which a tail
of coefficients does not tell. Then every rod gets the cheapest grid, intervals and order of the rotation integrator
together, since a low order with more intervals may cost less than a high one. The remaining slack drops further modes.
All changes are taken from previews, exact to about a per cent; no model is built.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import ceil

import numpy as np

from cosserat_casadi.accuracy.cost import foreseen_time, spread_on
from cosserat_casadi.accuracy.preview import Modes, Preview
from cosserat_casadi.maths.pose_change import change_size
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.rod.discretisation import Discretisation

MODES_SHARE = 0.6
"""Share of the bound that modes may use before grids are chosen."""

TRANSPORTS = ((1e-4, ("magnus4",)), (1e-6, ("magnus6", "magnus4")), (0.0, ("magnus6", "magnus8")))
"""Rotation integrators that may be the cheapest for bounds down to one, the likely one first."""

WAVE_STEPS = (8, 1)
"""Numbers of modes dropped at once in scenes with waves, which need many modes; else one at a time."""

MOST_TRIALS = 4
"""Most grids previewed for one rod and one integrator: each costs about a third of building a model."""

LIKELY = 1.35
"""Intervals for each mode of the component with most modes, at the start of a search."""

LEAST_LIKELY = 1.15
"""Intervals for each mode below which a second integrator is not tried."""

POWERS = {"magnus4": 4.5, "magnus6": 7.0, "magnus8": 9.0}
"""Powers of the intervals with which the change of the tips is assumed to fall if one grid is known."""

STEEPEST = 30.0
"""Largest power that is assumed from two grids."""

FLATTEST = 4.0
"""Smallest power that is assumed from two grids."""

AIM = 0.7
"""Share of the bound at which the next grid is aimed."""

FEWEST = 2
"""Least number of Chebyshev intervals."""

NODES_MARGIN = 1.1
"""Factor on the intervals that would just resolve the reference: a coarser rod may turn a little more somewhere."""

SINGLE = (2, 5)
"""Indices of torsion and extension, which belong to no pair of strains of a round rod."""

UNBOUNDED = 1e9
"""Excess of a grid that does not resolve the rod, so that its tips may be arbitrary, even NaN."""

ROUNDING = 1e-9
"""Smallest excess of a grid above rounding."""


def alike_rods(model: Model) -> list[tuple[str, ...]]:
    """Groups of rods with one discretisation: in an assembly rods with the same admitted strains, else each rod."""
    discrete = model.discrete
    if not discrete.is_assembly:
        return [(name,) for name in discrete.rods]
    groups: dict[object, tuple[str, ...]] = {}
    for name, discrete_rod in discrete.rods.items():
        # One choice for a group lets generated code share its kernels.
        key = (discrete_rod.properties.admitted, discrete_rod.grid.elements)
        group = groups.get(key, ())
        groups[key] = (*group, name)
    return list(groups.values())


@dataclass
class Coarsening:
    """One search below a reference solution.

    Attributes:
        preview: the reference, and the changes that it foresees.
        bound: largest change of a tip pose: distance over length, angle in rad.
        wave_modes: modes that waves along a rod need, 0 without waves: on fewer intervals a wave is aliased to a longer
            one, and the residual is too wrong for a preview.
        round: whether both bendings, and both shears, keep one number of modes: with unequal ones a round rod that may
            turn about an axis, by symmetry, would turn far.
    """

    preview: Preview
    bound: float
    wave_modes: int = 0
    round: bool = False

    def run(self) -> tuple[dict[str, Discretisation], FloatArray]:
        """The cheapest discretisation of every rod, and unknowns near its equilibrium, shape (n,)."""
        no_shift = self.preview.no_shift
        uniform_modes = self._uniform_modes()
        first_modes = self._drop_modes(uniform_modes, no_shift, MODES_SHARE * self.bound)
        grids, shift = self._coarsen_grids(first_modes)
        starts = self._starting_modes(first_modes, shift)
        trials = [self._drop_modes(start, shift, self.bound) for start in starts]
        modes = min(trials, key=lambda trial: self._scene_time(grids, trial))
        chosen = {name: replace(grid, modes=modes[name]) for name, grid in grids.items()}
        unknowns = self.preview.with_modes(modes)
        kept = self.preview.kept(modes)
        return chosen, unknowns[kept]

    def rod_time(self, name: str, discretisation: Discretisation) -> float:
        """Predicted time of one rod, µs."""
        model = self.preview.model
        rod = model.discrete.rods[name].properties
        spread = spread_on(model.scene, name)
        return foreseen_time(rod, discretisation, spread)

    @cached_property
    def alike(self) -> list[tuple[str, ...]]:
        """Groups of rods with one discretisation."""
        return alike_rods(self.preview.model)

    def _scene_time(self, grids: Mapping[str, Discretisation], modes: Modes) -> float:
        """Predicted time of all rods together, µs."""
        time = 0.0
        for name, grid in grids.items():
            discretisation = replace(grid, modes=modes[name])
            time += self.rod_time(name, discretisation)
        return time

    # Modes

    def _uniform_modes(self) -> dict[str, tuple[int, ...]]:
        """Fewest modes, the same number everywhere, within the share of the modes."""
        discretisation = self.preview.model.discretisation
        best = {name: d.modes for name, d in discretisation.items()}
        for ceiling in range(_most(best) - 1, 0, -1):
            trial = _below_ceiling(best, ceiling)
            shift = self.preview.mode_shift(trial)
            if change_size(shift) > MODES_SHARE * self.bound:
                break
            best = trial
        return best

    def _starting_modes(self, modes: Modes, grid_shift: FloatArray) -> list[Modes]:
        """Starts for dropping modes: the argument, and its modes below each lower ceiling that is within the bound.

        Changes of the components may cancel: fewer modes everywhere may be within the bound while one less is not.
        """
        starts: list[Modes] = [modes]
        for ceiling in range(_most(modes) - 1, 0, -1):
            trial = _below_ceiling(modes, ceiling)
            # Lower ceilings leave out these modes too, and more.
            if self._largest_shift(trial, grid_shift) > self.bound:
                break
            starts.append(trial)
        return starts

    def _drop_modes(self, modes: Modes, grid_shift: FloatArray, bound: float) -> dict[str, tuple[int, ...]]:
        """Drop modes step by step, each time the one with the least change of the tips for its cost.

        Args:
            modes: modes to begin with.
            grid_shift: change of the tips by the grids.
            bound: bound on the change of the tips by modes alone, and by modes and grids together.
        """
        current = dict(modes)
        steps = WAVE_STEPS if self.wave_modes else (1,)
        for step in steps:
            current = self._drop_by(step, current, grid_shift, bound)
        return current

    def _drop_by(
        self,
        step: int,
        modes: Modes,
        grid_shift: FloatArray,
        bound: float,
    ) -> dict[str, tuple[int, ...]]:
        """Drop ``step`` modes at a time."""
        current = dict(modes)
        droppable: set[tuple[tuple[str, ...], int]] = set()
        for names in self.alike:
            admitted = self.preview.model.discrete.rods[names[0]].properties.admitted
            single = [component for component, strain in enumerate(admitted) if not self.round or strain in SINGLE]
            droppable.update((names, component) for component in single)
        while droppable:
            best_rate = np.inf
            best_trial = None
            for names, component in sorted(droppable):
                if current[names[0]][component] == 1:
                    droppable.discard((names, component))
                    continue
                trial = _fewer(current, names, component, step)
                shift = self._largest_shift(trial, grid_shift)
                if not shift <= bound:
                    # The change by dropping a mode grows as others are dropped: a component that has failed once is not
                    # tried again.
                    droppable.discard((names, component))
                    continue
                rate = shift / self._mode_weight(names[0], component)
                if best_trial is None or rate < best_rate:
                    best_rate = rate
                    best_trial = trial
            if best_trial is not None:
                current = best_trial
        return current

    def _largest_shift(self, modes: Modes, grid_shift: FloatArray) -> float:
        """Largest change of the tips by modes alone, or by modes and grids together."""
        mode_shift = self.preview.mode_shift(modes)
        together = mode_shift + grid_shift
        return max(change_size(mode_shift), change_size(together))

    def _mode_weight(self, name: str, component: int) -> float:
        """Weight of a mode: a mode of bending or torsion costs about twice a mode of shear or extension."""
        rod = self.preview.model.discrete.rods[name].properties
        turns_sections = rod.admitted[component] < 3
        return 2.0 if turns_sections else 1.0

    # Grids

    def _coarsen_grids(self, modes: Modes) -> tuple[dict[str, Discretisation], FloatArray]:
        """The cheapest grid of every rod within the bound, and the change of the tips that all make together."""
        grids = {}
        for name, discretisation in self.preview.model.discretisation.items():
            grids[name] = replace(discretisation, modes=modes[name])
        shift = self.preview.no_shift
        for names in self.alike:
            search = _GridSearch(self, modes, grids, names, shift)
            cheapest, shift = search.cheapest()
            for name in names:
                grids[name] = replace(grids[name], nodes=cheapest.nodes, transport=cheapest.transport)
        return grids, shift


@dataclass
class _GridSearch:
    """Search for the grid of a group of rods; grids of other rods are kept.

    Attributes:
        coarsening: the search below the reference, with bound and preview.
        modes: modes of every rod.
        grids: discretisations of every rod.
        names: the rods.
        shift_before: change of the tips by the present grids.
    """

    coarsening: Coarsening
    modes: Modes
    grids: dict[str, Discretisation]
    names: tuple[str, ...]
    shift_before: FloatArray
    _shifts: dict[tuple[str, int], FloatArray] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name of the first rod of the group, which represents all."""
        return self.names[0]

    def cheapest(self) -> tuple[Discretisation, FloatArray]:
        """The cheapest grid within the bound and the change of the tips with it."""
        # The grid of the reference is sufficient, if nothing cheaper is found.
        start = self.grids[self.name]
        best = start
        best_time = np.inf
        for transport in self._candidate_transports():
            most = self._affordable(transport, best_time, start.nodes)
            nodes = self._fewest(transport, most, first=best_time == np.inf)
            if nodes is not None:
                best = self._grid(transport, nodes)
                best_time = self._time(transport, nodes)
        shift = self._shifts.get((best.transport, best.nodes), self.shift_before)
        return best, shift

    def _candidate_transports(self) -> tuple[str, ...]:
        """Rotation integrators to compare; for a rod that turns about one axis all are equal."""
        suitable = (names for least, names in TRANSPORTS if self.coarsening.bound >= least)
        transports = next(suitable)
        rod = self.coarsening.preview.model.discrete.rods[self.name].properties
        if len(rod.turning_axes) > 1:
            return transports
        return transports[:1]

    def _fewest(self, transport: str, most: int, first: bool) -> int | None:
        """Fewest intervals with which an integrator stays within the bound, by bisection with aimed guesses.

        Args:
            transport: the integrator.
            most: largest affordable number of intervals.
            first: whether no sufficient integrator is known yet.

        Returns:
            None if none do.
        """
        polynomials = max(*self.modes[self.name], self.coarsening.wave_modes)
        likely = max(FEWEST, round(LIKELY * polynomials))
        sufficient = most + 1
        insufficient = min(most, self._fewest_resolving) - 1
        if first:
            least_promising: float = self._fewest_resolving
            guess = min(most, max(likely, insufficient + 1))
        else:
            # Fewer intervals are tried only if the largest affordable number is sufficient.
            least_promising = LEAST_LIKELY / LIKELY * likely
            guess = most
        if most < least_promising:
            return None
        # The bracket (insufficient, sufficient] closes from both ends.
        for _ in range(MOST_TRIALS):
            if self._within(transport, guess):
                sufficient = guess
            else:
                insufficient = guess
            if sufficient - insufficient <= 1:
                break
            aimed = self._aimed(transport, guess)
            guess = min(max(aimed, insufficient + 1), sufficient - 1)
        if sufficient > most:
            return None
        return sufficient

    def _aimed(self, transport: str, nodes: int) -> int:
        """Intervals that should just suffice: the change by the grid falls with a high power of their number."""
        power = POWERS[transport]
        excess = self._excess(transport, nodes)
        compared = [n for name, n in self._shifts if name == transport and n != nodes]
        if compared:
            nearest = min(compared, key=lambda n: abs(n - nodes))
            ratio = self._excess(transport, nearest) / excess
            slope = np.log(ratio) / np.log(nodes / nearest)
            power = float(np.clip(slope, FLATTEST, STEEPEST))
        # The excess falls with this power; it is to come down to the aim.
        factor = (excess / AIM) ** (1 / power)
        # A tenth of an interval is not rounded up to a whole one.
        return int(np.ceil(nodes * factor - 0.1))

    def _within(self, transport: str, nodes: int) -> bool:
        """Whether grids alone, and grids and modes together, change the tips by less than the bound."""
        grid_shift = self._shift(transport, nodes)
        mode_shift = self.coarsening.preview.mode_shift(self.modes)
        excess = self._excess(transport, nodes)
        # Grids alone are tested too: a change that cancels the change by modes would be chance.
        together = grid_shift + mode_shift
        excess_together = change_size(together) / self.coarsening.bound
        return max(excess, excess_together) <= 1

    def _excess(self, transport: str, nodes: int) -> float:
        """Change of the tips by grids alone over the bound; at least rounding, and bounded for unresolved rods."""
        excess = change_size(self._shift(transport, nodes)) / self.coarsening.bound
        if excess < UNBOUNDED:
            return max(excess, ROUNDING)
        return UNBOUNDED

    def _shift(self, transport: str, nodes: int) -> FloatArray:
        """Change of the tips with this grid on the rods of the group."""
        key = (transport, nodes)
        if key not in self._shifts:
            trial = dict(self.grids)
            for name in self.names:
                trial[name] = replace(self.grids[name], nodes=nodes, transport=transport)
            self._shifts[key] = self.coarsening.preview.grid_shift(self._unknowns, self.modes, trial)
        return self._shifts[key]

    @cached_property
    def _fewest_resolving(self) -> int:
        """Least intervals none of which turns too far, from the turns of the reference."""
        reference = self.coarsening.preview.reference
        model = reference.model
        nodes = model.discretisation[self.name].nodes
        # The turn of an interval is inverse to their number.
        resolution_index = float(model.resolution_index(reference.x, reference.inputs))
        resolving = resolution_index * nodes
        # If sections sum layers the tips allow few nodes; with fewer nodes than modes no error estimate settles.
        modes = max(self.modes[self.name]) + 1 if self.grids[self.name].sections else 0
        return max(FEWEST, ceil(NODES_MARGIN * resolving), self.coarsening.wave_modes, modes)

    @cached_property
    def _unknowns(self) -> FloatArray:
        return self.coarsening.preview.with_modes(self.modes)

    def _affordable(self, transport: str, time: float, most: int) -> int:
        """Most intervals with which an integrator is cheaper than the best one so far."""
        while most >= FEWEST and self._time(transport, most) >= time:
            most -= 1
        return most

    def _time(self, transport: str, nodes: int) -> float:
        grid = self._grid(transport, nodes)
        return self.coarsening.rod_time(self.name, grid)

    def _grid(self, transport: str, nodes: int) -> Discretisation:
        current = self.grids[self.name]
        return replace(current, nodes=nodes, transport=transport)


def _fewer(modes: Modes, names: tuple[str, ...], component: int, step: int) -> dict[str, tuple[int, ...]]:
    """Modes with ``step`` modes less for a component of some rods, which keeps one mode at least."""
    # Rods of a group have equal modes.
    counts = list(modes[names[0]])
    counts[component] = max(1, counts[component] - step)
    changed = dict.fromkeys(names, tuple(counts))
    return {**modes, **changed}


def _below_ceiling(modes: Modes, ceiling: int) -> dict[str, tuple[int, ...]]:
    """Modes limited to a ceiling in each component."""
    lowered = {}
    for name, counts in modes.items():
        lowered[name] = tuple(min(m, ceiling) for m in counts)
    return lowered


def _most(modes: Modes) -> int:
    most_of_rods = [max(counts) for counts in modes.values()]
    return max(most_of_rods)
