"""Equations of rods in known contact with friction, in one increment of a path.

At a touching point the force t of friction and the slide u follow Coulomb's law with the normal force N:

    u = 0 and |t| ≤ μ N,    or    t = −μ N u/|u|.

With any stiffness k both are one equation: t is the point of the disk |t| ≤ μ N that is nearest to t − k u (P. Alart,
A. Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991) 353). The slide is that of the material point that touches now,
since the last point of the path: implicit Euler for Coulomb's law, as for smooth friction. So a touching place may move
along the rod, and the rod may roll. A surface that gives way by less than rounding leaves friction that nothing
determines as it was.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.body_obstacles import in_axes_of
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Written
from cosserat_casadi.equilibrium.contact.contact_state import ContactState, Touch, with_loads
from cosserat_casadi.equilibrium.contact.gap_rows import RodSurface
from cosserat_casadi.equilibrium.contact.gaps import obstacle_of
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import surface
from cosserat_casadi.equilibrium.solution import SolvedPoses
from cosserat_casadi.loads.contact_friction import ContactFriction
from cosserat_casadi.loads.contact_layer import along_surface
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix

STIFFNESSES = (1e4, 1e1, 1e7)
"""k, in EI/ℓ³, the first one first: it decides only how Newton's method goes from sticking to slipping and back."""

GIVES = 1e-11
"""Way, over the length, by which a surface gives along itself to a change of friction by the largest force."""

LEAST = 1e-3
"""Force, in EI/ℓ², to which smaller ones are compared."""

ROUNDING = 1e-12
"""Force, in EI/ℓ², that counts as zero."""

AXES = 3
"""Components of a force."""

HISTORY = 30
"""Numbers of a contact: an abscissa; pose there at the last point, and its rates; friction; compliance; k."""

NEAR = 0.05
"""Distance of places of contact on one obstacle at successive points below which they may be one contact."""


def rubs(scene: scenes.Scene, touch: Touch) -> bool:
    """Whether friction acts at a contact along a path: of a rod with an obstacle that has one coefficient."""
    if touch.of_body or touch.other is not None:
        return False
    return obstacle_of(scene, touch.obstacle).rubs_on_paths


@dataclass(frozen=True)
class LastShape:
    """The shape of a rod at the last point of a path, with the poses of its bodies.

    Attributes:
        ends: abscissae of the ends of its elements, shape (E + 1,).
        positions: positions of the nodes of each element, shape (E, N + 1, 3), m.
        quaternions: world_Q_section at these nodes, shape (E, N + 1, 4).
    """

    ends: FloatArray
    positions: FloatArray
    quaternions: FloatArray

    def at(self, X: float, body: SolvedPoses | None) -> FloatArray:
        """Position, m, its derivative by X, rotation matrix and its derivative at a section, in the axes of a body."""
        element = int(np.searchsorted(self.ends[1:-1], X, side="left"))
        width = self.ends[element + 1] - self.ends[element]
        intervals = self.positions.shape[1] - 1
        local = float(np.clip((X - self.ends[element]) / width, 0.0, 1.0))
        weights = chebyshev.interpolation_matrix(intervals, np.array([local]))[0]
        rates = weights @ chebyshev.differentiation_matrix(intervals) / width
        position, tangent = weights @ self.positions[element], rates @ self.positions[element]
        rotation, turning = (
            part.full() for part in _ROTATION(*(w @ self.quaternions[element] for w in (weights, rates)))
        )
        if body is not None:
            position, tangent = in_axes_of(body, position), tangent @ body.rotation
            rotation, turning = body.rotation.T @ rotation, body.rotation.T @ turning
        return np.concatenate([position, tangent, rotation.ravel(order="F"), turning.ravel(order="F")])


def _rotation() -> ca.Function:
    """(quaternion and its rate) ↦ rotation matrix of the normalised quaternion, and its rate."""
    quaternion, rate = ca.SX.sym("quaternion", 4), ca.SX.sym("rate", 4)
    rotation = quaternion_to_matrix(quaternion / ca.norm_2(quaternion))
    turning = ca.reshape(ca.jtimes(ca.vec(rotation), quaternion, rate), 3, 3)
    return ca.Function("rotation", [quaternion, rate], [rotation, turning])


_ROTATION = _rotation()


@dataclass(frozen=True)
class Before:
    """The last point of a path, from which slides are counted.

    Attributes:
        rods: shapes of the rods by name.
        bodies: poses of the bodies by name.
        friction: contacts with friction, and their dimensionless forces, shape (3,).
        largest: largest dimensionless force of a contact.
    """

    rods: Mapping[str, LastShape]
    bodies: Mapping[str, SolvedPoses]
    friction: tuple[tuple[Touch, FloatArray], ...]
    largest: float

    def numbers(self, touch: Touch, body: str | None) -> FloatArray:
        """Numbers of a contact at the last point, but for k, shape (HISTORY − 1,)."""
        pose = self.rods[touch.owner].at(float(touch.start), None if body is None else self.bodies[body])
        return np.concatenate([[float(touch.start)], pose, self.force(touch), [GIVES / max(LEAST, self.largest)]])

    def force(self, touch: Touch) -> FloatArray:
        """Force of friction of a contact, shape (3,); zero for a new one."""
        for other, force in self.friction:
            if is_same_contact(touch, other):
                return force
        return np.zeros(AXES)


def is_same_contact(touch: Touch, other: Touch) -> bool:
    """Whether two contacts at successive points of a path are one."""
    pairs = [(one.owner, one.obstacle, one.of_body) for one in (touch, other)]
    return pairs[0] == pairs[1] and abs(float(touch.start) - float(other.start)) < NEAR


@dataclass(frozen=True)
class RubbingWritten(Written):
    """The equations with friction as expressions.

    Attributes:
        before: symbol of the history of all contacts that rub, (HISTORY k)×1.
    """

    before: ca.MX

    @property
    def arguments(self) -> list[ca.MX]:
        """Arguments of the functions of the equations."""
        return [*super().arguments, self.before]

    @property
    def residual(self) -> Matrix:
        """Residual of the balance, then of the gaps, then of friction."""
        return ca.vertcat(super().residual, *(law for law, _ in self.laws))

    @property
    def jacobian(self) -> Matrix:
        """Derivative of the residual by the unknowns."""
        laws = ca.vertcat(*(law for law, _ in self.laws), ca.MX(0, 1))
        return ca.vertcat(super().jacobian, ca.horzcat(*(ca.jacobian(laws, part) for part in self.unknowns)))

    @cached_property
    def laws(self) -> list[tuple[Matrix, Matrix]]:
        """Law of each contact that rubs, 3×1, and the force that would hold it less what friction can, 1×1."""
        _, forces, _ = self.unknowns
        found: list[tuple[Matrix, Matrix]] = []
        touching = [
            (touch, pushing[0])
            for touch, pushing, _ in self.state.with_forces(forces, self.modes)
            if rubs(self.system.discrete.scene, touch)
        ]
        first = forces.shape[0] - AXES * len(touching)
        for number, (touch, push) in enumerate(touching):
            friction = forces[first + AXES * number : first + AXES * (number + 1)]
            before = self.before[HISTORY * number : HISTORY * (number + 1)]
            found.append(self._law(touch, push, friction, before))
        return found

    def _law(self, touch: Touch, push: Matrix, friction: Matrix, before: Matrix) -> tuple[Matrix, Matrix]:
        """Coulomb's law of one contact; forces are dimensionless, friction is in the axes of the obstacle."""
        system, obstacle = self.system, obstacle_of(self.system.discrete.scene, touch.obstacle)
        rod = RodSurface(system, touch.owner)
        shape, node = system.shapes[touch.owner], rod.discrete.grid.node_at(touch.start)
        directors = ca.horzcat(*(director[:, node] for director in shape.directors))
        rotation = system.turned_to(obstacle.body, system.base(touch.owner).rotation @ directors)
        position = system.seen_from(obstacle.body, rod.centre(touch.start))
        _, normal, _ = surface(obstacle)(position)
        arm = -rod.radius(touch.start) * normal
        # The pose at the last point of the section that touches now, to first order about the present iterate.
        beyond = touch.start - before[0]
        start = before[1:4] + beyond * before[4:7]
        turned = ca.reshape(before[7:16] + beyond * before[16:25], 3, 3)
        moved = position - start + (rotation @ turned.T - ca.DM.eye(3)) @ arm
        slide = along_surface(moved, normal) / rod.discrete.properties.length
        gives = before[28] * along_surface(friction - before[25:28], normal)
        held = along_surface(friction, normal) - before[29] * (slide + gives)
        size = ca.sqrt(ca.sumsqr(held) + ROUNDING**2)
        limit = obstacle.coefficients[0] * ca.fmax(push, 0)
        return friction - ca.fmin(1, limit / size) * held, size - limit


@dataclass(frozen=True)
class RubbingEquations(ContactEquations):
    """Equations of one state in z = (x, f, p), with friction; forces f end with the forces of friction.

    Attributes:
        before: the last point of the path; None until there is one, when only poses have a meaning.
        stiffness: k.
    """

    before: Before | None = None
    stiffness: float = STIFFNESSES[0]

    def changed(self, **changes: Any) -> RubbingEquations:
        """These equations after another point of the path, or with another k, with the same functions."""
        assert self._functions and self._by_arguments and self._excess
        other = replace(self, **changes)
        vars(other).update({name: value for name, value in vars(self).items() if name not in changes})
        return other

    def loaded(self, scene: scenes.Scene, state: ContactState, modes: Mapping[str, int]) -> scenes.Scene:
        """A scene with the forces of contacts as loads, those of friction last."""
        friction = [
            ContactFriction.model_construct(
                name=f"friction {number}",
                rod=touch.owner,
                obstacle=obstacle_of(scene, touch.obstacle),
                at=touch.start,
                force=(0.0, 0.0, 0.0),
            )
            for number, touch in enumerate(state.touches, start=1)
            if rubs(scene, touch)
        ]
        return with_loads(super().loaded(scene, state, modes), friction)

    @property
    def rubbing(self) -> list[int]:
        """Indices of the contacts that rub."""
        return [number for number, touch in enumerate(self.state.touches) if rubs(self.scene, touch)]

    @property
    def pushes(self) -> int:
        """Number of the forces along normals, which come first."""
        return len(self.nominal.force_units) - AXES * len(self.rubbing)

    def friction(self, z: FloatArray) -> FloatArray:
        """Dimensionless forces of friction, shape (k, 3), in the axes of the obstacles."""
        _, forces, _ = self.parts(z)
        return np.asarray(forces[self.pushes :].reshape(-1, AXES))

    def numbers(self, z: FloatArray, given: FloatArray) -> list[FloatArray]:
        """Values of the arguments of the functions of :attr:`written`."""
        arguments = super().numbers(z, given)
        return [*arguments, np.concatenate([np.zeros(0), *self._remembered(arguments[2])])]

    def _remembered(self, places: FloatArray) -> Iterator[FloatArray]:
        state = self.state.at(places[: len(self.state.places)].tolist())
        for number in self.rubbing:
            touch = state.touches[number]
            body = obstacle_of(self.scene, touch.obstacle).body
            own = np.zeros(HISTORY - 1) if self.before is None else self.before.numbers(touch, body)
            yield np.append(own, self.stiffness)

    def _write(self) -> Written:
        plain = super()._write()
        before = ca.MX.sym("before", HISTORY * len(self.rubbing))
        return RubbingWritten(plain.unknowns, plain.given, plain.state, plain.system, plain.modes, before)

    @cached_property
    def _excess(self) -> ca.Function:
        written = self.written
        assert isinstance(written, RubbingWritten)
        return ca.Function(
            "excess", written.arguments, [ca.vertcat(*(excess for _, excess in written.laws), ca.MX(0, 1))]
        )

    def excess(self, z: FloatArray) -> FloatArray:
        """Force that would hold each contact less what friction can, without unit, shape (k,): above zero it slips."""
        return np.asarray(self._excess(*self.numbers(z, self.given)).full()[:, 0])
