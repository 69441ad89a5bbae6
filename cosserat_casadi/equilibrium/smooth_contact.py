"""Smooth contacts of a solution: stretches of rods and bodies that obstacles or rods press, and their forces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cosserat_casadi.equilibrium.contact.gaps import DENSE, gap_along, normals, runs
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import surface
from cosserat_casadi.equilibrium.rubbing import friction_between
from cosserat_casadi.equilibrium.solution import Contact, Solution
from cosserat_casadi.loads.contact_layer import ContactLayer, pressure, push_on_disk
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.loads.rod_contact import coefficient
from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.grid import gauss_legendre
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.contact_pairs import ContactPair, section_places
from cosserat_casadi.rod.placed_sections import SummedSections

LOOKED_AT_BETWEEN = np.linspace(-1.0, 1.0, 33)
"""Offsets from a section, in distances of sections, at which gaps are evaluated."""

GAUSS_POINTS = 24
"""Number of points at which the force along a stretch is summed."""


def with_smooth_contacts(solution: Solution) -> Solution:
    """The solution with the stretches that smooth obstacles press; unchanged in a scene without these."""
    layers = smooth_layers(solution)
    if not (layers or solution.model.discrete.pairs) or not np.all(np.isfinite(solution.x)):
        return solution
    contacts = [contact for layer in layers for contact in _contacts(solution, layer)]
    contacts += contacts_of_rods(solution)
    order = [*solution.model.discrete.rods, *solution.model.body]
    contacts.sort(key=lambda contact: (contact.of_body, order.index(contact.owner), contact.start))
    return replace(solution, contacts=tuple(contacts), message=solution.message + _too_deep(contacts))


def smooth_layers(solution: Solution) -> list[ContactLayer]:
    """The push of each obstacle with a width on each rod and body that it concerns."""
    return [load for load in solution.model.discrete.loads if isinstance(load, ContactLayer)]


def _too_deep(contacts: list[Contact]) -> str:
    """A sentence on the deepest contact, if it is deeper than its width; else empty."""
    depths = [-contact.gap / contact.width for contact in contacts if contact.gap is not None and contact.width]
    if max(depths, default=0.0) <= 1.0:
        return ""
    worst = contacts[int(np.argmax(depths))]
    return (
        f" {worst.owner!r} is {max(depths):.3g} widths deep inside {worst.obstacle!r}, too deep for contact: give the "
        "contact more width or stiffness."
    )


def depths_along(model: Model, x: FloatArray, inputs: FloatArray) -> FloatArray:
    """Largest depth of nodes and bodies in smooth obstacles in each of k states, in widths, shape (k,).

    Args:
        model: model of a scene with smooth obstacles.
        x: unknowns, shape (k, model.size).
        inputs: stacked inputs, shape (k, model.inputs.size).
    """
    return evaluated(model.contact_depth, x, inputs)[0][:, 0, 0]


def _push_between(
    solution: Solution, layer: ContactLayer, sections: SummedSections | None, between: tuple[float, float]
) -> FloatArray:
    """Force of a layer on a rod between two abscissae, over the length, shape (3,), N/m."""
    X, weights = _summed_at(sections, *between)
    if not len(X):
        # If parameters have drawn sections apart, the rod may be in the layer between two of them.
        return np.zeros(3)
    per_length = pressure(layer, _gaps(solution, layer, X))
    assert layer.rod is not None, "a layer along a rod"
    return np.asarray((weights * per_length) @ normals(solution, layer.rod, layer.obstacle, X))


def _summed_at(sections: SummedSections | None, start: float, end: float) -> tuple[FloatArray, FloatArray]:
    """Abscissae at which the force along a stretch is summed, and their weights, shape (k,) each.

    If the equations sum the layer between nodes, their sections are used: this sum balances the rod.
    """
    if sections is not None:
        X = known(sections.placed.X)
        inside = (start <= X) & (end >= X)
        return X[inside], known(sections.lengths)[inside] / sections.rod.length
    # The force vanishes smoothly at both ends, or the stretch ends at the end of the rod.
    nodes, weights = gauss_legendre(GAUSS_POINTS)
    return start + (end - start) * (nodes + 1) / 2, (end - start) / 2 * weights


def _body_contact(solution: Solution, layer: ContactLayer) -> Iterator[Contact]:
    """The contact of a body, at its origin."""
    assert layer.body is not None
    position = solution.body(layer.body).position
    distance, gradient, _ = surface(layer.obstacle)(position)
    gap = float(distance) - layer.radius
    if gap < layer.obstacle.width:
        force = float(pressure(layer, np.array([gap]))[0]) * gradient.full()[:, 0]
        width = layer.obstacle.width
        yield Contact(layer.obstacle.name, layer.body, 0.0, 0.0, force, (), "smooth", width, gap, of_body=True)


def _disk_contact(solution: Solution, layer: ContactLayer) -> Iterator[Contact]:
    """The contact of a disk, at its section."""
    at = float(layer.at)
    pose = solution.pose(at, layer.rod)
    gap, force = push_on_disk(layer)(pose.position, pose.rotation, [layer.radius, layer.thickness])
    width = layer.obstacle.width
    if float(gap) < width:
        assert layer.rod is not None
        along = force.full()[:, 0]
        yield Contact(layer.obstacle.name, layer.rod, at, at, along, (), "smooth", width, float(gap))


def _gaps(solution: Solution, layer: ContactLayer, X: FloatArray) -> FloatArray:
    """Gaps along a rod, shape (k,), m."""
    assert layer.rod is not None
    relative = gap_along(solution, layer.rod, layer.obstacle, X)
    # Gaps are relative to the length of the rod in the scene.
    return relative * solution.model.discrete.rods[layer.rod].properties.length


def _crossing(X: FloatArray, values: FloatArray, before: int, after: int) -> float:
    """Abscissa between two neighbours of X at which values change sign; at an end of X this end."""
    if before < 0:
        return float(X[0])
    if after >= len(values):
        return float(X[-1])
    share = values[before] / (values[before] - values[after])
    return float(X[before] + share * (X[after] - X[before]))


def section_positions(
    model: Model, pair: ContactPair, x: FloatArray, inputs: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Positions of the sections of both rods of a pair, shape (sections, 3) each, m.

    Args:
        model: model of the scene.
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
    """The stretches of rods that other rods press, with the resultant on the first rod of each pair."""
    for pair in solution.model.discrete.pairs:
        yield from _contacts_of_pair(solution, pair)


def _contacts_of_pair(solution: Solution, pair: ContactPair) -> Iterator[Contact]:
    model = solution.model
    first, second = section_positions(model, pair, solution.x, solution.inputs)
    apart = first[:, None] - second
    discrete_rods = [model.at().discrete.rods[rod] for rod in pair.rods]
    (X, other_X), shares = zip(*map(section_places, discrete_rods, pair.sections), strict=True)
    lengths = [model.length(rod, solution.inputs) for rod in pair.rods]
    meets = pair.meets(lengths[0] * X, lengths[1] * other_X)
    touching = _touching(solution, pair, X, other_X) + 2 * pair.padding
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
    """Abscissae near a place at which two rods are nearest, between their sections too, and the gap there, m."""
    spacings = [LOOKED_AT_BETWEEN / count for count in pair.sections]
    first, second = (np.clip(at + spacing, 0.0, 1.0) for at, spacing in zip(place, spacings, strict=True))
    first_positions = solution.pose(first, pair.rods[0]).position
    second_positions = solution.pose(second, pair.rods[1]).position
    distances = np.linalg.norm(first_positions[:, None] - second_positions, axis=2)
    gaps = distances - _touching(solution, pair, first, second)
    row, column = np.unravel_index(np.argmin(gaps), gaps.shape)
    return (float(first[row]), float(second[column])), float(gaps[row, column])


def _touching(solution: Solution, pair: ContactPair, first: FloatArray, second: FloatArray) -> FloatArray:
    """Distance of the centres of touching sections at abscissae of both rods, shape (first, second), m."""
    rods = solution.model.at().discrete.rods
    radii = [section_radius(rods[rod].properties, X) for rod, X in zip(pair.rods, (first, second), strict=True)]
    return np.asarray(radii[0][:, None] + radii[1])


def _contacts(solution: Solution, layer: ContactLayer) -> Iterator[Contact]:
    if layer.rod is None:
        yield from _body_contact(solution, layer)
        return
    if layer.at is not None:
        yield from _disk_contact(solution, layer)
        return
    length = solution.model.length(layer.rod, solution.inputs)
    # Sections at which the equations sum the layer, if these are not the nodes.
    sections = solution.model.discrete.closer_sections.get(layer.name)
    looked_at = DENSE if sections is None else np.union1d(DENSE, known(sections.placed.X))
    gaps = _gaps(solution, layer, looked_at)
    width = layer.obstacle.width
    for part in runs(gaps < width):
        start = _crossing(looked_at, gaps - width, part.start - 1, part.start)
        end = _crossing(looked_at, gaps - width, part.stop - 1, part.stop)
        force = length * _push_between(solution, layer, sections, (start, end))
        force += friction_between(solution.model, layer, solution.x, solution.inputs, (start, end))
        yield Contact(layer.obstacle.name, layer.rod, start, end, force, (), "smooth", width, float(gaps[part].min()))
