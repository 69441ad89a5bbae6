"""Where rods push each other, and how hard."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cosserat_casadi.equilibrium.contact.gaps import runs
from cosserat_casadi.equilibrium.solution import Contact, Solution
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.loads.rod_contact import coefficient
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_pairs import ContactPair, section_places

LOOKED_AT_BETWEEN = np.linspace(-1.0, 1.0, 33)
"""Places about a section, in distances of sections, at which gaps are looked for."""


def section_positions(
    model: Model, pair: ContactPair, x: FloatArray, inputs: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Positions of the sections of both rods of a pair, shape (sections, 3) each, m.

    Args:
        model: of the scene.
        pair: the pair.
        x: unknowns, shape (model.size,).
        inputs: stacked inputs, shape (model.inputs.size,).
    """
    positions = model.contact_sections(x, inputs).full().T
    counts = [count for other in model.discrete.pairs for count in other.sections]
    parts = np.split(positions, np.cumsum(counts)[:-1])
    number = 2 * model.discrete.pairs.index(pair)
    return parts[number], parts[number + 1]


def contacts_of_rods(solution: Solution) -> Iterator[Contact]:
    """The stretches of rods that others press, with the resultant on the first rod of each pair."""
    for pair in solution.model.discrete.pairs:
        yield from _contacts(solution, pair)


def _contacts(solution: Solution, pair: ContactPair) -> Iterator[Contact]:
    model = solution.model
    first, second = section_positions(model, pair, solution.x, solution.inputs)
    apart = first[:, None] - second
    discrete_rods = [model.at().discrete.rods[rod] for rod in pair.rods]
    (X, other_X), shares = zip(*map(section_places, discrete_rods, pair.sections), strict=True)
    lengths = [model.length(rod, solution.inputs) for rod in pair.rods]
    meets = pair.meets(lengths[0] * X, lengths[1] * other_X)
    touching = _touching(solution, pair, X, other_X)
    reach = touching + pair.width
    inside = np.where(meets, np.maximum(reach**2 - np.sum(apart**2, axis=2), 0.0), 0.0)
    pressed = inside.max(axis=1) > 0.0
    weights = lengths[0] * lengths[1] * np.outer(*shares)
    slopes = 6 * weights * np.vectorize(coefficient)(pair.width, pair.stiffness, touching) * inside**2
    forces = np.sum(slopes[..., None] * apart, axis=1)
    for part in runs(pressed):
        rows = np.arange(part.start, part.stop)
        row, column = np.unravel_index(np.argmax(inside[rows]), inside[rows].shape)
        at, gap = _nearest(solution, pair, (float(X[rows[row]]), float(other_X[column])))
        half = shares[0] / 2
        start, end = X[rows[0]] - half[rows[0]], X[rows[-1]] + half[rows[-1]]
        force = forces[rows].sum(axis=0)
        owner, other = pair.rods
        yield Contact(other, owner, float(start), float(end), force, (), "smooth", pair.width, gap, on_rods=at)


def _nearest(solution: Solution, pair: ContactPair, place: tuple[float, float]) -> tuple[tuple[float, float], float]:
    """Abscissae about a place at which two rods are nearest, between their sections too, and the gap there, m."""
    around = [np.clip(at + LOOKED_AT_BETWEEN / count, 0.0, 1.0) for at, count in zip(place, pair.sections, strict=True)]
    first, second = (solution.pose(X, rod).position for X, rod in zip(around, pair.rods, strict=True))
    gaps = np.linalg.norm(first[:, None] - second, axis=2) - _touching(solution, pair, *around)
    row, column = np.unravel_index(np.argmin(gaps), gaps.shape)
    return (float(around[0][row]), float(around[1][column])), float(gaps[row, column])


def _touching(solution: Solution, pair: ContactPair, first: FloatArray, second: FloatArray) -> FloatArray:
    """Distance of centres that touch at abscissae of both rods, shape (first, second), m."""
    rods = solution.model.at().discrete.rods
    radii = [section_radius(rods[rod].properties, X) for rod, X in zip(pair.rods, (first, second), strict=True)]
    return np.asarray(radii[0][:, None] + radii[1])
