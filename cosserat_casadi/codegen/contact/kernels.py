"""The equations of arrangements of contacts as functions for C, of z = (x, f, p) and of the inputs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.codegen.columns import WrittenJacobian
from cosserat_casadi.codegen.contact.arrangements import Chosen
from cosserat_casadi.codegen.kernels import by_columns, kernel, with_derivatives
from cosserat_casadi.codegen.passages import distance_kernel
from cosserat_casadi.compiling.printed_kernels import Kernel
from cosserat_casadi.equilibrium.contact.contact_equations import ContactEquations, Written
from cosserat_casadi.equilibrium.contact.contact_state import Place, Touch, is_sought
from cosserat_casadi.equilibrium.contact.gap_rows import centres_apart
from cosserat_casadi.equilibrium.contact.gaps import body_pairs, obstacle_of, pairs
from cosserat_casadi.equilibrium.contact.obstacle_surfaces import surface
from cosserat_casadi.loads.load import polynomials_at
from cosserat_casadi.loads.rods_point import across
from cosserat_casadi.maths.numbers import as_matrix
from cosserat_casadi.maths.rotation import quaternion_product
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.function_table import Expressions
from cosserat_casadi.model.model_functions import resolution_index
from cosserat_casadi.model.strain_margins import strain_margins
from cosserat_casadi.model.system import System
from cosserat_casadi.model.watched import watched

WORDS = ("residual", "jacobian", "rate", "nodes", "tips", "tip_rate", "contacts")
"""Kernels of every arrangement, in the order of the table in C."""

ACTUATORS = "actuators"
"""Further kernel of a scene that has actuators."""

WATCHED = "watched"
"""Further kernel for error estimates: the poses and lengths whose errors are estimated."""

BENDS = "bends"
"""Further kernel of a library that judges stability."""

RICHER_WORDS = ("residual", "jacobian", "nodes", "contacts", WATCHED)
"""Kernels of an arrangement on the modes and intervals that an estimate of errors adds."""


@dataclass(frozen=True)
class ArrangementKernels:
    """The kernels of one arrangement.

    Attributes:
        equations: equations of the arrangement.
        name: prefix of the names of the kernels.
        words: the kernels that are wanted.
    """

    equations: ContactEquations
    name: str
    words: Sequence[str] = WORDS

    @cached_property
    def _written(self) -> Written:
        return self.equations.written

    def all(self) -> list[Kernel]:
        """Kernels of the arrangement, in the order of the words."""
        residual = self._written.residual
        kernels: dict[str, Callable[[], Kernel]] = {
            "residual": lambda: self.written_kernel("residual", [residual]),
            "jacobian": self._jacobian,
            "rate": lambda: self._rate_kernel("rate", residual),
            "nodes": lambda: self.written_kernel("nodes", [self._nodes(), self._indices()]),
            "tips": lambda: self.written_kernel("tips", [self._tips()]),
            "tip_rate": lambda: self._rate_kernel("tip_rate", self._tips()),
            "contacts": lambda: self.written_kernel("contacts", [self._resultants(), self._point_forces()]),
            WATCHED: lambda: self.written_kernel(WATCHED, [watched(self._written.system).column]),
            ACTUATORS: lambda: self.written_kernel(ACTUATORS, self._actuators()),
            BENDS: lambda: self.written_kernel(BENDS, [self._bends()]),
        }
        return [kernels[word]() for word in self.words]

    def differentiable(self) -> Iterator[ca.Function]:
        """Residual and poses, each with its derivatives, by the names for which ``casadi.external`` searches."""
        for word, result in (("residual", self._written.residual), ("poses", self._tips())):
            yield from with_derivatives(self.written_kernel(word, [result]))

    def _jacobian(self) -> Kernel:
        """The Jacobian, by columns if such a form exists and is not too long."""
        whole = self._of_z([self._by_z(self._written.jacobian)])
        name = f"{self.name}_jacobian"
        columned = by_columns(self._written_jacobian, whole, name)
        return kernel(self.equations.nominal.model, whole, name) if columned is None else columned.printed

    @property
    def _written_jacobian(self) -> WrittenJacobian:
        written = self._written
        arguments = dict(zip(("x", "f", "p", "inputs"), written.arguments, strict=True))

        def of_system(system: System) -> Matrix:
            return self._by_z(replace(written, system=system).jacobian)

        return WrittenJacobian(arguments, written.system, of_system, self._gathered, ("z", "inputs"))

    def _by_z(self, jacobian: Matrix) -> Matrix:
        """Select the columns of a Jacobian by z, which precede the columns by parameters."""
        count = self.equations.parameters.size
        return jacobian[:, :-count] if count else jacobian

    def written_kernel(self, word: str, results: Sequence[Matrix]) -> ca.Function:
        """Make a function of z and the inputs, with dense results, from expressions of the written equations."""
        return kernel(self.equations.nominal.model, self._of_z(results), f"{self.name}_{word}")

    def _rate_kernel(self, word: str, result: Matrix) -> ca.Function:
        """Make the derivative of a result along a direction of z and of the inputs."""
        of_z = self._of_z([result])
        symbols = of_z.mx_in()
        # Of a scene without inputs the symbol of these is empty, and has no name.
        words = [*of_z.name_in(), *(f"{word}_rate" for word in of_z.name_in())]
        moved = [ca.MX.sym(word, symbol.shape[0]) for word, symbol in zip(words[len(symbols) :], symbols, strict=True)]
        rate = ca.jtimes(of_z.call(symbols, True, False)[0], ca.vertcat(*symbols), ca.vertcat(*moved))
        whole = ca.Function("rate", [*symbols, *moved], [rate], words, ["result"])
        return kernel(self.equations.nominal.model, whole, f"{self.name}_{word}")

    def _of_z(self, results: Sequence[Matrix]) -> ca.Function:
        """Make the function (z, inputs) ↦ results."""
        names = [f"result_{number}" for number in range(len(results))]
        words = ["x", "f", "p", "inputs"]
        return self._gathered(ca.Function("of_z", self._written.arguments, list(results), words, names))

    def _gathered(self, function: ca.Function) -> ca.Function:
        """Turn a function of x, f, p, the inputs and further arguments into a function of z, the inputs and these.

        Parameters of the scene, which follow the places in p, are then appended to the inputs.
        """
        words = function.name_in()
        count = self.equations.parameters.size
        sizes = [part.shape[0] for part in self._written.unknowns]
        sizes[-1] -= count
        z = ca.MX.sym("z", sum(sizes))
        behind = function.mx_in()[len(sizes) :]
        parts = ca.vertsplit(z, np.cumsum([0, *sizes]).tolist())
        passed = behind
        if count:
            inputs = behind[0].shape[0]
            given = ca.MX.sym("inputs", inputs + count)
            parts[-1] = ca.vertcat(parts[-1], given[inputs:])
            behind, passed = [given, *behind[1:]], [given[:inputs], *behind[1:]]
        results = function.call([*parts, *passed], True, False)
        return ca.Function(function.name(), [z, *behind], results, ["z", *words[len(sizes) :]], function.name_out())

    def _nodes(self) -> Matrix:
        """Positions of the nodes of all rods, rod by rod, and of bodies that may touch, 3×M, m."""
        system = self._written.system
        positions = [system.nodes(name) for name in system.shapes]
        scene = system.discrete.scene
        if touches_bodies(scene):
            positions += [system.body(body.name).position for body in scene.bodies]
        return ca.horzcat(*positions)

    def _indices(self) -> Matrix:
        """Index of resolution, and the least margins of paths, of planes and of laws; 1 for an absent margin."""
        system = self._written.system
        symbols = {"x": ca.MX(system.arguments.x), "inputs": ca.MX(system.arguments.inputs)}
        index = resolution_index(Expressions(system.discrete, "", symbols))
        least: dict[str, list[Matrix]] = {"path": [], "plane": [], "law": []}
        for margin, value in strain_margins(system).items():
            least.get(margin.kind, least["law"]).append(value)
        return ca.vertcat(index, *(ca.mmin(ca.vertcat(1, *own)) for own in least.values()))

    def _tips(self) -> Matrix:
        """Position and quaternion of the tip of every rod, then of every body, stacked."""
        system = self._written.system
        poses = []
        for name, shape in system.shapes.items():
            poses.append(system.position_at(name, -1))
            poses.append(quaternion_product(system.base(name).quaternion, ca.densify(shape.quaternion)[:, -1]))
        for body in system.discrete.scene.bodies:
            frame = system.body(body.name)
            poses += [frame.position, frame.quaternion]
        return ca.vertcat(*poses)

    def _actuators(self) -> list[Matrix]:
        """Efforts of all actuators, and their conjugates."""
        system = self._written.system
        states = [system.actuators.state(actuator.name) for actuator in system.discrete.scene.actuators]
        return [ca.vertcat(*[state[place] for state in states]) for place in range(2)]

    def _point_forces(self) -> Matrix:
        """Force at the point, or at both ends, of every contact, N, two numbers for each."""
        forces: list[Matrix] = [ca.MX(0, 1)]
        for touch, ends, _ in self._forces():
            own = self._unit(touch) * ends
            forces.append(own if touch.is_line else ca.vertcat(own, 0))
        return ca.vertcat(*forces)

    def _resultants(self) -> Matrix:
        """Force of every contact on its rod, world axes, N, three numbers for each."""
        forces: list[Matrix] = [ca.MX(0, 1)]
        for touch, ends, line in self._forces():
            if touch.of_body:
                forces.append(self._unit(touch) * ends * self.normal_of_body(touch))
                continue
            if touch.other is not None:
                normal, _ = across(centres_apart(self._written.system, touch))
                forces.append(self._unit(touch) * ends * normal)
                continue
            grid = self._written.system.discrete.rods[touch.owner].grid
            force: Matrix = ca.MX.zeros(3)
            for number, end in enumerate(touch.ends):
                force = force + ends[number] * self._normal(touch, grid.node_at(end))
            if touch.is_line:
                force = force + self._resultant_along(touch, line)
            forces.append(self._unit(touch) * force)
        return ca.vertcat(*forces)

    def _resultant_along(self, touch: Touch, line: Matrix) -> Matrix:
        """Resultant ∫ λ n over a line of contact, 3×1."""
        grid = self._written.system.discrete.rods[touch.owner].grid
        nodes = grid.nodes_in(touch.start, touch.end)
        local = (grid.nodes_at(nodes) - touch.start) / (touch.end - touch.start)
        along = as_matrix(polynomials_at(line.shape[0], local)).T @ line
        lengths = ca.MX(ca.DM(grid.weights[nodes]))
        rates = grid.rates_in(grid.element_of_node[nodes])
        if rates is not None:
            lengths = lengths * as_matrix(rates)
        ratio = self._written.system.shapes[touch.owner].ratio
        if ratio is not None:
            lengths = lengths * ratio
        normals = ca.horzcat(*[self._normal(touch, int(node)) for node in nodes])
        return normals @ (lengths * along)

    def _normal(self, touch: Touch, node: int) -> Matrix:
        """Normal of the obstacle at a node of the rod that touches it, 3×1."""
        obstacle = obstacle_of(self._written.system.discrete.scene, touch.obstacle)
        normal: Matrix = surface(obstacle)(self._written.system.position_at(touch.owner, node))[1]
        return normal

    def _bends(self) -> Matrix:
        """Second derivative of the gap by X at the beginning of every contact, over the length.

        In a scene whose rods touch rods two numbers of every contact follow. The three numbers of two rods are the
        entries (1, 1), (1, 2) and (2, 2) of the second derivative by both places if both are sought; else the first
        number is the second derivative by the one that is sought.
        """
        scene = self._written.system.discrete.scene
        count = len(self._written.state.touches) if scene.rods_touch_exactly else 0
        further: list[Matrix] = [ca.MX.zeros(2)] * count
        bends: list[Matrix] = [ca.MX(0, 1)]
        for number, touch in enumerate(self._written.state.touches):
            if touch.of_body:
                # Its place follows from where it is, and does not slide by itself.
                bends.append(ca.MX.zeros(1))
                continue
            rod = self._written.system.discrete.rods[touch.owner]
            if touch.other is not None:
                of_both = self._bends_of_rods(touch) / rod.properties.length
                bends.append(of_both[0])
                further[number] = of_both[1:]
                continue
            position, tangent, turned = self._centre_line(touch.owner, touch.start)
            obstacle = obstacle_of(scene, touch.obstacle)
            _, normal, second = surface(obstacle)(position)
            bend = ca.dot(tangent, second @ tangent) + ca.dot(normal, turned)
            bends.append(bend / rod.properties.length)
        return ca.vertcat(*bends, *further)

    def _bends_of_rods(self, touch: Touch) -> Matrix:
        """Second derivative of the distance of two rods by the places that are sought, m, three numbers."""
        assert touch.other is not None, "two rods"
        own, other = (self._centre_line(*place) for place in zip(touch.rods, (touch.start, touch.other), strict=True))
        normal, curvature = across(own[0] - other[0])
        first = ca.dot(own[1], curvature @ own[1]) + ca.dot(normal, own[2])
        last = ca.dot(other[1], curvature @ other[1]) - ca.dot(normal, other[2])
        if is_sought(touch.start) and is_sought(touch.other):
            return ca.vertcat(first, -ca.dot(own[1], curvature @ other[1]), last)
        alone = first if is_sought(touch.start) else last if is_sought(touch.other) else ca.MX.zeros(1)
        return ca.vertcat(alone, 0, 0)

    def _centre_line(self, name: str, X: Place) -> tuple[Matrix, Matrix, Matrix]:
        """Position of a section at an end of an element, and its first and second derivative by X, 3×1 each, m.

        The second derivative is without the rate of the extension, which is along the tangent, normal to the contact.
        """
        system = self._written.system
        rod = system.discrete.rods[name]
        shape = system.shapes[name]
        node = rod.grid.node_at(X)
        rotation = system.base(name).rotation
        # Rates and strains are counted in the coordinate that integrals run over, which a moving element stretches.
        rates = rod.grid.rates_in(rod.grid.element_of_node[[node]])
        rate = 1.0 if rates is None else as_matrix(rates)[0]
        tangent = rotation @ shape.tangent[:, node] / rate
        curvature: Matrix = ca.MX.zeros(3)
        for director, row in zip(shape.directors, rod.strain_rows(shape.q, (0, 1, 2), shape.ratio), strict=True):
            if row is not None:
                curvature = curvature + rotation @ director[:, node] * row[node] / rate
        turned: Matrix = rod.properties.length * ca.cross(curvature, tangent)
        return system.position_at(name, node), tangent, turned

    def normal_of_body(self, touch: Touch) -> Matrix:
        """Normal of the obstacle at the origin of the body that touches it."""
        system = self._written.system
        obstacle = obstacle_of(system.discrete.scene, touch.obstacle)
        normal: Matrix = surface(obstacle)(system.body(touch.owner).position)[1]
        return normal

    def _forces(self) -> Iterator[tuple[Touch, Matrix, Matrix]]:
        """Each contact, the forces at its ends and the coefficients of the force along it, dimensionless."""
        _, f, _ = self._written.unknowns
        return self._written.state.with_forces(f, self._written.modes)

    def _unit(self, touch: Touch) -> float:
        return self._written.system.discrete.contact_unit(touch.owner, of_body=touch.of_body)


def touches_bodies(scene: scenes.Scene) -> bool:
    """Whether any body of a scene may touch an obstacle exactly."""
    return any(True for _ in body_pairs(scene))


def words_of(chosen: Chosen) -> tuple[str, ...]:
    """Kernels of every arrangement of a library, in the order of the table in C."""
    further = (
        (WATCHED, bool(chosen.richer)),
        (ACTUATORS, bool(chosen.scene.actuators)),
        (BENDS, chosen.judges_stability),
    )
    return (*WORDS, *(word for word, is_there in further if is_there))


def distance_kernels(chosen: Chosen, name: str) -> list[ca.Function]:
    """Point ↦ distance from an obstacle, for each obstacle that may be touched."""
    kernels = {}
    for _, obstacle in (*pairs(chosen.scene), *body_pairs(chosen.scene)):
        number = [other.name for other in chosen.scene.obstacles].index(obstacle.name)
        kernels[obstacle.name] = distance_kernel(obstacle, f"{name}_{number}")
    return list(kernels.values())
