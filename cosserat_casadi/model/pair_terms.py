"""Terms of two rods that push each other: forces on both, and the second variation of their energy.

The forces are minus the derivatives of one energy of the centres of the sections of both. On each rod they are a dead
force per length, which statics and tangents take like any other. The rest of the derivative by the unknowns is Gᵀ H G,
with the second derivative H of the energy and the motions G of the sections by the strains of their rod and by its
base, if it floats.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from cosserat_casadi.loads.load import Rubbing
from cosserat_casadi.loads.obstacle_load import section_radii
from cosserat_casadi.loads.rod_contact import PANEL, STILL, SectionPairs, SectionsInContact
from cosserat_casadi.maths.numbers import as_matrix, known, repeated
from cosserat_casadi.maths.rotation import cross
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.contact_pairs import ContactPair, PairHistory
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.inputs import HISTORY
from cosserat_casadi.rod.placed_sections import PlacedSections
from cosserat_casadi.rod.strain import DiscreteRod
from cosserat_casadi.rod.wrenches import LineWrench

if TYPE_CHECKING:
    from cosserat_casadi.model.system import System

HALF_TURN = 1e-6
"""Least 2 + 2 cos θ of a rotation by θ between points of a path: tan θ/2 grows without bound at half a turn."""


@dataclass(frozen=True)
class ContactSide:
    """The sections of one rod of a pair.

    Attributes:
        system: the scene.
        rod: name of the rod.
        count: number of sections that represent a part of the rod each. Further sections at the tip, which represent
            none, fill the last panel up to S sections.
        history: memory of friction from the last point of a path; None without a path.
    """

    system: System
    rod: str
    count: int
    history: PairHistory | None = None

    @property
    def discrete(self) -> DiscreteRod:
        """The constant matrices of the rod."""
        return self.system.discrete.rods[self.rod]

    @property
    def at_sections(self) -> Matrix:
        """Positions of the sections that represent a part of the rod, world axes, 3×count, m."""
        return self.sections.positions[:, : self.count]

    @property
    def columns(self) -> int:
        """Number of sections S."""
        return PANEL * ceil(self.count / PANEL)

    @cached_property
    def placed(self) -> PlacedSections:
        """The sections at their places."""
        return PlacedSections(self.discrete, self.coordinates)

    @property
    def interpolation(self) -> ca.DM:
        """Matrix from values at the nodes to values at the sections, S×M."""
        return self.placed.interpolation

    @cached_property
    def sections(self) -> SectionsInContact:
        """The sections at their places, each for an equal part of the rod between element ends."""
        rod = self.discrete
        X, rates = self.placed.X, self.placed.rates
        ratio = self.system.shapes[self.rod].ratio
        lengths = as_matrix(np.where(np.arange(self.columns) < self.count, rod.properties.length / self.count, 0.0))
        if rates is not None:
            lengths = lengths * as_matrix(rates)
        if ratio is not None:
            lengths = ratio * lengths
        radii = as_matrix(repeated(section_radii(rod.properties, X), self.columns))
        along = rod.properties.length * as_matrix(X)
        if ratio is not None:
            along = ratio * along
        data = ca.horzcat(lengths, radii, along).T
        origin = ca.repmat(ca.MX(self.system.base(self.rod).position), 1, self.columns)
        return SectionsInContact(origin + self._arms, data, self._motions)

    @property
    def _motions(self) -> Matrix:
        """Motions of the sections for the law of friction, world axes, MOTION×S; without columns without friction."""
        motion = self.system.motions.get(self.rod)
        if motion is not None:
            nodal = ca.vertcat(*[self._rotation @ rate for rate in (motion.velocity, motion.angular_velocity)])
        elif self.history is not None:
            nodal = self._moved_since(self.history.poses[self.rod])
        else:
            return STILL
        return ca.densify(nodal @ self.interpolation.T)

    def _moved_since(self, before: Matrix) -> Matrix:
        """Displacements and rotations of the nodes from other poses, MOTION×M."""
        own, remembered = self.discrete.grid, self.system.discrete.remembered[self.rod]
        if own is not remembered:
            before = before @ ca.DM(remembered.interpolation_matrix(known(own.nodes)).T)
        position, *directors = ca.vertsplit(before, 3)
        poses = self.poses
        here, *turned = ca.vertsplit(poses, 3)
        # The axis of R R₀ᵀ times tan θ/2 is Σ d₀ × d / (1 + Σ d₀·d) over the directors.
        sines = sum(cross(old, new) for old, new in zip(directors, turned, strict=True))
        cosines = ca.sum1(before[3:, :] * poses[3:, :])
        rotation = sines / ca.repmat(ca.fmax(1 + cosines, HALF_TURN), 3, 1)
        return ca.vertcat(here - position, rotation)

    @property
    def poses(self) -> Matrix:
        """Positions and rotation matrices of the nodes, world axes, POSE×M."""
        directors = [self._rotation @ director for director in self.system.shapes[self.rod].directors]
        return ca.vertcat(self.system.nodes(self.rod), *directors)

    def wrench(self, force: Matrix, moment: Matrix | None = None) -> LineWrench:
        """Load per length on the nodes that does the same work as forces and moments on the sections, base axes.

        Args:
            force: force on the sections, 3×S, N, world axes.
            moment: moment on the sections, 3×S, N m, world axes.
        """
        lengths = ca.repmat(as_matrix(self.discrete.node_lengths).T, 3, 1)
        per_length = [
            None if part is None else self._rotation.T @ (part @ self.interpolation) / lengths
            for part in (force, moment)
        ]
        return LineWrench(per_length[0], per_length[1], None, follower=False)

    @cached_property
    def base_frame(self) -> FrameName | None:
        """The floating frame of the rod's base; None if the base rests in the world."""
        return self.system.discrete.unloaded.floating_base(self.rod)

    @cached_property
    def motion(self) -> Matrix:
        """Motion of the sections, world axes, 3n×S: three components, each with a row for each coordinate.

        The coordinates are the strains of the rod, then the motion [δθ; δr] of its base if it floats.
        """
        tangent = self.system.tangents[self.rod]
        grid = self.discrete.grid
        integrate = ca.DM(grid.integration_matrix).T
        moved = [component.T @ integrate for component in ca.vertsplit(tangent.tangent, grid.size)]
        local = [component @ self.interpolation.T for component in moved]
        rotation = self._rotation
        components = [sum(rotation[i, j] * local[j] for j in range(3)) for i in range(3)]
        if self.base_frame is None:
            return ca.vertcat(*components)
        x, y, z = ca.vertsplit(self._arms)
        none = ca.DM(1, self.columns)
        # δθ × arm, one row for each component of δθ, and δr.
        turned = [(none, z, -y), (-z, none, x), (y, -x, none)]
        shifted = [[ca.DM.ones(1, self.columns) if i == j else none for j in range(3)] for i in range(3)]
        parts = zip(components, turned, shifted, strict=True)
        return ca.vertcat(*[ca.vertcat(own, *turn, *shift) for own, turn, shift in parts])

    @property
    def coordinates(self) -> FloatArray:
        """Coordinates of the sections on the grid, shape (S,)."""
        return np.minimum((np.arange(self.columns) + 0.5) / self.count, 1.0)

    @property
    def _rotation(self) -> Matrix:
        """world_R_base, 3×3."""
        return self.system.base(self.rod).rotation

    @cached_property
    def _arms(self) -> Matrix:
        """Sections from the base, world axes, 3×S, m."""
        return self._rotation @ self.system.shapes[self.rod].position @ self.interpolation.T


@dataclass(frozen=True)
class PairTerms:
    """The terms of one pair at the arguments of a system.

    Attributes:
        system: the scene.
        pair: the pair.
    """

    system: System
    pair: ContactPair

    @property
    def name(self) -> str:
        """Name of the pair."""
        return self.pair.name

    @property
    def rods(self) -> tuple[str, str]:
        """Names of both rods."""
        return self.pair.rods

    @cached_property
    def sides(self) -> tuple[ContactSide, ...]:
        """The sections of both rods; one entry for a rod that touches itself."""
        names = dict(zip(self.pair.rods, self.pair.sections, strict=True))
        return tuple(ContactSide(self.system, name, count, self.history) for name, count in names.items())

    @cached_property
    def section_pairs(self) -> SectionPairs:
        """All pairs of sections."""
        first, second = (self.sides[place].sections for place in (0, -1))
        if self.history is None or not self.rubs:
            return SectionPairs(first, second, self.pair.law)
        dragged = ca.vertcat(self.history.drag_at(self.sides[0].coordinates), ca.DM(3, self.sides[0].columns))
        law = ca.vertcat(self.pair.law[:3], self.pair.friction * self.history.is_known, self.pair.slip_way)
        return SectionPairs(replace(first, motion=first.motion + dragged), second, law, along_path=True)

    @cached_property
    def energy(self) -> Matrix:
        """Energy that the pair stores, 1×1, J."""
        return self._factor * self.section_pairs.energy

    def wrenches(self, rod: str) -> list[LineWrench]:
        """The push and the friction on a rod, base axes; nothing for a rod outside of the pair."""
        pushes = zip(self.sides, self._gradients, strict=True)
        loads = [side.wrench(-self._factor * gradient) for side, gradient in pushes if side.rod == rod]
        rubs = zip(self.sides, self.frictions, strict=False)
        frictions = [(side, self._factor * friction) for side, friction in rubs if side.rod == rod]
        return loads + [side.wrench(friction[:3, :], friction[3:, :]) for side, friction in frictions]

    @property
    def rubs(self) -> bool:
        """Whether friction acts: in motion, or along a path."""
        return self.pair.friction > 0.0 and (bool(self.system.motions) or self.history is not None)

    @cached_property
    def history(self) -> PairHistory | None:
        """The history of friction, from the last point of a path; None without a path."""
        discrete = self.system.discrete
        entries = discrete.layout.of_load(self.name, HISTORY)
        if entries is None or self.system.motions:
            return None
        return PairHistory.of_column(self.system.arguments.inputs[entries], self.pair, discrete.remembered)

    @property
    def rubbing(self) -> Rubbing:
        """Friction of the sections of the first rod: history, slip, 1×k, and force, 3×k, N."""
        assert self.history is not None, "asked for along a path"
        count = self.sides[0].count
        way, push, pressing = ca.vertsplit(self.section_pairs.way[:, :count], [0, 3, 6, 7])
        pressed = self.history.is_known * (pressing > 0.0)
        way = way * ca.repmat(pressed / ca.if_else(pressing > 0.0, pressing, 1.0), 3, 1)
        # The mean surface of all pairs takes the projection: projected on each pair's surface the drag would fade.
        square = ca.sum1(push**2)
        drag = way - push * ca.repmat(ca.sum1(push * way) / ca.if_else(square > 0.0, square, 1.0), 3, 1)
        share = ca.sqrt(ca.sum1(drag**2)) / self.pair.slip_way
        after = drag / ca.repmat(ca.fmax(share, 1.0), 3, 1)
        history = PairHistory(after, {side.rod: side.poses for side in self.sides})
        slip = ca.if_else(pressing > 0.0, share, -1.0)
        return Rubbing(history.column, slip, self.frictions[0][:3, :count])

    @property
    def dissipated_power(self) -> Matrix:
        """Power that friction dissipates, 1×1, W."""
        powers = [
            -ca.dot(friction, side.sections.motion) for side, friction in zip(self.sides, self.frictions, strict=True)
        ]
        return sum(powers[1:], powers[0])

    @property
    def _gradients(self) -> list[Matrix]:
        """Derivatives of the energy by the positions of the sections of each side, 3×S, N."""
        first, second = self.section_pairs.gradient
        return [first + second] if self.pair.itself else [first, second]

    @cached_property
    def frictions(self) -> Sequence[Matrix]:
        """[Force; moment] of friction on the sections of each side, 6×S; empty without friction."""
        if not self.rubs:
            return []
        if self.pair.name in self.system.friction:
            return self.system.friction[self.pair.name]
        first, second = self.section_pairs.friction
        return [first + second] if self.pair.itself else [first, second]

    def friction_jacobian(self, argument: Matrix) -> Matrix:
        """Derivative of the frictions, stacked, with unknowns or velocities, by places and motions of the sections."""
        columns = []
        rates = []
        for sections in (self.section_pairs.first, self.section_pairs.second):
            fields = (sections.positions, ca.vertcat(sections.data, sections.motion))
            derivatives = [ca.jacobian(ca.vec(field), argument) for field in fields]
            # Columns of unknowns that move neither rod, which are most, are left out.
            moving = {column for derivative in derivatives for column in derivative.sparsity().get_triplet()[1]}
            own = sorted(moving)
            columns.append(own)
            rates.append([ca.densify(derivative[:, own]).T for derivative in derivatives])
        parts = self.section_pairs.friction_rates(*rates)
        jacobian = ca.MX(sum(friction.numel() for friction in self.frictions), argument.numel())
        for own, loads in zip(columns, parts, strict=True):
            stacked = sum(loads[1:], loads[0]) if self.pair.itself else ca.horzcat(*loads)
            part = ca.MX(*jacobian.shape)
            part[:, own] = stacked.T
            jacobian += part
        return jacobian

    @cached_property
    def stiffness(self) -> dict[tuple[str, str], Matrix]:
        """Gᵀ H G for each pair of rods, in the coordinates of each side, J."""
        motions = [side.motion for side in self.sides]
        own, across, other = self.section_pairs.stiffness(motions[0], motions[-1])
        first, second = self.pair.rods
        factor = self._factor
        if self.pair.itself:
            return {(first, first): factor * (own + across + across.T + other)}
        return {
            (first, first): factor * own,
            (first, second): factor * across.T,
            (second, first): factor * across,
            (second, second): factor * other,
        }

    @property
    def _factor(self) -> Matrix | float:
        """Factor of the push along the load path: the load factor, as for loads."""
        load_factor = self.system.arguments.load_factor
        return 1.0 if load_factor is None else load_factor
