"""What residual and Jacobian of a rod cost, foreseen without building them.

Counting the operations of a model takes longer than solving it, compiling it far longer. The laws of operations follow
the products that the Jacobian is made of (rod/tangent.py). Length and time of the C, whose columns are computed four at
a time (codegen/columns.py), are affine in few terms: intervals, groups of four columns in them, entries of the
Jacobian. benchmarks/compiled_cost.py fits their factors to compiled rods of every strain model, section and load, and
tells how far they are off.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil

from cosserat_casadi import scene as scenes
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.properties import RodProperties

STRAIGHT = 25_000
"""Instructions up to which a kernel is straight-line code: a third faster than loops, but compilers choke on more.

Functions of one interval are called: each call is one instruction.
"""

MOST_IN_COLUMNS = 60_000
"""Statements up to which a Jacobian is written by columns, four at a time; a longer one is written in loops.

Compilers take more than a minute for 90 000.
"""

TOGETHER = 4
"""Columns that are computed together."""

PLANAR = "planar"
"""Stands for the method of a rod that turns about one axis, where all methods are one."""

_LAWS = {
    "magnus4": (433.0, 84.0, 1.3),
    "magnus6": (937.0, 116.0, 2.1),
    "magnus8": (5120.0, 108.0, 5.1),
    PLANAR: (114.0, 8.8, 0.5),
}
"""For each interval: operations of its functions, and the factors of the turning coordinates and of their square."""


@dataclass(frozen=True)
class AffineLaw:
    """A law of C with columns in fours: factors of :class:`Terms`.

    Attributes:
        constant: whatever the rod.
        of_intervals: of the intervals, by method.
        groups: of the groups of columns.
        entries: of the entries of the Jacobian.
        follower: of operations for a force per length that turns with the sections.
        couple: of operations for a moment per length.
    """

    constant: float
    of_intervals: Mapping[str, float]
    groups: float
    entries: float
    follower: float
    couple: float


@dataclass(frozen=True)
class LoopsLaw:
    """A law of C in loops: factors.

    Attributes:
        intervals: of the intervals, each as often as it has axes to turn about.
        structure: of operations for sums and products of any rod.
        loads: of operations for loads along the rod.
    """

    intervals: float
    structure: float
    loads: float


STATEMENTS = AffineLaw(
    constant=217.0,
    of_intervals={PLANAR: 41.8, "magnus4": 137.0, "magnus6": 224.0, "magnus8": 480.0},
    groups=0.0,
    entries=6.68,
    follower=1.04,
    couple=1.18,
)
"""Statements of the Jacobian by columns, which are written once for all groups of columns."""

TIME_IN_COLUMNS = AffineLaw(
    constant=0.0446,
    of_intervals={PLANAR: 0.0416, "magnus4": 0.00908, "magnus6": 0.0365, "magnus8": 0.156},
    groups=0.0178,
    entries=0.00176,
    follower=0.143e-3,
    couple=0.239e-3,
)
"""µs of residual and Jacobian by columns."""

TIME_IN_LOOPS = LoopsLaw(intervals=0.101, structure=0.499e-3, loads=0.156e-3)
"""µs of residual and Jacobian in loops."""


@dataclass(frozen=True)
class Spread:
    """What of the loads spread along a rod makes its Jacobian costlier; dead forces do not.

    Attributes:
        follower: a force per length turns with the sections.
        couple: there is a moment per length.
    """

    follower: bool = False
    couple: bool = False


@dataclass(frozen=True)
class Operations:
    """Scalar operations of residual and Jacobian, by what they belong to.

    Attributes:
        intervals: functions of the intervals.
        structure: sums and products of any rod.
        follower: a force per length that turns with the sections.
        couple: a moment per length.
    """

    intervals: float
    structure: float
    follower: float
    couple: float

    @property
    def all(self) -> float:
        """Their sum."""
        return self.intervals + self.structure + self.follower + self.couple


@dataclass(frozen=True)
class Terms:
    """What the laws of C with columns in fours are affine in.

    Attributes:
        method: of the rotations, or :data:`PLANAR`.
        intervals: intervals, each as often as it has axes to turn about.
        groups: groups of four columns in each of them; none of a planar rod, whose columns are constant.
        entries: entries of the Jacobian.
        operations: of the Jacobian, among them those for loads along the rod.
    """

    method: str
    intervals: float
    groups: float
    entries: float
    operations: Operations


def spread_on(scene: scenes.Scene, rod: str) -> Spread:
    """What the scene spreads along a rod."""
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
        rod: what the rod is made of.
        chosen: a candidate; its transport is one of the Magnus methods.
        spread: loads along the rod.
    """
    method = _method(rod, chosen)
    function, linear, square = _LAWS[method]
    elements = chosen.elements
    nodes = elements * (chosen.nodes + 1)
    intervals = elements * chosen.nodes
    turning, stretching = _coordinates(rod, chosen)
    # A coordinate moves the elements beyond its own only: these are shares of all pairs, and of all triples.
    once = (elements + 1) / (2 * elements)
    twice = (elements + 1) * (2 * elements + 1) / (6 * elements**2)
    structure = linear * once * turning + square * (once * turning) ** 2
    structure += 32 * once * stretching + 0.6 * once**2 * turning * stretching
    follower = 0.0
    if spread.follower:
        # The product with S that dead forces do without (docs/theory.md, section 6).
        products = 6 * once * nodes**2
        variations = 6 * once * nodes * (turning + stretching)
        follower = turning * (products + 9 * nodes + variations)
    couple = 0.0
    # About one axis rotations commute, and a moment per length leaves the Jacobian as it is.
    if spread.couple and method != PLANAR:
        couple = 3 * twice * nodes * turning**2 + 9 * nodes * turning
    return Operations(
        intervals=intervals * function,
        structure=intervals * structure,
        follower=follower,
        couple=couple,
    )


def terms_of(rod: RodProperties, chosen: Discretisation, spread: Spread = Spread()) -> Terms:
    """What the laws of C with columns in fours are affine in, of one rod.

    Args:
        rod: what the rod is made of.
        chosen: a candidate; its transport is one of the Magnus methods.
        spread: loads along the rod.
    """
    method = _method(rod, chosen)
    turning, stretching = _coordinates(rod, chosen)
    intervals = chosen.elements * chosen.nodes * len(rod.turning_axes)
    groups = 0 if method == PLANAR else ceil(turning / TOGETHER)
    return Terms(
        method=method,
        intervals=intervals,
        groups=intervals * groups,
        entries=(turning + stretching) ** 2,
        operations=foreseen_operations(rod, chosen, spread),
    )


def foreseen_statements(terms: Terms) -> float:
    """Statements of the Jacobian by columns in C, approximately: what :data:`MOST_IN_COLUMNS` is a bound of."""
    return _affine(STATEMENTS, terms)


def time_in_columns(terms: Terms) -> float:
    """Time of residual and Jacobian by columns, µs."""
    return _affine(TIME_IN_COLUMNS, terms)


def time_in_loops(terms: Terms) -> float:
    """Time of residual and Jacobian in loops, µs."""
    operations = terms.operations
    of_rod = TIME_IN_LOOPS.intervals * terms.intervals + TIME_IN_LOOPS.structure * operations.structure
    of_loads = TIME_IN_LOOPS.loads * (operations.follower + operations.couple)
    return of_rod + of_loads


def foreseen_time(
    rod: RodProperties,
    chosen: Discretisation,
    spread: Spread = Spread(),
) -> float:
    """Time of one rod's residual and Jacobian compiled with ``gcc -O2``, µs on the machine that the law was fitted on.

    Args:
        rod: what the rod is made of.
        chosen: a candidate; its transport is one of the Magnus methods.
        spread: loads along the rod.
    """
    terms = terms_of(rod, chosen, spread)
    if foreseen_statements(terms) <= MOST_IN_COLUMNS:
        return time_in_columns(terms)
    return time_in_loops(terms)


def _affine(law: AffineLaw, terms: Terms) -> float:
    of_rod = law.of_intervals[terms.method] * terms.intervals + law.groups * terms.groups + law.entries * terms.entries
    of_loads = law.follower * terms.operations.follower + law.couple * terms.operations.couple
    return law.constant + of_rod + of_loads


def _method(rod: RodProperties, chosen: Discretisation) -> str:
    """The method of the rotations, or :data:`PLANAR`."""
    return PLANAR if len(rod.turning_axes) < 2 else chosen.transport


def _coordinates(rod: RodProperties, chosen: Discretisation) -> tuple[float, float]:
    """Coordinates of a rod that turn sections, and those that stretch or shear."""
    turning = 0
    stretching = 0
    for modes, component in zip(chosen.modes, rod.admitted, strict=True):
        if component < 3:
            turning += modes
        else:
            stretching += modes
    return chosen.elements * turning, chosen.elements * stretching
