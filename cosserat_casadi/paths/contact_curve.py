"""Rods in one arrangement of contacts: a curve in y = (z, λ), and the margins and eigenvalues at its points.

z = (x, f, p) are the unknowns of equilibrium/contact/contact_equations.py. The margins along the curve are functions of
the positions of the nodes, which move with the places of contact: no model is built for a point.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.contact.body_obstacles import in_axes_of
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations
from cosserat_casadi.equilibrium.contact.contact_judgement import FLAT
from cosserat_casadi.equilibrium.contact.contact_search import ContactEquilibrium, contact_equilibrium
from cosserat_casadi.equilibrium.contact.contact_solve import LEAST_TOLERANCE
from cosserat_casadi.equilibrium.contact.contact_state import ContactState, Touch, continuations, is_sought
from cosserat_casadi.equilibrium.contact.gaps import body_pairs, gap_at, inner_radius, pairs, rod_pairs
from cosserat_casadi.equilibrium.contact.passing_through import (
    OF_RODS,
    SECTIONS,
    ball_is_inside_between,
    is_inside_between,
    lines_cross_between,
)
from cosserat_casadi.equilibrium.solution import SolvedPoses, poses_between_nodes, rotations
from cosserat_casadi.equilibrium.stability import ConstrainedVariations, admissible_eigenvalues, restricted, variations
from cosserat_casadi.loads.penetration import section_radius
from cosserat_casadi.maths import chebyshev
from cosserat_casadi.maths.grid import Grid
from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.numerics.arclength import ArcPoint, ArcSettings, Curve, Monitor
from cosserat_casadi.numerics.continuation import Path
from cosserat_casadi.numerics.events import DETERMINANT
from cosserat_casadi.paths.gaps_along import GapsAlong, LineOfNodes, ObstacleGaps, RodsGaps
from cosserat_casadi.rod.strain import DiscreteRod

EQUILIBRATIONS = 6
"""Rounds of scaling rows and columns."""

SINGULAR = 1e-13
"""Singular value, relative to the largest, that counts as zero: a short line has some in proportion to its width
cubed."""


ANGULAR = (0, 1, 2)
"""Indices of the curvatures and the torsion among the strains."""


@dataclass(frozen=True)
class Nodes:
    """The nodes of a rod.

    Attributes:
        positions: world axes, shape (M, 3), m.
        rates: their derivatives by the coordinate of the integrals, shape (M, 3), m.
        quaternions: world_Q_section, shape (M, 4).
        curvatures: curvatures from the internal moment, section axes, shape (M, 3), 1/m; curvatures that the rod does
            not admit have their unloaded values.
    """

    positions: FloatArray
    rates: FloatArray
    quaternions: FloatArray
    curvatures: FloatArray


@dataclass(frozen=True)
class Arrangement:
    """One arrangement of contacts while an input grows, or inputs and parameters move together.

    Attributes:
        equations: equations with its contacts, at the inputs and parameters of load factor 0.
        change: stacked inputs of the scene, followed by parameters if these move too, at load factor 1 less their
            values at 0. Parameters change no length, no section and no obstacle.
        potential: whether all loads have a potential along the path.
        settings: limits of the curve.
        near: z at or near the beginning of the arrangement.
        load_factor: λ at this z.
    """

    equations: ContactEquations
    change: FloatArray
    potential: bool
    settings: ArcSettings
    near: FloatArray
    load_factor: float

    @property
    def scene(self) -> scenes.Scene:
        """The scene without contacts."""
        return self.equations.scene

    @property
    def tolerance(self) -> float:
        """Relative depth, pull and the like up to which the arrangement is valid."""
        return max(self.scene.accuracy.tolerance, LEAST_TOLERANCE)

    @cached_property
    def following(self) -> dict[str, str]:
        """Rods that continue others, by the names of the others."""
        return continuations(self.scene)

    def at(self, load_factor: float) -> ContactEquations:
        """The equations at the inputs and parameters of a load factor."""
        equations = self.equations
        inputs, parameters = self._changes
        theta = equations.theta
        if parameters.size:
            theta = equations.parameters.between(theta, theta + parameters, load_factor)
        return equations.at(equations.given + load_factor * inputs, theta)

    @cached_property
    def _changes(self) -> tuple[FloatArray, FloatArray]:
        """Changes of inputs, and of parameters; empty if parameters stay."""
        inputs, parameters = np.split(self.change, [len(self.equations.given)])
        return inputs, parameters

    def rate(self, z: FloatArray, load_factor: float) -> FloatArray:
        """Derivative of the residual by the load factor."""
        inputs, parameters = self._changes
        if parameters.size:
            theta = self.equations.theta
            parameters = self.equations.parameters.rate_between(theta, theta + parameters, load_factor)
        return self.at(load_factor).rate(z, inputs, parameters)

    @cached_property
    def _scales(self) -> tuple[FloatArray, FloatArray]:
        """Units of z along the curve, and factors on the equations in linear systems.

        A short line of contact has forces with little effect on the rod, and moments of the gap with little dependence
        on it: their columns and rows are scaled to the size of the others (D. Ruiz, RAL-TR-2001-034).
        """
        nominal = self.equations.nominal
        size = nominal.model.size
        forces = slice(size, size + self.equations.pushes)
        here = self.at(self.load_factor)
        rate = self.rate(self.near, self.load_factor)
        load = float(np.linalg.norm(rate[:size]))
        scale = np.ones(len(self.near))
        # A strain counts as the angle by which its element turns, for every width of the element.
        scale[:size] = 1.0 / self.equations.nominal_widths
        # Otherwise a strong load on a held rod would need many small steps.
        scale[variations(nominal.model).held] = max(1.0, load)
        matrix = np.abs(here.jacobian(self.near, here.given)) * scale
        rows = np.ones(len(matrix))
        for _ in range(EQUILIBRATIONS):
            rows = _inverse(np.maximum(matrix.max(axis=1), np.abs(rate)))
            columns = _inverse((rows[:, None] * matrix)[:, forces].max(axis=0))
            matrix[:, forces] *= columns
            scale[forces] *= columns
        # A force with an effect counts relative to the load, as multipliers of supports do.
        scale[forces] = np.maximum(scale[forces], max(1.0, load))
        return scale, rows

    @property
    def scale(self) -> FloatArray:
        """Units of z along the curve."""
        return self._scales[0]

    @cached_property
    def curve(self) -> Curve:
        """The curve of the scaled equations in y; the start of its path is ignored."""
        scale, rows = self._scales
        path = Path(
            residual=lambda y, t: self.at(t).equations.residual(scale * y),
            jacobian=lambda y, t: self.at(t).equations.jacobian(scale * y) * scale,
            rate=lambda y, t: self.rate(scale * y, t),
            start=self.near / scale,
        )
        monitor = Monitor(self._eigenvalues, feels_limits=True) if self.potential else DETERMINANT
        # Solved to the last digit, since a small residual does not determine the forces of a short line.
        settings = replace(self.settings, aim=0.0)
        return Curve(path, monitor, settings, rows, SINGULAR)

    def z(self, point: ArcPoint) -> FloatArray:
        """Unknowns, forces and places of a point."""
        return self.scale * point.x

    def y(self, z: FloatArray, load_factor: float) -> FloatArray:
        """The point y of the curve's space for z and λ."""
        return np.append(z / self.scale, load_factor)

    def state(self, z: FloatArray) -> ContactState:
        """The contacts at the places in z."""
        _, _, places = self.equations.parts(z)
        return self.equations.state.at(places.tolist())

    def equilibrium_at(self, z: FloatArray, load_factor: float) -> ContactEquilibrium:
        """A point of the curve, solved on new elements, with all that a solution offers."""
        equations = self.at(load_factor)
        return contact_equilibrium(equations, z, equations.given)

    def resolution_index(self, z: FloatArray, load_factor: float) -> float:
        """Resolution index of a point, above 1 where the nodes do not resolve the rods."""
        model = self.equations.model
        x, inputs, p = self.at(load_factor).arguments(z)
        # Without contacts no place moves.
        places = [p] if model.parameters.size else []
        return float(model.resolution_index(x, inputs, *places))

    def parts(self, z: FloatArray) -> Iterator[tuple[Touch, FloatArray, FloatArray]]:
        """Each contact at its place, with dimensionless forces at sections and coefficients of the force along it."""
        _, forces, _ = self.equations.parts(z)
        modes = self.equations.nominal.modes
        return self.state(z).with_forces(forces, modes)

    @cached_property
    def _poses(self) -> ca.Function:
        """(x, f, p and parameters, inputs) ↦ fields of :class:`Nodes` for every rod, one column for each node."""
        written = self.equations.written
        results: list[Matrix] = []
        for name, shape in written.system.shapes.items():
            results.append(written.system.nodes(name))
            results.append(written.system.base(name).rotation @ shape.tangent)
            results.append(written.system.nodal_quaternions(name))
            moment = written.system.rods[name].statics.internal_wrench()[:3, :]
            results.append(_curvatures(shape.rod, moment))
        return ca.Function("poses", written.arguments, results)

    def _nodes(self, z: FloatArray, load_factor: float) -> dict[str, Nodes]:
        """The nodes of every rod."""
        outputs = self._poses(*self._arguments(z, load_factor))
        arrays = [output.full().T for output in outputs]
        nodes = {}
        for number, name in enumerate(self.equations.written.system.shapes):
            nodes[name] = Nodes(*arrays[4 * number : 4 * number + 4])
        return nodes

    def _arguments(self, z: FloatArray, load_factor: float) -> list[FloatArray]:
        """Arguments of the functions of :attr:`equations` at a point."""
        here = self.at(load_factor)
        return here.numbers(z, here.given)

    def ends(self, rod: str, z: FloatArray) -> FloatArray:
        """Abscissae of the ends of a rod's elements."""
        return self.equations.ends(rod, self.equations.parts(z)[2])

    def gaps(self, z: FloatArray, load_factor: float) -> dict[tuple[str, str], GapsAlong]:
        """Distances of rods from obstacles and other rods, by the names of rod and obstacle, or of both rods."""
        nodes = self._nodes(z, load_factor)
        bodies = self.bodies(z, load_factor)
        gaps: dict[tuple[str, str], GapsAlong] = {}
        for rod, obstacle in pairs(self.scene):
            line = self._line(rod, nodes[rod], z)
            if obstacle.body is not None:
                # Positions are in the axes of the obstacle's body.
                line = line.seen_from(bodies[obstacle.body])
            gaps[rod, obstacle.name] = ObstacleGaps(line, obstacle)
        for rods in rod_pairs(self.scene):
            gaps[rods] = RodsGaps(*(self._line(rod, nodes[rod], z) for rod in rods))
        return gaps

    def _line(self, rod: str, nodes: Nodes, z: FloatArray) -> LineOfNodes:
        """The centre line of a rod."""
        discrete_rod = self.equations.nominal.model.discrete.rods[rod]
        ends = self.ends(rod, z)
        # The derivative by the abscissa, which moved elements stretch.
        moved = np.diff(ends) / np.diff(discrete_rod.discretisation.breaks)
        by_element = (discrete_rod.grid.elements, -1, 3)
        tangents = nodes.rates.reshape(by_element) / moved[:, None, None]
        return LineOfNodes(
            ends=ends,
            positions=nodes.positions.reshape(by_element),
            tangents=tangents,
            bends=self._bends(rod, nodes, tangents, ends),
            radii=section_radius(discrete_rod.properties, np.array([0.0, 1.0])),
            length=discrete_rod.properties.length,
        )

    def _bends(self, rod: str, nodes: Nodes, tangents: FloatArray, ends: FloatArray) -> FloatArray:
        """Second derivatives of the positions by X, shape (E, N + 1, 3), without parts along the tangent.

        Curvatures follow from the moment, which is more accurate at the end of an element than the strain's polynomial,
        a mean over the element. With actuators, and for nonlinear materials, the polynomial is taken.
        """
        discrete_rod = self.equations.nominal.model.discrete.rods[rod]
        intervals = discrete_rod.grid.intervals
        widths = np.diff(ends)[:, None, None]
        is_actuated = any(actuator.rod == rod for actuator in self.scene.actuators)
        if is_actuated or discrete_rod.properties.beyond_hooke is not None:
            return np.asarray(chebyshev.differentiation_matrix(intervals) @ tangents / widths)
        unit = nodes.quaternions / np.linalg.norm(nodes.quaternions, axis=1, keepdims=True)
        in_world = np.einsum("kij,kj->ki", rotations(unit), nodes.curvatures)
        bends = discrete_rod.properties.length * np.cross(in_world, tangents.reshape(-1, 3))
        return np.asarray(bends.reshape(tangents.shape))

    @cached_property
    def _body_poses(self) -> ca.Function:
        """(x, f, p and parameters, inputs) ↦ positions, m, and quaternions of the bodies, one column each."""
        written = self.equations.written
        poses = [written.system.body(body.name) for body in self.scene.bodies]
        positions = ca.horzcat(*[pose.position for pose in poses])
        quaternions = ca.horzcat(*[pose.quaternion for pose in poses])
        return ca.Function("body_poses", written.arguments, [positions, quaternions])

    def bodies(self, z: FloatArray, load_factor: float) -> dict[str, SolvedPoses]:
        """Poses of the bodies of the scene by name."""
        if not self.scene.bodies:
            return {}
        outputs = self._body_poses(*self._arguments(z, load_factor))
        positions, quaternions = (output.full().T for output in outputs)
        poses = [SolvedPoses(*pose) for pose in zip(positions, map(rotations, quaternions), quaternions, strict=True)]
        return {body.name: pose for body, pose in zip(self.scene.bodies, poses, strict=True)}

    def body_gaps(self, z: FloatArray, load_factor: float) -> dict[tuple[str, str], float]:
        """Distances of bodies from their obstacles, by the names of body and obstacle."""
        pairs_of_bodies = list(body_pairs(self.scene))
        if not pairs_of_bodies:
            return {}
        bodies = self.bodies(z, load_factor)
        gaps = {}
        for body, obstacle in pairs_of_bodies:
            gaps[body.name, obstacle.name] = gap_at(obstacle, body, bodies[body.name]) / self._length_of(body)
        return gaps

    def _length_of(self, body: scenes.Body) -> float:
        """Unit of distances of a body, m."""
        return self.equations.nominal.model.discrete.body_frame(body.name).length

    def goes_through(self, start: ArcPoint, end: ArcPoint) -> bool:
        """Whether a rod or a body is inside an obstacle on the straight way from one point of the curve to another."""
        for rod, obstacle in pairs(self.scene):
            properties = self.equations.nominal.model.discrete.rods[rod].properties
            start_positions, end_positions = (
                self._seen_sections(self.z(point), point.load_factor, rod, obstacle) for point in (start, end)
            )
            if is_inside_between(obstacle, properties, start_positions, end_positions):
                return True
        for rods in rod_pairs(self.scene):
            ways = [
                [self.poses(self.z(point), point.load_factor, OF_RODS, rod).position for point in (start, end)]
                for rod in rods
            ]
            if lines_cross_between(*ways):
                return True
        pairs_of_bodies = list(body_pairs(self.scene))
        if not pairs_of_bodies:
            return False
        before, after = (self.bodies(self.z(point), point.load_factor) for point in (start, end))
        return any(
            ball_is_inside_between(
                obstacle,
                inner_radius(body),
                self._length_of(body),
                before[body.name].position,
                after[body.name].position,
            )
            for body, obstacle in pairs_of_bodies
        )

    def _seen_sections(
        self, z: FloatArray, load_factor: float, rod: str, obstacle: scenes.ObstacleRecord
    ) -> FloatArray:
        """Positions of the checked sections of a rod in the axes of an obstacle, shape (k, 3), m."""
        positions = self.poses(z, load_factor, SECTIONS, rod).position
        if obstacle.body is None:
            return positions
        return in_axes_of(self.bodies(z, load_factor)[obstacle.body], positions)

    def poses(self, z: FloatArray, load_factor: float, X: npt.ArrayLike, rod: str) -> SolvedPoses:
        """Pose of the section at one abscissa X, or poses at an array of abscissae, shape (k,)."""
        nodes = self._nodes(z, load_factor)[rod]
        breaks = self.equations.nominal.model.discretisation[rod].breaks
        intervals = self.equations.nominal.model.discrete.rods[rod].grid.intervals
        grid = Grid(breaks, intervals, tuple(self.ends(rod, z).tolist()))
        return poses_between_nodes(grid.interpolation_matrix(X), nodes.positions, nodes.quaternions)

    @cached_property
    def _variations(self) -> ConstrainedVariations:
        return variations(self.equations.nominal.model)

    def _eigenvalues(self, y: FloatArray, jacobian: FloatArray, _bordered: FloatArray) -> FloatArray:
        """Eigenvalues of the second variation over the motions that keep the contacts, see contact_judgement.py."""
        z = self.scale * y[:-1]
        size = self.equations.nominal.model.size
        count = len(self.equations.nominal.force_units)
        moved = self.equations.moved_strains(self.equations.parts(z)[2])
        # Strains count per length of the rod, as for elements that do not move.
        scale, row_factors = self._scales
        by_x = (jacobian / scale / row_factors[:, None])[:, :size] * moved
        hessian = moved[:, None] * by_x[:size]
        rows = by_x[size:]
        held: list[FloatArray] = []
        gaps = self.gaps(z, float(y[-1])) if count else {}
        first = 0
        for touch, ends, line in self.parts(z):
            own = rows[first : first + len(ends) + len(touch.moving) + len(line)]
            first += len(own)
            if touch.is_line or not touch.moving:
                held.extend(own)
                continue
            held.append(own[0])
            along = gaps[touch.owner, touch.obstacle]
            if isinstance(along, RodsGaps):
                moves = [is_sought(touch.start), is_sought(touch.other)]
                bends = along.between(float(touch.start), float(touch.other or 0.0))[2][np.ix_(moves, moves)]
            else:
                bends = np.array([[along.at(touch.start)[2]]])
            if np.linalg.eigvalsh(bends)[0] <= FLAT:
                held.extend(own[1:])
            else:
                hessian = hessian + ends[0] * own[1:].T @ np.linalg.inv(bends) @ own[1:]
        return admissible_eigenvalues(*restricted(hessian, held, self._variations))


def _curvatures(rod: DiscreteRod, moment: Matrix) -> Matrix:
    """Curvatures at the nodes of a rod that obeys Hooke's law, 3×M, 1/m.

    Args:
        rod: the rod, with nodes that may have moved and numbers that may be parameters.
        moment: internal moment at the nodes, 3×M, N m.
    """
    stiffness = as_matrix(rod.properties.hooke(rod.grid.nodes))
    if stiffness.shape[0] == 1:
        stiffness = ca.repmat(stiffness, rod.grid.size, 1)
    own = as_matrix(rod.properties.intrinsic_curvature(rod.grid.nodes))
    rows = []
    for axis in ANGULAR:
        row = own[:, axis].T
        if axis in rod.admitted:
            row = row + moment[axis, :] / stiffness[:, axis].T
        rows.append(row)
    return ca.MX(ca.vertcat(*rows))


def _inverse(sizes: FloatArray) -> FloatArray:
    """Factors that scale rows or columns of these sizes to one; 1 for rows or columns without entries."""
    return np.asarray(1.0 / np.where(sizes > 0.0, sizes, 1.0))
