"""Refinement levels: uniform discretisations, one finer than the next."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.contact_layers import seeing_nodes, seeing_sections
from cosserat_casadi.model.discretise import discretise, nodes_for
from cosserat_casadi.model.element_ends import NARROWEST, element_ends
from cosserat_casadi.model.required_modes import most_wave_modes, unloaded_turn
from cosserat_casadi.model.scene_rods import rod_properties
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.scene.accuracy import MOST_FIBRES, MOST_SECTIONS

REFERENCE_MODES = (3, 5, 7, 9, 12, 15, 19, 24, 30, 38, 48, 64, 80, 100, 128)
"""Modes per strain component and element of a reference solution, level by level."""

USUAL_MODES = 64
"""Modes of the finest level for a scene whose signals do not ask for more, even if it does not converge there."""

SIGNAL_FACTOR = 2
"""Factor on the modes for the signals of a scene up to which levels are tried."""

FIRST_LEVELS = ((1e-4, 1), (0.0, 2))
"""First level for tolerances down to a bound; lower levels cannot show the rate of convergence."""

MOST_LEVELS = 3
"""Most levels in one step with extrapolated modes: convergence may be faster than extrapolated."""

GRID_FACTOR = 1.4
"""Factor on the intervals after a grid was too coarse."""

MOST_GRID_FACTOR = 4.0
"""Product of the factors on the intervals above which the grid is given up."""

VERIFIED_MODES = (6, 9, 12, 16, 21, 28, 36, 48)
"""Modes per strain component and element of levels that the next level verifies."""

VERIFIED_WAVES = (48, 64, 85, 113, 150)
"""Further modes of such levels, for scenes with waves along their rods."""

SHORT = 0.25
"""Length of an element over its rod's, below which it is short: it covers less of the rod, and needs fewer modes."""

SPARE_NODES = 2
"""Intervals of a verified level beyond the number for the modes and the turn of a rod."""


TOO_MANY_WAVES = (
    " Coils, windings or loads ask for more than {modes} modes in an element, and at most {most} are tried: fix "
    "accuracy.modes and accuracy.nodes, or cut the rod into shorter elements by point wrenches of zero."
)
"""Sentence for a rod whose waves no level resolves."""


def nodes_for_turn(modes: int, turn: float) -> int:
    """Chebyshev intervals that resolve a rod with a number of modes and a turn.

    Args:
        modes: per strain component and element.
        turn: angle through which an element turns, rad. It needs one more interval for every 2 rad, since the Magnus
            series and the interpolation need a bounded turn of each (docs/theory.md, section 10).
    """
    return nodes_for(modes) + ceil(turn / 2)


def layer_nodes(scene: scenes.Scene) -> int:
    """Intervals per element below which a rod sinks into a smooth obstacle that presses its nodes; 0 without any."""
    return max((seeing_nodes(*met) for met in _layers(scene)), default=0)


def layer_sections(scene: scenes.Scene, tolerance: float) -> int:
    """Sections per element for the sums of frictionless layers to a tolerance; 0 without any."""
    return max((seeing_sections(*met, tolerance) for met in _layers(scene)), default=0)


def _layers(scene: scenes.Scene) -> Iterator[tuple[scenes.ObstacleRecord, RodProperties, float]]:
    """Smooth obstacles with the rods that they press, and the length of the longest element of each rod, m."""
    for record in scene.rods:
        for obstacle in scene.obstacles:
            if obstacle.is_smooth and obstacle.concerns(record.name):
                rod = rod_properties(record)
                yield obstacle, rod, rod.length * float(np.diff(element_ends(scene, record.name)).max())


def is_thin(scene: scenes.Scene) -> bool:
    """Whether thin smooth obstacles ask for more intervals than the modes of a usual level: a solve takes seconds."""
    return layer_nodes(scene) > nodes_for(REFERENCE_MODES[FIRST_LEVELS[0][1]])


def told_waves(modes: int) -> str:
    """Sentence on modes that waves need if no level resolves them and another level tells its error; else empty."""
    most = REFERENCE_MODES[-1]
    return TOO_MANY_WAVES.format(modes=modes, most=most) if modes > REFERENCE_MODES[-2] else ""


def verified_modes(scene: scenes.Scene, of_short: tuple[int, ...]) -> tuple[int, ...]:
    """Modes of levels that the next level verifies; see :func:`seeing_modes`.

    Args:
        scene: the scene.
        of_short: modes of further, lower levels for scenes in which every rod is cut into short elements.
    """
    widths = np.concatenate([np.diff(element_ends(scene, rod.name)) for rod in scene.rods])
    all_are_short = widths.max() <= SHORT + NARROWEST
    return seeing_modes(scene, (*of_short, *VERIFIED_MODES) if all_are_short else VERIFIED_MODES)


def seeing_modes(scene: scenes.Scene, usual: tuple[int, ...]) -> tuple[int, ...]:
    """Modes of two levels at least that the next level verifies; all resolve the loads and coils along the rods.

    Args:
        scene: the scene.
        usual: modes of the levels of a scene without waves.
    """
    needed = most_wave_modes(scene)
    if needed <= usual[0]:
        return usual
    levels = (*usual, *(modes for modes in VERIFIED_WAVES if modes > usual[-1]))
    seeing = tuple(modes for modes in levels if modes >= needed)
    return max(seeing, levels[-2:], key=len)


def verified_nodes(scene: scenes.Scene, modes: int, turn: float) -> int:
    """Intervals per element of a level that the next level verifies; arguments as for :func:`verified_model`."""
    return nodes_for_turn(modes, max(turn, unloaded_turn(scene))) + SPARE_NODES


def verified_model(scene: scenes.Scene, modes: int, turn: float) -> Model:
    """The model of a level that the next level verifies.

    Args:
        scene: the scene.
        modes: per strain component and element, one of :func:`verified_modes`.
        turn: largest turn of an element on the level before, rad; 0 on the first level.
    """
    nodes = verified_nodes(scene, modes, turn)
    # Levels should differ by their modes alone: the highest order keeps the grid's error out of the comparison.
    discretisation = discretise(scene, modes, nodes, "magnus8")
    return build(scene, with_fibres(discretisation, modes))


def with_fibres(chosen: Mapping[str, Discretisation], modes: int) -> dict[str, Discretisation]:
    """The discretisation of a level that the next level verifies, with laws summed more finely than on lower levels."""
    fibres = min(modes // 3 + 1, MOST_FIBRES)
    return {name: own.with_more_fibres(fibres - own.fibres) for name, own in chosen.items()}


@dataclass(frozen=True)
class Level:
    """A refinement level in the search for a reference solution, with the state of its grid.

    Attributes:
        index: index in REFERENCE_MODES.
        grid_factor: factor on the intervals.
        min_nodes: intervals below which a grid was too coarse for the bent rod.
        layer_nodes: intervals that thin smooth obstacles ask for, before the factor.
        sections: sections per element at which layers are summed; 0 for as many as the intervals ask for.
        more_fibres: points across half of a section beyond the fewest of a law that is summed.
        finest: index of the last level that is tried in any case; higher levels are tried if the rods converge.
    """

    index: int
    grid_factor: float = 1.0
    min_nodes: int = 0
    layer_nodes: int = 0
    sections: int = 0
    more_fibres: int = 0
    finest: int = REFERENCE_MODES.index(USUAL_MODES)

    @classmethod
    def first(cls, tolerance: float, signal_modes: int = 0, layer_nodes: int = 0, sections: int = 0) -> Level:
        """The first level of a scene.

        Args:
            tolerance: wanted error.
            signal_modes: least modes that resolve the waves in the scene's data; the last level is taken if none has as
                many.
            layer_nodes: intervals that thin smooth obstacles ask for.
            sections: number of sections per element at which layers are summed.
        """
        suitable = (index for bound, index in FIRST_LEVELS if tolerance >= bound)
        visible = _lowest_with(signal_modes)
        finest = _lowest_with(max(USUAL_MODES, SIGNAL_FACTOR * signal_modes))
        return cls(max(next(suitable), visible), layer_nodes=layer_nodes, sections=sections, finest=finest)

    @property
    def modes(self) -> int:
        """Modes per strain component and element."""
        return REFERENCE_MODES[self.index]

    def nodes(self, turn: float) -> int:
        """Intervals per element for a turn of the elements, rad."""
        nodes = max(nodes_for_turn(self.modes, turn), self.layer_nodes)
        stretched = ceil(self.grid_factor * nodes)
        return max(stretched, self.min_nodes)

    def with_modes(self, modes: int) -> Level | None:
        """The lowest higher level with at least these modes and this grid factor; None if no level has as many."""
        if modes > REFERENCE_MODES[self.finest]:
            return None
        # At least one level higher: a level that is too coarse is not solved again.
        index = max(_lowest_with(modes), self.index + 1)
        if index > self.finest:
            return None
        return replace(self, index=index)

    def with_seeing_modes(self, modes: int) -> Level | None:
        """The lowest higher level with modes that see the waves of a rod, and one above to compare it with, if any."""
        return replace(self, finest=max(self.finest, _lowest_with(SIGNAL_FACTOR * modes))).with_modes(modes)

    def with_extrapolated_modes(self, modes: int) -> Level | None:
        """A higher level towards a number of modes that may be too large; None if none is worth a try.

        Up to the finest level every number is. Above, only a number that some level has: rods that bend sharply, but
        converge.
        """
        if self.index >= self.finest:
            if modes > REFERENCE_MODES[-1] or self.index + 1 == len(REFERENCE_MODES):
                return None
            # One level at a time: these levels cost most, and rounding grows with their modes.
            return replace(self, index=self.index + 1)
        tried = min(modes, REFERENCE_MODES[self.finest])
        above = self.with_modes(tried)
        if above is None:
            return None
        return replace(above, index=min(above.index, self.index + MOST_LEVELS))

    def with_finer_sums(self, factor: float) -> Level | None:
        """This level with the sections of layers times a factor, or the intervals if layers are summed at nodes.

        Returns:
            None if sums, or the grid, are given up.
        """
        if not self.sections:
            return self.with_finer_grid()
        if self.sections == MOST_SECTIONS:
            return None
        return replace(self, sections=min(ceil(factor * self.sections), MOST_SECTIONS))

    def with_more_fibres(self) -> Level | None:
        """This level with laws summed at one point more across half of a section; None if their sums are given up."""
        return None if self.more_fibres == MOST_FIBRES else replace(self, more_fibres=self.more_fibres + 1)

    def with_finer_grid(self) -> Level | None:
        """This level on more intervals; None if the grid is given up."""
        if self.grid_factor >= MOST_GRID_FACTOR:
            return None
        return replace(self, grid_factor=self.grid_factor * GRID_FACTOR)


def _lowest_with(modes: int) -> int:
    """Index of the lowest level with at least these modes; the last index if there is none."""
    last = len(REFERENCE_MODES) - 1
    sufficient = (i for i in range(last) if REFERENCE_MODES[i] >= modes)
    return next(sufficient, last)
