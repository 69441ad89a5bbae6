"""Conversion of a solved state of contact to a solution: its residual, its contacts by name, and its stability.

Contacts that press are constraints, and the curvature of the gap times their force is in the Jacobian already: their
forces have the energy −N d. The place of a point of contact follows the motion; it stays at the least gap, which adds N
(∂d′/∂x)² / d″, the other part of the second variation of −N min d. (E. Polak, *Optimization*, Springer 1997, section
3.1, for the least value over a parameter.)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.body_obstacles import seen_directions, seen_positions, world_directions
from cosserat_casadi.equilibrium.contact.contact_search import ContactEquilibrium
from cosserat_casadi.equilibrium.contact.contact_state import Touch, contact_loads, is_sought
from cosserat_casadi.equilibrium.contact.gaps import body_normal, normals
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import distance_along
from cosserat_casadi.equilibrium.contact.rod_gaps import distance_of_lines
from cosserat_casadi.equilibrium.judge import stability_note
from cosserat_casadi.equilibrium.solution import Contact, Solution
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, restricted, stability_of, variations
from cosserat_casadi.equilibrium.strain_limits import within_limits
from cosserat_casadi.loads.contact_friction import ContactFriction
from cosserat_casadi.maths.chebyshev import legendre_polynomials
from cosserat_casadi.maths.numbers import known
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.numerics.newton import relative_norm
from cosserat_casadi.numerics.outcome import Outcome

FLAT = 1e-6
"""Curvature of the gap, relative to the length, below which a point of contact does not slide."""

PRESSING = 1e-9
"""Force, relative to the largest, above which a contact counts as a constraint."""

ROUNDED_GAP = 1e-16
"""Rounding of a gap, relative to the length of the rod."""


def judged(found: ContactEquilibrium, *, holds: bool, iterations: int, tolerance: float) -> Solution:
    """A solved state as a solution.

    Args:
        found: the solved state.
        holds: whether no force pulls and nothing is inside an obstacle.
        iterations: Newton steps of the search.
        tolerance: bound on the relative norm of the residual.
    """
    residual = found.placed.residual(found.x, found.forces)
    norm = relative_norm(residual, np.concatenate([found.x, found.forces]))
    outcome = Outcome.CONVERGED if holds else Outcome.CONTACT_UNSETTLED
    inputs = found.solution.inputs
    if not norm <= tolerance:
        outcome = Outcome.MAX_ITERATIONS
    elif holds and float(found.placed.model.resolution_index(found.x, inputs)) > 1.0:
        outcome = Outcome.UNRESOLVED
    outcome, message = within_limits(found.placed.model, found.x, inputs, outcome)
    solution = replace(
        found.solution,
        outcome=outcome,
        message=message,
        residual_norm=norm,
        iterations=iterations,
        contacts=contacts_of(found),
    )
    if not solution.converged or not found.placed.model.has_potential(inputs):
        return solution
    stability = stability_of(_eigenvalues(found))
    critical = stability.neutral
    return replace(
        solution,
        smallest_eigenvalue=stability.smallest_eigenvalue,
        stable=stability.stable and not critical,
        message=solution.message + stability_note(stability, critical),
    )


def contacts_of(found: ContactEquilibrium) -> tuple[Contact, ...]:
    """The contacts by name, with the forces on the rods."""
    contacts = []
    for touch, carried, line in found.parts():
        unit = found.placed.model.discrete.contact_unit(touch.owner, of_body=touch.of_body)
        zero = max(PRESSING * found.largest_force, _rounding(touch))
        # A pull that is rounding alone counts as zero.
        forces = unit * np.where((carried < 0.0) & (carried > -zero), 0.0, carried)
        total = unit * carried @ _normals(found, touch) + _friction(found, touch)
        if touch.is_line:
            total = total + unit * _resultant(found, touch, found.placed.obstacle(touch.obstacle), line)
        ends, sections = touch.sorted_forces(forces)
        contacts.append(
            Contact(
                obstacle=touch.obstacle,
                owner=touch.owner,
                start=touch.start,
                end=touch.end,
                force=total,
                ends=ends,
                kind=touch.kind,
                of_body=touch.of_body,
                # A section where loads do not jump carries the remainder of the polynomials.
                inside=tuple(own for own in sections if abs(own.force) > unit * zero),
                on_rods=None if touch.other is None else (touch.start, touch.other),
            )
        )
    return tuple(contacts)


def _rounding(touch: Touch) -> float:
    """Force at a section of a line that rounding leaves open, without unit; 0 for a point.

    At the end of a stretch of the width w a force F bends the rod by about F w³/3.
    """
    narrowest = min((end - start for start, end in touch.stretches), default=inf)
    return 3 * ROUNDED_GAP / float(narrowest) ** 3


def _friction(found: ContactEquilibrium, touch: Touch) -> FloatArray:
    """Friction at a point of contact on a path, world axes, shape (3,), N; zero without friction."""
    values = found.placed.model.inputs.unpack(found.solution.inputs)
    for load in contact_loads(found.placed.model.scene):
        if isinstance(load, ContactFriction) and (load.rod, load.obstacle.name, load.at) == (
            touch.owner,
            touch.obstacle,
            touch.start,
        ):
            return world_directions(found.solution, load.obstacle, values[f"{load.name}.force"].ravel())
    return np.zeros(3)


def _normals(found: ContactEquilibrium, touch: Touch) -> FloatArray:
    """Normals at the sections of a contact that carry forces, world axes, shape (k, 3)."""
    if touch.other is not None:
        (own, _, _), (other, _, _) = _lines_of_rods(found, touch)
        return np.asarray((own - other)[None] / np.linalg.norm(own - other))
    obstacle = found.placed.obstacle(touch.obstacle)
    if touch.of_body:
        return body_normal(found.solution, touch.owner, obstacle)[None, :]
    return normals(found.solution, touch.owner, obstacle, np.array(touch.carriers))


def _resultant(
    found: ContactEquilibrium, touch: Touch, obstacle: scenes.ObstacleRecord, line: FloatArray
) -> FloatArray:
    """∫ λ n over a stretch of contact, in units of EI/ℓ², shape (3,)."""
    grid = found.placed.model.discrete.rods[touch.owner].grid
    total = np.zeros(3)
    for start, end, own in touch.by_stretch(line, found.placed.modes[touch.owner]):
        nodes = grid.nodes_in(start, end)
        X = known(grid.nodes_at(nodes))
        along = legendre_polynomials(len(own), (X - start) / (end - start)) @ own
        normal = normals(found.solution, touch.owner, obstacle, X)
        total += (grid.weights[nodes] * along) @ normal
    # Forces per length act on the length of the rod by an input or a parameter; their unit is by the scene's length.
    return found.placed.model.length_ratio(touch.owner, found.solution.inputs) * total


@dataclass(frozen=True)
class Pressing:
    """Constraints and stiffness of contacts that press, for small variations at fixed places.

    Attributes:
        held: rows of the gaps that stay zero, in their order.
        sliding: weights N (d″)⁻¹ in the unit of each balance, (n,), by the pair of slope rows of a sliding point.
    """

    held: list[int]
    sliding: Mapping[tuple[int, int], FloatArray]

    def stiffness(self, by_x: FloatArray, by_others: FloatArray) -> FloatArray:
        """Term of sliding points in the derivative of the balance by m arguments, shape (n, m).

        Args:
            by_x: derivative of all gap rows by the unknowns, shape (rows, n).
            by_others: derivative of all gap rows by the arguments, shape (rows, m).
        """
        added = np.zeros((by_x.shape[1], by_others.shape[1]))
        for (row, other), weights in self.sliding.items():
            added += np.outer(weights * by_x[row], by_others[other])
        return added


def pressing(found: ContactEquilibrium) -> Pressing:
    """Gap rows that stay zero in small variations of a state, and points that slide."""
    model = found.placed.model
    held: list[int] = []
    sliding = {}
    first = 0
    for touch, carried, line in found.parts():
        count = len(carried) + len(touch.moving) + len(line)
        rows = range(first, first + count)
        first += count
        if touch.is_line:
            held.extend(rows)
            continue
        if carried[0] <= PRESSING * found.largest_force:
            continue
        held.append(rows[0])
        if touch.moving:
            bends = _gap_curvatures(found, touch)
            if np.linalg.eigvalsh(bends)[0] <= FLAT:
                held.extend(rows[1:])
                continue
            # Each row of the Jacobian has its own unit.
            unit = model.discrete.rods[touch.owner].energy_unit / model.discrete.unknowns.units
            for (i, j), share in np.ndenumerate(np.linalg.inv(bends)):
                sliding[rows[1 + i], rows[1 + j]] = carried[0] * share * unit
    return Pressing(held, sliding)


def _eigenvalues(found: ContactEquilibrium) -> FloatArray:
    """Eigenvalues of the second variation over the variations that contacts admit."""
    model = found.placed.model
    inputs = found.solution.inputs
    rows = found.placed.gaps(found.x, inputs)[1].full()
    contacts = pressing(found)
    jacobian = model.path_jacobian(found.x, inputs, 1.0).full() + contacts.stiffness(rows, rows)
    return admissible_eigenvalues(*restricted(jacobian, list(rows[contacts.held]), variations(model)))


def _gap_curvatures(found: ContactEquilibrium, touch: Touch) -> FloatArray:
    """Hessian of the gap by the k moving places of a point of contact, over the length of the rod, shape (k, k)."""
    # Gaps are relative to the length of the rod in the scene.
    length = found.placed.model.discrete.rods[touch.owner].properties.length
    if touch.other is not None:
        moves = [is_sought(touch.start), is_sought(touch.other)]
        return distance_of_lines(*_lines_of_rods(found, touch))[2][np.ix_(moves, moves)] / length
    centre, tangent, bend = _centre_line(found, touch.owner, touch.start)
    obstacle = found.placed.obstacle(touch.obstacle)
    (position,) = seen_positions(found.solution, obstacle, centre[None])
    first, second = seen_directions(found.solution, obstacle, np.array([tangent, bend]))
    return np.array([[distance_along(obstacle, position, first, second).bend / length]])


def _centre_line(found: ContactEquilibrium, rod: str, X: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position of a section and its first and second derivative by X, shape (3,) each, m."""
    pose = found.solution.pose(X, rod)
    strain = found.solution.strain(X, rod)
    length = found.placed.model.length(rod, found.solution.inputs)
    tangent = length * pose.rotation @ strain[3:]
    # The rate of the extension is along the tangent, normal to the normal of the contact.
    return pose.position, tangent, length**2 * pose.rotation @ np.cross(strain[:3], strain[3:])


def _lines_of_rods(found: ContactEquilibrium, touch: Touch) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
    """Centres of the sections at which two rods touch, with first and second derivative by X, shape (3,) each, m."""
    return [_centre_line(found, rod, X) for rod, X in zip(touch.rods, (touch.start, touch.other), strict=True)]
