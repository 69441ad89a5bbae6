"""Functions for friction of exact contact in motion: sliding of a touching point along an obstacle or another rod.

A section with the centre c and the radius ρ touches at c − ρ n, with n the normal of the obstacle. This material point
has the velocity ċ + ω × (−ρ n). Positions and directors between nodes follow the polynomials through the nodes. Forces
act by the transpose of the derivatives of sliding, so the power of friction is force times velocity, to rounding.

Sections of two rods touch at the point that divides the line between their centres in the ratio of their radii. Each
rod has a velocity at this point, and the sliding is their difference. Friction acts on both rods at this one point,
which conserves their total momentum and angular momentum.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.equilibrium.contact.obstacle_surfaces import surface
from cosserat_casadi.loads.contact_layer import STANDING
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.system import System
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.moving_points import in_stacked_inputs, stacked_size
from cosserat_casadi.motion.rods_facing import RodsFacing


@dataclass(frozen=True)
class SurfaceSliding:
    """The velocity of a rod or a body along an obstacle or another rod, as functions of unknowns and rates.

    Attributes:
        facing: the pair of the rod or body and the obstacle, or of two rods.
    """

    facing: Facing

    @cached_property
    def _symbols(self) -> list[ca.MX]:
        """Unknowns, n×1; inputs and parameters, k×1; rates of both, 1/s; the section, (M + s)×1; an axis, 3×1.

        The section consists of the weights of the M nodes, followed by its abscissa X; for two rods, of the weights of
        the nodes of both, followed by both abscissae, so that s is 2. The first tangent of the surface is the part of
        the axis along the surface, normalised.
        """
        model = self.facing.model
        size, count = model.size, stacked_size(model)
        sides = 2 if isinstance(self.facing, RodsFacing) else 1
        sizes = {
            "x": size,
            "inputs": count,
            "v": size,
            "rate": count,
            "section": self.facing.points.count + sides,
            "axis": 3,
        }
        return [ca.MX.sym(name, rows) for name, rows in sizes.items()]

    def _sliding(self, section: Matrix) -> tuple[Matrix, Matrix]:
        """Velocity along both tangents, in lengths per second, and components of the rod's direction, 2×1 each.

        Args:
            section: weights of the nodes, then the abscissae, (M + s)×1.
        """
        axis, facing = self._symbols[5], self.facing
        count = facing.points.count
        if isinstance(facing, RodsFacing):
            own, other = section[: facing.node_count], section[facing.node_count : count]
            centre, rotation = self._pose(facing, own)
            other_centre, other_rotation = self._pose(facing.other, other)
            way = centre - other_centre
            normal = way / ca.sqrt(ca.sumsqr(way))
            radius, other_radius = _radius(facing, section[count]), _radius(facing.other, section[count + 1])
            arm = -radius / (radius + other_radius) * way
            own_arm = material_arm(rotation, arm)
            other_arm = material_arm(other_rotation, way + arm)
            velocity = self._velocity(centre, rotation, own_arm)
            velocity -= self._velocity(other_centre, other_rotation, other_arm)
        else:
            centre, rotation = self._pose(facing, section[:-1])
            _, normal, _ = surface(facing.obstacle)(centre)
            arm = -_radius(facing, section[-1]) * normal
            velocity = self._velocity(centre, rotation, rotation.T @ arm)
        first = axis - ca.dot(normal, axis) * normal
        first = first / ca.sqrt(ca.sumsqr(first))
        tangents = ca.horzcat(first, ca.cross(normal, first))
        along = tangents.T @ rotation[:, 2]
        # A rod that stands upright on the surface has no direction along it.
        return tangents.T @ velocity / facing.length, along / ca.sqrt(ca.sumsqr(along) + STANDING**2)

    def _pose(self, side: Facing, weights: Matrix) -> list[Matrix]:
        """Centre, 3×1, m, and rotation, 3×3, of a section of a rod, or of a body, in the world."""
        x, inputs = self._symbols[:2]
        return in_stacked_inputs(side.model, x, inputs, lambda system: _pose(side, system, weights))

    def _velocity(self, centre: Matrix, rotation: Matrix, arm: Matrix) -> Matrix:
        """Velocity of a material point at an arm from the centre of its section, along the directors, 3×1, m/s."""
        x, inputs, v, rate, _, _ = self._symbols
        moved = ca.reshape(_rate(ca.horzcat(centre, rotation), [(x, v), (inputs, rate)]), 3, 4)
        return moved[:, 0] + moved[:, 1:] @ arm

    @cached_property
    def function(self) -> ca.Function:
        """(x, inputs, v, rate, section, axis) ↦ velocity, 2×1; gradients by v, n×2; direction of the rod, 2×1."""
        sliding, along = self._sliding(self._symbols[4])
        by_v = ca.jacobian(sliding, self._symbols[2]).T
        return ca.Function("rubbing", self._symbols, [ca.densify(part) for part in (sliding, by_v, along)])

    @cached_property
    def derivatives(self) -> ca.Function:
        """(…, axis, change of the section with X, force along both tangents) ↦ derivatives by x, X, inputs and rates.

        The first arguments are those of :attr:`function`. Derivatives by x, X and inputs have 4 + n rows: of the
        velocity, the direction and the generalised force. Those by the rates of the inputs are of the velocity, 2×k.
        Both abscissae of two rods have a column each, in the change and in the derivatives by X.
        """
        x, inputs, v, rate, section, _ = self._symbols
        sides = section.shape[0] - self.facing.points.count
        change, force = ca.MX.sym("change", section.shape[0], sides), ca.MX.sym("force", 2)
        shift = ca.MX.sym("shift", sides)
        sliding, along = self._sliding(section + change @ shift)
        rows = ca.vertcat(sliding, along, ca.gradient(ca.dot(force, sliding), v))
        parts = [ca.jacobian(rows, x), ca.jacobian(rows, shift), ca.jacobian(rows, inputs), ca.jacobian(sliding, rate)]
        parts = ca.graph_substitute(parts, [shift], [ca.MX(sides, 1)])
        arguments = [*self._symbols, change, force]
        return ca.Function("rubbing_derivatives", arguments, [ca.densify(part) for part in parts])

    @property
    def moving(self) -> list[int]:
        """Indices of the unknowns whose rates move the touching point along the surface."""
        return sorted(set(ca.jacobian_sparsity(self.function(*self._symbols)[0], self._symbols[2]).get_col()))


def _radius(side: Facing, X: Matrix) -> Matrix:
    """Radius of a section, m, at an abscissa."""
    base, tip = side.radii
    return base + X * (tip - base)


def material_arm(rotation: Matrix, arm: Matrix) -> Matrix:
    """Components of an arm along the directors, 3×1, m.

    Interpolated directors are orthogonal only up to the error of polynomials, so they are inverted: otherwise forces at
    one point of two rods would leave a moment.
    """
    first, second, third = ca.horzsplit(rotation)
    across = [ca.cross(second, third), ca.cross(third, first), ca.cross(first, second)]
    return ca.vertcat(*(ca.dot(one, arm) for one in across)) / ca.dot(across[0], first)


def _rate(quantity: Matrix, moved: list[tuple[ca.MX, ca.MX]]) -> Matrix:
    """Rate of a quantity, stacked in one column, from pairs of an argument and its rate."""
    stacked = ca.vec(quantity)
    return sum((ca.jtimes(stacked, argument, rate) for argument, rate in moved), ca.MX(stacked.shape[0], 1))


def _pose(facing: Facing, system: System, weights: Matrix) -> list[Matrix]:
    """Centre, 3×1, m, and rotation, 3×3, of a section of a rod, or of a body, in the axes of the obstacle."""
    if facing.of_body:
        pose = system.body(facing.owner)
        return [ca.MX(pose.position), ca.MX(pose.rotation)]
    position, *directors = system.sections(facing.owner, weights)
    seen = system.seen_from(facing.carrier, position)
    return [seen, system.turned_to(facing.carrier, ca.horzcat(*directors))]


def functions_of_sliding(model: Model) -> list[ca.Function]:
    """Functions of all pairs that may touch: :attr:`SurfaceSliding.function` with its results in one column."""
    found = []
    for number, facing in enumerate(facings(model)):
        function = SurfaceSliding(facing).function
        arguments = function.mx_in()
        results = [ca.vec(result) for result in function.call(arguments)]
        found.append(ca.Function(f"rubbing_{number}", arguments, [ca.vertcat(*results)]))
    return found
