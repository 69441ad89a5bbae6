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

TINY = float(np.finfo(float).tiny)
"""Keeps the share of no acceleration finite."""


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
    # A motion that goes on had waves before: its lateness adds up.
    late = out_of_phase(history) * duration / (duration - history.begin)
    return max((REST * len(moved) * last_of(moved) for moved in strains), default=0.0) + late


def out_of_phase(history: History) -> float:
    """Largest displacement over the length by which waves come too early or too late, for the modes that they lack.

    A frequency errs by half the square of the share of its mode that coefficients lack. So the way of the last
    coefficients, times half of their share, bounds the displacement by which a wave is late in the end. Accelerations
    tell their share of the shortest waves, which long and larger ones would hide.
    """
    if not history.steps:
        return 0.0
    model = history.model
    ends = [history.of_model(history.flight.to_model(step.end)) for _, step in history.steps]
    sizes = np.array([step.size for _, step in history.steps])
    rates = np.abs([end.v for end in ends])
    ways = sizes @ rates * displacements(model)
    accelerations = np.abs([end.a for end in ends]).max(axis=0)
    late = 0.0
    for name, rod in model.discrete.rods.items():
        span = model.discrete.unknowns.strain(name)
        for columns in rod.columns.values():
            of_way = ways[span][columns].reshape(rod.grid.elements, -1).max(axis=0)
            of_acceleration = accelerations[span][columns].reshape(rod.grid.elements, -1).max(axis=0)
            share = last_of(of_acceleration) / max(of_acceleration.max(), TINY)
            late = max(late, 0.5 * last_of(of_way) * share)
    return late
