"""A planar rod that falls on a floor, from event to event, by SciPy: laws of Newton and Coulomb, not the package.

The rod neither stretches nor shears, and has no radius. Unknowns are q = (x, z, θ, c): position and angle of its base,
and coefficients c of its curvature in Legendre polynomials. The floor is z = 0. What touches it is an end, or the
section at which the rod is level, which rolls along the rod: its gap has the second derivative z_tt - z_ts² / z_ss.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from scipy.integrate import solve_ivp

from cosserat_casadi.maths.typing import FloatArray

NODES = 20
GRAVITY = 9.81
STILL = 1e-7
"""Velocity that counts as none, m/s, and so of accelerations and forces in their units."""

INWARDS = {0.0: 1.0, 1.0: -1.0}
BESIDE = 0.05
"""Abscissa up to which a valley of the gap is that of a contact."""


SHORTEST = 2e-6
"""Time for which a motion is computed after an event, s; then twice as long, and so on."""

SLOWEST = 2e-3
"""Speed below which nothing rebounds, m/s: bounces end."""


@dataclass(frozen=True)
class Contact:
    """A section that touches: its abscissa, whether it rolls, the sign of its slide: 0 sticks, None does not press."""

    place: float
    rolls: bool
    slides: int | None = None


@dataclass(frozen=True)
class Section:
    """A section and its motion along and across the floor.

    Attributes:
        height: m.
        rows: its velocity by q̇, shape (2, n).
        velocity: m/s.
        acceleration: that without q̈; across the floor that of the gap, m/s².
        slope: of the rod.
        rolling: how fast the section rolls along the rod, 1/s.
    """

    height: float
    rows: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    slope: float
    rolling: float


class _Guard:
    """An event of SciPy: one of the guards falls below zero."""

    terminal = True
    direction = -1.0

    def __init__(self, guards: Callable[[FloatArray], FloatArray], number: int) -> None:
        self._guards = guards
        self._number = number

    def __call__(self, _: float, y: FloatArray) -> float:
        return float(self._guards(y)[self._number])


class FallingRod:
    """A rod above a floor, in SI units."""

    def __init__(
        self,
        length: float,
        bending: float,
        density: float,
        inertia: float,
        retardation: float,
        modes: int,
        friction: float,
        restitution: float,
    ) -> None:
        self.length = length
        self.retardation = retardation
        self.modes = modes
        self.friction = friction
        self.restitution = restitution
        z, w = legendre.leggauss(NODES)
        self._fits = (np.arange(NODES) + 0.5)[:, None] * legendre.legvander(z, NODES - 1).T * w
        self._curvatures = legendre.legvander(z, modes - 1)
        self._integrals = self.integrals((z + 1.0) / 2.0)
        self._turns = self._turns_of(self._integrals)
        self._mass = density * w * length / 2.0
        self._spin_mass = inertia * (self._turns.T * w) @ self._turns * length / 2.0
        self._stiffness = bending * (self._curvatures.T * w) @ self._curvatures * length / 2.0
        self._grid = np.linspace(0.0, 1.0, 201)
        self._grid_integrals = self.integrals(self._grid)

    def integrals(self, X: FloatArray) -> FloatArray:
        """Weights of values at the nodes in their integrals from the base to sections, m."""
        values = legendre.legvander(2.0 * X - 1.0, NODES)
        parts = [(values[:, k + 1] - values[:, k - 1]) / (2 * k + 1) for k in range(1, NODES)]
        return np.column_stack([2.0 * X, *parts]) @ self._fits * self.length / 2.0

    def positions(self, q: FloatArray, X: FloatArray) -> FloatArray:
        return self._along(q, 0.0 * q, self.integrals(X))[0]

    def _turns_of(self, integrals: FloatArray) -> FloatArray:
        count = len(integrals)
        return np.hstack([np.zeros((count, 2)), np.ones((count, 1)), integrals @ self._curvatures])

    def _along(self, q: FloatArray, v: FloatArray, integrals: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions of sections, their derivatives by q, and what q̇ adds to their accelerations."""
        angles, spins = self._turns @ q, self._turns @ v
        tangents = np.stack([np.cos(angles), np.sin(angles)])
        normals = np.stack([-tangents[1], tangents[0]])
        rows = np.stack([(integrals * normal) @ self._turns for normal in normals], axis=1)
        rows[:, 0, 0] += 1.0
        rows[:, 1, 1] += 1.0
        return q[:2] + integrals @ tangents.T, rows, -integrals @ (tangents * spins**2).T

    def section(self, q: FloatArray, v: FloatArray, contact: Contact) -> Section:
        integrals = self.integrals(np.array([contact.place]))
        at, rows, acceleration = (part[0] for part in self._along(q, v, integrals))
        turns = self._turns_of(integrals)[0]
        curvature = legendre.legvander(np.array([2.0 * contact.place - 1.0]), self.modes - 1)[0] @ q[3:]
        spin, rolling = turns @ v, 0.0
        if contact.rolls:
            acceleration[1] -= np.cos(turns @ q) * spin**2 / curvature
            rolling = -spin / (self.length * curvature)
        return Section(at[1], rows, rows @ v, acceleration, np.sin(turns @ q), rolling)

    def mechanics(self, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Masses and forces."""
        _, rows, acceleration = self._along(q, v, self._integrals)
        weighted = np.einsum("j,jak->kja", self._mass, rows)
        force = -weighted.reshape(q.size, -1) @ (acceleration + np.array([0.0, GRAVITY])).ravel()
        force[3:] -= self._stiffness @ (q[3:] + self.retardation * v[3:])
        return weighted.reshape(q.size, -1) @ rows.reshape(-1, q.size) + self._spin_mass, force

    def pushed(
        self,
        mass: FloatArray,
        force: FloatArray,
        sections: Sequence[Section],
        wanted: FloatArray,
        slides: Sequence[int | None],
    ) -> tuple[FloatArray, FloatArray]:
        """q̈, and forces of contacts along and across the floor, for accelerations of sections that are wanted.

        Impulses are the same, with momenta for forces and velocities for accelerations.
        """
        columns, conditions, values = [], [], []
        for own, goal, slide in zip(sections, wanted, slides, strict=True):
            along, normal = own.rows
            if slide is not None:
                columns.append(normal - self.friction * slide * along)
                conditions.append(normal)
                values.append(goal[1])
            if slide == 0:
                columns.append(along)
                conditions.append(along)
                values.append(goal[0])
        n, m = force.size, len(columns)
        matrix = np.zeros((n + m, n + m))
        matrix[:n, :n] = mass
        if m:
            matrix[:n, n:] = -np.array(columns).T
            matrix[n:, :n] = conditions
        found = np.linalg.solve(matrix, np.concatenate([force, values]))
        left, forces = list(found[n:]), np.zeros((len(slides), 2))
        for k, slide in enumerate(slides):
            if slide is not None:
                forces[k, 1] = left.pop(0)
                forces[k, 0] = left.pop(0) if slide == 0 else -self.friction * slide * forces[k, 1]
        return found[:n], forces

    def settled(
        self,
        mass: FloatArray,
        force: FloatArray,
        sections: Sequence[Section],
        wanted: FloatArray,
        velocities: FloatArray,
    ) -> tuple[FloatArray, list[int | None]]:
        """What presses, sticks and slides by the laws: the first of all choices that holds; behind q̈ of it.

        Args:
            velocities: with which sections slide already, m/s; none of them in a blow.
        """
        choices = (None, -1, 1, 0) if self.friction > 0.0 else (None, 1)
        for slides in itertools.product(choices, repeat=len(sections)):
            found, forces = self.pushed(mass, force, sections, wanted, slides)
            holds = True
            for own, goal, slide, push, speed in zip(sections, wanted, slides, forces, velocities, strict=True):
                along, normal = own.rows @ found - goal
                moves = speed if abs(speed) > STILL else along
                if slide is None:
                    holds &= normal >= -STILL
                elif slide == 0:
                    holds &= push[1] >= 0.0 and abs(push[0]) <= self.friction * push[1] and abs(speed) <= STILL
                else:
                    holds &= push[1] >= 0.0 and (self.friction == 0.0 or moves * slide > 0.0)
            if holds:
                return found, list(slides)
        raise ArithmeticError("no choice of contacts holds")

    def restarted(self, q: FloatArray, v: FloatArray, contacts: Sequence[Contact]) -> tuple[FloatArray, list[Contact]]:
        """Velocities after a blow, if there is one, and the contacts from then on."""
        sections = [self.section(q, v, own) for own in contacts]
        mass, force = self.mechanics(q, v)
        if any(own.velocity[1] < -STILL for own in sections):
            back = [-self.restitution * own.velocity[1] for own in sections]
            gives = [[0.0, speed if speed > SLOWEST else 0.0] for speed in back]
            v, _ = self.settled(mass, mass @ v, sections, np.array(gives), np.zeros(len(sections)))
            stays = [k for k, own in enumerate(sections) if abs(own.rows[1] @ v) <= 10.0 * STILL]
            return self.restarted(q, v, [contacts[k] for k in stays])
        wanted = np.array([-own.acceleration for own in sections]).reshape(-1, 2)
        speeds = np.array([own.velocity[0] for own in sections])
        _, slides = self.settled(mass, force, sections, wanted, speeds)
        kept = zip(contacts, slides, strict=True)
        return v, [Contact(own.place, own.rolls, slide) for own, slide in kept if slide is not None]

    def others(self, q: FloatArray, contacts: Sequence[Contact]) -> tuple[float, Contact]:
        """The least gap of what does not touch, m."""
        angles = self._turns @ q
        z = q[1] + self._grid_integrals @ np.sin(angles)
        padded = np.concatenate([[np.inf], z, [np.inf]])
        valleys = np.flatnonzero((z <= padded[:-2]) & (z <= padded[2:]))
        best = (1.0, Contact(0.0, False))
        for k in valleys:
            own = Contact(self._grid[k], 0 < k < z.size - 1)
            if any(abs(own.place - other.place) <= BESIDE for other in contacts):
                continue
            for _ in range(3 if own.rolls else 0):
                integrals = self.integrals(np.array([own.place]))
                slope = np.sin(self._turns_of(integrals)[0] @ q)
                curvature = legendre.legvander(np.array([2.0 * own.place - 1.0]), self.modes - 1)[0] @ q[3:]
                own = Contact(own.place - np.clip(slope / (self.length * curvature), -5e-3, 5e-3), True)
            height = self.section(q, 0.0 * q, own).height
            best = min(best, (height, own), key=lambda pair: pair[0])
        return best

    def motion(self, q: FloatArray, times: FloatArray) -> FloatArray:
        """q at times, from rest."""
        contacts: list[Contact] = []
        n, t, v = q.size, 0.0, 0.0 * q
        states = np.empty((len(times), n))

        def at(y: FloatArray) -> tuple[list[Section], FloatArray, FloatArray]:
            own = [self.section(y[:n], y[n : 2 * n], moved) for moved in here(y)]
            wanted = np.array([-section.acceleration for section in own]).reshape(-1, 2)
            found, forces = self.pushed(*self.mechanics(y[:n], y[n : 2 * n]), own, wanted, [c.slides for c in contacts])
            return own, found, forces

        def here(y: FloatArray) -> list[Contact]:
            return [Contact(s, c.rolls, c.slides) for s, c in zip(y[2 * n :], contacts, strict=True)]

        def rates(_: float, y: FloatArray) -> FloatArray:
            try:
                own, found, _ = at(y)
            except np.linalg.LinAlgError:
                # A step was tried too far, and the integrator tries a shorter one.
                return np.full(y.size, np.nan)
            return np.concatenate([y[n : 2 * n], found, [section.rolling for section in own]])

        def guards(y: FloatArray) -> FloatArray:
            """What is positive while contacts stay, four for each, and the least gap besides."""
            own, _, forces = at(y)
            values = []
            for contact, section, push in zip(here(y), own, forces, strict=True):
                slides = contact.slides or 0
                holds = self.friction * push[1] - abs(push[0]) if slides == 0 else 1.0
                moves = slides * section.velocity[0] if slides and self.friction > 0.0 else 1.0
                inside = INWARDS.get(contact.place, 0.0) * section.slope
                if contact.rolls:
                    inside = min(contact.place, 1.0 - contact.place)
                values += [push[1], holds, moves, inside]
            return np.array([*values, self.others(y[:n], here(y))[0]])

        piece = SHORTEST
        while t < times[-1]:
            events = [_Guard(guards, k) for k in range(4 * len(contacts) + 1)]
            start = np.concatenate([q, v, [own.place for own in contacts]])
            end = min(t + piece, times[-1])
            run = solve_ivp(
                rates, (t, end), start, method="DOP853", events=events, rtol=1e-9, atol=1e-11, dense_output=True
            )
            inside = (times >= t) & (times <= run.t[-1])
            if inside.any():
                states[inside] = run.sol(times[inside])[:n].T
            t, y = run.t[-1], run.y[:, -1]
            q, v, contacts = y[:n], y[n : 2 * n], here(y)
            piece *= 2.0
            if run.status == 0:
                continue
            piece = SHORTEST
            which = next(k for k, found in enumerate(run.t_events) if len(found))
            if which == 4 * len(contacts):
                contacts.append(self.others(q, contacts)[1])
            elif which % 4 == 0:
                contacts.pop(which // 4)
            elif which % 4 == 1:
                # What breaks loose has no velocity yet: it slides against the force that held it.
                own = contacts[which // 4]
                contacts[which // 4] = Contact(own.place, own.rolls, -int(np.sign(at(y)[2][which // 4, 0])))
                continue
            elif which % 4 == 3:
                own = contacts[which // 4]
                contacts[which // 4] = Contact(float(round(own.place)), not own.rolls)
            v, contacts = self.restarted(q, v, contacts)
        return states
