"""Base class of loads: a kind of load gives the wrench of its table on one section of a rod or on a body.

A member is one file and one line of the registry. It gives :meth:`Load.wrench`, a small function of a section, or
:meth:`Load.energy`, of which the wrench is the derivative. Its treatment by the mechanics follows from its structure: a
wrench that does not depend on the pose is coefficients times known profiles, dead or follower by its axes, and any
other is evaluated section by section and differentiated by CasADi. The structure also tells whether it has a potential.
"""

from __future__ import annotations

from abc import ABC
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import zip_longest
from typing import ClassVar, Generic, Literal, TypeVar

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem
from cosserat_casadi.maths.chebyshev import legendre_polynomials
from cosserat_casadi.maths.numbers import (
    Numbers,
    Scalar,
    any_symbolic,
    as_matrix,
    as_vector,
    is_symbolic,
    is_zero,
    known,
    legendre_table,
)
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.rod.properties import RodProperties
from cosserat_casadi.rod.section_kernel import wrench_of_energy
from cosserat_casadi.scene.actuator_records import ACTUATORS
from cosserat_casadi.scene.families import Kind, Kinds
from cosserat_casadi.scene.load_records import LOADS, LoadRecord

Sort = Literal["point", "moment", "line"]

UNITS: dict[Sort, str] = {"point": "N", "moment": "N m", "line": "N/m"}
"""Unit of an arrow of each sort."""


@dataclass(frozen=True)
class Arrow:
    """An arrow of a picture.

    Attributes:
        start: start of the arrow, world axes, shape (3,), m.
        vector: force, moment or force per length, world axes, shape (3,), in the unit of its sort.
        sort: kind of vector that the arrow stands for.
        label: its entry in the legend; empty if another arrow has the entry.
    """

    start: FloatArray
    vector: FloatArray
    sort: Sort
    label: str


RecordType = TypeVar("RecordType", bound=LoadRecord)

EFFECTS = Kinds(LOADS, ACTUATORS)
"""Mechanics of loads and actuators by the words of the scene format."""

Axes = Literal["world", "section"]
Poses = tuple[FloatArray, FloatArray]
"""World positions (3, k) in m and rotation matrices world_R_section (k, 3, 3) of k sections."""

UnloadedPoses = tuple[Numbers, Numbers]
"""World positions (3, k) in m and rotation matrices world_R_section, column after column (9, k), of k sections."""


AT_REST = ca.DM(3, 1)
"""Rate of a section at rest: zeros without entries."""


@dataclass(frozen=True)
class Section:
    """The section of a rod, or the point of a body, that a load acts on.

    Attributes:
        position: 3×1, world axes, m.
        rotation: 3×3, world_R_section, or world_R_body.
        data: the numbers that :meth:`Load.data` gives for this section, d×1.
        velocity: velocity of its centre, world axes, 3×1, m/s; at rest this and the other rates are zeros without
            entries.
        angular_velocity: 3×1, rad/s.
        acceleration: acceleration of its centre, 3×1, m/s².
        angular_acceleration: 3×1, rad/s².
    """

    position: Matrix
    rotation: Matrix
    data: Matrix
    velocity: Matrix = AT_REST
    angular_velocity: Matrix = AT_REST
    acceleration: Matrix = AT_REST
    angular_acceleration: Matrix = AT_REST


@dataclass(frozen=True)
class Site:
    """Sections of a rod before it is loaded.

    Attributes:
        rod: properties of the rod.
        X: abscissae of the sections, shape (k,), numbers, or expressions if a parameter moves elements.
        unloaded: function that returns the poses of the sections in the unloaded scene.
        nodal: values at the sections of the load's nodal input, h×k; None without such an input.
    """

    rod: RodProperties
    X: Numbers
    unloaded: Callable[[], UnloadedPoses]
    nodal: Matrix | None = None

    @cached_property
    def unloaded_position(self) -> Numbers:
        """World positions in the unloaded scene, shape (3, k), m."""
        return self.unloaded()[0]

    @cached_property
    def unloaded_rotation(self) -> Numbers:
        """World rotation matrices in the unloaded scene, column after column, shape (9, k)."""
        return self.unloaded()[1]


@dataclass(frozen=True)
class BodyPoint:
    """Application point and factor of a load on a rigid body.

    Attributes:
        position: the application point of the force, in the axes of the body, m.
        factor: factor on force and moment.
    """

    position: tuple[Scalar, Scalar, Scalar] = (0.0, 0.0, 0.0)
    factor: Scalar = 1.0


@dataclass(frozen=True)
class Rubbing:
    """Friction of a section on an obstacle.

    Attributes:
        history: history of the section for the next point of a path, h×1.
        slip: drag, or speed, over the value at which it slips, 1×1; −1 for a section that is not pressed.
        friction: force of friction, N/m, 3×1.
    """

    history: Matrix
    slip: Matrix
    friction: Matrix


class Load(Kind, ABC, Generic[RecordType]):
    """One kind of load.

    The methods take ``load``, the frozen record of the scene. ``values`` has each input as a 3×k or 1×1 matrix,
    symbolic or numeric; entries that are always zero are not stored.

    Attributes:
        record: the record of the scene, whose word, inputs and units are the load's.
        kind: the word of the scene format.
        per_mass: whether its force is per mass, so that it acts on masses that are fixed to sections too.
        uniform: whether a wrench per length has the profile 1 all along the rod: varying numbers are data of the
            sections. Otherwise its columns are coefficients of Legendre polynomials.
        nodal: name of an input with values at each node of the rod; empty for none.
    """

    record: ClassVar[type[LoadRecord]]
    family = LOADS
    kinds = EFFECTS
    per_mass: ClassVar[bool] = False
    uniform: ClassVar[bool] = False
    nodal: ClassVar[str] = ""

    def growth(self, load: RecordType, site: Site) -> int:
        """Power of the load factor by which a pose-dependent load grows from the unloaded scene."""
        return 1

    def wrench(self, load: RecordType, section: Section, values: Mapping[str, Matrix]) -> tuple[Matrix, Matrix]:
        """Force and moment on a section, in the load's axes.

        By default they are minus the derivatives of :meth:`energy`; for a load without an energy, the scene's values.

        Returns:
            force in N and moment in N m, or both per metre for a load that has no abscissa: 3×k each, where column j
            multiplies profile j of :meth:`profiles`.
        """
        # The pose consists of free symbols while a load is traced, so that the energy can be differentiated here.
        energy = self.energy(load, section, values)
        if energy is not None:
            return wrench_of_energy(energy, section.position, section.rotation)
        if "force" not in values or "moment" not in values:
            raise NotImplementedError(f"{type(self).__name__} gives neither a wrench nor an energy")
        return values["force"], values["moment"]

    def energy(self, load: RecordType, section: Section, values: Mapping[str, Matrix]) -> Matrix | None:
        """Potential energy on a section, 1×1, J or J/m; None for a load that is not given by an energy."""
        return None

    def axes(self, load: RecordType) -> Axes:
        """Axes of the force and the moment in the scene; a load that is given by an energy is in world axes."""
        frame = getattr(load, "frame", "world")
        return "section" if frame == "body" else "world"

    def abscissa(self, load: RecordType) -> Scalar | None:
        """Abscissa X of the section that the load acts on; None for a load per length along the rod.

        By default it is ``at`` of the record, if it has this key.
        """
        return getattr(load, "at", None)

    def acts_on(self, load: RecordType, rod: str) -> bool:
        """Whether the load acts on the rod of this name."""
        return bool(getattr(load, "rod", None) == rod)

    def on_body(self, load: RecordType, body: scenes.Body) -> BodyPoint | None:
        """How the load acts on a rigid body of the scene; None if it does not.

        By default it acts at the point ``position`` of the body that the record names, or at its origin.
        """
        if getattr(load, "body", None) != body.name:
            return None
        return BodyPoint(getattr(load, "position", BodyPoint.position))

    def seen_from(self, load: RecordType) -> str | None:
        """Name of the body that bears the reaction of a load on rods, which is in its axes; None for the world.

        Poses and wrenches of sections are then in the axes of this body.
        """
        return None

    def span(self, load: RecordType) -> tuple[Scalar, Scalar]:
        """Abscissae X between which a load per length acts: ``span`` of the record, else the whole rod."""
        start, end = getattr(load, "span", (0.0, 1.0))
        return start, end

    def breaks(self, load: RecordType) -> tuple[Scalar, ...]:
        """Abscissae of jumps in the rod's fields, at which its elements must end."""
        # Strain and internal force jump at a point load, their derivatives jump at the ends of a load per length.
        at = self.abscissa(load)
        if at is None:
            return self.span(load)
        return (at,)

    def faults(self, load: RecordType, site: Site) -> Iterator[Problem]:
        """Problems of a load on an unloaded rod, tested at many sections; none by default."""
        yield from ()

    def profiles(self, load: RecordType, rod: RodProperties, X: Numbers, columns: int) -> Numbers:
        """Factors on the columns of a wrench per length at abscissae X, shape (columns, len(X)); see ``uniform``."""
        return np.ones((columns, X.shape[0])) if self.uniform else polynomials_at(columns, X)

    def data(self, load: RecordType, site: Site) -> Numbers:
        """Numbers of each section that the wrench depends on, shape (d, k), such as its unloaded position."""
        return np.zeros((0, site.X.shape[0]))

    def remembers(self, load: RecordType) -> int:
        """Count of numbers in the history of each section along a path; 0 by default."""
        return 0

    def rubbing(self, load: RecordType, section: Section) -> Rubbing:
        """Friction of a section on its obstacle, for a load with a history."""
        raise NotImplementedError(f"{type(self).__name__} remembers nothing")

    def arrows(
        self, load: RecordType, label: str, position: FloatArray, force: FloatArray, moment: FloatArray
    ) -> list[Arrow]:
        """Arrows of the load on a rod: force and moment at its section, or force per length along the rod.

        A load per length without force is drawn by its moment.

        Args:
            load: record of the load in the scene.
            label: its name in the legend; empty if the legend has it already.
            position: positions of the k drawn sections, world axes, shape (3, k), m.
            force: force on these sections, world axes, shape (3, k), N or N/m.
            moment: moment on these sections, world axes, shape (3, k), N m or N m/m.
        """
        if self.abscissa(load) is not None:
            return self.point_arrows(label, position, force, moment)
        sort: Sort = "line"
        drawn, unit = force, UNITS[sort]
        if not np.any(force):
            sort = "moment"
            drawn, unit = moment, "N m/m"
        largest = float(np.linalg.norm(drawn, axis=0).max())
        legend = f"{label}: up to {largest:.3g} {unit}" if label else ""
        arrows = []
        for start, vector in zip(position.T, drawn.T, strict=True):
            if np.any(vector):
                arrows.append(Arrow(start, vector, sort, legend))
            # One entry in the legend is enough.
            legend = ""
        return arrows

    def point_arrows(self, label: str, position: FloatArray, force: FloatArray, moment: FloatArray) -> list[Arrow]:
        """Arrows of force and moment on one section or on a body, shape (3, 1) each; a zero vector is not drawn."""
        arrows = []
        vectors: dict[Sort, FloatArray] = {"point": force[:, 0], "moment": moment[:, 0]}
        for sort, vector in vectors.items():
            if not np.any(vector):
                continue
            size = float(np.linalg.norm(vector))
            legend = f"{label}: {size:.3g} {UNITS[sort]}" if label else ""
            arrows.append(Arrow(position[:, 0], vector, sort, legend))
        return arrows


def polynomials_at(count: int, X: Numbers) -> Numbers:
    """Legendre polynomials in 2X − 1 at abscissae, shape (count, len(X))."""
    # The constant polynomial is a number even at symbolic abscissae.
    if count == 1:
        return np.ones((1, X.shape[0]))
    if is_symbolic(X):
        return as_matrix(legendre_table(count, X)).T
    return np.asarray(legendre_polynomials(count, known(X)).T)


def legendre_series(series: Numbers, X: Numbers) -> Numbers:
    """Series of Legendre polynomials in 2X − 1 at abscissae, from coefficients (m, k): shape (m, len(X))."""
    return combined(series, polynomials_at(series.shape[1], X))


def combined(weights: Numbers, functions: Numbers) -> Numbers:
    """Weighted sums, weights (m, k), of functions at n abscissae, (k, n): shape (m, n)."""
    if any_symbolic([weights, functions]):
        return as_matrix(weights) @ as_matrix(functions)
    return known(weights) @ known(functions)


def coefficients(components: tuple[Scalar | tuple[Scalar, ...], ...]) -> Numbers:
    """Three components, each a number or a list of Legendre coefficients, as one (3, k) array."""
    if any_symbolic(components):
        return _symbolic_coefficients(components)
    rows = [np.atleast_1d(np.asarray(component, dtype=float)) for component in components]
    longest = max(len(row) for row in rows)
    matrix = np.zeros((len(rows), longest))
    for i, row in enumerate(rows):
        matrix[i, : len(row)] = row
    return matrix


def _symbolic_coefficients(components: tuple[Scalar | tuple[Scalar, ...], ...]) -> Matrix:
    """Three components with expressions among their numbers as one 3×k matrix; zeros are not stored."""
    rows = [component if isinstance(component, tuple) else (component,) for component in components]
    degrees = zip_longest(*rows, fillvalue=0.0)
    return ca.horzcat(*map(as_vector, degrees))


def constant(values: Numbers) -> Matrix | None:
    """A constant magnitude; None if it is zero, so that it adds no instruction."""
    if is_zero(values):
        return None
    if is_symbolic(values):
        return values
    return ca.sparsify(as_matrix(values))
