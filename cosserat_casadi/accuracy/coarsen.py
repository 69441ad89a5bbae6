"""The cheapest discretisation whose tips stay within a bound of those of a witness.

Modes go first: each strain component of each rod keeps as few as its effect on the tips allows, which a tail of
coefficients does not tell. Then every rod gets the cheapest grid: intervals and order of the rotation integrator
together, since a low order with more intervals may cost less than a high one. What slack is left goes into modes again.
All of it is read off previews, exact to a per cent or so; no model is built.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import ceil

import numpy as np

from cosserat_casadi.accuracy.cost import foreseen_time, spread_on
from cosserat_casadi.accuracy.preview import Modes, Preview
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.rod.discretisation import Discretisation

MODES_SHARE = 0.6
"""Share of the bound that modes may use before grids are chosen."""

ORDERS = ((1e-4, ("magnus4",)), (1e-6, ("magnus6", "magnus4")), (0.0, ("magnus6", "magnus8")))
"""Rotation integrators that may be the cheapest for bounds down to one, the likely one first."""

LOOKS = 4
"""Most grids looked at for one rod and one integrator: each costs about a third of building a model."""

LIKELY, LEAST_LIKELY = 1.35, 1.15
"""Intervals for each mode of the component that has most: where a search begins, and below what a second is not."""

POWERS = {"magnus4": 4.5, "magnus6": 7.0, "magnus8": 9.0}
"""Powers of the intervals with which the change of the tips falls where only one grid is known."""

AIM = 0.7
"""Share of the bound that the next grid is aimed at."""

FEWEST = 2
"""Chebyshev intervals below which nothing is tried."""

MORE = 1.1
"""Factor on the intervals that would just resolve the witness: the trimmed rod may turn a little more somewhere."""

UNBOUNDED = 1e9
"""Excess of a grid that does not resolve the rod at all, so that its tips may be anything, no numbers too."""


@dataclass(frozen=True)
class Trimmed:
    """What a trim found.

    Attributes:
        discretisation: one for every rod.
        start: its unknowns, near its equilibrium, shape (n,).
    """

    discretisation: dict[str, Discretisation]
    start: FloatArray


@dataclass
class Trim:
    """One search below a witness.

    Attributes:
        preview: the witness, and what it foresees.
        bound: largest change of a tip pose: position over length, rotation entries.
    """

    preview: Preview
    bound: float

    def run(self) -> Trimmed:
        """The cheapest discretisation found."""
        modes = self._fewer(self._uniform(), np.zeros_like(self.preview.tips), MODES_SHARE * self.bound)
        grids, shift = self._grids(modes)
        trials = [self._fewer(start, shift, self.bound) for start in self._starts(modes, shift)]
        modes = min(trials, key=lambda trial: self._time(grids, trial))
        chosen = {name: replace(grids[name], modes=modes[name]) for name in grids}
        return Trimmed(chosen, self.preview.with_modes(modes)[self.preview.kept(modes)])

    # Modes

    @property
    def _full(self) -> dict[str, tuple[int, ...]]:
        return {name: d.modes for name, d in self.preview.model.discretisation.items()}

    def _uniform(self) -> dict[str, tuple[int, ...]]:
        """Fewest modes, the same number everywhere, within the share of the modes."""
        best = self._full
        for most in range(max(map(max, best.values())) - 1, 0, -1):
            trial = {name: tuple(min(m, most) for m in modes) for name, modes in best.items()}
            if _size(self.preview.mode_shift(trial)) > MODES_SHARE * self.bound:
                break
            best = trial
        return best

    def _starts(self, modes: Modes, shift: FloatArray) -> list[Modes]:
        """Modes to drop more from: those given, and all that are left below lower ceilings within the bound.

        Changes of the components may make up for each other: fewer modes everywhere may do where one less does not.
        """
        starts: list[Modes] = [modes]
        for ceiling in range(max(map(max, modes.values())) - 1, 0, -1):
            trial = {name: tuple(min(m, ceiling) for m in counts) for name, counts in modes.items()}
            change = self.preview.mode_shift(trial)
            if max(_size(change), _size(change + shift)) > self.bound:
                break
            starts.append(trial)
        return starts

    def _time(self, grids: Mapping[str, Discretisation], modes: Modes) -> float:
        """Foreseen time of all rods together, µs."""
        return sum(self.time(name, replace(grid, modes=modes[name])) for name, grid in grids.items())

    def time(self, name: str, discretisation: Discretisation) -> float:
        """Foreseen time of one rod, µs."""
        model = self.preview.model
        return foreseen_time(model.discrete.rods[name].properties, discretisation, spread_on(model.scene, name))

    def _fewer(self, modes: Modes, shift: FloatArray, bound: float) -> dict[str, tuple[int, ...]]:
        """Modes dropped one by one, each time where most cost goes for the least change of the tips.

        Args:
            modes: where to begin.
            shift: change of the tips that the grids make.
            bound: on the change of the tips that modes alone make, and on that which both make together.
        """
        here = dict(modes)
        open_places = {(names, place) for names in self._alike for place in range(len(here[names[0]]))}
        while open_places:
            trials = []
            for names, place in sorted(open_places):
                if here[names[0]][place] == 1:
                    open_places.discard((names, place))
                    continue
                trial = _less(here, names, place)
                change = self.preview.mode_shift(trial)
                size = max(_size(change), _size(change + shift))
                if size <= bound:
                    trials.append((size / self._saving(names[0], place), trial))
                else:
                    # What a component gives up grows with what others have: it stays closed.
                    open_places.discard((names, place))
            if trials:
                here = min(trials, key=lambda trial: trial[0])[1]
        return here

    @cached_property
    def _alike(self) -> list[tuple[str, ...]]:
        """Rods that are discretised alike: in an assembly those that admit the same strains, else each for itself."""
        discrete = self.preview.model.discrete
        if not discrete.is_assembly:
            return [(name,) for name in discrete.rods]
        found: dict[object, tuple[str, ...]] = {}
        for name, discrete_rod in discrete.rods.items():
            key = (discrete_rod.properties.admitted, discrete_rod.grid.elements)
            found[key] = (*found.get(key, ()), name)
        return list(found.values())

    def _saving(self, name: str, place: int) -> float:
        """Weight of a mode: those of bending and torsion cost about twice those of shear and extension."""
        return 2.0 if self.preview.model.discrete.rods[name].properties.admitted[place] < 3 else 1.0

    # Grids

    def _grids(self, modes: Modes) -> tuple[dict[str, Discretisation], FloatArray]:
        """The cheapest grid of every rod within the bound, and the change of the tips that all make together."""
        grids = {n: replace(d, modes=modes[n]) for n, d in self.preview.model.discretisation.items()}
        shift = np.zeros_like(self.preview.tips)
        for names in self._alike:
            search = _GridSearch(self, modes, grids, names, shift)
            found, shift = search.cheapest()
            grids.update({name: replace(grids[name], nodes=found.nodes, transport=found.transport) for name in names})
        return grids, shift


@dataclass
class _GridSearch:
    """Search for the grid of rods that are discretised alike, those of the others kept.

    Attributes:
        trim: bound and preview.
        modes: modes of every rod.
        grids: discretisations of every rod.
        names: the rods.
        before: change of the tips that the grids make now.
    """

    trim: Trim
    modes: Modes
    grids: dict[str, Discretisation]
    names: tuple[str, ...]
    before: FloatArray
    _seen: dict[tuple[str, int], FloatArray] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """One of the rods."""
        return self.names[0]

    def cheapest(self) -> tuple[Discretisation, FloatArray]:
        """The cheapest grid within the bound and the change of the tips with it."""
        start = self.grids[self.name]
        best, cost = (start.transport, start.nodes), np.inf  # a grid that is known to do
        turning = len(self.trim.preview.model.discrete.rods[self.name].properties.turning_axes)
        orders = next(names for least, names in ORDERS if self.trim.bound >= least)
        for order in orders if turning > 1 else orders[:1]:
            most = self._affordable(order, cost, start.nodes)
            found = self._fewest(order, most, first=cost == np.inf)
            if found is not None:
                best, cost = (order, found), self._cost(order, found)
        return self._grid(*best), self._seen.get(best, self.before)

    def _fewest(self, order: str, most: int, first: bool) -> int | None:
        """Fewest intervals, at most ``most``, with which an integrator stays within the bound; None if none do."""
        likely = max(FEWEST, round(LIKELY * max(self.modes[self.name])))
        if most < (self._fewest_resolving if first else LEAST_LIKELY / LIKELY * likely):
            return None
        enough, short = most + 1, min(most, self._fewest_resolving) - 1
        guess = min(most, max(likely, short + 1)) if first else most
        for _ in range(LOOKS):
            if self._within(order, guess):
                enough = guess
            else:
                short = guess
            if enough - short <= 1:
                break
            guess = min(max(self._next(order, guess), short + 1), enough - 1)
        return enough if enough <= most else None

    def _next(self, order: str, here: int) -> int:
        """Intervals that should just do: the change by the grid alone falls like a power of them, a high one."""
        power, excess = POWERS[order], self._excess(order, here)
        known = [n for o, n in self._seen if o == order and n != here]
        if known:
            near = min(known, key=lambda n: abs(n - here))
            slope = np.log(self._excess(order, near) / excess) / np.log(here / near)
            power = float(np.clip(slope, 4.0, 30.0))
        return int(np.ceil(here * (excess / AIM) ** (1 / power) - 0.1))

    def _within(self, order: str, nodes: int) -> bool:
        """Whether grids alone, and grids and modes together, change the tips by less than the bound."""
        together = self._shift(order, nodes) + self.trim.preview.mode_shift(self.modes)
        return max(self._excess(order, nodes), _size(together) / self.trim.bound) <= 1

    def _excess(self, order: str, nodes: int) -> float:
        """Change of the tips by grids alone over the bound; rounding apart, and bounded where nothing is resolved."""
        excess = _size(self._shift(order, nodes)) / self.trim.bound
        return max(excess, 1e-9) if excess < UNBOUNDED else UNBOUNDED

    def _shift(self, order: str, nodes: int) -> FloatArray:
        if (order, nodes) not in self._seen:
            trial = self.grids | {n: replace(self.grids[n], nodes=nodes, transport=order) for n in self.names}
            self._seen[order, nodes] = self.trim.preview.grid_shift(self._unknowns, self.modes, trial)
        return self._seen[order, nodes]

    @cached_property
    def _fewest_resolving(self) -> int:
        """Intervals below which one would turn too far, from the turns of the witness."""
        witness = self.trim.preview.witness
        turning = (
            float(witness.model.coarseness(witness.x, witness.inputs)) * witness.model.discretisation[self.name].nodes
        )
        return max(FEWEST, ceil(MORE * turning))

    @cached_property
    def _unknowns(self) -> FloatArray:
        return self.trim.preview.with_modes(self.modes)

    def _affordable(self, order: str, cost: float, most: int) -> int:
        """Most intervals with which an integrator is cheaper than what is known."""
        while most >= FEWEST and self._cost(order, most) >= cost:
            most -= 1
        return most

    def _cost(self, order: str, nodes: int) -> float:
        return self.trim.time(self.name, self._grid(order, nodes))

    def _grid(self, order: str, nodes: int) -> Discretisation:
        return replace(self.grids[self.name], nodes=nodes, transport=order)


def _less(modes: Modes, names: tuple[str, ...], place: int) -> dict[str, tuple[int, ...]]:
    """The same modes but for one less in a place of some rods."""
    counts = list(modes[names[0]])
    counts[place] -= 1
    return {**modes, **dict.fromkeys(names, tuple(counts))}


def _size(shift: FloatArray) -> float:
    return float(np.abs(shift).max())
