"""How much the coefficients of strains move a rod along a motion, and what further ones would, by a power law.

Errors of a motion fall with a power p of its modes. So of a strain on m modes the further coefficients together move
m/p times what its last one moves. See docs/theory.md, section 11.
"""

from __future__ import annotations

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.motion.displacement import displacements
from cosserat_casadi.motion.history import History
from cosserat_casadi.motion.tip_paths import watched_times

UNKNOWN_ORDER = 1.7
"""Power of the modes with which errors fall, before two distances tell; waves of a sudden load have 2.3."""

SAFETY = 1.5
"""Factor on the error that is extrapolated from it."""

REST = SAFETY / UNKNOWN_ORDER
"""Displacement by all further coefficients over that by the last one and their number."""

LAST = 3
"""One of so many coefficients counts as one of the last."""


def felt(history: History, duration: float) -> dict[str, list[FloatArray]]:
    """Largest displacement over the length by the coefficients of each degree, of every strain of every rod."""
    model = history.model
    x, _ = history.rough_positions(watched_times(history, duration))
    moved = np.abs(x).max(axis=0) * displacements(model)
    by_rod = {}
    for name, rod in model.discrete.rods.items():
        of_rod = moved[model.discrete.unknowns.strain(name)]
        by_degree = []
        for columns in rod.columns.values():
            by_element = of_rod[columns].reshape(rod.grid.elements, -1)
            by_degree.append(by_element.max(axis=0))
        by_rod[name] = by_degree
    return by_rod


def last_of(moved: FloatArray) -> float:
    """Largest displacement by the last coefficients of a strain, of those by all; one alone may vanish by symmetry."""
    return float(moved[-max(2, len(moved) // LAST) :].max())


def lacking(history: History, duration: float) -> float:
    """Largest displacement over the length that coefficients would make which a strain of a motion lacks."""
    strains = [moved for of_rod in felt(history, duration).values() for moved in of_rod]
    return max((REST * len(moved) * last_of(moved) for moved in strains), default=0.0)
