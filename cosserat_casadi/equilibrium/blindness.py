"""Turns that modes cannot resolve: an element that loads roll up has waves of strain that few modes miss.

A force of fixed direction goes round in the frame of a section that turns. Over an element that turns by T the strain
oscillates with it, and Legendre coefficients of such a wave are small up to a degree of about T/2. The missing modes
show the error of an answer if the richer model has these degrees. If it lacks them, and its missing modes are not zero,
the error of the answer is unknown. See docs/theory.md, section 10.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.discrete_scene import DiscreteScene, Richer
from cosserat_casadi.model.element_ends import unloaded_turns

WHOLE_TURN = 2 * np.pi
"""Turn of an element, rad, up to which it has no whole wave that modes could miss."""

BEYOND = 3
"""Modes beyond T/2 with which a richer model resolves the waves of an element that turns by T."""

UNSEEN = 0.1
"""Strain in missing modes, over the tolerance, below which no wave matters; curvatures times the length."""

Indices = npt.NDArray[np.int64]


@dataclass(frozen=True)
class TurnedElements:
    """Elements of a scene, rod after rod, with their turns by unknowns and the modes of the richer model.

    Attributes:
        richer: the scene with modes added, and the scene of the answers.
    """

    richer: Richer

    @cached_property
    def unloaded(self) -> FloatArray:
        """Angle through which sections turn along each unloaded element, summed, shape (elements,), rad."""
        coarse = self.richer.coarse
        rods = coarse.nominal.scene.rods
        return np.concatenate([unloaded_turns(rod, coarse.rods[rod.name].grid.breaks) for rod in rods])

    @cached_property
    def of_unknowns(self) -> Indices:
        """Index of the element that each unknown turns, shape (n,); −1 for unknowns that turn none."""
        return np.where(self.turns > 0, _elements(self.richer.coarse), -1)

    @cached_property
    def turns(self) -> FloatArray:
        """Root mean square of the turn of its element by a unit of each unknown, shape (n,), rad; 0 without one."""
        turns = np.zeros(self.richer.coarse.size)
        for name, rod in self.richer.coarse.nominal.rods.items():
            of_rod = turns[self.richer.coarse.unknowns.strain(name)]
            points, weights = gauss_legendre(max(rod.discretisation.modes) + 1)
            breaks = np.asarray(rod.discretisation.breaks)
            widths = np.diff(breaks)
            places = (breaks[:-1, None] + widths[:, None] * (points + 1) / 2).ravel()
            element = np.repeat(np.arange(len(widths)), len(points))
            shares = np.repeat(widths, len(points)) * rod.length
            for component in rod.angular:
                by_unit = shares[:, None] * rod.shape_functions(component, places, element)
                squares = (np.tile(weights, len(widths))[:, None] / 2 * by_unit**2).sum(axis=0)
                of_rod[rod.columns[component]] = np.sqrt(squares)
        return turns

    @cached_property
    def of_missing(self) -> Indices:
        """Index of the element of each missing coordinate, shape (missing,)."""
        return _elements(self.richer.discrete)[~self.richer.known]

    @cached_property
    def modes_of_missing(self) -> Indices:
        """Number of modes in the richer model for the strain of each missing coordinate, shape (missing,)."""
        discrete = self.richer.discrete
        modes = np.zeros(discrete.size, dtype=np.int64)
        for name, rod in discrete.rods.items():
            of_rod = modes[discrete.unknowns.strain(name)]
            for columns, count in zip(rod.columns.values(), rod.discretisation.modes, strict=True):
                of_rod[columns] = count
        return modes[~self.richer.known]

    def turns_at(self, x: FloatArray) -> FloatArray:
        """Bounds on the turns of all elements, shape (..., elements), rad: unloaded, plus root mean square by loads.

        Args:
            x: unknowns, shape (..., n).
        """
        turned_by = self.of_unknowns[:, None] == np.arange(len(self.unloaded))
        return np.asarray(self.unloaded + np.sqrt((self.turns * x) ** 2 @ turned_by))

    def hide_waves(self, x: FloatArray, missing: FloatArray) -> bool:
        """Whether an element turns so far that the missing modes, which are not zero, cannot show the waves along it.

        Args:
            x: unknowns of the answer, shape (n,).
            missing: coordinates of the missing modes, shape (missing,).
        """
        tolerance = self.richer.coarse.scene.accuracy.tolerance
        for element, turn in enumerate(self.turns_at(x)):
            blind = (self.of_missing == element) & (self.modes_of_missing < turn / 2 + BEYOND)
            if turn > WHOLE_TURN and np.linalg.norm(missing[blind]) > UNSEEN * tolerance:
                return True
        return False


def _elements(discrete: DiscreteScene) -> Indices:
    """Index of the element of each strain coordinate, counted over all rods, shape (n,); −1 for other unknowns."""
    elements = np.full(discrete.size, -1)
    before = 0
    for name, rod in discrete.rods.items():
        of_rod = elements[discrete.unknowns.strain(name)]
        count = rod.discretisation.elements
        for columns in rod.columns.values():
            of_rod[columns] = before + np.repeat(np.arange(count), (columns.stop - columns.start) // count)
        before += count
    return elements
