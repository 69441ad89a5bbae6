"""The push of an obstacle that has a width: smooth contact, a load like any other.

With the gap g = d(r) − ρ between a section of radius ρ and the obstacle, the width w and the stiffness k

    u = k (w − g)₊⁴ / (12 w²),    f = −du/dg = k (w − g)₊³ / (3 w²),    df/dg = −k at g = 0,

per length of the rod. The force is zero for g ≥ w, and k w/3 at zero gap. Energy, force and stiffness are continuous,
and so is the derivative of the stiffness, except for its kink at g = w.

In motion the force is f (1 − δ ġ): the power δ f ġ² that it dissipates is never negative. K. H. Hunt and F. R. E.
Crossley, J. Appl. Mech. 42 (1975) 440. It pulls only on a rod that leaves faster than 1/δ.

Coulomb's friction acts at the touching point of the section, ρ from its centre: μ times the normal force, times −u over
a regularised length of the displacement or velocity u along the surface, as long as the section is pushed.

In motion u is the velocity, and the length √(u² + s²): far above the slip speed s that is Coulomb's law to the share
½ (s/u)²; a section that sticks by Coulomb's law creeps, slower than s until it is close to slipping.

Along a path u is the drag of the layer: the drag at the last point of the path plus the displacement since then of the
point that touched there. The length is |u| or the reach a = μ f/k, whichever is larger: a spring of the stiffness k
that slips at μ f, and then stays dragged by a. That is the return map of plasticity without hardening: F · Δr ≥ Δ(½ k
u²), so that energy only leaves.

The coefficient may differ along the tangent of the rod, against it and across it. A single equilibrium, which has no
history, has no friction.

A disk of radius R and thickness h, square to its rod with the tangent t, reaches as far as R √(1 − (n·t)²) + h/2 |n·t|
along the normal n, its corners rounded; its gap is d(r) less that. For a plane this gap is exact. For a ball it is
smaller than the true gap, by R² (n·t)²/2D at most, D the distance between the centres. The force on a disk is that on a
stretch of rod as long as its diameter, and force and moment derive from one energy.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, final

import casadi as ca
import numpy as np

from cosserat_casadi.errors import SceneError
from cosserat_casadi.loads.disk_reach import disk_reach
from cosserat_casadi.loads.load import Rubbing, Section, Site
from cosserat_casadi.loads.obstacle_load import ObstacleLoad, ObstacleLoadRecord, section_radii
from cosserat_casadi.maths.numbers import Numbers, any_symbolic, as_matrix, known, stacked_rows
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.obstacles.registry import SURFACES
from cosserat_casadi.rod.section_kernel import wrench_of_energy

STANDING = 1e-3
"""Norm of the tangent's part along the surface below which the direction of a rod on the surface fades."""

HISTORY_FIELD = "history"
"""Name of the input with the history of friction at the nodes."""

HISTORY = 12
"""Count of numbers in the history of a section: a position, m, and a rotation matrix, column after column."""

GROWTH_INSIDE = 2
"""Power of the load factor by which a layer grows if the unloaded rod is, or may be, inside the obstacle."""

NOTHING = 1e-9
"""Displacement along an obstacle, in widths, that counts as zero."""


class ContactLayer(ObstacleLoadRecord):
    """The push of an obstacle with a width on a rod, on a disk of it, or on a body; no scene file names this load."""

    kind: Literal["contact_layer"] = "contact_layer"
    stiffness: float
    radius: Any = 0.0
    thickness: Any = 0.0
    at: Any = None

    @property
    def takes_energy(self) -> bool:
        """Whether the layer dissipates energy in motion."""
        return bool(self.obstacle.damping > 0.0 or self.obstacle.rubs)

    def widened(self, ratio: float) -> ContactLayer:
        """The layer with its width times a ratio; the force at zero gap stays the same."""
        if ratio == 1.0:
            return self
        obstacle = self.obstacle.model_copy(update={"width": ratio * self.obstacle.width})
        return self.model_copy(update={"obstacle": obstacle, "stiffness": self.stiffness / ratio})


@final
class ContactLayerLoad(ObstacleLoad[ContactLayer]):
    """Force k (w − g)₊³ / (3 w²) along the normal of the obstacle, per length of a rod, or on a body with k in N/m.

    For a disk k is replaced by 2 R k.
    """

    record = ContactLayer
    nodal = HISTORY_FIELD

    def growth(self, load: ContactLayer, site: Site) -> int:
        """Power of the load factor: 0 for an unloaded rod outside of the layer, 1 in it, 2 inside the obstacle.

        A layer that grew more slowly at first than the other loads would let a rod through. But a straight rod in a
        bent lumen lies many widths deep in the obstacle: a force that is nearly zero at first leads it in.
        """
        if load.obstacle.body is not None:
            return GROWTH_INSIDE
        try:
            positions = site.unloaded_position
        except SceneError:
            # The unloaded position is an expression if parameters move the unloaded rod.
            return GROWTH_INSIDE
        reach = section_radii(site.rod, site.X) if load.at is None else np.array([load.radius + load.thickness])
        if any_symbolic([positions, reach, load.obstacle.width]):
            return GROWTH_INSIDE
        distances = SURFACES[load.obstacle.kind].function(load.obstacle)(positions)[0].full()[0]
        gap = np.min(distances - known(reach))
        if gap < 0.0:
            return GROWTH_INSIDE
        return 1 if gap < load.obstacle.width else 0

    def energy(self, load: ContactLayer, section: Section, values: Mapping[str, Matrix]) -> Matrix | None:
        """The energy k (w − g)₊⁴ / (12 w²), J/m, or J of a body or a disk; None with friction."""
        return None if _remembers(section) else _energy(load, section)

    def wrench(self, load: ContactLayer, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        """Force, N/m, or N on a body or a disk, and moment about the centre, by friction, on a disk by all forces."""
        if load.at is not None:
            return self._on_disk(load, section)
        normal = _normal(load, section)
        pressing = _pressing(load, section)
        # At rest the velocity has no entries, and damping adds no instruction.
        if load.takes_energy and _moves(section) and load.obstacle.damping > 0.0:
            pressing = pressing * (1 - load.obstacle.damping * ca.dot(normal, section.velocity))
        drag = _drag(load, section, normal, ca.fmax(pressing, 0.0))
        if drag is None:
            return pressing * normal, ca.DM(3, 1)
        rubbing = _friction(load, section, normal, ca.fmax(pressing, 0.0), drag)
        return pressing * normal + rubbing, ca.cross(_touching(load, section, normal), rubbing)

    def remembers(self, load: ContactLayer) -> int:
        """Size of the history: the position with zero drag, and the rotation of the section."""
        return HISTORY if load.body is None and load.at is None and load.obstacle.rubs else 0

    def rubbing(self, load: ContactLayer, section: Section) -> Rubbing:
        """History of the section after an increment, slip, and force of friction."""
        normal = _normal(load, section)
        pressing = _pressing(load, section)
        drag = _drag(load, section, normal, pressing)
        assert drag is not None, "asked for of a layer that rubs, of a section that moves or has a history"
        slip = ca.if_else(pressing > 0.0, drag.share, -1.0)
        friction = _friction(load, section, normal, pressing, drag)
        if _moves(section):
            return Rubbing(ca.DM(HISTORY, 1), slip, friction)
        known = _is_known(section)
        origin = section.position - known * drag.way / ca.fmax(drag.share, 1.0)
        return Rubbing(ca.vertcat(origin, ca.vec(section.rotation)), slip, friction)

    def _on_disk(self, load: ContactLayer, section: Section) -> tuple[Matrix, Matrix]:
        """Force and moment on a disk from the energy, with damping and friction at the touching point."""
        obstacle = load.obstacle
        force, moment = wrench_of_energy(_energy(load, section), section.position, section.rotation)
        if not (load.takes_energy and _moves(section)):
            return force, moment
        normal = _normal(load, section)
        touching = _touching(load, section, normal)
        pressing = _pressing(load, section)
        approach = ca.dot(normal, section.velocity + ca.cross(section.angular_velocity, touching))
        damped = -obstacle.damping * approach * pressing
        taken = damped * normal
        pushed = ca.fmax(pressing + damped, 0.0)
        drag = _drag(load, section, normal, pushed)
        if drag is not None:
            taken = taken + _friction(load, section, normal, pushed, drag)
        return force + taken, moment + ca.cross(touching, taken)

    def data(self, load: ContactLayer, site: Site) -> Numbers:
        """Radius of the sections, m, and their history; empty for a disk."""
        if load.at is not None:
            return super().data(load, site)
        radii = stacked_rows([section_radii(site.rod, site.X)])
        if site.nodal is None:
            return radii
        return ca.vertcat(as_matrix(radii), site.nodal)


@dataclass(frozen=True)
class _Drag:
    """Motion along an obstacle of the touching point of a section.

    Attributes:
        way: velocity, m/s, or drag of the layer, m, 3×1.
        length: its regularised length, 1×1.
        reach: slip speed, m/s, or drag of a slipping layer, m.
        blur: width of the transition between forward and back along the rod, m/s or m.
    """

    way: Matrix
    length: Matrix
    reach: Matrix | float
    blur: float

    @property
    def share(self) -> Matrix:
        """The way over the reach, 1×1."""
        return ca.sqrt(ca.sumsqr(self.way)) / self.reach


def _drag(load: ContactLayer, section: Section, normal: Matrix, pressing: Matrix) -> _Drag | None:
    """Motion of a section for friction; None without friction, as at rest without memory."""
    in_motion = load.takes_energy and load.obstacle.rubs and _moves(section)
    if not (in_motion or _remembers(section)):
        return None
    touching = _touching(load, section, normal)
    if in_motion:
        slip = load.obstacle.slip_speed
        velocity = section.velocity + ca.cross(section.angular_velocity, touching)
        sliding = along_surface(velocity, normal)
        return _Drag(sliding, ca.sqrt(ca.sumsqr(sliding) + slip**2), slip, slip)
    start, turned = section.data[1:4], ca.reshape(section.data[4:], 3, 3)
    moved = section.position - start + (section.rotation @ turned.T - ca.DM.eye(3)) @ touching
    way = along_surface(moved, normal)
    nothing = NOTHING * load.obstacle.width
    reach = max(load.obstacle.coefficients) * pressing / load.stiffness + nothing
    return _Drag(way, ca.fmax(ca.sqrt(ca.sumsqr(way) + nothing**2), reach), reach, nothing)


def _friction(load: ContactLayer, section: Section, normal: Matrix, pressing: Matrix, drag: _Drag) -> Matrix:
    """Force of friction, N/m.

    Args:
        load: the push.
        section: a section of the rod.
        normal: normal of the obstacle, 3×1.
        pressing: force along the normal, not negative, N/m.
        drag: motion of the section along the obstacle.
    """
    direction = along_surface(section.rotation[:, 2], normal)
    weighted = weighted_way(load.obstacle.coefficients, drag.way, direction, drag.blur)
    friction: Matrix = -pressing / drag.length * weighted
    if _remembers(section) and not _moves(section):
        friction = _is_known(section) * friction
    return friction


def weighted_way(
    coefficients: tuple[float, float, float], way: Matrix, direction: Matrix, blur: Matrix | float
) -> Matrix:
    """A motion along an obstacle, 3×1, with each of its parts times the coefficient of friction of its direction.

    Args:
        coefficients: coefficients of friction along the rod, back, and across it.
        way: drag, or velocity, of the touching point along the surface, 3×1.
        direction: part of the tangent of the rod along the surface, 3×1.
        blur: width of the transition between forward and back along the rod.
    """
    along, back, across = coefficients
    if along == back == across:
        return across * way
    # A rod that stands on the surface has no direction along it.
    direction = direction / ca.sqrt(ca.sumsqr(direction) + STANDING**2)
    forward = ca.dot(direction, way)
    share = forward / ca.sqrt(forward**2 + blur**2)
    coefficient = (along * (1 + share) + back * (1 - share)) / 2
    return across * way + (coefficient - across) * forward * direction


def _moves(section: Section) -> bool:
    """Whether the velocity of a section is an argument."""
    return bool(section.velocity.nnz())


def _remembers(section: Section) -> bool:
    """Whether a section comes with its history."""
    return bool(section.data.shape[0] > 1)


def _is_known(section: Section) -> Matrix:
    """1 for a section with a history, 0 before there is one, when the stored rotation is zero; 1×1."""
    return ca.sumsqr(section.data[4:]) / 3


def along_surface(vector: Matrix, normal: Matrix) -> Matrix:
    """The part of a vector orthogonal to the normal, 3×1."""
    return vector - ca.dot(normal, vector) * normal


def _normal(load: ContactLayer, section: Section) -> Matrix:
    """Normal of the obstacle, 3×1."""
    distance = SURFACES[load.obstacle.kind].distance(load.obstacle, section.position)
    normal: Matrix = ca.gradient(distance, section.position)
    return normal


def _touching(load: ContactLayer, section: Section, normal: Matrix) -> Matrix:
    """Vector from the centre of a section, or of a disk, to its point that touches, 3×1, m."""
    if load.at is not None:
        return _support(load, section, normal)[1]
    return -_reach(load, section) * normal


def _reach(load: ContactLayer, section: Section) -> Matrix | float:
    """Radius of a section or a body, m."""
    return section.data[0] if load.body is None else load.radius


def _energy(load: ContactLayer, section: Section) -> Matrix:
    """Energy k (w − g)₊⁴ / (12 w²), J/m, or J of a body or a disk."""
    energy: Matrix = _stiffness(load) / (12 * load.obstacle.width**2) * _depth(load, section) ** 4
    return energy


def _pressing(load: ContactLayer, section: Section) -> Matrix:
    """Force along the normal at rest, N/m, or N on a body or a disk."""
    pressing: Matrix = _stiffness(load) / (3 * load.obstacle.width**2) * _depth(load, section) ** 3
    return pressing


def _stiffness(load: ContactLayer) -> Matrix | float:
    """Stiffness of the layer for a rod, N/m², or for a body or a disk, N/m."""
    return load.stiffness if load.at is None else 2 * load.radius * load.stiffness


def _support(load: ContactLayer, section: Section, normal: Matrix) -> tuple[Matrix, Matrix]:
    """Reach of a disk against the normal, 1×1, m, and vector from its centre to the point that touches, 3×1, m."""
    return disk_reach(normal, section.rotation[:, 2], load.radius, load.thickness)


def push_on_disk(load: ContactLayer) -> ca.Function:
    """(position, 3×1, rotation, 3×3, radius and thickness, 2×1, m) ↦ (gap, m, force at rest, 3×1, N)."""
    section = Section(ca.SX.sym("position", 3), ca.SX.sym("rotation", 3, 3), ca.SX(0, 1))
    size = ca.SX.sym("size", 2)
    disk = load.model_copy(update={"radius": size[0], "thickness": size[1]})
    force, _ = wrench_of_energy(_energy(disk, section), section.position, section.rotation)
    return ca.Function("push", [section.position, section.rotation, size], ca.cse([_gap(disk, section), force]))


def _gap(load: ContactLayer, section: Section) -> Matrix:
    """Gap of a section, a disk or a body, m."""
    distance = SURFACES[load.obstacle.kind].distance(load.obstacle, section.position)
    reach = _reach(load, section) if load.at is None else _support(load, section, _normal(load, section))[0]
    gap: Matrix = distance - reach
    return gap


def _depth(load: ContactLayer, section: Section) -> Matrix:
    """Depth (w − g)₊ of a section in the layer, m."""
    depth: Matrix = ca.fmax(load.obstacle.width - _gap(load, section), 0.0)
    return depth


def pressure(layer: ContactLayer, gaps: FloatArray) -> FloatArray:
    """Force at rest for gaps in m: per length, N/m, or on a body, N."""
    width = layer.obstacle.width
    return np.asarray(layer.stiffness / (3 * width**2) * np.maximum(width - gaps, 0.0) ** 3)
