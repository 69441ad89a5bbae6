"""Functions for friction of exact contact in motion: sliding of a touching point along an obstacle or another rod.

A section with the centre c and the radius ρ touches at c − ρ n, with n the normal of the obstacle. This material point
has the velocity ċ + ω × (−ρ n). Positions and directors between nodes follow the polynomials through the nodes. Forces
act by the transpose of the derivatives of sliding, so the power of friction is force times velocity, to rounding.

Sections of two rods touch at the point that divides the line between their centres in the ratio of their radii. Each
rod has a velocity at this point, and the sliding is their difference. Friction acts on both rods at this one point,
which conserves their total momentum and angular momentum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from cosserat_casadi.equilibrium.contact.obstacle_surfaces import surface
from cosserat_casadi.loads.contact_layer import STANDING
from cosserat_casadi.maths.calls import KEPT
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.system import System
from cosserat_casadi.motion.contact_gap import Facing
from cosserat_casadi.motion.facings import facings
from cosserat_casadi.motion.moving_points import in_stacked_inputs, stacked_size
from cosserat_casadi.motion.rods_facing import RodsFacing

Pose = tuple[Matrix, Matrix]
"""Centre of a section, 3×1, m, and its rotation, 3×3; or their rates."""


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

    @cached_property
    def _law(self) -> ca.Function:
        """(poses, their rates, abscissae, axis) ↦ velocity along both tangents and components of the rod's direction.

        Poses of the touching sections are stacked as by :func:`_pose`, 12s×1; results are 2×1 each, the first one in
        lengths per second. The velocity is linear in the rates.
        """
        facing = self.facing
        sides = [facing, facing.other] if isinstance(facing, RodsFacing) else [facing]
        stacked, rates = ca.SX.sym("poses", 12 * len(sides)), ca.SX.sym("rates", 12 * len(sides))
        abscissae, axis = ca.SX.sym("X", len(sides)), ca.SX.sym("axis", 3)
        poses, moved = (poses_apart(each) for each in (stacked, rates))
        radii = [_radius(side, X) for side, X in zip(sides, ca.vertsplit(abscissae), strict=True)]
        centre, rotation = poses[0]
        if len(sides) == 2:
            normal, _, velocity = touching_point_of_rods(poses, moved, radii)
        else:
            _, normal, _ = surface(facing.obstacle)(centre)
            velocity = _velocity(moved[0], rotation.T @ (-radii[0] * normal))
        first = axis - ca.dot(normal, axis) * normal
        first = first / ca.sqrt(ca.sumsqr(first))
        tangents = ca.horzcat(first, ca.cross(normal, first))
        along = tangents.T @ rotation[:, 2]
        # A rod that stands upright on the surface has no direction along it.
        along = along / ca.sqrt(ca.sumsqr(along) + STANDING**2)
        results = [tangents.T @ velocity / facing.length, along]
        return ca.Function("law", [stacked, rates, abscissae, axis], ca.cse([ca.densify(part) for part in results]))

    @cached_property
    def _poses(self) -> Matrix:
        """Poses of the touching sections in the unknowns, the inputs and the section, 12s×1."""
        x, inputs, _, _, section, _ = self._symbols

        def stacked(system: System) -> list[Matrix]:
            return [_pose(side, system, section[span]) for side, span in self._sides]

        return ca.vertcat(*in_stacked_inputs(self.facing.model, x, inputs, stacked))

    @property
    def _sides(self) -> list[tuple[Facing, slice]]:
        """The rod or body, or both rods, each with the place of the weights of its nodes in the section."""
        facing, count = self.facing, self.facing.points.count
        if not isinstance(facing, RodsFacing):
            return [(facing, slice(0, count))]
        own = facing.node_count
        return [(facing, slice(0, own)), (facing.other, slice(own, count))]

    @cached_property
    def _rates(self) -> Matrix:
        """Rates of the poses, 12s×1."""
        x, inputs, v, rate, _, _ = self._symbols
        return ca.jtimes(self._poses, x, v) + ca.jtimes(self._poses, inputs, rate)

    @cached_property
    def _tangents(self) -> ca.Function:
        """(poses, abscissae, axis) ↦ gradients of the velocity by the rates of the poses, 12s×2.

        They are also the forces on the poses that do the work of unit forces along both tangents.
        """
        poses, rates, abscissae, axis = self._law.sx_in()
        sliding, _ = self._law.call([poses, rates, abscissae, axis])
        gradients = ca.densify(ca.jacobian(sliding, rates).T)
        return ca.Function("tangents", [poses, abscissae, axis], [gradients])

    @cached_property
    def _law_derivatives(self) -> ca.Function:
        """(poses, rates, abscissae, axis, force along both tangents) ↦ forces on the poses, 12s×1, and four matrices.

        The matrices are the derivatives of velocity and direction, four rows, by poses and by abscissae, and those of
        the forces on the poses.
        """
        poses, rates, abscissae, axis = self._law.sx_in()
        force = ca.SX.sym("force", 2)
        rows = ca.vertcat(*self._law.call([poses, rates, abscissae, axis]))
        forces = self._tangents(poses, abscissae, axis) @ force
        matrices = [ca.jacobian(part, by) for part in (rows, forces) for by in (poses, abscissae)]
        results = ca.cse([ca.densify(result) for result in (forces, *matrices)])
        return ca.Function("law_derivatives", [poses, rates, abscissae, axis, force], results)

    @cached_property
    def function(self) -> ca.Function:
        """(x, inputs, v, rate, section, axis) ↦ velocity, 2×1; gradients by v, n×2; direction of the rod, 2×1."""
        x, inputs, v, rate, section, axis = self._symbols
        abscissae = section[self.facing.points.count :]
        poses, rates = self._poses, self._rates
        if len(self._sides) == 1:
            by_v = ca.jtimes(poses, x, self._tangents(poses, abscissae, axis), True)
        else:
            # Generated code calls one routine for the section of a rod, in each pair that the rod is in.
            moved = [_moved(*own)(x, inputs, v, rate, section[own[1]]) for own in self._sides]
            poses, rates = (ca.vertcat(*parts) for parts in zip(*moved, strict=True))
            forces = ca.vertsplit(self._tangents(poses, abscissae, axis), 12)
            sides = zip(self._sides, forces, strict=True)
            by_v = sum(_pulled(*own)(x, inputs, section[own[1]], held) for own, held in sides)
        sliding, along = self._law(poses, rates, abscissae, axis)
        return ca.Function("rubbing", self._symbols, [ca.densify(part) for part in (sliding, by_v, along)])

    @cached_property
    def derivatives(self) -> ca.Function:
        """(…, axis, change of the section with X, force along both tangents) ↦ derivatives by x, X, inputs and rates.

        The first arguments are those of :attr:`function`. Derivatives by x, X and inputs have 4 + n rows: of the
        velocity, the direction and the generalised force. Those by the rates of the inputs are of the velocity, 2×k.
        Both abscissae of two rods have a column each, in the change and in the derivatives by X.

        The chain rule goes through the poses q of the touching sections. The only second derivatives of q are then
        those of the sums wᵀq and τᵀq̇, with the forces w on the poses and the tangents τ held. Such a sum does not
        couple both rods, and its code is a fraction of that of the derivatives of the generalised force as a whole.
        """
        x, inputs, v, rate, section, axis = self._symbols
        count = self.facing.points.count
        poses, rates, abscissae = self._poses, self._rates, section[count:]
        change, force = ca.MX.sym("change", section.shape[0], abscissae.shape[0]), ca.MX.sym("force", 2)
        forces, *matrices = self._law_derivatives(poses, rates, abscissae, axis, force)
        rows_by_poses, rows_by_X, forces_by_poses, forces_by_X = matrices
        tangents = self._tangents(poses, abscissae, axis)
        held = ca.MX.sym("held_forces", forces.shape[0])
        along = ca.MX.sym("held_tangents", *tangents.shape)
        if len(self._sides) == 1:
            parts = [_section_derivatives(poses, rates, x, inputs, section, change, held, along)]
        else:
            parts = []
            for number, (side, span) in enumerate(self._sides):
                entries = slice(12 * number, 12 * number + 12)
                arguments = [x, inputs, v, rate, section[span], change[span, :], held[entries], along[entries, :]]
                parts.append(_routine(side, span).call(arguments))
        of_pose, of_sums = [part[:3] for part in parts], [part[3:] for part in parts]
        by_x, by_inputs, shifted = (ca.vertcat(*blocks) for blocks in zip(*of_pose, strict=True))
        rates_by_x, force_by_x, rates_shifted, force_shifted, rates_by_inputs, force_by_inputs = (
            sum(blocks[1:], blocks[0]) for blocks in zip(*of_sums, strict=True)
        )

        def chained(of_poses: Matrix, of_rates: Matrix, of_generalised: Matrix, shift: Matrix | None = None) -> Matrix:
            """Derivatives, (4 + n)×k, from those of poses, of τᵀq̇, of the generalised force, and of abscissae."""
            rows, pushes = rows_by_poses @ of_poses, forces_by_poses @ of_poses
            if shift is not None:
                rows, pushes = rows + rows_by_X @ shift, pushes + forces_by_X @ shift
            stacked: Matrix = ca.vertcat(rows[:2, :] + of_rates, rows[2:, :], of_generalised + by_x.T @ pushes)
            return stacked

        results = [
            chained(by_x, rates_by_x, force_by_x),
            chained(shifted, rates_shifted, force_shifted, change[count:, :]),
            chained(by_inputs, rates_by_inputs, force_by_inputs),
            along.T @ by_inputs,
        ]
        results = ca.graph_substitute(results, [held, along], [forces, tangents])
        arguments = [*self._symbols, change, force]
        return ca.Function("rubbing_derivatives", arguments, [ca.densify(result) for result in results])

    @property
    def moving(self) -> list[int]:
        """Indices of the unknowns whose rates move the touching point along the surface."""
        return sorted(set(ca.jacobian_sparsity(self.function(*self._symbols)[0], self._symbols[2]).get_col()))


def _radius(side: Facing, X: Matrix) -> Matrix:
    """Radius of a section, m, at an abscissa."""
    base, tip = side.radii
    return base + X * (tip - base)


def touching_point_of_rods(
    poses: Sequence[Pose], rates: Sequence[Pose], radii: Sequence[Matrix]
) -> tuple[Matrix, list[Matrix], Matrix]:
    """Find the point at which two sections touch, and the velocity of the first rod past the second one there.

    The point divides the way between the centres as the radii do.

    Args:
        poses: centres, m, and rotations of both sections.
        rates: rates of the poses.
        radii: radii of both sections, m.

    Returns:
        normal, from the second rod to the first; arms from each centre to the point, along the directors of its
        section, m; velocity, m/s. All are 3×1.
    """
    way = poses[0][0] - poses[1][0]
    arm = -radii[0] / (radii[0] + radii[1]) * way
    arms = [_material_arm(poses[0][1], arm), _material_arm(poses[1][1], way + arm)]
    velocity = _velocity(rates[0], arms[0]) - _velocity(rates[1], arms[1])
    return way / ca.sqrt(ca.sumsqr(way)), arms, velocity


def _material_arm(rotation: Matrix, arm: Matrix) -> Matrix:
    """Components of an arm along the directors, 3×1, m.

    Interpolated directors are orthogonal only up to the error of polynomials, so they are inverted: otherwise forces at
    one point of two rods would leave a moment.
    """
    first, second, third = ca.horzsplit(rotation)
    across = [ca.cross(second, third), ca.cross(third, first), ca.cross(first, second)]
    return ca.vertcat(*(ca.dot(one, arm) for one in across)) / ca.dot(across[0], first)


def _section(side: Facing, nodes: slice) -> tuple[int, list[ca.MX], Matrix, Matrix]:
    """Number of a rod; x, inputs, their rates, weights of its nodes; the pose of its section, 12×1, and its rates."""
    model = side.model
    count = stacked_size(model)
    sizes = {"x": model.size, "inputs": count, "v": model.size, "rate": count, "weights": nodes.stop - nodes.start}
    symbols = [ca.MX.sym(word, size) for word, size in sizes.items()]
    x, inputs, v, rate, weights = symbols
    pose = ca.vertcat(*in_stacked_inputs(model, x, inputs, lambda system: [_pose(side, system, weights)]))
    rates = ca.jtimes(pose, x, v) + ca.jtimes(pose, inputs, rate)
    return [rod.name for rod in model.scene.rods].index(side.owner), symbols, pose, rates


def _moved(side: Facing, nodes: slice) -> ca.Function:
    """(x, inputs, v, rate, weights of nodes) ↦ the pose of a section of a rod, and its rates, 12×1 each."""
    number, symbols, pose, rates = _section(side, nodes)
    return ca.Function(f"moved_section_of_{number}", symbols, [ca.densify(pose), ca.densify(rates)], KEPT)


def _pulled(side: Facing, nodes: slice) -> ca.Function:
    """(x, inputs, weights of nodes, forces on the pose, 12×2) ↦ generalised forces, n×2."""
    number, (x, inputs, _, _, weights), pose, _ = _section(side, nodes)
    forces = ca.MX.sym("forces", 12, 2)
    pulls = ca.densify(ca.jtimes(pose, x, forces, True))
    return ca.Function(f"pulled_section_of_{number}", [x, inputs, weights, forces], [pulls], KEPT)


def _routine(side: Facing, nodes: slice) -> ca.Function:
    """(x, inputs, v, rate, weights of nodes, their changes, forces, tangents) ↦ derivatives of a rod's section."""
    number, symbols, pose, rates = _section(side, nodes)
    x, inputs, _, _, weights = symbols
    held = [ca.MX.sym("change", weights.shape[0], 2), ca.MX.sym("forces", 12), ca.MX.sym("tangents", 12, 2)]
    results = _section_derivatives(pose, rates, x, inputs, weights, *held)
    return ca.Function(f"section_of_{number}", [*symbols, *held], [ca.densify(result) for result in results], KEPT)


def _section_derivatives(
    pose: Matrix,
    rates: Matrix,
    x: Matrix,
    inputs: Matrix,
    section: Matrix,
    change: Matrix,
    forces: Matrix,
    tangents: Matrix,
) -> list[Matrix]:
    """Derivatives of the pose q of a section and of its rates.

    The forces w on the pose, 12×1, and the tangents τ, 12×2, are held; each column of the changes moves the section.

    Returns:
        the derivatives of q by x, by inputs and with the changes, 12 rows each; of τᵀq̇ and of (∂q/∂x)ᵀ w by x; of both
        with the changes; of both by inputs.
    """
    generalised = ca.jtimes(pose, x, forces, True)
    pose_shifted, rates_shifted, force_shifted = (
        ca.jtimes(part, section, change) for part in (pose, rates, generalised)
    )
    of_pose = [ca.jacobian(pose, x), ca.jacobian(pose, inputs), pose_shifted]
    by_x = [ca.jtimes(rates, x, tangents, True).T, ca.jacobian(generalised, x)]
    with_changes = [tangents.T @ rates_shifted, force_shifted]
    by_inputs = [ca.jtimes(rates, inputs, tangents, True).T, ca.jacobian(generalised, inputs)]
    return [*of_pose, *by_x, *with_changes, *by_inputs]


def _pose(facing: Facing, system: System, weights: Matrix) -> Matrix:
    """Centre, m, and columns of the rotation of a section of a rod, or of a body, in the axes of the obstacle, 12×1."""
    if facing.of_body:
        pose = system.body(facing.owner)
        return ca.vertcat(ca.MX(pose.position), ca.vec(ca.MX(pose.rotation)))
    position, *directors = system.sections(facing.owner, weights)
    seen = system.seen_from(facing.carrier, position)
    return ca.vertcat(seen, ca.vec(system.turned_to(facing.carrier, ca.horzcat(*directors))))


def poses_apart(stacked: Matrix) -> list[Pose]:
    """Centre, 3×1, and rotation, 3×3, of each of s stacked poses, 12s×1; or their rates."""
    return [(pose[:3], ca.reshape(pose[3:], 3, 3)) for pose in ca.vertsplit(stacked, 12)]


def _velocity(rates: Pose, arm: Matrix) -> Matrix:
    """Velocity of a material point at an arm from the centre of its section, along the directors, 3×1, m/s."""
    centre, rotation = rates
    return centre + rotation @ arm


def functions_of_sliding(model: Model) -> list[ca.Function]:
    """Functions of all pairs that may touch: :attr:`SurfaceSliding.function` with its results in one column."""
    found = []
    for number, facing in enumerate(facings(model)):
        function = SurfaceSliding(facing).function
        arguments = function.mx_in()
        results = [ca.vec(result) for result in function.call(arguments)]
        found.append(ca.Function(f"rubbing_{number}", arguments, [ca.vertcat(*results)]))
    return found
