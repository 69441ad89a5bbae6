"""A model with a further function for all drawn parts of a scene, for pictures from the compiled library.

Exports for controllers do not have this function.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi.actuators.routing import drawn_places, offset_at
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.loads.load import Sort
from cosserat_casadi.maths.numbers import Numbers
from cosserat_casadi.maths.rotation import quaternion_to_matrix
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.arrow_records import DrawnPoses, LoadArrows
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.floating_frames import FrameName
from cosserat_casadi.model.function_table import Expressions, Output, scene_function
from cosserat_casadi.model.system import Arguments, System

SECTIONS = np.linspace(0.0, 1.0, 49)
"""Abscissae of the drawn points of rods and actuators."""


@dataclass(frozen=True)
class Drawn:
    """One drawn part of a scene.

    Attributes:
        kind: "rod" (position and quaternion of each section, 7×k), "actuator" (positions, 3×k), "body" (position and
            quaternion, 7×1), or "arrows" (start and vector of each, 6×k); in m, vectors in the unit of their sort.
        name: name of the rod, the actuator, the body or the load.
        numbers: columns as above.
        sort: sort of the vectors of arrows.
    """

    kind: str
    name: str
    numbers: Matrix
    sort: Sort | None = None

    @property
    def key(self) -> tuple[str, str, Sort | None]:
        """Key of the part among all drawn parts."""
        return self.kind, self.name, self.sort


class DrawnModel(Model):
    """A model with a drawing function for use without Python."""

    @scene_function(
        Output("drawn"),
        kernel="drawn",
        header="What is drawn of the scene, in the order of the layout of the page: poses of sections and of bodies, "
        "points of actuators, arrows of loads, world axes.",
    )
    def drawn(self, written: Expressions) -> list[Matrix]:
        """(x, inputs) ↦ all numbers of a picture, one column."""
        return [drawn_column(drawn_parts(written.system))]


def drawn_column(parts: Iterable[Drawn]) -> Matrix:
    """All numbers of drawn parts, one column."""
    return ca.densify(ca.vertcat(*[ca.vec(part.numbers) for part in parts]))


def drawn_layout(model: Model) -> list[dict[str, Any]]:
    """Layout of the parts in ``drawn``: kind, name, first entry, rows, columns, sort of arrows."""
    entries: list[dict[str, Any]] = []
    first = 0
    for part in _symbolic_parts(model):
        rows, columns = part.numbers.shape
        entry = {"kind": part.kind, "name": part.name, "first": first, "rows": rows, "columns": columns}
        if part.sort is not None:
            entry["sort"] = part.sort
        entries.append(entry)
        first += rows * columns
    return entries


def drawn_numbers(wanted: Model, solution: Solution) -> FloatArray:
    """The drawn parts of an equilibrium, shape (k,), in the layout of a model with a subset of the solution's loads."""
    arguments = Arguments(ca.DM(solution.x), ca.DM(solution.inputs))
    system = System(solution.model.discrete, arguments)
    numbers = {part.key: part.numbers for part in drawn_parts(system)}
    drawn = [ca.densify(numbers[part.key]) for part in _symbolic_parts(wanted)]
    stacked = ca.vertcat(*map(ca.vec, drawn))
    return np.asarray(ca.evalf(stacked).full()[:, 0])


def _symbolic_parts(model: Model) -> Iterator[Drawn]:
    symbols = Arguments(ca.MX.sym("x", model.size), ca.MX.sym("inputs", model.inputs.size))
    return drawn_parts(System(model.discrete, symbols))


def drawn_parts(system: System, loaded: DiscreteScene | None = None, inputs: Matrix | None = None) -> Iterator[Drawn]:
    """All drawn parts, as expressions: rods, actuators, bodies, loads, in the order of the scene.

    Args:
        system: system of the equilibrium.
        loaded: the scene with the drawn loads; by default that of the system, which in contact has further loads.
        inputs: stacked inputs of ``loaded``.
    """
    picture = _Picture(system, loaded or system.discrete, system.arguments.inputs if inputs is None else inputs)
    scene = system.discrete.scene
    for rod in system.discrete.rods:
        position, quaternion = picture.sections(rod, SECTIONS)
        yield Drawn("rod", rod, ca.vertcat(position, quaternion))
    for actuator in scene.actuators:
        if hasattr(actuator, "offset"):
            yield Drawn("actuator", actuator.name, picture.routing(actuator))
    for body in scene.bodies:
        pose = system.frame(FrameName("body", body.name))
        yield Drawn("body", body.name, ca.vertcat(pose.position, pose.quaternion))
    yield from picture.arrows()


def sections_of(system: System, rod: str, X: Numbers) -> tuple[Matrix, Matrix]:
    """World positions 3×k and unit quaternions 4×k of sections of a system."""
    return _Picture(system, system.discrete, system.arguments.inputs).sections(rod, X)


@dataclass(frozen=True)
class _Picture:
    """Expressions of the picture of a system, with the loads of a scene at given inputs."""

    system: System
    loaded: DiscreteScene
    inputs: Matrix

    @cached_property
    def _fields(self) -> dict[str, tuple[Matrix, Matrix]]:
        """World positions 3×M and quaternions 4×M at the nodes of every rod."""
        return {rod: (self.system.nodes(rod), self.system.nodal_quaternions(rod)) for rod in self.system.shapes}

    def sections(self, rod: str, X: Numbers) -> tuple[Matrix, Matrix]:
        """World positions 3×k and unit quaternions 4×k of sections, interpolated through the nodes."""
        grid = self.system.discrete.rods[rod].grid
        position, quaternion = self._fields[rod]
        between = grid.interpolated(quaternion, X)
        norm = ca.sqrt(ca.sum1(between**2))
        return grid.interpolated(position, X), between / ca.repmat(norm, 4, 1)

    def routing(self, actuator: Any) -> Matrix:
        """Points r + R D of an actuator's routing in world axes, 3×k."""
        X = drawn_places(actuator, SECTIONS)
        offset, _ = offset_at(actuator, X)
        position, rotations = self._rod_poses(actuator.rod, X)
        points = [position[:, k] + rotations[k][:, :2] @ ca.DM(offset[:, k]) for k in range(len(X))]
        routing: Matrix = ca.horzcat(*points)
        return routing

    def arrows(self) -> Iterator[Drawn]:
        """Arrows of all loads, without loads that are identically zero."""
        loads = LoadArrows(self.loaded, self.inputs, self._rod_poses, self._body_pose)
        for drawn in loads.drawn():
            vectors: dict[Sort, Matrix] = {"line": drawn.force}
            if drawn.at_point:
                vectors = {"point": drawn.force, "moment": drawn.moment}
            for sort, vector in vectors.items():
                if vector.nnz():
                    yield Drawn("arrows", drawn.load.name, ca.vertcat(drawn.position, vector), sort)

    def _rod_poses(self, rod: str, X: FloatArray) -> DrawnPoses:
        position, quaternion = self.sections(rod, X)
        return position, [quaternion_to_matrix(column) for column in ca.horzsplit(quaternion)]

    def _body_pose(self, body: str) -> DrawnPoses:
        pose = self.system.frame(FrameName("body", body))
        return pose.position, [pose.rotation]
