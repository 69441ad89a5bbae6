"""Functions of what rubs in exact contact in motion: how the point that touches slides along the surface.

A section of the radius ρ touches at −ρ n from its centre, n the normal of the obstacle, and that point of its material
has the velocity ċ + ω × (−ρ n). Positions and directors between nodes follow the polynomials through the nodes;
forces act by the transpose of the same derivatives, so that what friction takes is force times velocity to rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.equilibrium.contact.obstacle_surfaces import surface
from cosserat_casadi.loads.contact_layer import STANDING
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.contact_sections import facings


@dataclass(frozen=True)
class SurfaceSliding:
    """The velocity along the surface of a rod or a body before an obstacle, as functions of unknowns and rates.

    Attributes:
        facing: the two.
    """

    facing: Facing

    @cached_property
    def _symbols(self) -> list[ca.MX]:
        """Unknowns, inputs, their rates, the section, and an axis.

        The section is given by the weights of the nodes and by its abscissa behind them. The axis, 3×1, tells which two
        tangents of the surface are taken: the first is its part along the surface.
        """
        model = self.facing.model
        size, count = model.size, model.inputs.size
        sizes = {
            "x": size,
            "inputs": count,
            "v": size,
            "rate": count,
            "section": self.facing.points.count + 1,
            "axis": 3,
        }
        return [ca.MX.sym(name, rows) for name, rows in sizes.items()]

    def _sliding(self, section: Matrix) -> tuple[Matrix, Matrix]:
        """Velocity along both tangents, in lengths per second, and the direction of the rod along them, 2×1 each.

        Args:
            section: weights and abscissa.
        """
        x, inputs, v, rate, _, axis = self._symbols
        facing = self.facing
        system = System(facing.model.discrete, Arguments(x, inputs))
        weights, X = section[:-1], section[-1]
        centre, rotation = _pose(facing, system, weights)
        base, tip = facing.radii
        _, normal, _ = surface(facing.obstacle)(centre)
        arm = -(base + X * (tip - base)) * normal
        pose = ca.horzcat(centre, rotation)
        moved = ca.reshape(_rate(pose, [(x, v), (inputs, rate)]), 3, 4)
        velocity = moved[:, 0] + moved[:, 1:] @ (rotation.T @ arm)
        first = axis - ca.dot(normal, axis) * normal
        first = first / ca.sqrt(ca.sumsqr(first))
        tangents = ca.horzcat(first, ca.cross(normal, first))
        along = tangents.T @ rotation[:, 2]
        # A rod that stands on the surface slides in no direction of its own.
        return tangents.T @ velocity / facing.length, along / ca.sqrt(ca.sumsqr(along) + STANDING**2)

    @cached_property
    def function(self) -> ca.Function:
        """(x, inputs, v, rate, section, axis) ↦ sliding, its derivative with v, row after row, and the direction."""
        sliding, along = self._sliding(self._symbols[4])
        by_v = ca.jacobian(sliding, self._symbols[2]).T
        return ca.Function("rubbing", self._symbols, [ca.densify(part) for part in (sliding, by_v, along)])

    @cached_property
    def derivatives(self) -> ca.Function:
        """(…, axis, change of the section with X, force along the tangents) ↦ derivatives by x, by X and by inputs.

        The first arguments are those of :attr:`function`. First stand derivatives of sliding, of the direction, and of
        the force on the unknowns, 4 + n rows; then derivatives of sliding by the rates.
        """
        x, inputs, v, rate, section, _ = self._symbols
        change, force, shift = ca.MX.sym("change", section.shape[0]), ca.MX.sym("force", 2), ca.MX.sym("shift")
        sliding, along = self._sliding(section + shift * change)
        rows = ca.vertcat(sliding, along, ca.gradient(ca.dot(force, sliding), v))
        parts = [ca.jacobian(rows, x), ca.jacobian(rows, shift), ca.jacobian(rows, inputs), ca.jacobian(sliding, rate)]
        parts = ca.graph_substitute(parts, [shift], [ca.MX(0)])
        arguments = [*self._symbols, change, force]
        return ca.Function("rubbing_derivatives", arguments, [ca.densify(part) for part in parts])

    @property
    def moving(self) -> list[int]:
        """Numbers of the unknowns whose rates move what touches."""
        return sorted(set(ca.jacobian_sparsity(self.function(*self._symbols)[0], self._symbols[2]).get_col()))


def _rate(quantity: Matrix, moved: list[tuple[ca.MX, ca.MX]]) -> Matrix:
    """Rate of a quantity of arguments that have rates."""
    stacked = ca.vec(quantity)
    return sum((ca.jtimes(stacked, argument, rate) for argument, rate in moved), ca.MX(stacked.shape[0], 1))


def _pose(facing: Facing, system: System, weights: Matrix) -> tuple[Matrix, Matrix]:
    """Centre, 3×1, and rotation, 3×3, of a section of a rod, or of a body, in the world."""
    if facing.of_body:
        pose = system.body(facing.owner)
        return ca.MX(pose.position), ca.MX(pose.rotation)
    base, shape = system.base(facing.owner), system.shapes[facing.owner]
    world = quaternion_to_matrix(base.quaternion)
    directors = [world @ (director @ weights) for director in shape.directors]
    return base.position + world @ (shape.position @ weights), ca.horzcat(*directors)


def functions_of_sliding(model: Model) -> list[ca.Function]:
    """How all pairs that may touch slide, each as :attr:`SurfaceSliding.function` with its results in one column."""
    found = []
    for number, facing in enumerate(facings(model)):
        function = SurfaceSliding(facing).function
        arguments = function.mx_in()
        results = [ca.vec(result) for result in function.call(arguments)]
        found.append(ca.Function(f"rubbing_{number}", arguments, [ca.vertcat(*results)]))
    return found
