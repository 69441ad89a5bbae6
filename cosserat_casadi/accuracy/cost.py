"""Predicted time of residual and Jacobian of a rod, without building them.

Counting the operations of a model takes longer than solving it, compiling it far longer. The laws of operations follow
the products in the Jacobian (rod/tangent.py). Length and time of the C, whose columns are computed four at a time
(codegen/columns.py), are affine in few terms: intervals, products with constant matrices in a column, entries of the
Jacobian. The code of columns is written once and runs for each group of four. benchmarks/compiled_cost.py fits the
factors to compiled rods of every strain model, section and load, and prints their errors. Factors of loops are
fitted to the rods of benchmarks/code_limit.py, which prints their foreseen times.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil

from cosserat_casadi import scene as scenes
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.properties import RodProperties

STRAIGHT = 3_000
"""Most instructions of a kernel in straight-line code: longer kernels are as fast in loops, and shorter code.

Functions of one interval are called: each call is one instruction.
"""

STRAIGHT_BESIDE_INTERVALS = 9_000
"""Most instructions of a function of one rod, intervals excluded, in straight-line code.

Four intervals are computed together. Loops take 1.5 to 2 times as long there: they gather arguments and results of the
intervals.
"""

STRAIGHT_IN_SHARES = 25_000
"""Instructions up to which a function of each rod of an assembly is straight-line code, shared by rods that are alike.

Six legs in loops take 1.5 times as long, and their C is longer (docs/theory.md).
"""

MOST_IN_COLUMNS = 50_000
"""Statements up to which a Jacobian is written by columns, four at a time; a longer one is written in loops.

Loops take up to a third longer there (benchmarks/code_limit.py); compilers take some 20 s for such code on a loaded
machine.
"""

TOGETHER = 4
"""Number of columns that are computed together: LANES of compiling/listing.py, which a solve does not load."""

PLANAR = "planar"
"""Name of the method for a rod that turns about one axis, for which all methods are equal."""

_LAWS = {
    "magnus4": (433.0, 84.0, 1.3),
    "magnus6": (937.0, 116.0, 2.1),
    "magnus8": (5120.0, 108.0, 5.1),
    PLANAR: (114.0, 8.8, 0.5),
}
"""Operations of the functions of an interval, and factors of the turning coordinates and of their square, by method."""

_TAYLOR_COUNT = {PLANAR: 1, "magnus4": 2, "magnus6": 3, "magnus8": 4}
"""Count of numbers of the strain about each axis in an interval, by method."""


@dataclass(frozen=True)
class AffineLaw:
    """A law of C with columns in fours: factors of :class:`Terms`.

    Attributes:
        constant: constant term.
        of_intervals: factor of the intervals, by method.
        in_columns: factor of the intervals in each group of columns.
        turns: factor of products with the matrix of turns in each group of columns.
        integrals: factor of products with the matrix of integration in each group of columns.
        entries: factor of the entries of the Jacobian.
    """

    constant: float
    of_intervals: Mapping[str, float]
    in_columns: float
    turns: float
    integrals: float
    entries: float


STATEMENTS = AffineLaw(
    constant=201.0,
    of_intervals={PLANAR: 65.9, "magnus4": 99.4, "magnus6": 128.0, "magnus8": 278.0},
    in_columns=0.0,
    turns=0.0,
    integrals=5.74,
    entries=1.64,
)
"""Statements of the Jacobian by columns, which are written once for all groups of columns."""

TIME_IN_COLUMNS = AffineLaw(
    constant=0.110,
    of_intervals={PLANAR: 0.0134, "magnus4": 0.0241, "magnus6": 0.0495, "magnus8": 0.165},
    in_columns=0.00679,
    turns=0.000586,
    integrals=0.00108,
    entries=0.000858,
)
"""µs of residual and Jacobian by columns."""

LOOP_TIMES = {"intervals": 0.157, "structure": 0.167e-3, "loads": 0.0538e-3}
"""µs of residual and Jacobian in loops, of rods near the limit (benchmarks/code_limit.py).

The factors are for each interval and turning axis, each operation of sums and products, and each of loads along a rod.
"""


@dataclass(frozen=True)
class Spread:
    """Kinds of loads along a rod that make its Jacobian costlier; dead forces do not.

    Attributes:
        follower: whether a force per length turns with the sections.
        couple: whether there is a moment per length.
    """

    follower: bool = False
    couple: bool = False


@dataclass(frozen=True)
class Operations:
    """Scalar operations of residual and Jacobian, by their cause.

    Attributes:
        intervals: functions of the intervals.
        structure: sums and products of every rod.
        follower: a force per length that turns with the sections.
        couple: a moment per length.
    """

    intervals: float
    structure: float
    follower: float
    couple: float

    @property
    def all(self) -> float:
        """Operations of all kinds together."""
        return self.intervals + self.structure + self.follower + self.couple


@dataclass(frozen=True)
class Terms:
    """Terms in which the laws of C with columns in fours are affine.

    Attributes:
        method: rotation integrator, or :data:`PLANAR`.
        groups: number of groups of four columns.
        intervals: number of intervals times turning axes.
        turns: products of one column with the constant matrix of turns.
        integrals: products of one column with the constant matrix of integration, for follower forces per length.
        entries: entries of the Jacobian.
        operations: operations of the Jacobian, loads along the rod included.
    """

    method: str
    groups: int
    intervals: float
    turns: float
    integrals: float
    entries: float
    operations: Operations


def spread_on(scene: scenes.Scene, rod: str) -> Spread:
    """The loads that the scene spreads along a rod."""
    follower = False
    couple = False
    for load in scene.loads:
        if load.kind != "distributed_wrench" or load.rod != rod:
            continue
        given = load.model_fields_set
        follower = follower or ("force" in given and load.frame == "body")
        couple = couple or "moment" in given
    return Spread(follower, couple)


def foreseen_operations(
    rod: RodProperties,
    chosen: Discretisation,
    spread: Spread = Spread(),
) -> Operations:
    """Scalar operations of one rod's residual and Jacobian, approximately.

    Args:
        rod: properties of the rod.
        chosen: a candidate discretisation with one of the Magnus methods as transport.
        spread: loads along the rod.
    """
    method = _method(rod, chosen)
    function, linear, square = _LAWS[method]
    elements = chosen.elements
    nodes = elements * (chosen.nodes + 1)
    intervals = elements * chosen.nodes
    turning, stretching = _coordinates(rod, chosen)
    once = _share_beyond(chosen)
    structure = linear * once * turning + square * (once * turning) ** 2
    structure += 32 * once * stretching + 0.6 * once**2 * turning * stretching
    # Loads without a potential need both triangles of the Jacobian.
    triangle = intervals * square * (once * turning) ** 2
    follower = 0.0
    if spread.follower:
        integrals = 2 * _integrals(rod, chosen)
        follower = triangle + turning * (integrals + nodes * (27 + 2.2 * stretching))
    couple = 0.0
    # About one axis rotations commute, and a moment per length leaves the Jacobian as it is.
    if spread.couple and method != PLANAR:
        couple = 31 * nodes * turning
        if not spread.follower:
            couple += triangle
    return Operations(
        intervals=intervals * function,
        structure=intervals * structure,
        follower=follower,
        couple=couple,
    )


def terms_of(rod: RodProperties, chosen: Discretisation, spread: Spread = Spread()) -> Terms:
    """Terms of one rod in which the laws of C with columns in fours are affine.

    Args:
        rod: properties of the rod.
        chosen: a candidate discretisation with one of the Magnus methods as transport.
        spread: loads along the rod.
    """
    method = _method(rod, chosen)
    turning, stretching = _coordinates(rod, chosen)
    return Terms(
        method=method,
        groups=ceil(turning / TOGETHER),
        intervals=chosen.elements * chosen.nodes * len(rod.turning_axes),
        turns=turning * chosen.nodes * _TAYLOR_COUNT[method],
        integrals=_integrals(rod, chosen) if spread.follower else 0.0,
        entries=(turning + stretching) ** 2,
        operations=foreseen_operations(rod, chosen, spread),
    )


def foreseen_statements(terms: Terms) -> float:
    """Statements of the Jacobian by columns in C, approximately; :data:`MOST_IN_COLUMNS` bounds this number."""
    return _affine(STATEMENTS, terms, groups=1)


def time_in_columns(terms: Terms) -> float:
    """Time of residual and Jacobian by columns, µs."""
    return _affine(TIME_IN_COLUMNS, terms, terms.groups)


def time_in_loops(terms: Terms) -> float:
    """Time of residual and Jacobian in loops, µs."""
    operations = terms.operations
    of_rod = LOOP_TIMES["intervals"] * terms.intervals + LOOP_TIMES["structure"] * operations.structure
    of_loads = LOOP_TIMES["loads"] * (operations.follower + operations.couple)
    return of_rod + of_loads


def foreseen_time(
    rod: RodProperties,
    chosen: Discretisation,
    spread: Spread = Spread(),
) -> float:
    """Time of one rod's residual and Jacobian compiled with ``gcc -O2``, µs on the machine that the law was fitted on.

    Args:
        rod: properties of the rod.
        chosen: a candidate discretisation with one of the Magnus methods as transport.
        spread: loads along the rod.
    """
    terms = terms_of(rod, chosen, spread)
    if foreseen_statements(terms) <= MOST_IN_COLUMNS:
        return time_in_columns(terms)
    return time_in_loops(terms)


def _affine(law: AffineLaw, terms: Terms, groups: int) -> float:
    """Value of a law for code that runs for ``groups`` groups of columns."""
    once = law.of_intervals[terms.method] * terms.intervals + law.entries * terms.entries
    of_group = law.in_columns * terms.intervals + law.turns * terms.turns + law.integrals * terms.integrals
    return law.constant + once + groups * of_group


def _method(rod: RodProperties, chosen: Discretisation) -> str:
    """The method of the rotations, or :data:`PLANAR`."""
    return PLANAR if len(rod.turning_axes) < 2 else chosen.transport


def _coordinates(rod: RodProperties, chosen: Discretisation) -> tuple[float, float]:
    """Coordinates of a rod that turn sections, and coordinates that stretch or shear."""
    turning = 0
    stretching = 0
    for modes, component in zip(chosen.modes, rod.admitted, strict=True):
        if component < 3:
            turning += modes
        else:
            stretching += modes
    return chosen.elements * turning, chosen.elements * stretching


def _share_beyond(chosen: Discretisation) -> float:
    """Share of pairs of elements with the second not before the first: a coordinate moves only these."""
    return (chosen.elements + 1) / (2 * chosen.elements)


def _integrals(rod: RodProperties, chosen: Discretisation) -> float:
    """Number of products with the matrix S, of the components of forces on the nodes that a turn of the rod changes."""
    nodes = chosen.elements * (chosen.nodes + 1)
    components = 2 if len(rod.turning_axes) < 2 else 3
    return components * _share_beyond(chosen) * nodes**2
