"""What residual and Jacobian of a rod cost, foreseen without building them.

Counting the operations of a model takes longer than solving it, compiling it far longer. The laws here follow the
products that the Jacobian is made of (rod/tangent.py); their factors are fitted to counted and compiled models of every
strain model, section and load (benchmarks/compiled_cost.py). They are right to a fifth or so, and better where they
only compare discretisations of one rod.
"""

from __future__ import annotations

from dataclasses import dataclass

from cosserat_casadi import scene as scenes
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.rod.properties import RodProperties

STRAIGHT = 25_000
"""Instructions up to which a kernel is straight-line code: a third faster than loops, but compilers choke on more.

Functions of one interval are called: each call is one instruction.
"""

_LAWS = {
    "magnus4": (433.0, 84.0, 1.3),
    "magnus6": (937.0, 116.0, 2.1),
    "magnus8": (5120.0, 108.0, 5.1),
}
"""For each interval: operations of its functions, and the factors of the turning coordinates and of their square."""

_PLANAR = (114.0, 8.8, 0.5)
"""The same for a rod that turns about one axis, where all methods are one."""

_STRAIGHT_TIME = (0.14, 0.29e-3, 0.44e-3)
"""µs of straight-line code: a constant, the factor of operations in functions of an interval, that of the others."""

_LOOPS_TIME = (0.66, 0.39e-3, 0.34e-3, 0.18e-3, 0.18e-3)
"""µs of loops: for each interval, and the factors of the parts of :class:`Operations`."""


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
    def instructions(self) -> float:
        """Those that are not in functions of an interval."""
        return self.structure + self.follower + self.couple

    @property
    def all(self) -> float:
        """Their sum."""
        return self.intervals + self.instructions


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
    planar = len(rod.turning_axes) < 2
    function, linear, square = _PLANAR if planar else _LAWS[chosen.transport]
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
    if spread.couple and not planar:
        couple = 3 * twice * nodes * turning**2 + 9 * nodes * turning
    return Operations(
        intervals=intervals * function,
        structure=intervals * structure,
        follower=follower,
        couple=couple,
    )


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
    operations = foreseen_operations(rod, chosen, spread)
    if operations.instructions <= STRAIGHT:
        constant, in_functions, in_kernel = _STRAIGHT_TIME
        time = constant + in_functions * operations.intervals
        return time + in_kernel * operations.instructions
    per_interval, *factors = _LOOPS_TIME
    counts = (
        operations.intervals,
        operations.structure,
        operations.follower,
        operations.couple,
    )
    looped = sum(factor * count for factor, count in zip(factors, counts, strict=True))
    return per_interval * chosen.elements * chosen.nodes + looped


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
