"""Two rods that touch at one section of each, in the equations of a scene: wrenches, and blocks of the Jacobian.

The energy is U = −N d. G is the derivative of the positions of the sections with respect to the strains of their rods,
and to the motions of their bases if these float. The Jacobian has the blocks Gᵀ ∂²U G, as for rods that push each other
smoothly (pair_terms.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import casadi as ca

from cosserat_casadi.loads.rods_point import RodsPoint, across
from cosserat_casadi.maths.numbers import Scalar
from cosserat_casadi.maths.rotation import hat
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.inputs import input_value
from cosserat_casadi.rod.wrenches import WrenchAt

if TYPE_CHECKING:
    from cosserat_casadi.model.system import System


@dataclass(frozen=True)
class TouchingRods:
    """A point of contact of two rods, evaluated at the arguments of a system.

    Attributes:
        system: the scene.
        load: the force between them.
    """

    system: System
    load: RodsPoint

    @property
    def rods(self) -> tuple[str, str]:
        """Names of both rods."""
        return self.load.rods

    @cached_property
    def normal(self) -> Matrix:
        """Unit vector from the centre of the second section to that of the first, world axes, 3×1."""
        return self._across[0]

    def wrenches(self, rod: str) -> list[WrenchAt]:
        """Force on a rod, in the axes of its base; an empty list for a rod outside the pair."""
        base_R_world = self.system.base(rod).rotation.T
        sides = zip(self.rods, self.load.places, (1.0, -1.0), strict=True)
        return [
            WrenchAt(at, side * self.force * (base_R_world @ self.normal), None, follower=False)
            for name, at, side in sides
            if name == rod
        ]

    @cached_property
    def stiffness(self) -> dict[tuple[str, str], Matrix]:
        """Blocks Gᵀ ∂²U G by pairs of rods, J, in strains and then the motion [δθ; δr] of a floating base."""
        own, other = (self._motion(rod, at) for rod, at in zip(self.rods, self.load.places, strict=True))
        first, second = self.rods
        pressed = -self.force * self._across[1]
        mixed = -own.T @ pressed @ other
        return {
            (first, first): own.T @ pressed @ own,
            (first, second): mixed,
            (second, first): mixed.T,
            (second, second): other.T @ pressed @ other,
        }

    @cached_property
    def force(self) -> Matrix:
        """Force N between the rods, times the load factor, 1×1, N."""
        given = input_value(self.system.discrete.layout, self.load, "force", self.system.arguments.inputs)
        force = ca.DM(1, 1) if given is None else given
        load_factor = self.system.arguments.load_factor
        return force if load_factor is None else load_factor * force

    @cached_property
    def _across(self) -> tuple[Matrix, Matrix]:
        centres = [
            self.system.position_at(rod, self._node(rod, at))
            for rod, at in zip(self.rods, self.load.places, strict=True)
        ]
        return across(centres[0] - centres[1])

    def _node(self, rod: str, at: Scalar) -> int:
        return self.system.discrete.rods[rod].grid.node_at(at)

    def _motion(self, rod: str, at: Scalar) -> Matrix:
        """Derivative G of the position of a section, world axes, 3×n, or 3×(n + 6) for a floating base."""
        node = self._node(rod, at)
        rotation = self.system.base(rod).rotation
        by_strains = rotation @ self.system.tangents[rod].position(node)
        if self.system.discrete.unloaded.floating_base(rod) is None:
            return by_strains
        arm = rotation @ self.system.shapes[rod].position_at(node)
        return ca.horzcat(by_strains, -hat(arm), ca.DM.eye(3))
